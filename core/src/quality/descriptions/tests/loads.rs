//! Logs with a load at the tip that the description lacks: it is no scale of the torques and no other fault, and hides none.

use super::*;
use crate::recording::lenient::{self, ColumnMap};

/// An arm whose links near the tip are lighter than what it carries.
fn small_arm() -> Robot {
    arm("tests/reference/payload/arm.urdf")
}

/// A log of that arm by another simulator.
fn log(name: &str) -> Sieved {
    let path = format!("{}/../tests/reference/payload/{name}.csv", env!("CARGO_MANIFEST_DIR"));
    lenient::load(std::path::Path::new(&path), Some(&small_arm().joint_names()), &ColumnMap::default()).unwrap()
}

#[test]
fn a_load_is_no_scale_of_the_torques() {
    let robot = small_arm();
    for names in [&["after"][..], &["elsewhere"], &["nothing", "after"], &["after", "elsewhere"]] {
        let logs: Vec<Sieved> = names.iter().map(|name| log(name)).collect();
        assert_eq!(accusations(&logs, Some(&robot)), [""; 0], "{names:?}");
    }
}

#[test]
fn a_load_in_all_logs_or_in_one_accuses_nothing() {
    let skew = arm("tests/reference/skew7.urdf");
    let mut wrong = Vec::new();
    for (robot, masses) in [(&irb(), &[3.0, 12.0][..]), (&skew, &[1.0])] {
        for &mass in masses {
            let loaded = [0, 1].map(|log| simulated(robot, Oddity::Payload(mass), 8.0, 300 + log));
            let plain = [2, 3].map(|log| simulated(robot, Oddity::None, 8.0, 300 + log));
            let one = [plain[0].clone(), plain[1].clone(), loaded[0].clone()];
            let first = [loaded[1].clone(), plain[1].clone()];
            // Free base parameters alone: nothing is known of the bodies.
            let mut bare = robot.clone();
            bare.joints.iter_mut().for_each(|joint| joint.inertia = Inertia::default());
            for (what, logs, robot) in [
                ("all", &loaded[..], robot),
                ("one of three", &one, robot),
                ("alone", &loaded[1..], robot),
                ("first of two", &first, robot),
                ("one of three, bare", &one, &bare),
                ("first of two, bare", &first, &bare),
            ] {
                let told = accusations(logs, Some(robot));
                if !told.is_empty() {
                    wrong.push(format!("{}, {mass} kg, {what}: {told:?}", robot.name));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} accused:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn a_scale_is_found_with_a_load() {
    let robot = small_arm();
    for factor in [20.0, 0.01, 1e4] {
        let mut log = log("after");
        log.recording.tau.as_mut_slice().iter_mut().for_each(|torque| *torque *= factor);
        let verdict = examine_together(&[&log], Some(&robot)).unwrap().verdict.unwrap();
        let [Some(found)] = verdict.factors[..] else { panic!("{factor}: {verdict:?}") };
        assert!((found / factor - 1.0).abs() < 0.15 && !verdict.beyond_doubt, "{found} of {factor}");
    }
}

#[test]
fn factors_that_differ_are_listed_by_joint() {
    let robot = irb();
    let factors = [1.0 / 121.0, 1.0 / 180.0, 1.0 / 100.0, 1.0 / 50.0, 1.0 / 20.0, 1.0 / 30.0];
    let mut log = simulated(&robot, Oddity::None, 15.0, 4);
    for (joint, factor) in factors.into_iter().enumerate() {
        log.recording.tau.channel_mut(joint).iter_mut().for_each(|torque| *torque *= factor);
    }
    let verdict = examine_together(&[&log], Some(&robot)).unwrap().verdict.unwrap();
    assert_eq!(verdict.factors.len(), 6, "{verdict:?}");
    for (found, wanted) in verdict.factors.iter().zip(factors).filter_map(|(found, wanted)| Some(((*found)?, wanted))) {
        assert!((found / wanted).ln().abs() < 0.3, "{found} of {wanted}");
    }
    let said = findings(&verdict, &robot.joint_names(), None);
    assert!(said.len() == 1 && said[0].text.contains("differs from joint to joint"), "{said:?}");
}

#[test]
fn a_wrong_sign_is_found_where_one_log_has_a_load() {
    let robot = irb();
    let sign = Description::as_given(6, robot.gravity).with(Change::TorqueSign(2));
    let mut logs = [(Oddity::None, 1), (Oddity::None, 2), (Oddity::Payload(6.0), 3)]
        .map(|(oddity, seed)| simulated(&robot, oddity, 8.0, seed));
    logs.iter_mut().for_each(|log| sign.apply(&mut log.recording));
    let together = examine_together(&logs.iter().collect::<Vec<_>>(), Some(&robot)).unwrap();
    assert_eq!(together.verdict.unwrap().description.changes, [Change::TorqueSign(2)]);
}
