//! Columns that a log has and nothing uses, and why where the robot says it.

use crate::quality::finding::{Finding, Kind, Severity};
use crate::recording::lenient::Sieved;
use crate::robot::Robot;
use std::collections::BTreeMap;

/// The finding about columns without use. A joint that follows another has no position and no equation of its own.
pub(crate) fn finding(sieved: &Sieved, robot: Option<&Robot>) -> Option<Finding> {
    let mut followers: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (robot, follower) in robot.iter().flat_map(|robot| robot.followers().iter().map(move |own| (robot, own))) {
        if sieved.unknown_joints.contains(&follower.joint.name) {
            let master = robot.joints[follower.coordinate].name.as_str();
            followers.entry(master).or_default().push(&follower.joint.name);
        }
    }
    let each = followers.into_iter().map(|(master, names)| match names[..] {
        [one] => {
            format!("{one} follows {master} in the robot's file: its motion and its drive are part of that joint's")
        }
        _ => {
            let names = names.join(", ");
            format!(
                "{names} follow {master} in the robot's file: their motion and their drives are part of that joint's"
            )
        }
    });
    let notes: Vec<String> = sieved.notes.iter().cloned().chain(each).collect();
    (!notes.is_empty()).then(|| Finding::new(Kind::UnusedColumns, Severity::Note, "header", notes.join("; ")))
}

/// Findings about columns that are called as others are and hold other values.
pub(crate) fn ambiguous(sieved: &Sieved) -> impl Iterator<Item = Finding> {
    let finding =
        |[name, text]: &[String; 2]| Finding::new(Kind::UnusedColumns, Severity::Warning, name.as_str(), text.as_str());
    sieved.ambiguous.iter().map(finding)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{InertiaCheck, load};

    #[test]
    fn joints_that_follow_others_are_told_as_that() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/reference/trees/two_finger.urdf");
        let robot = load(file, InertiaCheck::Required).unwrap();
        let unused = "columns not used: finger_right_joint_position, camera";
        let sieved = |unknown: &str| Sieved {
            notes: vec![unused.to_owned()],
            unknown_joints: vec![unknown.to_owned()],
            ..Sieved::default()
        };
        let said = |unknown: &str, robot| finding(&sieved(unknown), robot).unwrap().text;
        let follows = "finger_right_joint follows finger_left_joint in the robot's file";
        assert!(said("finger_right_joint", Some(&robot)).starts_with(&format!("{unused}; {follows}")));
        assert_eq!([said("camera", Some(&robot)), said("finger_right_joint", None)], [unused, unused]);
        assert!(finding(&Sieved::default(), Some(&robot)).is_none());
    }
}
