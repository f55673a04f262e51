//! Structure that the mixed model shows in the residual of the extended model, on joints where the block tests are not significant.
//!
//! The block tests estimate the noise spectrum from the residual itself, so that a slow, periodic or wandering residual is part of that
//! noise. The tests of the mixed model need no noise spectrum.

use super::structure::{STRICTER, Unexplained, WORTH_TELLING};
use crate::diagnosis::variance::{JointMap, Kind, ResidualMap};

/// What a spectral line is.
const LINE: &str = "oscillates at a fixed frequency";

/// Share of the cut-off of a joint's positions up to which a spectral line counts: nearer to it, what the differences make of encoder
/// noise is a peak, too.
const BELOW_CUTOFF: f64 = 0.5;

/// The largest significant part, or line, of every joint of `map` that is not among `known`. `cutoffs_hz` are those of the joints'
/// positions, `alpha` is the family-wise level of names.
pub fn mapped(map: &ResidualMap, cutoffs_hz: &[f64], known: &[Unexplained], alpha: f64) -> Vec<Unexplained> {
    let level = STRICTER * alpha;
    let count = map.joints.len() as f64;
    let open = map.joints.iter().filter(|own| known.iter().all(|left| left.joint != own.joint));
    open.filter_map(|own| largest(own, count, BELOW_CUTOFF * cutoffs_hz[own.joint], level)).collect()
}

fn largest(own: &JointMap, joints: f64, highest_hz: f64, level: f64) -> Option<Unexplained> {
    // A constant torque is a law of the library, which has been tested.
    let parts = own.reported().filter(|part| part.follows != Kind::Offset);
    let parts = parts.map(|part| (part.rms, part.follows.meaning(), part.family_wise_p));
    let lines = own.reported_lines().filter(|line| line.hz < highest_hz);
    let lines = lines.map(|line| (line.rms, LINE, (joints * line.p).min(1.0)));
    let (rms, structure, p) = parts.chain(lines).filter(|(_, _, p)| *p <= level).max_by(|a, b| a.0.total_cmp(&b.0))?;
    let share = (rms / own.residual).powi(2).min(1.0);
    let (family_wise_p, instead_of) = (Some(p), Vec::new());
    (share >= WORTH_TELLING).then_some(Unexplained {
        joint: own.joint,
        share,
        structure,
        family_wise_p,
        sure: false,
        instead_of,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::variance::{Line, Part};

    fn map(rms: f64, p: f64, line: Option<(f64, f64)>) -> ResidualMap {
        let part = Part { follows: Kind::SlowTime, rms, p, family_wise_p: p, significant: true };
        let lines = line.into_iter().map(|(rms, p)| Line { hz: 7.3, rms, p }).collect();
        let own = JointMap {
            joint: 0,
            torque: 10.0,
            residual: 1.2,
            noise: 1.0,
            correlation: 0.0,
            sensor_noise: 1.0,
            parts: vec![part],
            lines,
        };
        ResidualMap { joints: vec![own] }
    }

    #[test]
    fn what_is_significant_and_clear_of_the_noise_is_told() {
        let told = |map: &ResidualMap| mapped(map, &[15.0], &[], 0.05);
        let [left] = &told(&map(0.6, 0.009, None))[..] else { panic!() };
        assert!(left.structure == Kind::SlowTime.meaning() && (left.share - 0.25).abs() < 1e-12 && !left.sure);
        // A fifth of the level decides, and a quarter of the noise.
        assert!(told(&map(0.6, 0.011, None)).is_empty());
        assert!(told(&map(0.24, 0.001, None)).is_empty());
        assert_eq!(told(&map(0.26, 0.001, None)).len(), 1);
        assert_eq!(told(&map(0.1, 0.001, Some((0.3, 1e-3))))[0].structure, LINE);
        assert!(told(&map(0.1, 0.001, Some((0.2, 1e-3)))).is_empty());
        // A line near the cut-off is none.
        assert!(mapped(&map(0.1, 0.001, Some((0.3, 1e-3))), &[14.0], &[], 0.05).is_empty());
        // What is known of a joint stays as it is.
        assert!(mapped(&map(0.6, 0.001, None), &[15.0], &told(&map(0.6, 0.001, None)), 0.05).is_empty());
    }
}
