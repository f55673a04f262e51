//! Freudenstein sequences inside given limits, from a point of a box or drawn at random.
//!
//! The unknowns of a joint with m moves are m - 1 via points, -1 to 1 across its range, and m duration shares x, the
//! durations being in proportion to exp(1.2 x). Within a duration d the 1-3-5 law can cover at most
//! H = min(v d / 2, a d^2 / 5.06), from its peak factors; each via point is clipped to what can be reached from the one
//! before and to what leaves zero within reach of the moves after it. So every point of the box is a feasible motion.

use super::encoding::{self, Encoding, FULL_USE};
use super::trajectories::freudenstein::{FreudensteinSequence, JointMoves, PEAK_ACCELERATION, PEAK_VELOCITY};
use super::{JointLimits, Motion};
use crate::error::Result;

/// Sequences of equally many moves per joint; see the module for the unknowns.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::excitation::random_sequence::FreudensteinEncoding;
/// use tauscope::excitation::{JointLimits, Reference};
///
/// // Three moves of 10 s each: to half the upper limit, to the lower limit, back to zero.
/// let limits = [JointLimits { lower: -1.0, upper: 3.0, velocity: 2.0, acceleration: 10.0 }];
/// let motion = FreudensteinEncoding::new(&limits, 3, 30.0)?.decode_sequence(&[0.5, -1.0, 0.0, 0.0, 0.0]);
/// let (mut q, mut qd, mut qdd) = ([0.0], [0.0], [0.0]);
/// motion.at(10.0, &mut q, &mut qd, &mut qdd);
/// assert!((q[0] - 2.0).abs() < 1e-9 && qd[0].abs() < 1e-9);
/// motion.at(20.0, &mut q, &mut qd, &mut qdd);
/// assert!((q[0] + 1.0).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct FreudensteinEncoding {
    limits: Vec<JointLimits>,
    moves: usize,
    duration_s: f64,
}

impl FreudensteinEncoding {
    /// Sequences of `moves` (at least 2) moves per joint that last `duration_s`.
    ///
    /// # Errors
    /// Names the joint whose limits are infinite or leave out zero, or the argument at fault.
    pub fn new(limits: &[JointLimits], moves: usize, duration_s: f64) -> Result<Self> {
        encoding::require_usable(limits, duration_s)?;
        encoding::require_at_least("moves", moves, 2)?;
        Ok(FreudensteinEncoding { limits: limits.to_vec(), moves, duration_s })
    }

    /// The sequence that `x` stands for: joint by joint m - 1 via points, then m duration shares.
    ///
    /// # Panics
    /// When `x` does not have [`Encoding::dimension`] entries, or one is not a number.
    pub fn decode_sequence(&self, x: &[f64]) -> FreudensteinSequence {
        let joints = encoding::per_joint(x, self.dimension(), self.limits.len())
            .zip(&self.limits)
            .map(|(x, limits)| {
                let (via, shares) = x.split_at(self.moves - 1);
                let durations = encoding::durations(shares, self.duration_s);
                JointMoves { via: reachable(via, &durations, limits), duration_s: durations }
            })
            .collect();
        FreudensteinSequence::new(self.duration_s, joints).expect("durations are positive and add up")
    }
}

/// Via points clipped to what the moves can reach, from via points in [-1, 1] across the range.
fn reachable(via: &[f64], durations: &[f64], limits: &JointLimits) -> Vec<f64> {
    let reach: Vec<f64> = durations
        .iter()
        .map(|d| FULL_USE * (limits.velocity * d / PEAK_VELOCITY).min(limits.acceleration * d * d / PEAK_ACCELERATION))
        .collect();
    // What is left to come back to zero with is summed from the end, so that no rounding is left over at the last move.
    let mut home = vec![0.0; durations.len()];
    for k in (1..durations.len()).rev() {
        home[k - 1] = home[k] + reach[k];
    }
    let mut before = 0.0_f64;
    via.iter()
        .enumerate()
        .map(|(k, x)| {
            let low = limits.lower.max(before - reach[k]).max(-home[k]);
            let high = limits.upper.min(before + reach[k]).min(home[k]);
            before = encoding::position(limits, *x).max(low).min(high);
            before
        })
        .collect()
}

impl Encoding for FreudensteinEncoding {
    fn dimension(&self) -> usize {
        (2 * self.moves - 1) * self.limits.len()
    }

    fn decode(&self, x: &[f64]) -> Motion {
        Motion::Freudenstein(self.decode_sequence(x))
    }
}

