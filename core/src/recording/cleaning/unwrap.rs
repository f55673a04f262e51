//! Positions that jump by whole turns.

use crate::recording::Recording;
use std::f64::consts::TAU;

/// Turns in the units that files have: turns, radians, degrees, gon, thousandths of a radian, tenths, hundredths and thousandths
/// of a degree; counts of encoders come on top.
const TURNS: [f64; 8] = [1.0, TAU, 360.0, 400.0, 1e3 * TAU, 3600.0, 36_000.0, 360_000.0];

/// Bits of encoders whose counts wrap.
const BITS: std::ops::RangeInclusive<i32> = 9..=24;

/// The steps before and behind a jump are smaller than this share of a turn, and make up for what the jump differs from it.
const CALM: f64 = 0.1;

/// A jump differs from a whole turn by no more than this share of it.
const TURN_TOLERANCE: f64 = 0.05;

/// A velocity that was differenced from a wrapped position differs from the jump over the time by less than this share: the
/// rest is the velocity of the motion, which is small there.
const DIFFERENCED: f64 = 0.25;

/// Undoes jumps of positions by whole turns, in whatever unit they are, and what they did to velocities that were differenced
/// from them; returns the joints, each with its turn, and a note.
pub(crate) fn unwrap(log: &mut Recording) -> (Vec<(usize, f64)>, Option<String>) {
    let mut joints = Vec::new();
    let mut names = Vec::new();
    for joint in 0..log.joints() {
        let q = log.q.channel_mut(joint);
        let Some(turn) = wrapped_at(q) else { continue };
        let mut turns = 0.0;
        let mut last = q[0];
        let mut jumps = Vec::new();
        for (row, value) in q.iter_mut().enumerate().skip(1) {
            let jump = ((*value - last) / turn).round();
            if jump != 0.0 {
                jumps.push((row, jump * turn));
            }
            turns -= jump;
            last = *value;
            *value += turns * turn;
        }
        if let Some(qd) = &mut log.qd {
            without_jumps(qd.channel_mut(joint), &log.time, &jumps);
        }
        joints.push((joint, turn));
        names.push(format!("{} (turns of {turn:.6})", log.joints[joint]));
    }
    let note = (!joints.is_empty()).then(|| {
        format!(
            "positions of {} jumped by whole turns where they came to an end of their range; undone",
            names.join(", ")
        )
    });
    (joints, note)
}

/// Takes jumps of the position, each with the row behind it, out of a velocity that was differenced from it: over one step, or
/// over the two on either side of a row.
fn without_jumps(velocity: &mut [f64], time: &[f64], jumps: &[(usize, f64)]) {
    for &(row, jump) in jumps {
        let whole = jump / (time[row] - time[row - 1]);
        for value in &mut velocity[row - 1..=row] {
            let spike =
                [whole, 0.5 * whole].into_iter().find(|spike| (*value - spike).abs() < DIFFERENCED * spike.abs());
            *value -= spike.unwrap_or(0.0);
        }
    }
}

/// The turn by which a position jumps while its joint hardly moves from one row to the next.
fn wrapped_at(q: &[f64]) -> Option<f64> {
    let (low, high) = q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    let whole = |value: &f64| value.fract() == 0.0;
    let counts = q.iter().all(whole);
    let bits = BITS.map(|bits| 2f64.powi(bits)).filter(|_| counts);
    let jumps = |turn: f64| {
        let jump = |x: &[f64]| {
            let (before, step, behind) = (x[1] - x[0], (x[2] - x[1]).abs(), x[3] - x[2]);
            let calm = before.abs().max(behind.abs());
            calm < CALM * turn && (step - turn).abs() < (3.0 * calm).clamp(1e-3 * turn, TURN_TOLERANCE * turn).max(calm)
        };
        // A position that wraps keeps within its turn, but for where it began.
        high - low < (1.0 + TURN_TOLERANCE) * turn && q.windows(4).any(jump)
    };
    // The smallest units first: a jump of a turn of 360 is none of one.
    let jump_of_one = |turn: &f64| *turn != 1.0 || q.iter().all(|value| value.abs() <= 1.0);
    TURNS.into_iter().filter(jump_of_one).chain(bits).find(|&turn| jumps(turn))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::samples;

    fn log(q: Vec<f64>) -> Recording {
        let mut log = samples::full(1, q.len());
        log.q.channel_mut(0).copy_from_slice(&q);
        log
    }

    #[test]
    fn whole_turns_are_undone_in_every_unit() {
        for turn in [TAU, 360.0, 4096.0, 65536.0, 1.0] {
            let truth: Vec<f64> = (0..400).map(|i| turn * (0.3 + 0.9 * (0.02 * f64::from(i)).sin())).collect();
            let round = |value: f64| if turn > 1000.0 { value.round() } else { value };
            let truth: Vec<f64> = truth.into_iter().map(round).collect();
            for low in [0.0, -0.5 * turn] {
                let wrapped: Vec<f64> = truth.iter().map(|v| (v - low).rem_euclid(turn) + low).collect();
                let mut log = log(wrapped.clone());
                let (joints, note) = unwrap(&mut log);
                assert_eq!(joints, [(0, turn)], "{turn}");
                assert!(note.unwrap().contains("axis_1"));
                let shift = log.q.channel(0)[0] - truth[0];
                let worst = log.q.channel(0).iter().zip(&truth).map(|(a, b)| (a - b - shift).abs()).fold(0.0, f64::max);
                assert!(worst < 1e-9 * turn, "{turn}: {worst}");
            }
        }
    }

    #[test]
    fn a_velocity_from_the_wrapped_position_loses_its_spikes_and_another_stays() {
        let truth: Vec<f64> = (0..400).map(|i| TAU * (0.3 + 0.9 * (0.02 * f64::from(i)).sin())).collect();
        let wrapped: Vec<f64> = truth.iter().map(|v| v.rem_euclid(TAU)).collect();
        let difference = |q: &[f64], back: usize, ahead: usize| -> Vec<f64> {
            let at = |i: usize| (i.saturating_sub(back), (i + ahead).min(q.len() - 1));
            let of = |(a, b): (usize, usize)| if a == b { 0.0 } else { (q[b] - q[a]) / (0.004 * (b - a) as f64) };
            (0..q.len()).map(|i| of(at(i))).collect()
        };
        for (back, ahead) in [(1, 1), (1, 0), (0, 1)] {
            let right = difference(&truth, back, ahead);
            for logged in [difference(&wrapped, back, ahead), right.clone()] {
                let mut log = log(wrapped.clone());
                log.time = (0..400).map(|i| 0.004 * f64::from(i)).collect();
                log.qd = Some(crate::channels::Channels::from_vectors(&[logged]));
                unwrap(&mut log);
                let worst =
                    log.qd.unwrap().channel(0).iter().zip(&right).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(worst < 1e-6, "{back} {ahead}: {worst}");
            }
        }
    }

    #[test]
    fn fast_motion_and_steps_of_other_sizes_stay() {
        // 6 degrees a row, a step of 3 rad, a spike of 6.28 on a joint that moves as fast.
        for q in [
            (0..200).map(|i| 170.0 * (0.037 * f64::from(i)).sin()).collect::<Vec<_>>(),
            (0..200).map(|i| if i < 100 { 0.1 } else { 3.1 }).collect(),
            (0..200).map(|i| 0.001 * f64::from(i * i)).collect(),
        ] {
            let mut log = log(q.clone());
            assert_eq!(unwrap(&mut log), (vec![], None));
            assert_eq!(log.q.channel(0), q);
        }
    }
}
