//! Units of a joint, and of a robot's joints.

use super::arm::Robot;
use super::joint::{Joint, JointKind};
use super::unit::Unit;

impl JointKind {
    /// A unit as it is on a joint of this kind.
    pub const fn unit(self, unit: Unit) -> &'static str {
        match self {
            JointKind::Prismatic => unit.on_joints()[1],
            JointKind::Revolute => unit.on_joints()[0],
        }
    }
}

impl Joint {
    /// Unit of the joint's position.
    pub fn position_unit(&self) -> &'static str {
        self.kind.unit(Unit::Position)
    }

    /// Unit of the joint's velocity.
    pub(crate) fn velocity_unit(&self) -> &'static str {
        self.kind.unit(Unit::Velocity)
    }

    /// Unit of the joint's effort.
    pub fn effort_unit(&self) -> &'static str {
        self.kind.unit(Unit::Effort)
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
        let units =
            [Unit::Effort, Unit::Damping, Unit::Inertia, Unit::Compliance, Unit::Time, Unit::One, Unit::PerTurn];
        let turning = ["N m", "N m s/rad", "kg m2", "rad/(N m)", "s", "1", "1/turn"];
        assert_eq!(units.map(|unit| JointKind::Prismatic.unit(unit)), ["N", "N s/m", "kg", "m/N", "s", "1", "1/turn"]);
        assert_eq!(units.map(|unit| JointKind::Revolute.unit(unit)), turning);
        assert_eq!(units.map(|unit| unit.to_string()), turning);
    }

    #[test]
    fn what_belongs_to_bodies_has_one_unit() {
        let of_bodies = [Unit::Angle, Unit::Length, Unit::Force, Unit::Mass, Unit::FirstMoment, Unit::MomentOfInertia];
        assert!(of_bodies.iter().all(|unit| JointKind::Prismatic.unit(*unit) == unit.name()));
    }
}
