//! Clocks of logs without velocities, of arms whose masses are described wrongly.

use super::*;

/// The arm with masses between 0.7 and 1.3 times those described, and a log of it by a clock that runs wrong.
fn timed(robot: &Robot, oddity: Oddity, clock: f64, seed: u64) -> Sieved {
    let mut random = random::stream(seed, "masses", 0);
    let mut actual = robot.clone();
    for joint in &mut actual.joints {
        let factor = random.random_range(0.7..1.3);
        joint.inertia.0.iter_mut().for_each(|value| *value *= factor);
    }
    let mut log = simulated(&actual, oddity, 20.0, seed);
    log.recording.time.iter_mut().for_each(|t| *t *= clock);
    log
}

fn factor(robot: &Robot, log: &Sieved) -> Option<f64> {
    examine_together(&[log], Some(robot)).unwrap().reports[0].units.time_factor
}

/// What is said of the clock.
fn said(robot: &Robot, log: &Sieved) -> Vec<String> {
    let report = examine_together(&[log], Some(robot)).unwrap().reports.remove(0);
    report.findings.into_iter().filter(|f| f.kind == Kind::ClockFactor).map(|f| f.text).collect()
}

/// An arm of another size moves by a right clock as the described one does by a wrong one: both are named, and neither is applied.
#[test]
fn an_arm_of_another_size_is_not_taken_for_a_clock() {
    let robot = irb();
    let mut longer = robot.clone();
    for joint in &mut longer.joints {
        joint.origin.translation *= 1.4;
        // Mass, first moment, second moment.
        joint.inertia.0[1..4].iter_mut().for_each(|value| *value *= 1.4);
        joint.inertia.0[4..].iter_mut().for_each(|value| *value *= 1.4 * 1.4);
    }
    let log = timed(&longer, Oddity::None, 1.0, 8);
    assert_eq!(factor(&robot, &log), None);
    let said = said(&robot, &log);
    assert!(
        said.len() == 1 && said[0].contains("or if the arm is about 1.") && said[0].contains("times as long"),
        "{said:?}"
    );
}

#[test]
fn a_clock_shows_though_masses_are_wrong_and_a_right_one_is_not_accused() {
    let mut wrong = Vec::new();
    let all = [(1, Oddity::None), (2, Oddity::Stribeck), (3, Oddity::Payload(5.0))];
    for (robot, oddities) in [(irb(), &all[..]), (arm("tests/reference/skew7.urdf"), &all[1..2])] {
        for &(seed, oddity) in oddities {
            for clock in [1.0, 1.1, 1.5, 0.5] {
                let found = factor(&robot, &timed(&robot, oddity, clock, seed));
                let right = match found {
                    Some(found) => (found * clock - 1.0).abs() < 0.1 && clock != 1.0,
                    // An arm of another size would show so much too.
                    None if clock == 1.5 => said(&robot, &timed(&robot, oddity, clock, seed)).len() == 1,
                    None => clock == 1.0 || clock == 1.1,
                };
                if !right {
                    wrong.push(format!("{}, {oddity:?}, {clock}: {found:?}", robot.name));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What moves slowly has no torque of inertia to speak of, and elastic gears and play are no clocks.
#[test]
fn what_the_model_lacks_is_no_clock() {
    let robot = irb();
    for oddity in [Oddity::SlowMotion, Oddity::Elastic, Oddity::Backlash, Oddity::Coarse, Oddity::Spring] {
        assert_eq!(factor(&robot, &timed(&robot, oddity, 1.0, 5)), None, "{oddity:?}");
    }
}

/// Moments of inertia that are placeholders show another second than free bodies do.
#[test]
fn placeholders_of_inertia_are_no_clock() {
    let described = irb();
    let mut placeholders = described.clone();
    for joint in &mut placeholders.joints {
        joint.inertia.0[4..].iter_mut().for_each(|moment| *moment *= 6.0);
    }
    let report =
        examine_together(&[&timed(&described, Oddity::None, 1.0, 6)], Some(&placeholders)).unwrap().reports.remove(0);
    assert_eq!(report.units.time_factor, None);
    // Nor is a clock named as a possibility.
    assert!(report.findings.iter().all(|finding| finding.kind != Kind::ClockFactor), "{:?}", report.findings);
}

/// Short logs of one recorder, each of which alone may show the factor or not, have one clock; and one file that was resampled wrongly
/// is no fault of the others.
#[test]
fn logs_of_one_recorder_have_one_clock() {
    let robot = irb();
    let factors = |clocks: [f64; 3]| {
        let logs: Vec<Sieved> = (11..).zip(clocks).map(|(seed, clock)| short(&robot, clock, seed)).collect();
        let together = examine_together(&logs.iter().collect::<Vec<_>>(), Some(&robot)).unwrap();
        together.reports.iter().map(|report| report.units.time_factor).collect::<Vec<_>>()
    };
    let wrong = factors([0.5; 3]);
    assert!(wrong.iter().all(|factor| factor.is_some_and(|factor| (factor / 2.0 - 1.0).abs() < 0.05)), "{wrong:?}");
    assert!(wrong.iter().all(|factor| factor == &wrong[0]), "{wrong:?}");
    assert_eq!(factors([1.0; 3]), [None; 3]);
    let one = factors([1.0, 1.0, 0.5]);
    assert!(one[..2] == [None; 2] && one[2].is_some_and(|factor| (factor / 2.0 - 1.0).abs() < 0.05), "{one:?}");
}

/// A log of 9 s without velocities.
fn short(robot: &Robot, clock: f64, seed: u64) -> Sieved {
    let mut log = simulated(robot, Oddity::None, 9.0, seed);
    log.recording.time.iter_mut().for_each(|t| *t *= clock);
    log
}

#[test]
fn a_column_that_counts_cycles_shows_how_long_they_are() {
    let robot = irb();
    let mut log = timed(&robot, Oddity::None, 1.0 / 8.0, 7);
    log.may_count = true;
    let report = &examine_together(&[&log], Some(&robot)).unwrap().reports[0];
    assert_eq!(report.units.time_factor, Some(8.0), "{:?}", report.findings);
    let clocks: Vec<&str> =
        report.findings.iter().filter(|f| f.kind == Kind::ClockFactor).map(|f| f.text.as_str()).collect();
    assert!(clocks.len() == 1 && clocks[0].contains("cycles of about 8.000 ms"), "{clocks:?}");
}
