//! What comes of a fault is no fault of its own: one cause, one finding.

use super::*;

/// All else is compared in true time: torques are of no other size, velocities are at no motor, and no log is too short.
#[test]
fn a_clock_that_runs_wrong_is_the_only_fault() {
    // The last ones are of ms that are taken for s, and of s that are taken for ms.
    for factor in [0.625, 2.0, 10.0, 0.1, 30.0, 1e3, 1e-3] {
        assert_found(Kind::ClockFactor, "t", Some(&irb()), |log| log.time.iter_mut().for_each(|t| *t *= factor));
    }
}

/// Velocities that are some times too large, by a factor of no unit, while torques and positions belong to the clock.
#[test]
fn velocities_of_another_scale_are_no_fault_of_the_clock_where_the_torques_deny_it() {
    for factor in [4.0, 0.25, 1.6] {
        assert_found(Kind::VelocityUnit, "qd", Some(&irb()), |log| {
            log.qd.as_mut().unwrap().as_mut_slice().iter_mut().for_each(|v| *v *= factor);
        });
    }
}

/// Velocities at the motors of gears of one ratio are faster than joints can be: the clock is right.
#[test]
fn velocities_at_the_motors_are_no_fault_of_the_clock() {
    for known in [None, Some(&irb())] {
        assert_found(Kind::VelocityUnit, "qd", known, |log| {
            log.qd.as_mut().unwrap().as_mut_slice().iter_mut().for_each(|v| *v *= 101.0);
        });
    }
}

#[test]
fn positions_in_milliradians_are_the_only_fault() {
    for known in [None, Some(&irb())] {
        for velocities in [1.0, 1e3] {
            assert_found(Kind::PositionUnit, "q", known, |log| {
                log.q.as_mut_slice().iter_mut().for_each(|v| *v *= 1e3);
                log.qd.as_mut().unwrap().as_mut_slice().iter_mut().for_each(|v| *v *= velocities);
            });
        }
    }
    let mut sieved = log(&irb(), 250.0, 12.0);
    sieved.recording.q.as_mut_slice().iter_mut().for_each(|v| *v *= 1e3);
    let units = examine(&sieved, Some(&irb())).unwrap().units;
    assert_eq!((units.positions, units.velocities), (vec![Some(OtherUnit::Milliradian); 6], Vec::new()));
}

#[test]
fn clipped_and_frozen_signals_are_the_only_faults() {
    for known in [None, Some(&irb())] {
        for joint in [1, 2] {
            assert_found(Kind::Clipped, "tau", known, |log| {
                let top = log.tau.channel(joint).iter().fold(0.0f64, |m, v| m.max(v.abs()));
                log.tau.channel_mut(joint).iter_mut().for_each(|v| *v = v.clamp(-0.3 * top, 0.3 * top));
            });
        }
        for joints in [1..2, 0..6] {
            assert_found(Kind::Frozen, "tau", known, |log| {
                for joint in joints.clone() {
                    let held = log.tau.channel(joint)[1000];
                    log.tau.channel_mut(joint)[1000..1600].fill(held);
                }
            });
            assert_found(Kind::Frozen, "q", known, |log| {
                for joint in joints.clone() {
                    let held = log.q.channel(joint)[1000];
                    log.q.channel_mut(joint)[1000..1600].fill(held);
                }
            });
        }
    }
}

#[test]
fn a_driver_that_reports_no_torque_is_one_fault() {
    let mut sieved = log(&irb(), 250.0, 12.0);
    sieved.recording.tau.as_mut_slice().fill(0.0);
    assert_eq!(found(&sieved, Some(&irb())), [(Kind::NoTorque, "tau".to_owned())]);
}

