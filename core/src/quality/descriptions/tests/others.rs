//! Logs of another robot.

use super::*;
use crate::quality::Severity;

/// What is found about the robot as a whole.
fn doubts(log: &Sieved, robot: &Robot) -> Vec<(Kind, Severity)> {
    let report = examine_together(&[log], Some(robot)).unwrap().reports.remove(0);
    report.findings.iter().filter(|own| own.kind.is_another_robot()).map(|own| (own.kind, own.severity)).collect()
}

/// Masses that are placeholders are doubted, and bodies on the joints explain the torques all the same, whatever the arm does besides.
#[test]
fn placeholders_of_an_arm_with_an_effect_are_not_another_arm() {
    let mut light = irb();
    for (place, joint) in light.joints.iter_mut().enumerate() {
        let size = 0.01 * (place + 1) as f64;
        let tensor = Matrix3::identity() * size;
        joint.inertia = Inertia::from_center_of_mass(1.0, nalgebra::Vector3::new(size, 0.0, 0.0), tensor);
    }
    for oddity in [Oddity::Payload(12.0), Oddity::Spring, Oddity::Load, Oddity::Offset] {
        let log = simulated(&irb(), oddity, 15.0, 6);
        assert!(doubts(&log, &light).iter().all(|(kind, _)| *kind == Kind::OtherRobot), "{oddity:?}");
        assert_eq!(doubts(&log, &irb()), [], "{oddity:?}");
    }
}
