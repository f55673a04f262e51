//! Faults put into clean logs of several motions are found and named; clean logs have none.

use super::{SETUP, logs, with};
use std::sync::LazyLock;
use tauscope::channels::Channels;
use tauscope::diagnosis::{Consequence, DataFault, screen};
use tauscope::effects::{LIBRARY, Placed, Scope, Site};
use tauscope::quality::Kind;
use tauscope::recording::Recording;
use tauscope::recording::lenient::Sieved;

const SEEDS: u64 = 4;

static CLEAN: LazyLock<Vec<Recording>> =
    LazyLock::new(|| (0..SEEDS).flat_map(|seed| logs(&SETUP, 100 + seed, 1)).collect());

fn screened(log: &Recording) -> (Vec<Recording>, Vec<DataFault>) {
    let lines = (2..log.samples() + 2).collect();
    let sieved = Sieved { recording: log.clone(), lines, ..Sieved::default() };
    let screened = screen("log", sieved, &SETUP.known).unwrap();
    (screened.pieces, screened.faults)
}

/// Without the logged velocity and acceleration, which many logs do not have.
fn bare(log: &Recording) -> Recording {
    Recording { qd: None, qdd: None, truth: None, ..log.clone() }
}

/// Two of the logs, one with velocities and one without: other ones in each turn, so that all are used alike.
fn pair(turn: usize) -> [Recording; 2] {
    let log = |turn: usize| &CLEAN[turn % CLEAN.len()];
    [log(turn).clone(), bare(log(turn + CLEAN.len() / 2))]
}

/// Puts a fault into the logs of a turn and checks that it is found at a place that begins with `place`.
#[track_caller]
fn assert_found((kind, consequence): (Kind, Consequence), place: &str, turn: usize, fault: impl Fn(&mut Recording)) {
    for mut log in pair(turn) {
        fault(&mut log);
        let (_, faults) = screened(&log);
        let found = faults.iter().any(|f| f.kind == kind && f.consequence == consequence && f.place.starts_with(place));
        assert!(found, "turn {turn}, velocities {}: {kind:?} at {place}: {faults:?}", log.qd.is_some());
    }
}

fn exchange(table: &mut Channels, a: usize, b: usize) {
    let (first, second) = (table.channel(a).to_vec(), table.channel(b).to_vec());
    table.channel_mut(a).copy_from_slice(&second);
    table.channel_mut(b).copy_from_slice(&first);
}

#[test]
fn clean_logs_have_none() {
    for log in CLEAN.iter() {
        for log in [log.clone(), bare(log)] {
            let (pieces, faults) = screened(&log);
            assert!(faults.is_empty(), "{faults:?}");
            assert_eq!(pieces.len(), 1);
            assert!(pieces[0].tau.as_slice().iter().all(|v| v.is_finite()));
        }
    }
}

/// What an arm does, the diagnosis must get to see.
#[test]
fn physical_effects_are_no_faults_of_the_data() {
    for effect in LIBRARY.iter().filter(|effect| effect.about().site != Site::Integrator) {
        let joint = if effect.about().scope == Scope::Arm { 0 } else { 1 };
        let log = &logs(&with(&[Placed::typical(*effect, joint)]), 200, 1)[0];
        for log in [log.clone(), bare(log)] {
            let (_, mut faults) = screened(&log);
            faults.retain(|fault| fault.consequence == Consequence::Stops);
            assert!(faults.is_empty(), "{}: {faults:?}", effect.about().name);
        }
    }
}

#[test]
fn swapped_torques() {
    let pairs = [(0, 1), (1, 2), (0, 2), (2, 4), (1, 5), (3, 4), (4, 5), (3, 5)];
    for (turn, (a, b)) in pairs.into_iter().enumerate() {
        let place = format!("tau{}", a + 1);
        assert_found((Kind::Swapped, Consequence::Stops), &place, turn, |log| exchange(&mut log.tau, a, b));
    }
}

#[test]
fn swapped_positions() {
    for (turn, (a, b)) in [(0, 1), (1, 2), (3, 4), (4, 5)].into_iter().enumerate() {
        assert_found((Kind::Swapped, Consequence::Stops), "", turn, |log| {
            exchange(&mut log.q, a, b);
            log.qd.iter_mut().for_each(|qd| exchange(qd, a, b));
        });
    }
}