/// Torques alone show a clock that is wrong by much, and the factor rounded to a power of ten where it is near one.
#[test]
fn a_clock_without_velocities_is_shown_by_gravity_and_inertia() {
    for (clock, factor) in
        [(10.0, Some(0.1)), (0.1, Some(10.0)), (1.0, None), (1.1, None), (1.4, Some(1.0 / 1.4)), (0.4, Some(2.5))]
    {
        let mut sieved = log(&irb(), 250.0, 12.0);
        sieved.recording.qd = None;
        sieved.recording.time.iter_mut().for_each(|t| *t *= clock);
        let report = examine(&sieved, Some(&irb())).unwrap();
        let found = report.units.time_factor;
        // A factor of 1.4 may be an arm of another size, and is applied no more.
        let near = match (found, factor) {
            (None, Some(_)) => clock == 1.4,
            (Some(found), Some(factor)) => (found / factor - 1.0f64).abs() < 0.05,
            (found, factor) => found == factor,
        };
        assert!(near, "{clock}: {found:?}");
        let kinds: Vec<Kind> = report.findings.iter().map(|finding| finding.kind).collect();
        assert_eq!(kinds, vec![Kind::ClockFactor; usize::from(factor.is_some())], "{clock}: {:?}", report.findings);
    }
}

/// Units of positions and velocities, joint by joint, as the log shows them.
#[test]
fn units_of_single_joints_and_of_velocities_alone() {
    let (degrees, rpm, turns) = (180.0 / std::f64::consts::PI, 30.0 / std::f64::consts::PI, 0.5 / std::f64::consts::PI);
    let units = |joints: &[usize], position: f64, velocity: f64| {
        let mut sieved = log(&irb(), 250.0, 12.0);
        let Recording { q, qd: Some(qd), .. } = &mut sieved.recording else { panic!() };
        for &joint in joints {
            q.channel_mut(joint).iter_mut().for_each(|v| *v *= position);
            qd.channel_mut(joint).iter_mut().for_each(|v| *v *= velocity);
        }
        let report = examine(&sieved, Some(&irb())).unwrap();
        let found: Vec<(Kind, String)> = report.findings.into_iter().map(|own| (own.kind, own.place)).collect();
        (found, report.units)
    };
    let all = [0, 1, 2, 3, 4, 5];
    let one = |kind: Kind, place: &str| vec![(kind, place.to_owned())];
    let only = |joint: usize| -> Vec<bool> { (0..6).map(|own| own == joint).collect() };
    // Velocities alone, of all joints and of one.
    for (velocity, unit) in [
        (degrees, OtherRate::PerSecond(OtherUnit::Degree)),
        (rpm, OtherRate::Rpm),
        (turns, OtherRate::PerSecond(OtherUnit::Turn)),
    ] {
        let (found, of) = units(&all, 1.0, velocity);
        assert_eq!((found, of.velocities), (one(Kind::VelocityUnit, "qd1 .. qd6"), vec![Some(unit); 6]));
        let (found, of) = units(&[2], 1.0, velocity);
        assert_eq!(found, one(Kind::VelocityUnit, "qd3 (joint_3)"));
        assert_eq!(of.velocities.iter().map(|own| *own == Some(unit)).collect::<Vec<_>>(), only(2));
        assert!(of.positions.is_empty());
    }
    // One joint in degrees, with velocities in deg/s and in rad/s.
    for velocity in [degrees, 1.0] {
        let (found, of) = units(&[2], degrees, velocity);
        assert_eq!(found, one(Kind::PositionUnit, "q3 (joint_3)"));
        assert_eq!(of.positions.iter().map(Option::is_some).collect::<Vec<_>>(), only(2));
        assert_eq!(of.velocities.iter().any(Option::is_some), velocity != 1.0);
    }
    // All in degrees with velocities in rpm; all in turns.
    let (found, of) = units(&all, degrees, rpm);
    assert_eq!(found.iter().map(|own| own.0).collect::<Vec<_>>(), [Kind::VelocityUnit, Kind::PositionUnit]);
    assert_eq!((of.time_factor, of.velocities), (None, vec![Some(OtherRate::Rpm); 6]));
    // With velocities in rad/s, and in turns per second, of which the torques show both.
    for velocity in [1.0, turns] {
        let (found, of) = units(&all, turns, velocity);
        assert_eq!(found, one(Kind::PositionUnit, "q1 .. q6"));
        assert_eq!(of.positions, vec![Some(OtherUnit::Turn); 6]);
        assert_eq!(of.velocities.is_empty(), velocity == 1.0);
    }
    let (found, of) = units(&all, turns, rpm);
    assert_eq!(found.iter().map(|own| own.0).collect::<Vec<_>>(), [Kind::PositionUnit, Kind::VelocityUnit]);
    assert_eq!(of.velocities, vec![Some(OtherRate::Rpm); 6]);
}

