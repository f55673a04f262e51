//! Motors by the names that a file gives them.

/// A motor of a joint.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{self, InertiaCheck};
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("arm.xml");
///
/// let model = r#"<mujoco><worldbody><body name="rod"><joint name="elbow" axis="0 1 0"/><geom size="0.1"/></body></worldbody>
///   <actuator><motor name="m1" joint="elbow" gear="50"/></actuator></mujoco>"#;
/// std::fs::write(&path, model).unwrap();
/// let robot = robot::load(&path, InertiaCheck::Required)?;
///
/// // Logs of MuJoCo name their forces by the motors.
/// let motor = &robot.actuators[0];
/// assert_eq!((&motor.name[..], &motor.joint[..], motor.gear), ("m1", "elbow", 50.0));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Actuator {
    /// Its name.
    pub name: String,
    /// The joint that it moves.
    pub joint: String,
    /// Torque of the joint over that of the motor.
    pub gear: f64,
}