/// A sequence of `moves` moves per joint inside `limits`, drawn from the stream `label` number `index` of `seed`.
///
/// # Errors
/// Those of [`FreudensteinEncoding::new`].
pub fn random_sequence(
    seed: u64,
    label: &str,
    index: u64,
    moves: usize,
    duration_s: f64,
    limits: &[JointLimits],
) -> Result<FreudensteinSequence> {
    let encoding = FreudensteinEncoding::new(limits, moves, duration_s)?;
    Ok(encoding.decode_sequence(&encoding::random_point(&encoding, seed, label, index)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::Reference;
    use crate::excitation::limits::check;
    use crate::excitation::testing::{irb1600, state};
    use proptest::prelude::*;

    #[test]
    fn random_sequences_keep_inside_the_limits_at_10_khz() {
        let limits = irb1600();
        let [mut q, mut qd, mut qdd] = [[0.0; 6]; 3];
        for index in 0..200 {
            let (moves, duration) = (2 + index as usize % 6, 2.0 + (index % 4) as f64);
            let sequence = random_sequence(1, "test motions", index, moves, duration, &limits).unwrap();
            let names = ["1", "2", "3", "4", "5", "6"];
            check(&sequence, &limits, 1000.0, &names).unwrap();
            for k in 0..=(duration * 1e4) as u32 {
                sequence.at(f64::from(k) / 1e4, &mut q, &mut qd, &mut qdd);
                for (j, limits) in limits.iter().enumerate() {
                    assert!(q[j] >= limits.lower && q[j] <= limits.upper, "position of joint {j} in motion {index}");
                    assert!(qd[j].abs() <= limits.velocity, "velocity of joint {j} in motion {index}");
                    assert!(qdd[j].abs() <= limits.acceleration, "acceleration of joint {j} in motion {index}");
                }
            }
        }
    }

    #[test]
    fn draws_are_repeatable_and_differ_by_seed_label_and_index() {
        let draw = |seed, label, index| random_sequence(seed, label, index, 6, 10.0, &irb1600()).unwrap();
        let first = draw(1, "excitation", 0);
        assert_eq!(first, draw(1, "excitation", 0));
        for other in [draw(2, "excitation", 0), draw(1, "held out", 0), draw(1, "excitation", 1)] {
            assert_ne!(state(&first, 5.0), state(&other, 5.0));
        }
    }

    #[test]
    fn a_point_within_reach_is_decoded_as_it_stands() {
        let limits = [JointLimits { lower: -1.0, upper: 3.0, velocity: 2.0, acceleration: 10.0 }];
        let encoding = FreudensteinEncoding::new(&limits, 3, 30.0).unwrap();
        let sequence = encoding.decode_sequence(&[0.5, -1.0, 0.0, 0.0, 0.0]);
        assert_eq!(sequence.joint_moves()[0].via, [2.0, -1.0]);
        for duration in &sequence.joint_moves()[0].duration_s {
            assert!((duration - 10.0).abs() < 1e-12);
        }
    }

    #[test]
    fn via_points_are_clipped_to_the_reach_out_and_home() {
        // 1 s moves at 2 rad/s and ample acceleration reach 1 rad each: out 1, 2, then back 1.
        let limits = [JointLimits { lower: -5.0, upper: 5.0, velocity: 2.0, acceleration: 100.0 }];
        let encoding = FreudensteinEncoding::new(&limits, 4, 4.0).unwrap();
        let sequence = encoding.decode_sequence(&[1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        for (via, expected) in sequence.joint_moves()[0].via.iter().zip([1.0, 2.0, 1.0]) {
            assert!((via - expected).abs() < 1e-8, "{via} against {expected}");
        }
    }

    proptest! {
        #[test]
        fn any_point_is_feasible(
            x in prop::collection::vec(-1.5_f64..1.5, 6 * 9),
            duration in prop_oneof![0.05_f64..60.0, 1e3_f64..1e8],
        ) {
            let limits = irb1600();
            let encoding = FreudensteinEncoding::new(&limits, 5, duration).unwrap();
            let names = ["1", "2", "3", "4", "5", "6"];
            prop_assert!(check(&encoding.decode_sequence(&x), &limits, 1000.0, &names).is_ok());
        }
    }

    #[test]
    fn unusable_arguments_are_refused() {
        let draw = |moves, duration, limits: &[JointLimits]| random_sequence(1, "x", 0, moves, duration, limits);
        assert!(draw(1, 10.0, &irb1600()).unwrap_err().to_string().contains("moves"));
        assert!(draw(6, f64::NAN, &irb1600()).unwrap_err().to_string().contains("duration_s"));
        let mut limits = irb1600();
        limits[1].lower = 0.2;
        assert!(draw(6, 10.0, &limits).unwrap_err().to_string().contains("joint 2"));
    }
}
