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
