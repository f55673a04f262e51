//! Motions one after the other. As every motion starts and ends at rest at zero, any of them can follow any other; moves
//! and quintic segments then make one motion of the same kind.

use super::freudenstein::{FreudensteinSequence, JointMoves};
use super::motion::Motion;
use super::quintic::{JointSegments, QuinticSequence};
use crate::error::{Error, Result};
use crate::excitation::primitives::Reference;

impl Motion {
    /// The motions in their order as one motion.
    ///
    /// # Errors
    /// When there are none, their kinds or joints differ, or the kind is neither `freudenstein` nor `quintic`: a Fourier
    /// series has one period, and a uniform B-spline evenly spaced knots.
    pub fn joined(motions: &[Motion]) -> Result<Motion> {
        let Some(first) = motions.first() else {
            return Err(Error::request("motions", "there are none to join"));
        };
        let alike = |motion: &Motion| motion.kind() == first.kind() && motion.joints() == first.joints();
        if !motions.iter().all(alike) {
            return Err(Error::request("motions", "only motions of one kind with equally many joints can be joined"));
        }
        let duration_s = motions.iter().map(Reference::duration_s).sum();
        match first {
            Motion::Freudenstein(_) => {
                let sequences = motions.iter().filter_map(|motion| match motion {
                    Motion::Freudenstein(sequence) => Some(sequence.joint_moves()),
                    _ => None,
                });
                let joints = by_joint(sequences, join_moves);
                Ok(Motion::Freudenstein(FreudensteinSequence::new(duration_s, joints)?))
            }
            Motion::Quintic(_) => {
                let sequences = motions.iter().filter_map(|motion| match motion {
                    Motion::Quintic(sequence) => Some(sequence.joint_segments()),
                    _ => None,
                });
                let joints = by_joint(sequences, join_segments);
                Ok(Motion::Quintic(QuinticSequence::new(duration_s, joints)?))
            }
            other => Err(Error::request("motions", format!("motions of the kind `{}` cannot be joined", other.kind()))),
        }
    }
}

/// Puts the data of every joint together, motion after motion.
fn by_joint<'a, D: Clone + 'a>(motions: impl Iterator<Item = &'a [D]>, append: impl Fn(&mut D, &D)) -> Vec<D> {
    let mut joined: Vec<D> = Vec::new();
    for joints in motions {
        if joined.is_empty() {
            joined = joints.to_vec();
            continue;
        }
        for (whole, part) in joined.iter_mut().zip(joints) {
            append(whole, part);
        }
    }
    joined
}

fn join_moves(whole: &mut JointMoves, part: &JointMoves) {
    whole.duration_s.extend(&part.duration_s);
    whole.via.push(0.0);
    whole.via.extend(&part.via);
}

fn join_segments(whole: &mut JointSegments, part: &JointSegments) {
    // Rates that are left out are zero; joined ones are written out.
    for (target, own, added) in [
        (&mut whole.velocity, whole.position.len(), &part.velocity),
        (&mut whole.acceleration, whole.position.len(), &part.acceleration),
    ] {
        target.resize(own, 0.0);
        target.push(0.0);
        target.extend(added);
        target.resize(own + 1 + part.position.len(), 0.0);
    }
    whole.duration_s.extend(&part.duration_s);
    whole.position.push(0.0);
    whole.position.extend(&part.position);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::encoding::{Encoding, FourierEncoding, QuinticEncoding, random_point};
    use crate::excitation::random_sequence::FreudensteinEncoding;
    use crate::excitation::testing::{irb1600, state};

    #[test]
    fn the_parts_come_one_after_the_other() {
        let limits = irb1600();
        let encodings: [Box<dyn Encoding>; 3] = [
            Box::new(FreudensteinEncoding::new(&limits, 4, 3.0).unwrap()),
            Box::new(QuinticEncoding::new(&limits, 4, 3.0, true).unwrap()),
            Box::new(QuinticEncoding::new(&limits, 4, 3.0, false).unwrap()),
        ];
        for encoding in &encodings {
            let parts: Vec<Motion> =
                (0..3).map(|k| encoding.decode(&random_point(&**encoding, 1, "parts", k))).collect();
            let whole = Motion::joined(&parts).unwrap();
            assert_eq!(whole.duration_s(), 9.0);
            for (k, part) in parts.iter().enumerate() {
                for t in [0.0, 0.4, 1.7, 2.9] {
                    let (whole, part) = (state(&whole, 3.0 * k as f64 + t).concat(), state(part, t).concat());
                    for (a, b) in whole.iter().zip(&part) {
                        assert!((a - b).abs() < 1e-9, "part {k} at {t}: {a} against {b}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_joined_is_refused() {
        let limits = irb1600();
        let draw = |encoding: &dyn Encoding| encoding.decode(&random_point(encoding, 1, "parts", 0));
        let moves = draw(&FreudensteinEncoding::new(&limits, 4, 3.0).unwrap());
        let series = draw(&FourierEncoding::new(&limits, 4, 3.0, 1).unwrap());
        assert!(Motion::joined(&[]).is_err());
        assert!(Motion::joined(&[moves, series.clone()]).unwrap_err().to_string().contains("one kind"));
        assert!(Motion::joined(&[series.clone(), series]).unwrap_err().to_string().contains("fourier"));
    }
}
