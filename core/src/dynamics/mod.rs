//! Rigid-body dynamics of any arm, a serial chain or a tree with coupled joints: inverse and forward dynamics, torque regressor, base
//! parameters.
//!
//! All functions are batched over samples laid out `[channel][time]`, and walk the chain in link frames, carrying the
//! joints' screws forward (Featherstone 2008 for the recursions, Atkeson, An and Hollerbach 1986 for the linearity in
//! the inertial parameters).

mod base_parameters;
mod branched;
mod chain;
mod composite;
mod forward;
mod kinematics;
mod nearly_dependent;
mod regressor;
mod rnea;
mod rotation;
mod spatial;
mod wrench;

pub use crate::lane::{Lane, Lanes};
pub use base_parameters::{BaseParameters, Grouping};
pub use chain::Chain;
pub use forward::{EquationsOfMotion, forward_dynamics};
pub use kinematics::{Point, coordinates};
pub use regressor::{Entries, block_row, regressor, regressor_in};
pub use rnea::{inverse_dynamics, inverse_dynamics_at, inverse_dynamics_in, inverse_dynamics_into, mass_matrix};

use crate::channels::Channels;
use std::ops::Range;

/// Positions, velocities and accelerations of all joints over time; each is `[joint][time]`.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::channels::Channels;
/// use tauscope::dynamics::{Chain, Motion, inverse_dynamics};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // A pendulum held in two poses, and its torque in them: m g l sin q.
/// let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let motion = Motion::at_rest(Channels::from_vectors(&[vec![0.0, 1.0]]));
/// let torque = inverse_dynamics(&Chain::new(&robot), &robot.inertial_parameters(), &motion);
/// let expected = [0.0, 2.0 * 9.81 * 0.5 * 1f64.sin()];
/// assert!(torque.channel(0).iter().zip(expected).all(|(torque, expected)| (torque - expected).abs() < 1e-9));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Motion {
    /// Positions, rad or m.
    pub q: Channels,
    /// Velocities, rad/s or m/s.
    pub qd: Channels,
    /// Accelerations, rad/s2 or m/s2.
    pub qdd: Channels,
}

impl Motion {
    /// A motion at rest at zero.
    pub fn zeros(joints: usize, samples: usize) -> Self {
        Motion::at_rest(Channels::zeros(joints, samples))
    }

    /// Poses without velocities and accelerations.
    pub fn at_rest(q: Channels) -> Self {
        let still = Channels::zeros(q.channels(), q.samples());
        Motion { q, qd: still.clone(), qdd: still }
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.q.channels()
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.q.samples()
    }

    /// Position, velocity and acceleration of one joint at up to a lane's width of samples.
    #[inline(always)]
    fn lanes<L: Lane>(&self, joint: usize, samples: Range<usize>) -> (L, L, L) {
        let part = |channels: &Channels| L::load_part(&channels.channel(joint)[samples.clone()]);
        (part(&self.q), part(&self.qd), part(&self.qdd))
    }
}
