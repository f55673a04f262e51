//! Torques from which a controller took the gravity of a model whose masses are not quite the arm's.

use super::*;
use crate::quality::Severity;

/// A log from whose torques the gravity of a `known` robot is taken.
fn compensated(mut log: Sieved, known: &Robot) -> Sieved {
    let motion = Motion::at_rest(log.recording.q.clone());
    let gravity = inverse_dynamics(&Chain::new(known), &known.inertial_parameters(), &motion);
    for joint in 0..known.dof() {
        let tau = log.recording.tau.channel_mut(joint).iter_mut();
        tau.zip(gravity.channel(joint)).for_each(|(tau, gravity)| *tau -= gravity);
    }
    log
}

/// A torque without any gravity, of bodies that are not those described.
#[test]
fn a_torque_without_gravity_shows_though_masses_are_wrong() {
    let robot = irb();
    for seed in [1, 2] {
        let actual = scales::with_other_masses(&robot, seed);
        let logs = [0, 1].map(|log| compensated(simulated(&actual, Oddity::None, 15.0, 40 + 10 * seed + log), &actual));
        let together = examine_together(&[&logs[0], &logs[1]], Some(&robot)).unwrap();
        let verdict = together.verdict.unwrap();
        assert_eq!(verdict.description.changes, [Change::WithoutGravity], "{seed}");
        let others = together.reports[0].findings.iter().any(|finding| finding.kind == Kind::OtherRobot);
        assert!(!others, "{:?}", together.reports[0].findings);
    }
}

#[test]
fn gravity_that_a_controller_takes_off_is_nothing_else() {
    let mut wrong = Vec::new();
    let mut found = 0;
    for (robot, seeds) in [(irb(), 0..3), (arm("tests/reference/skew7.urdf"), 0..1)] {
        for seed in seeds {
            let actual = scales::with_other_masses(&robot, seed);
            let logs =
                [0, 1].map(|log| compensated(simulated(&actual, Oddity::None, 15.0, 40 + 10 * seed + log), &robot));
            let together = examine_together(&[&logs[0], &logs[1]], Some(&robot)).unwrap();
            let verdicts = together.reports.into_iter().filter_map(|report| report.description);
            for changes in verdicts.map(|verdict| verdict.description.changes) {
                found += usize::from(changes == [Change::WithoutGravity]);
                if changes != [Change::WithoutGravity] {
                    wrong.push(format!("{}, {seed}: {changes:?}", robot.name));
                }
            }
        }
    }
    assert!(wrong.is_empty() && found > 0, "{found}: {}", wrong.join("\n"));
}

/// Torques that lack the weight of some links, as `gravcomp` of MuJoCo makes them, are judged by no bodies.
#[test]
fn weights_that_a_simulator_carries_in_part_accuse_nothing() {
    let robot = Robot { lifted: vec!["link_4".to_owned()], ..irb() };
    let mut outer = irb();
    outer.joints[..3].iter_mut().for_each(|joint| joint.inertia = Inertia::default());
    let logs = [0, 1].map(|log| compensated(simulated(&irb(), Oddity::None, 15.0, 40 + log), &outer));
    assert_eq!(accusations(&logs, Some(&robot)), Vec::<String>::new());
    // Of the whole arm, the torque without gravity is still found.
    let logs = [0, 1].map(|log| compensated(simulated(&irb(), Oddity::None, 15.0, 40 + log), &irb()));
    assert!(!accusations(&logs, Some(&irb())).is_empty());
}

/// What a controller leaves of gravity where its masses are wrong by some per cent is that of no other robot.
#[test]
fn gravity_that_is_left_is_no_other_robot() {
    let robot = irb();
    for share in [0.05, 0.1] {
        let mut actual = robot.clone();
        for (joint, sign) in actual.joints.iter_mut().zip([1.0, -1.0, 1.0, -1.0, 1.0, -1.0]) {
            joint.inertia.0.iter_mut().for_each(|value| *value *= 1.0 + share * sign);
        }
        let log = { compensated(simulated(&actual, Oddity::None, 30.0, 45), &robot) };
        let together = examine_together(&[&log], Some(&robot)).unwrap();
        let changes = together.verdict.map(|verdict| verdict.description.changes);
        assert_eq!(changes, Some(vec![Change::WithoutGravity]), "{share}");
        let others = together.reports[0].findings.iter().any(|finding| finding.kind == Kind::OtherRobot);
        assert!(!others, "{share}: {:?}", together.reports[0].findings);
    }
}

/// Nor is it a clock: masses that a controller knows wrongly leave a gravity that is small against inertia.
#[test]
fn gravity_that_is_left_is_no_clock_and_no_scale() {
    let robot = irb();
    let mut wrong = Vec::new();
    for seed in 0..6 {
        let mut random = random::stream(seed, "controller", 0);
        let mut actual = robot.clone();
        for joint in &mut actual.joints {
            let factor = random.random_range(0.7..1.3);
            joint.inertia.0.iter_mut().for_each(|value| *value *= factor);
        }
        let log = compensated(simulated(&actual, Oddity::None, 30.0, 60 + seed), &robot);
        let report = examine_together(&[&log], Some(&robot)).unwrap().reports.remove(0);
        let changes = report.description.map(|verdict| verdict.description.changes).unwrap_or_default();
        if report.units.time_factor.is_some() || changes.iter().any(|change| *change != Change::WithoutGravity) {
            wrong.push(format!("{seed}: clock {:?}, {changes:?}", report.units.time_factor));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What a controller commands while a hand guides the arm, with the noise of a sensor.
#[test]
fn torques_of_gravity_alone_are_that_and_nothing_else() {
    for (robot, seed) in [(irb(), 1), (irb(), 2), (arm("tests/reference/skew7.urdf"), 3)] {
        let actual = scales::with_other_masses(&robot, seed);
        let guided = |log: u64| {
            let mut log = simulated(&actual, Oddity::None, 15.0, 40 + 10 * seed + log);
            let mut random = random::stream(seed, "noise of torques", 0);
            let motion = Motion::at_rest(log.recording.q.clone());
            log.recording.tau = inverse_dynamics(&Chain::new(&actual), &actual.inertial_parameters(), &motion);
            for joint in 0..actual.dof() {
                let size = 5e-3 * crate::linear::root_mean_square(log.recording.tau.channel(joint));
                log.recording.tau.channel_mut(joint).iter_mut().for_each(|tau| {
                    let own: f64 = StandardNormal.sample(&mut random);
                    *tau += size * own;
                });
            }
            log
        };
        let logs = [guided(0), guided(1)];
        let together = examine_together(&[&logs[0], &logs[1]], Some(&robot)).unwrap();
        assert!(together.verdict.is_none());
        for report in together.reports {
            let warned = report.findings.iter().filter(|finding| finding.severity > Severity::Note);
            let kinds: Vec<Kind> = warned.map(|finding| finding.kind).collect();
            assert_eq!(kinds, [Kind::GravityAlone], "{}, {seed}: {:?}", robot.name, report.findings);
        }
    }
}
