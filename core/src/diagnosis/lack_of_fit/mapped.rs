//! Structure that the mixed model shows in the residual of the extended model, on joints where the block tests are not significant.
//!
//! The block tests estimate the noise spectrum from the residual itself, so that a slow, periodic or wandering residual is part of that
//! noise. The tests of the mixed model need no noise spectrum.

use super::structure::Unexplained;
use crate::diagnosis::criteria::{Criteria, Gate, Judgement, StructureCriteria};
use crate::diagnosis::variance::{JointMap, Kind, Line, ResidualMap};
use crate::error::Result;

/// What a spectral line is.
const LINE: &str = "oscillates at a fixed frequency";

/// The largest part, or line, of every joint that is significant over all logs, and again in the training and in the held-out logs by
/// themselves: few blocks of uneven noise make the p-value of one map too small now and then, but not of the same kind in both.
///
/// `map` is that of all logs, `cutoffs_hz` are those of the joints' positions, joints among `known` are left out, `alpha` is the
/// family-wise level of names. `apart` makes the maps of the training and of the held-out logs, and is called where they are asked for;
/// where it gives none, the map of all logs decides alone.
///
/// # Errors
/// Those of `apart`.
pub(crate) fn mapped(
    map: &ResidualMap,
    cutoffs_hz: &[f64],
    known: &[Unexplained],
    criteria: &Criteria,
    alpha: f64,
    apart: impl FnOnce() -> Result<Vec<ResidualMap>>,
) -> Result<Vec<Unexplained>> {
    let level = criteria.structure.together * alpha;
    let count = map.joints.len() as f64;
    let open = map.joints.iter().filter(|own| known.iter().all(|left| left.joint != own.joint));
    let shown: Vec<(&JointMap, Vec<Shown>)> = open
        .map(|own| (own, shown(own, count, criteria.levels.most * cutoffs_hz[own.joint], level, &criteria.structure)))
        .filter(|(_, shown)| !shown.is_empty())
        .collect();
    if shown.is_empty() {
        return Ok(Vec::new());
    }
    let apart = apart()?;
    let largest = |(own, shown): (&JointMap, Vec<Shown>)| {
        let again = |shown: Shown| {
            let again = apart.iter().filter_map(|map| shown.follows.again(map, own.joint, criteria));
            let passed: Vec<Judgement> = shown.passed.into_iter().chain(again).collect();
            let failed = Judgement::first_failed(passed.iter().copied());
            tracing::debug!(joint = own.joint, follows = shown.follows.meaning(), ?failed, "structure in all logs");
            failed.is_none().then_some((shown, passed))
        };
        let again = shown.into_iter().filter_map(again);
        let (largest, passed) = again.max_by(|(a, _), (b, _)| a.share.total_cmp(&b.share))?;
        Some(Unexplained {
            joint: own.joint,
            share: largest.share,
            structure: largest.follows.meaning(),
            family_wise_p: Some(largest.family_wise_p),
            certain: false,
            instead_of: Vec::new(),
            passed,
        })
    };
    Ok(shown.into_iter().filter_map(largest).collect())
}

/// What a residual follows.
#[derive(Debug, Clone, Copy)]
enum Follows {
    Kind(Kind),
    Line(Line),
}

/// Something that a map shows.
#[derive(Debug, Clone, Copy)]
struct Shown {
    follows: Follows,
    /// Share of the residual's square.
    share: f64,
    family_wise_p: f64,
    /// The gates that it passed.
    passed: [Judgement; 2],
}

impl Follows {
    fn meaning(self) -> &'static str {
        match self {
            Follows::Kind(kind) => kind.meaning(),
            Follows::Line(_) => LINE,
        }
    }

    /// Whether a map of other logs shows it too: the p-value of a kind, the distance to the nearest line. None where the logs are too
    /// short to be asked.
    fn again(self, map: &ResidualMap, joint: usize, criteria: &Criteria) -> Option<Judgement> {
        let own = map.joints.iter().find(|own| own.joint == joint);
        match self {
            Follows::Kind(kind) => {
                let p = own.map_or(Some(1.0), |own| own.p(kind))?;
                Some(Judgement::below(Gate::StructureAgain, p, criteria.levels.usual_p))
            }
            Follows::Line(line) => {
                let lines = own.into_iter().flat_map(|own| &own.lines);
                let distance = lines.map(|other| (other.hz - line.hz).abs()).fold(f64::INFINITY, f64::min);
                Some(Judgement::at_most(Gate::SameLine, distance, criteria.structure.same_line_hz))
            }
        }
    }
}

