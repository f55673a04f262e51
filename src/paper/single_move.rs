//! What the paper's own excitation can identify: one Freudenstein 1-3-5 move per joint, all over the same time.

use crate::dynamics::Motion;
use crate::excitation::{JointLimits, Reference};
use crate::identification::model::Model;
use crate::internal::excitation::{Move, PEAK_ACCELERATION, PEAK_VELOCITY};
use nalgebra::DMatrix;

/// Singular values above this share of the largest count.
const TOLERANCE: f64 = 1e-9;

/// Share of the way to its upper limit that every joint moves.
const REACH: f64 = 0.5;

/// Rank of the base regressor along a motion.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct MotionRank {
    /// Length, s.
    pub duration_s: f64,
    /// Base parameters that the motion can separate.
    pub rank: usize,
    /// Base parameters of the arm.
    pub of: usize,
    /// The smallest singular value that counts over the largest, columns of unit length.
    pub smallest_counted: f64,
    /// The largest one that does not count over the largest; None at full rank.
    pub largest_left_out: Option<f64>,
}

/// One move per joint from 0 to a half of its upper limit, as fast as `limits` allow with one duration for all joints.
pub(crate) fn single_move(model: &Model, limits: &[JointLimits], rate_hz: f64) -> MotionRank {
    let ends: Vec<f64> = limits.iter().map(|limit| REACH * limit.upper.min(std::f64::consts::PI)).collect();
    let duration_s = ends.iter().zip(limits).fold(0.0, |longest: f64, (h, limit)| {
        let by_speed = PEAK_VELOCITY * h / limit.velocity;
        longest.max(by_speed).max((PEAK_ACCELERATION * h / limit.acceleration).sqrt())
    });
    let moves: Vec<Move> = ends.into_iter().map(|to| Move { from: 0.0, to, start_s: 0.0, duration_s }).collect();
    let samples = (duration_s * rate_hz) as usize + 1;
    let mut motion = Motion::zeros(limits.len(), samples);
    for sample in 0..samples {
        let state: Vec<[f64; 3]> = moves.iter().map(|leg| leg.at(sample as f64 / rate_hz)).collect();
        set(&mut motion, sample, |joint| state[joint]);
    }
    rank(model, &motion, duration_s)
}

/// The same for a whole motion.
pub(crate) fn motion_rank(model: &Model, reference: &dyn Reference, rate_hz: f64) -> MotionRank {
    let time: Vec<f64> =
        (0..=(reference.duration_s() * rate_hz) as usize).map(|sample| sample as f64 / rate_hz).collect();
    rank(model, &sampled(reference, &time), reference.duration_s())
}

/// A reference at the times `time`, s.
pub(crate) fn sampled(reference: &dyn Reference, time: &[f64]) -> Motion {
    let joints = reference.joints();
    let mut motion = Motion::zeros(joints, time.len());
    let [mut q, mut qd, mut qdd] = [(); 3].map(|()| vec![0.0; joints]);
    for (sample, &t) in time.iter().enumerate() {
        reference.at(t, &mut q, &mut qd, &mut qdd);
        set(&mut motion, sample, |joint| [q[joint], qd[joint], qdd[joint]]);
    }
    motion
}

fn set(motion: &mut Motion, sample: usize, state: impl Fn(usize) -> [f64; 3]) {
    for joint in 0..motion.joints() {
        let [q, qd, qdd] = state(joint);
        motion.q.channel_mut(joint)[sample] = q;
        motion.qd.channel_mut(joint)[sample] = qd;
        motion.qdd.channel_mut(joint)[sample] = qdd;
    }
}

fn rank(model: &Model, motion: &Motion, duration_s: f64) -> MotionRank {
    let samples = motion.samples();
    let mut observation = DMatrix::zeros(samples * model.dof(), model.base().len());
    for (joint, table) in model.columns(motion, 0.0).iter().enumerate() {
        for (parameter, column) in model.active(joint).into_iter().zip(table.iter()) {
            observation.view_mut((joint * samples, parameter), (samples, 1)).copy_from_slice(column);
        }
    }
    for mut column in observation.column_iter_mut() {
        let norm = column.norm();
        if norm > 0.0 {
            column /= norm;
        }
    }
    let mut singular: Vec<f64> = observation.qr().r().singular_values().iter().copied().collect();
    singular.sort_by(|a, b| b.total_cmp(a));
    let share = |value: f64| value / singular[0];
    let rank = singular.iter().filter(|&&value| share(value) > TOLERANCE).count();
    MotionRank {
        duration_s,
        rank,
        of: model.base().len(),
        smallest_counted: share(singular[rank - 1]),
        largest_left_out: singular.get(rank).map(|&value| share(value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::random_sequence::random_sequence;
    use crate::robot::{self, InertiaCheck};

    #[test]
    fn one_move_with_common_timing_leaves_one_combination_out_and_a_sequence_none() {
        let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/irb1600_6_120.urdf");
        let robot = robot::load(urdf, InertiaCheck::Required).unwrap();
        let limits: Vec<JointLimits> = robot
            .joints
            .iter()
            .zip([10.0, 10.0, 12.0, 35.0, 40.0, 50.0])
            .map(|(joint, acceleration)| JointLimits {
                lower: joint.limits.lower,
                upper: joint.limits.upper,
                velocity: joint.limits.velocity,
                acceleration,
            })
            .collect();
        let model = Model::new(&robot);
        let single = single_move(&model, &limits, 500.0);
        assert_eq!((single.rank, single.of), (51, 52), "{single:?}");
        assert!(single.smallest_counted > 1e3 * single.largest_left_out.unwrap(), "a clear gap: {single:?}");
        let sequence = random_sequence(1, "excitation", 0, 6, 10.0, &limits).unwrap();
        let sequence = motion_rank(&model, &sequence, 100.0);
        assert_eq!((sequence.rank, sequence.largest_left_out), (52, None), "{sequence:?}");
    }
}
