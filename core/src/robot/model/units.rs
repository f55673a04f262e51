//! Units of the quantities of a joint: what is an angle and a torque on one that turns is a length and a force on one that
//! slides.

use super::arm::Robot;
use super::joint::{Joint, JointKind};

/// Units on a joint that turns, and of the same quantity on one that slides.
const SLIDING: [(&str, &str); 11] = [
    ("rad", "m"),
    ("rad/s", "m/s"),
    ("rad/s2", "m/s2"),
    ("rad/s^2", "m/s^2"),
    ("N m", "N"),
    ("N m s/rad", "N s/m"),
    ("N m s2/rad2", "N s2/m2"),
    ("N m/rad", "N/m"),
    ("N m (s/rad)^alpha", "N (s/m)^alpha"),
    ("rad/(N m)", "m/N"),
    ("kg m2", "kg"),
];

impl JointKind {
    /// Unit of a joint's quantity that has the unit `revolute` where the joint turns. What has no angle in it (a time, a
    /// ratio) keeps its unit.
    pub fn unit(self, revolute: &'static str) -> &'static str {
        let sliding = SLIDING.iter().find(|(turning, _)| self == JointKind::Prismatic && *turning == revolute);
        sliding.map_or(revolute, |(_, sliding)| sliding)
    }
}

impl Joint {
    /// Unit of the joint's position.
    pub fn position_unit(&self) -> &'static str {
        self.kind.unit("rad")
    }

    /// Unit of the joint's velocity.
    pub fn velocity_unit(&self) -> &'static str {
        self.kind.unit("rad/s")
    }

    /// Unit of the joint's effort.
    pub fn effort_unit(&self) -> &'static str {
        self.kind.unit("N m")
    }
}

impl Robot {
    /// Unit of every joint's effort.
    pub fn effort_units(&self) -> Vec<&'static str> {
        self.joints.iter().map(Joint::effort_unit).collect()
    }

    /// Unit of all joints' efforts; None where some turn and some slide.
    pub fn common_effort_unit(&self) -> Option<&'static str> {
        let first = self.joints.first()?.effort_unit();
        self.joints.iter().all(|joint| joint.effort_unit() == first).then_some(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sliding_joint_has_forces_and_lengths() {
        let units = ["N m", "N m s/rad", "kg m2", "rad/(N m)", "s", "1", "1/turn"];
        assert_eq!(units.map(|unit| JointKind::Prismatic.unit(unit)), ["N", "N s/m", "kg", "m/N", "s", "1", "1/turn"]);
        assert_eq!(units.map(|unit| JointKind::Revolute.unit(unit)), units);
    }
}