/// What is significant at `level` on a joint, clear of the noise, and large enough.
fn shown(own: &JointMap, joints: f64, highest_hz: f64, level: f64, criteria: &StructureCriteria) -> Vec<Shown> {
    let judged = |follows: Follows, rms: f64, family_wise_p: f64| {
        let share = (rms / own.residual).powi(2).min(1.0);
        let passed = [
            Judgement::at_most(Gate::Structure, family_wise_p, level),
            Judgement::at_least(Gate::StructureShare, share, criteria.share_of_residual()),
        ];
        Judgement::first_failed(passed).is_none().then_some(Shown { follows, share, family_wise_p, passed })
    };
    // A constant torque is a law of the library, which has been tested.
    let parts = own
        .reported()
        .filter(|part| part.follows != Kind::Offset)
        .filter_map(|part| judged(Follows::Kind(part.follows), part.rms, part.family_wise_p?));
    let lines = own.reported_lines().filter(|line| line.hz < highest_hz);
    let lines = lines.filter_map(|line| judged(Follows::Line(*line), line.rms, (joints * line.p).min(1.0)));
    parts.chain(lines).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::variance::Part;

    fn map(rms: f64, p: f64, line: Option<(f64, f64)>) -> ResidualMap {
        let part = Part { follows: Kind::SlowTime, rms, p: Some(p), family_wise_p: Some(p), significant: p < 0.05 };
        let lines = line.into_iter().map(|(rms, p)| Line { hz: 7.3, rms, p }).collect();
        let own = JointMap {
            joint: 0,
            torque: 10.0,
            residual: 1.2,
            noise: 1.0,
            correlation: 0.0,
            sensor_noise: 1.0,
            reported_from: 0.25,
            misfit: false,
            parts: vec![part],
            lines,
        };
        ResidualMap { joints: vec![own] }
    }

    /// What is reported where the logs by themselves show the same.
    fn reported(map: &ResidualMap, cutoff_hz: f64, known: &[Unexplained]) -> Vec<Unexplained> {
        mapped(map, &[cutoff_hz], known, &Criteria::default(), 0.05, || Ok(vec![map.clone(), map.clone()])).unwrap()
    }

    #[test]
    fn what_is_significant_and_clear_of_the_noise_is_told() {
        let [left] = &reported(&map(0.6, 0.009, None), 15.0, &[])[..] else { panic!() };
        assert!(left.structure == Kind::SlowTime.meaning() && (left.share - 0.25).abs() < 1e-12 && !left.certain);
        // A fifth of the level decides, and a quarter of the residual, which is 1.2.
        assert!(reported(&map(0.6, 0.011, None), 15.0, &[]).is_empty());
        assert!(reported(&map(0.29, 0.001, None), 15.0, &[]).is_empty());
        assert_eq!(reported(&map(0.31, 0.001, None), 15.0, &[]).len(), 1);
        assert_eq!(reported(&map(0.1, 0.001, Some((0.31, 1e-3))), 15.0, &[])[0].structure, LINE);
        assert!(reported(&map(0.1, 0.001, Some((0.2, 1e-3))), 15.0, &[]).is_empty());
        // A line near the cut-off is none.
        assert!(reported(&map(0.1, 0.001, Some((0.31, 1e-3))), 14.0, &[]).is_empty());
        // What is known of a joint stays as it is.
        let once = reported(&map(0.6, 0.001, None), 15.0, &[]);
        assert!(reported(&map(0.6, 0.001, None), 15.0, &once).is_empty());
    }

    #[test]
    fn the_training_and_the_held_out_logs_each_show_it() {
        let criteria = Criteria::default();
        let reported = |map: &ResidualMap, apart: [ResidualMap; 2]| {
            mapped(map, &[15.0], &[], &criteria, 0.05, || Ok(apart.into())).unwrap()
        };
        let slow = map(0.6, 0.001, None);
        let [left] = &reported(&slow, [map(0.6, 0.049, None), map(0.1, 0.049, None)])[..] else { panic!() };
        let again = [Judgement::below(Gate::StructureAgain, 0.049, criteria.levels.usual_p); 2];
        assert_eq!(left.passed[2..], again);
        assert!(reported(&slow, [map(0.6, 0.051, None), slow.clone()]).is_empty());
        assert!(reported(&slow, [slow.clone(), map(0.6, 0.051, None)]).is_empty());
        // Logs that are too short for the test do not contradict it.
        let mut short = slow.clone();
        (short.joints[0].parts[0].p, short.joints[0].parts[0].family_wise_p) = (None, None);
        assert_eq!(reported(&slow, [slow.clone(), short]).len(), 1);
        let line = map(0.1, 0.5, Some((0.3, 1e-3)));
        let moved = |hz: f64| {
            let mut moved = line.clone();
            moved.joints[0].lines[0].hz = hz;
            moved
        };
        assert_eq!(reported(&line, [line.clone(), moved(7.39)]).len(), 1);
        assert!(reported(&line, [line.clone(), moved(7.41)]).is_empty());
        assert!(reported(&line, [line.clone(), slow]).is_empty());
    }
}
