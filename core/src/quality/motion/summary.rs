//! Range, speed, reversals and torque of every joint.

use crate::linear::root_mean_square;
use crate::quality::view::View;
use crate::robot::Robot;
use crate::signal::size_quantile;

/// Range, speed and torque of a joint.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::quality;
///
/// let joints = quality::inspect("../tests/reference/payload/before.csv".as_ref(), None)?.joints;
/// assert_eq!(joints[1].name, "j2");
/// let [low, high] = joints[1].range;
/// assert!(low < -0.7 && high > -0.7 && joints[1].reversals > 10 && joints[1].torque_rms > 3.0);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct JointSummary {
    /// Name of the joint.
    pub name: String,
    /// Lowest and highest position, rad or m.
    pub range: [f64; 2],
    /// Share of the URDF's range that is used.
    pub range_share: Option<f64>,
    /// Highest speed, from positions, rad/s or m/s.
    pub speed: f64,
    /// Share of the URDF's speed.
    pub speed_share: Option<f64>,
    /// Reversals of the direction of motion.
    pub reversals: usize,
    /// Root mean square torque, N m or N.
    pub torque_rms: f64,
    /// Part of the torque that the joint's own model leaves unexplained, root mean square over root mean square.
    pub unexplained: Option<f64>,
    /// The constant torque that the joint's model lacks, and the share that is unexplained with it.
    #[serde(skip)]
    pub constant: Option<Constant>,
    /// Time by which the torque lags the motion, s, where the residual shows it.
    pub dead_time_s: Option<f64>,
}

/// A constant torque that no body makes: an offset of a sensor or of a current.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::{dataset, quality};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let mut read = dataset::read("../tests/reference/pendulum/train.csv".as_ref(), &robot)?;
/// // A torque sensor that reads 8 N m too much on a pendulum.
/// read.recording.tau.channel_mut(0).iter_mut().for_each(|torque| *torque += 8.0);
/// let constant = quality::examine(&read, Some(&robot))?.joints[0].constant.expect("the joint has a model");
/// assert!((constant.torque - 8.0).abs() < 0.5 && constant.unexplained < 0.3);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constant {
    /// Its size with its sign, N m or N.
    pub torque: f64,
    /// Part of the torque that stays unexplained with it, root mean square over root mean square.
    pub unexplained: f64,
}

/// Summaries of all joints.
pub(crate) fn summaries(view: &View, robot: Option<&Robot>) -> Vec<JointSummary> {
    (0..view.dof())
        .map(|joint| {
            let q = view.log.q.channel(joint);
            let range = q.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| [a.min(v), b.max(v)]);
            let speed = size_quantile(view.qd.channel(joint).iter().copied(), 1.0);
            let limits = robot.map(|robot| robot.joints[joint].limits);
            let span = limits.map(|limits| limits.upper - limits.lower).filter(|span| span.is_finite() && *span > 0.0);
            let fastest = limits.map(|limits| limits.velocity).filter(|v| v.is_finite());
            JointSummary {
                name: view.log.joints[joint].clone(),
                range,
                range_share: span.map(|span| (range[1] - range[0]) / span),
                speed,
                speed_share: fastest.map(|fastest| speed / fastest),
                reversals: reversals(view.qd.channel(joint), view.band[joint]),
                torque_rms: root_mean_square(view.log.tau.channel(joint)),
                unexplained: None,
                constant: None,
                dead_time_s: None,
            }
        })
        .collect()
}

fn reversals(velocity: &[f64], band: f64) -> usize {
    let mut direction = 0.0;
    let mut count = 0;
    for &v in velocity.iter().filter(|v| v.abs() > band) {
        if direction * v < 0.0 {
            count += 1;
        }
        direction = v.signum();
    }
    count
}
