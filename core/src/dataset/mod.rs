//! `dataset.toml`: what a log's file cannot say of itself. Columns, units, motors and gears, mounting and payload, and
//! which logs train and which are held out.
//!
//! ```toml
//! schema = "tauscope.dataset/1"
//! robot = "arm.urdf"            # beside this file
//! joints = ["j1", "j2"]         # joints under study, in the order of columns and lists below; without, those that the logs name
//!
//! [[train]]
//! file = "a.csv"
//! [[test]]
//! file = "b.csv"                # from_s and to_s, on the log's clock, take a part of a file
//! # files = ["q.csv", "tau.csv"]  # in the place of `file`: columns in several files, rows matched one by one where there
//!                                 # are as many in each, else by time
//! # rate_hz = 100                 # rows per second of files without a column of time; also in [columns]
//!
//! [columns]                     # one per joint; usual names are found without; numbers, from 1 on, of a file without names
//! time = "stamp"
//! # rate_hz = 100               # in the place of `time`
//! q = ["enc1", "enc2"]
//! tau = ["i1", "i2"]
//! topic = "/joint_states"       # of a log of ROS 2 with several that hold the joints
//!
//! [units]
//! time = "ms"                   # s, ms, us, ns; recognised from its name and numbers where it is not given
//! position = "deg"              # rad, deg, mrad, rev, m, mm, um; or a list of one per joint, as for velocity and acceleration
//! velocity = "rpm"              # rad/s, deg/s, mrad/s, rpm, rev/s, m/s, mm/s, um/s
//! acceleration = "deg/s2"       # rad/s2, deg/s2, m/s2
//! torque = "A"                  # Nm, mNm, kNm, kgf cm, kgf m, ozf in, lbf in, lbf ft, A, mA, N
//! # Units that the names of the columns give, as `q1 [deg]`, are used where none is given here.
//! time_factor = 1.6             # of a clock that runs wrong: true seconds per second of the log
//!
//! [motors]                      # a number for all or one per joint
//! gear_ratio = [100.0, 80.0]    # turns of the motor per turn of the joint
//! torque_constant_nm_a = 0.12
//! sign = [1, -1]                # of position, velocity and torque
//! torque_sign = -1              # of torque alone
//! position_offset = [0.0, 1.571]   # rad (m) that are added to positions at the joints, after their signs
//! torque_offset = 0.4           # N m (N) at the joint that the torque shows too much
//! position_at = "motor"         # or "joint"
//! torque_at = "motor"           # or "joint"; currents are at the motor
//! coupling = [[1.0, 0.0], [0.5, 1.0]]   # joints = coupling x motors, behind their gears
//! torques_exchanged = [["j1", "j2"]]    # pairs of joints in each other's columns of torque
//! positions_exchanged = [["j1", "j2"]]  # the same of position, velocity and acceleration
//!
//! [hold]                        # joints not under study that the logs do not have, or not at one place, rad or m
//! finger_joint = 0.02
//!
//! [payload]                     # at the flange, known
//! mass_kg = 5.0
//! center_m = [0.0, 0.0, 0.1]
//! inertia_kg_m2 = [0.1, 0.0, 0.1, 0.0, 0.0, 0.1]   # about its centre: xx, xy, yy, xz, yz, zz
//!
//! [mounting]
//! gravity_m_s2 = [0.0, 0.0, 9.81]   # in the base frame: an arm that hangs
//! ```

pub mod arm;
mod convert;
mod corrected;
mod description;
mod mounting;
mod order;
mod read;
mod ready;
mod spec;
mod still;
#[cfg(test)]
mod tests;
mod units;

pub use corrected::{Named, corrected};
pub use description::Dataset;
pub use read::{read, read_all};
pub use ready::{Logs, plain, ready};
pub use spec::SCHEMA;