/// Counts of encoders are one matter, whatever the velocities are.
#[test]
fn counts_are_one_finding() {
    assert_found(Kind::PositionUnit, "q1 .. q6", Some(&irb()), |log| {
        log.q.as_mut_slice().iter_mut().for_each(|v| *v = (*v * 1.3e5).round());
    });
}

/// Counts of encoders on a clock that runs wrong: to which unit the proportion of velocities comes is chance.
#[test]
fn velocities_are_in_no_unit_where_positions_are_counts() {
    let per_turn = 4096.0 / std::f64::consts::TAU;
    // So many counts per second for one of the velocity's: turns, degrees, rpm.
    for proportion in [std::f64::consts::TAU, 180.0 / std::f64::consts::PI, 30.0 / std::f64::consts::PI, 1.0] {
        assert_found(Kind::PositionUnit, "q1 .. q6", Some(&irb()), |log| {
            log.q.as_mut_slice().iter_mut().for_each(|v| *v = (2048.0 + *v * per_turn).round());
            log.qd.as_mut().unwrap().as_mut_slice().iter_mut().for_each(|v| *v *= per_turn / proportion);
        });
    }
}

/// Torques that are those of another joint come at no time of their own.
#[test]
fn exchanged_torques_are_not_late() {
    for (a, b) in [(0, 3), (1, 3), (1, 5), (2, 4)] {
        assert_found(Kind::Swapped, "tau", Some(&irb()), |log| {
            let (first, second) = (log.tau.channel(a).to_vec(), log.tau.channel(b).to_vec());
            log.tau.channel_mut(a).copy_from_slice(&second);
            log.tau.channel_mut(b).copy_from_slice(&first);
        });
    }
}

/// A motor that is switched off in motion, whose brake falls in, is no frozen position; a log that repeats its last row is.
#[test]
fn a_motor_that_is_switched_off_is_not_frozen() {
    for (left, kind) in [(0.0, None), (1.0, Some(Kind::Frozen))] {
        let mut sieved = log(&irb(), 250.0, 12.0);
        let Recording { q, qd: Some(qd), tau, .. } = &mut sieved.recording else { panic!() };
        let at = (2000..2900).max_by(|&a, &b| qd.channel(1)[a].abs().total_cmp(&qd.channel(1)[b].abs())).unwrap();
        for joint in 0..6 {
            let (held, torque) = (q.channel(joint)[at], tau.channel(joint)[at]);
            q.channel_mut(joint)[at..].fill(held);
            qd.channel_mut(joint)[at..].fill(0.0);
            tau.channel_mut(joint)[at..].fill(left * torque);
        }
        let report = examine(&sieved, Some(&irb())).unwrap();
        let frozen = report.findings.iter().find(|own| own.kind == Kind::Frozen).map(|own| own.kind);
        assert_eq!(frozen, kind, "{:?}", report.findings);
    }
}

/// A model explains the torques of motors that run, whatever it leaves of those that are off.
#[test]
fn motors_that_are_off_leave_no_torque_unexplained() {
    let mut sieved = log(&irb(), 250.0, 12.0);
    let share = |sieved: &Sieved| {
        let report = examine(sieved, Some(&irb())).unwrap();
        report.joints.iter().filter_map(|joint| joint.unexplained).fold(0.0, f64::max)
    };
    let before = share(&sieved);
    (0..6).for_each(|joint| sieved.recording.tau.channel_mut(joint)[1000..1500].fill(0.0));
    assert!(share(&sieved) < 1.5 * before, "{} after {before}", share(&sieved));
}