#[test]
fn flipped_torques() {
    for joint in 0..6 {
        assert_found((Kind::TorqueSign, Consequence::Stops), &format!("tau{}", joint + 1), joint, |log| {
            log.tau.channel_mut(joint).iter_mut().for_each(|v| *v = -*v);
        });
    }
    assert_found((Kind::TorqueSign, Consequence::Stops), "tau1", 0, |log| {
        log.tau.as_mut_slice().iter_mut().for_each(|v| *v = -*v);
    });
}

#[test]
fn unsigned_torques() {
    let (mut missed, mut all) = (Vec::new(), 0);
    for turn in 0..CLEAN.len() {
        // Of six joints each turn asks three.
        for joint in (turn % 2..6).step_by(2) {
            for mut log in pair(turn) {
                log.tau.channel_mut(joint).iter_mut().for_each(|v| *v = v.abs());
                let place = format!("tau{}", joint + 1);
                let stops = |f: &DataFault| f.kind == Kind::UnsignedTorque && f.consequence == Consequence::Stops;
                let (_, faults) = screened(&log);
                all += 1;
                if !faults.iter().any(|f| stops(f) && f.place.starts_with(&place)) {
                    missed.push(format!("turn {turn}, {place}: {faults:?}"));
                }
            }
        }
    }
    // A torque that comes to zero a few times may turn there of its own.
    assert!(10 * missed.len() <= all, "{}", missed.join("\n"));
}

#[test]
fn degrees() {
    let degrees = 180.0 / std::f64::consts::PI;
    assert_found((Kind::PositionUnit, Consequence::Stops), "q", 0, |log| {
        log.q.as_mut_slice().iter_mut().for_each(|v| *v *= degrees);
    });
    for joint in 0..6 {
        assert_found((Kind::PositionUnit, Consequence::Stops), &format!("q{}", joint + 1), joint, |log| {
            log.q.channel_mut(joint).iter_mut().for_each(|v| *v *= degrees);
        });
    }
}

#[test]
fn frozen_channels() {
    for joint in 0..6 {
        let moving = |log: &Recording, from: usize| {
            let q = log.q.channel(joint);
            (from..q.len() - 300).find(|&k| (q[k + 200] - q[k]).abs() > 0.1).unwrap()
        };
        assert_found((Kind::Frozen, Consequence::LeftOut), &format!("q{}", joint + 1), joint, |log| {
            let start = moving(log, 1500);
            let held = log.q.channel(joint)[start];
            log.q.channel_mut(joint)[start..start + 200].fill(held);
        });
        assert_found((Kind::Frozen, Consequence::LeftOut), &format!("tau{}", joint + 1), joint, |log| {
            let start = moving(log, 1500);
            let held = log.tau.channel(joint)[start];
            log.tau.channel_mut(joint)[start..start + 200].fill(held);
        });
    }
}

#[test]
fn clipped_torques_are_left_out() {
    for joint in 0..6 {
        let clip = |log: &mut Recording| {
            let top = log.tau.channel(joint).iter().fold(0.0f64, |m, v| m.max(v.abs()));
            log.tau.channel_mut(joint).iter_mut().for_each(|v| *v = v.clamp(-0.6 * top, 0.6 * top));
            0.6 * top
        };
        assert_found((Kind::Clipped, Consequence::LeftOut), &format!("tau{}", joint + 1), joint, |log| {
            clip(log);
        });
        let mut log = CLEAN[0].clone();
        let level = clip(&mut log);
        let (pieces, _) = screened(&log);
        let tau = pieces[0].tau.channel(joint);
        assert!(tau.iter().any(|v| v.is_nan()) && !tau.iter().any(|v| v.abs() >= level), "{joint} {level}");
    }
}

#[test]
fn gaps_cut_the_log() {
    assert_found((Kind::Gap, Consequence::LeftOut), "", 0, |log| {
        let (head, tail) = (log.slice(0..2000), log.slice(2400..log.samples()));
        let join = |a: &Channels, b: &Channels| a.map(|j, signal| [signal, b.channel(j)].concat());
        *log = Recording {
            time: [head.time, tail.time].concat(),
            q: join(&head.q, &tail.q),
            qd: head.qd.zip(tail.qd).map(|(a, b)| join(&a, &b)),
            qdd: None,
            truth: None,
            tau: join(&head.tau, &tail.tau),
            ..log.clone()
        };
        assert_eq!(screened(log).0.len(), 2);
    });
}
