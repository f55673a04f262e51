//! The map of the residual: what it follows, by joint, whatever the library holds.

use super::{SETUP, logs, with};
use std::f64::consts::TAU;
use tauscope::diagnosis::{Diagnosis, Kind, ResidualMap};
use tauscope::effects::{Placed, find};
use tauscope::recording::Recording;

/// The map with as little as possible to be searched for.
fn map(logs: &[Recording]) -> ResidualMap {
    let (test, train) = logs.split_last().unwrap();
    let diagnosis = Diagnosis::of(&SETUP.known).train(train).test([test]).candidates(["torque_offset"]);
    diagnosis.run().unwrap().into_conclusion().unwrap().diagnosis.map
}

/// What each joint's residual follows most; nothing for joints on which it follows nothing.
fn largest(map: &ResidualMap) -> Vec<(usize, Kind)> {
    map.joints.iter().filter_map(|joint| Some((joint.joint, joint.reported().next()?.follows))).collect()
}

fn hidden(effect: &str, joint: usize) -> Placed {
    Placed::typical(find(effect).unwrap(), joint)
}

#[test]
fn the_residual_of_a_right_model_follows_nothing() {
    let map = map(&logs(&SETUP, 51, 3));
    assert_eq!(largest(&map), []);
    for joint in &map.joints {
        assert!(joint.lines.is_empty(), "{joint:?}");
        assert!((0.8..2.0).contains(&(joint.noise / joint.sensor_noise)), "{joint:?}");
    }
}

#[test]
fn each_kind_of_effect_is_followed_as_what_it_is() {
    let cases = [
        ("stribeck_friction", 1, Kind::Speed),
        ("presliding_hysteresis", 1, Kind::Reversal),
        ("torque_offset", 2, Kind::Offset),
        ("torque_lag", 1, Kind::Lag),
        ("friction_warm_up", 1, Kind::FrictionOverTime),
        ("position_dependent_friction", 2, Kind::PositionByDirection),
    ];
    for (effect, joint, kind) in cases {
        let map = map(&logs(&with(&[hidden(effect, joint)]), 52, 3));
        assert_eq!(largest(&map), [(joint, kind)], "{effect}: {map:?}");
    }
}

#[test]
fn vibration_at_a_fixed_frequency_is_a_line() {
    let mut logs = logs(&SETUP, 53, 3);
    for log in &mut logs {
        let time = log.time.clone();
        log.tau = log.tau.map(|joint, tau| {
            let swing = |(tau, t): (&f64, &f64)| tau + if joint == 1 { 4.0 * (TAU * 7.3 * t).sin() } else { 0.0 };
            tau.iter().zip(&time).map(swing).collect()
        });
    }
    let map = map(&logs);
    for joint in &map.joints {
        let lines: Vec<f64> = joint.lines.iter().map(|line| line.hz).collect();
        match joint.joint {
            1 => assert!(lines.len() == 1 && (lines[0] - 7.3).abs() < 0.1, "{joint:?}"),
            _ => assert!(lines.is_empty(), "{joint:?}"),
        }
    }
}
