//! Values that several tables of a scenario share.

use serde::{Deserialize, Serialize};

/// One value for all joints, or one per joint.
///
/// ```
/// use tauscope::scenario::PerJoint;
///
/// assert_eq!(PerJoint::All(0.5).values(3), [0.5, 0.5, 0.5]);
/// assert_eq!(PerJoint::Each(vec![3.0, 4.0]).values(2), [3.0, 4.0]);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "give a number, or a list with one number per joint")]
pub enum PerJoint {
    /// The same for every joint.
    All(f64),
    /// Base to flange.
    Each(Vec<f64>),
}

impl PerJoint {
    /// The value of every joint of an arm of `dof` joints; a list of another length was refused on loading.
    pub fn values(&self, dof: usize) -> Vec<f64> {
        match self {
            PerJoint::All(value) => vec![*value; dof],
            PerJoint::Each(values) => values.clone(),
        }
    }
}

/// A random sequence of rest-to-rest moves inside the limits.
///
/// ```
/// use tauscope::scenario::{RandomMotion, Scenario};
///
/// // [held_out.random] of a scenario.
/// let scenario = Scenario::load("tests/scenarios/pendulum.toml")?;
/// assert_eq!(scenario.held_out.random, Some(RandomMotion { moves: 3, duration_s: 4.0 }));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RandomMotion {
    /// Moves of each joint.
    pub moves: usize,
    /// Length, s.
    pub duration_s: f64,
}
