//! Logs of another robot.

use super::scales::with_other_masses;
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

/// The arm with another distance from the joint before one.
fn longer(joint: usize, factor: f64) -> Robot {
    let mut other = irb();
    other.joints[joint].origin.translation *= factor;
    other
}

/// A sister model has another upper arm: no effect of a drive is the cause of what free bodies leave then.
#[test]
fn a_length_that_is_not_that_of_the_file_is_named() {
    for factor in [0.7 / 0.475, 0.6] {
        let log = simulated(&with_other_masses(&longer(2, factor), 5), Oddity::None, 15.0, 6);
        let report = examine_together(&[&log], Some(&irb())).unwrap().reports.remove(0);
        let [finding] = &report.findings[..] else { panic!("{factor}: {:?}", report.findings) };
        assert_eq!((finding.kind, finding.severity), (Kind::OtherRobot, Severity::Warning), "{factor}");
        let told = finding.text.split_once("joint_3 about ").and_then(|(_, rest)| rest.split_once(" m"));
        let length: f64 = told.unwrap_or_else(|| panic!("{}", finding.text)).0.parse().unwrap();
        assert!((length / (factor * 0.475) - 1.0).abs() < 0.03, "{}", finding.text);
    }
}

#[test]
fn right_lengths_are_not_denied_whatever_the_arm_does_besides() {
    for (place, oddity) in ODDITIES.into_iter().enumerate() {
        let log = simulated(&with_other_masses(&irb(), 5), oddity, 15.0, 60 + place as u64);
        let report = examine_together(&[&log], Some(&irb())).unwrap().reports.remove(0);
        let of_lengths = |text: &str| text.contains("lengths of the file");
        assert!(report.findings.iter().all(|own| !of_lengths(&own.text)), "{oddity:?}: {:?}", report.findings);
    }
}
