//! Places of joints and motors in the vectors of a simulator.

/// Where the joints of a MuJoCo model stand in its vectors of positions and velocities, and which joints its motors move. A joint that
/// turns or slides has one place in both. A free body takes seven positions and six velocities, a ball joint four and three.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{self, InertiaCheck};
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("arm.xml");
///
/// let model = r#"<mujoco><worldbody>
///   <body name="box"><freejoint/><geom size="0.1"/></body>
///   <body name="rod"><joint name="elbow" axis="0 1 0"/><geom size="0.1"/></body></worldbody>
///   <actuator><motor joint="elbow"/></actuator></mujoco>"#;
/// std::fs::write(&path, model).unwrap();
/// let places = robot::load(&path, InertiaCheck::Required)?.addresses;
///
/// // The joint stands behind the box: `qpos[7]` and `qvel[6]` of the simulator.
/// assert_eq!((places.positions[7].as_str(), places.velocities[6].as_str()), ("elbow", "elbow"));
/// assert_eq!(places.motors, [Some("elbow".to_owned())]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Addresses {
    /// The joint of each position.
    pub positions: Vec<String>,
    /// The joint of each velocity, acceleration and generalised force.
    pub velocities: Vec<String>,
    /// The joint that each motor moves; None where it moves none, or is not the only one of its joint.
    pub motors: Vec<Option<String>>,
    /// The joints with one place, those that turn or slide.
    pub single: Vec<String>,
}

impl Addresses {
    /// Adds a joint with so many positions and velocities.
    pub(in crate::robot) fn add(&mut self, joint: &str, [positions, velocities]: [usize; 2]) {
        self.positions.extend(std::iter::repeat_n(joint.to_owned(), positions));
        self.velocities.extend(std::iter::repeat_n(joint.to_owned(), velocities));
        self.single.extend((positions == 1).then(|| joint.to_owned()));
    }

    /// Adds a motor with its joint.
    pub(in crate::robot) fn add_motor(&mut self, joint: Option<&str>) {
        self.motors.push(joint.map(str::to_owned));
    }

    /// Takes the joints from motors that share one.
    pub(in crate::robot) fn settle(&mut self) {
        let all = self.motors.clone();
        for motor in &mut self.motors {
            if all.iter().filter(|own| *own == motor).count() > 1 {
                *motor = None;
            }
        }
    }

    /// Whether the numbers of columns are those of the joints in the order of the file, as without a simulator.
    pub(crate) fn are_plain(&self) -> bool {
        let motors = self.motors.iter().map(Option::as_ref);
        self.positions == self.single && (self.motors.is_empty() || motors.eq(self.single.iter().map(Some)))
    }
}
