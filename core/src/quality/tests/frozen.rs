//! Positions that stand for seconds while the arm moves on.

use super::*;
use crate::quality::channels::leave_out_unmeasured;

/// The log of a joint whose position stands for two seconds from where it is fast, until it comes by that position again at speed: no step
/// makes up for it. Velocities are as logged, `zero` meanwhile or missing.
fn hangs(velocities: Option<bool>) -> (Sieved, usize) {
    let mut sieved = log(&irb(), 250.0, 12.0);
    let q = sieved.recording.q.channel(1).to_vec();
    let speed = |k: usize| (q[k + 1] - q[k - 1]).abs() * 125.0;
    let comes_by = |from: usize| {
        let passes = |k: &usize| (q[*k] - q[from]) * (q[*k + 1] - q[from]) <= 0.0 && speed(*k) > 0.6;
        (from + 300..from + 1200).find(passes).map(|end| (from, end))
    };
    let (from, end) = (300..1500).filter(|&k| speed(k) > 0.6).find_map(comes_by).unwrap();
    sieved.recording.q.channel_mut(1)[from..=end].fill(q[from]);
    match (velocities, &mut sieved.recording.qd) {
        (None, velocities) => *velocities = None,
        (Some(true), Some(qd)) => qd.channel_mut(1)[from..=end].fill(0.0),
        _ => {}
    }
    (sieved, end - from)
}

#[test]
fn a_position_that_stands_between_fast_motions_is_frozen_and_left_out() {
    for velocities in [None, Some(true), Some(false)] {
        let (mut sieved, rows) = hangs(velocities);
        for known in [None, Some(&irb())] {
            let told = examine(&sieved, known).unwrap().findings;
            let [only] = &told[..] else { panic!("{velocities:?}: {told:?}") };
            assert!(only.kind == Kind::Frozen && only.text.contains("these rows are left out"), "{only:?}");
            assert_eq!(only.severity, Severity::Warning);
        }
        let all = sieved.recording.samples();
        leave_out_unmeasured(&mut sieved.recording).unwrap();
        assert!(sieved.recording.samples().abs_diff(all - rows) <= 1, "{all} {rows}");
    }
}

#[test]
fn a_torque_that_is_frozen_is_left_out() {
    let mut recording = log(&irb(), 250.0, 12.0).recording;
    let held = recording.tau.channel(2)[1000];
    recording.tau.channel_mut(2)[1000..1600].fill(held);
    leave_out_unmeasured(&mut recording).unwrap();
    let missing = |joint: usize| recording.tau.channel(joint).iter().filter(|v| v.is_nan()).count();
    assert_eq!([missing(1), missing(2)], [0, 600]);
}

/// What is left of a log whose position is known for less than half of it is too little.
#[test]
fn a_position_that_is_frozen_for_most_of_a_log_forbids_it() {
    for (until, usable) in [(1450, true), (1550, false)] {
        let mut sieved = log(&irb(), 250.0, 12.0);
        let held = sieved.recording.q.channel(1)[0];
        sieved.recording.q.channel_mut(1)[..until].fill(held);
        assert_eq!(examine(&sieved, Some(&irb())).unwrap().usable, usable, "{until}");
    }
}
