//! Structure that the mixed model shows in the residual of the extended model, on joints where the block tests are not significant.
//!
//! The block tests estimate the noise spectrum from the residual itself, so that a slow, periodic or wandering residual is part of that
//! noise. The tests of the mixed model need no noise spectrum.

use super::above_noise::above_sensor;
use super::reported::{RejectedStructure, Structure, Unexplained};
use crate::diagnosis::criteria::{Criteria, Gate, Judgement};
use crate::diagnosis::variance::{JointMap, Kind, Line, ResidualMap};
use crate::error::Result;

/// What a spectral line is.
const LINE: &str = "oscillates at a fixed frequency";

/// The largest part, or line, of every joint that is significant over all logs, and again in the training and in the held-out logs by
/// themselves: few blocks of uneven noise make the p-value of one map too small now and then, but not of the same kind in both.
///
/// `map` is that of all logs, `cutoffs_hz` are those of the joints' positions, `alpha` is the family-wise level of names. `apart` makes the maps of the training and of the held-out logs, and is called where they are asked for;
/// where it gives none, the map of all logs decides alone.
///
/// # Errors
/// Those of `apart`.
pub(crate) fn mapped(
    map: &ResidualMap,
    cutoffs_hz: &[f64],
    criteria: &Criteria,
    alpha: f64,
    apart: impl FnOnce() -> Result<Vec<ResidualMap>>,
) -> Result<Structure> {
    let level = criteria.structure.together * alpha;
    let count = map.joints.len() as f64;
    let rejected = |own: &JointMap, follows: Follows, failed: Judgement| RejectedStructure {
        joint: own.joint,
        structure: follows.meaning(),
        failed,
    };
    let mut all = Structure::default();
    let mut shown: Vec<(&JointMap, Vec<Shown>)> = Vec::new();
    for own in &map.joints {
        let highest_hz = criteria.levels.most * cutoffs_hz[own.joint];
        let mut large = Vec::new();
        for one in significant(own, count, highest_hz, level, criteria) {
            match Judgement::first_failed(one.passed[1..].iter().copied()) {
                Some(failed) => all.rejected.push(rejected(own, one.follows, failed)),
                None => large.push(one),
            }
        }
        if !large.is_empty() {
            shown.push((own, large));
        }
    }
    if shown.is_empty() {
        return Ok(all);
    }
    let apart = apart()?;
    for (own, shown) in shown {
        let mut confirmed: Vec<(Shown, Vec<Judgement>)> = Vec::new();
        for shown in shown {
            let again = apart.iter().filter_map(|map| shown.follows.again(map, own.joint, criteria));
            let passed: Vec<Judgement> = shown.passed.into_iter().chain(again).collect();
            match Judgement::first_failed(passed.iter().copied()) {
                Some(failed) => all.rejected.push(rejected(own, shown.follows, failed)),
                None => confirmed.push((shown, passed)),
            }
        }
        let largest = confirmed.into_iter().max_by(|(a, _), (b, _)| a.share.total_cmp(&b.share));
        all.unexplained.extend(largest.map(|(largest, passed)| Unexplained {
            joint: own.joint,
            share: largest.share,
            structure: largest.follows.meaning(),
            family_wise_p: Some(largest.family_wise_p),
            certain: false,
            instead_of: Vec::new(),
            passed,
        }));
    }
    Ok(all)
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
    /// Whether it is significant, enough of the residual, and whether that is more than the sensor's noise.
    passed: [Judgement; 3],
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

/// What is significant at `level` on a joint, and clear of the noise.
fn significant(own: &JointMap, joints: f64, highest_hz: f64, level: f64, criteria: &Criteria) -> Vec<Shown> {
    let above_sensor = above_sensor(own.residual, own.sensor_noise, criteria);
    let judged = |follows: Follows, rms: f64, family_wise_p: f64| {
        let share = (rms / own.residual).powi(2).min(1.0);
        let significant = Judgement::at_most(Gate::Structure, family_wise_p, level);
        let large = Judgement::at_least(Gate::StructureShare, share, criteria.structure.share_of_residual());
        let passed = [significant, large, above_sensor];
        significant.passed.then_some(Shown { follows, share, family_wise_p, passed })
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
    use super::super::reported::Replaced;
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
    fn reported(map: &ResidualMap, cutoff_hz: f64) -> Vec<Unexplained> {
        let apart = || Ok(vec![map.clone(), map.clone()]);
        mapped(map, &[cutoff_hz], &Criteria::default(), 0.05, apart).unwrap().unexplained
    }

    #[test]
    fn what_is_significant_and_clear_of_the_noise_is_told() {
        let [left] = &reported(&map(0.6, 0.0049, None), 15.0)[..] else { panic!() };
        assert!(left.structure == Kind::SlowTime.meaning() && (left.share - 0.25).abs() < 1e-12 && !left.certain);
        // A tenth of alpha decides, and a quarter of the residual, which is 1.2.
        assert!(reported(&map(0.6, 0.0051, None), 15.0).is_empty());
        assert!(reported(&map(0.29, 0.001, None), 15.0).is_empty());
        assert_eq!(reported(&map(0.31, 0.001, None), 15.0).len(), 1);
        assert_eq!(reported(&map(0.1, 0.001, Some((0.31, 1e-3))), 15.0)[0].structure, LINE);
        assert!(reported(&map(0.1, 0.001, Some((0.2, 1e-3))), 15.0).is_empty());
        // A line near the cut-off is none.
        assert!(reported(&map(0.1, 0.001, Some((0.31, 1e-3))), 14.0).is_empty());
    }

    #[test]
    fn of_a_joint_the_larger_structure_is_reported() {
        let of_map = || {
            let criteria = Criteria::default();
            mapped(&map(0.6, 0.001, None), &[15.0], &criteria, 0.05, || Ok(Vec::new())).unwrap()
        };
        let with = |share: f64, instead_of: &[Replaced]| {
            let [mut left] = <[Unexplained; 1]>::try_from(of_map().unexplained).unwrap();
            (left.share, left.certain, left.structure, left.instead_of) = (share, true, LINE, instead_of.to_vec());
            let mut all = Structure { unexplained: vec![left], rejected: Vec::new() };
            all.merge(of_map());
            all.unexplained
        };
        let [smaller] = &with(0.24, &[])[..] else { panic!() };
        assert!(smaller.structure == Kind::SlowTime.meaning() && smaller.certain);
        assert_eq!(with(0.26, &[])[0].structure, LINE);
        // A finding that the smaller replaces stays replaced.
        let replaced = [Replaced { place: 0, beyond: 0.5 }];
        let [smaller] = &with(0.24, &replaced)[..] else { panic!() };
        assert!(smaller.structure == Kind::SlowTime.meaning() && smaller.instead_of == replaced);
        assert_eq!(with(0.26, &replaced)[0].structure, LINE);
    }

    #[test]
    fn the_training_and_the_held_out_logs_each_show_it() {
        let criteria = Criteria::default();
        let reported = |map: &ResidualMap, apart: [ResidualMap; 2]| {
            mapped(map, &[15.0], &criteria, 0.05, || Ok(apart.into())).unwrap()
        };
        let gates = |found: &Structure| found.rejected.iter().map(|one| one.failed.gate).collect::<Vec<Gate>>();
        let slow = map(0.6, 0.001, None);
        let found = reported(&slow, [map(0.6, 0.049, None), map(0.1, 0.049, None)]);
        let again = [Judgement::below(Gate::StructureAgain, 0.049, criteria.levels.usual_p); 2];
        assert_eq!(found.unexplained[0].passed[3..], again);
        assert!(found.rejected.is_empty());
        for apart in [[map(0.6, 0.051, None), slow.clone()], [slow.clone(), map(0.6, 0.051, None)]] {
            let found = reported(&slow, apart);
            assert!(found.unexplained.is_empty() && gates(&found) == [Gate::StructureAgain], "{found:?}");
        }
        let small = reported(&map(0.29, 0.001, None), [slow.clone(), slow.clone()]);
        assert!(small.unexplained.is_empty() && gates(&small) == [Gate::StructureShare], "{small:?}");
        // A residual of 1.2 is more than the noise of a sensor of 1.09, and not of 1.1.
        for (noise, none) in [(1.09, vec![]), (1.1, vec![Gate::AboveExpected])] {
            let mut noisy = slow.clone();
            noisy.joints[0].sensor_noise = noise;
            assert_eq!(gates(&reported(&noisy, [slow.clone(), slow.clone()])), none);
        }
        // Logs that are too short for the test do not contradict it.
        let mut short = slow.clone();
        (short.joints[0].parts[0].p, short.joints[0].parts[0].family_wise_p) = (None, None);
        assert_eq!(reported(&slow, [slow.clone(), short]).unexplained.len(), 1);
        let line = map(0.1, 0.5, Some((0.3, 1e-3)));
        let moved = |hz: f64| {
            let mut moved = line.clone();
            moved.joints[0].lines[0].hz = hz;
            moved
        };
        assert_eq!(reported(&line, [line.clone(), moved(7.39)]).unexplained.len(), 1);
        for apart in [[line.clone(), moved(7.41)], [line.clone(), slow]] {
            assert_eq!(gates(&reported(&line, apart)), [Gate::SameLine]);
        }
    }
}
