//! Which candidates may win a model comparison, and which stay as alternatives only.

use super::found::{Found, Rejected};
use crate::diagnosis::criteria::{Gate, Judgement, Levels};
use crate::diagnosis::evidence::{Judged, Multiplicity, Scan};
use crate::diagnosis::model::{Candidate, Session, Slot, is_event, is_level, is_shift};
use crate::diagnosis::regression::{Column, combined, rms};
use crate::effects::Effect;
use std::collections::BTreeMap;

/// A candidate that was refused.
#[derive(Debug, Clone)]
pub(super) struct Refused {
    /// What it was.
    pub slot: Slot,
    /// The joints that it acts on.
    pub joints: Vec<usize>,
    /// Whether it may act all the same: the logs are too few to decide, and it stays an alternative to what is found in its place.
    pub may_be: bool,
    /// Score statistic with which it was refused.
    statistic: f64,
    /// Whether something was found since where it acts.
    is_open: bool,
}

impl Refused {
    /// A candidate, as judged in the scan, that may be so all the same, or not.
    pub(super) fn new(judged: &Judged, may_be: bool) -> Self {
        let Judged { candidate, test, .. } = judged;
        Refused {
            slot: candidate.slot(),
            joints: candidate.joints(),
            may_be,
            statistic: test.statistic,
            is_open: false,
        }
    }

    /// One that is not asked, or not significant: it may act, but a saturation limit cannot be judged by a few rows.
    fn faint(judged: &Judged) -> Self {
        Self::new(judged, !is_level(judged.candidate.placed.effect))
    }

    /// Opens the question once something was found on `joints`: it was asked in a noise that did not know that.
    pub(super) fn open_on(&mut self, joints: &[usize]) {
        self.is_open |= self.joints.iter().any(|joint| joints.contains(joint));
    }

    /// Whether it is asked again with so large a `statistic`. As long as what was found since leaves its test as it was, to a minor share,
    /// the answer is the same: laws of the whole arm would be asked after every finding on a joint.
    fn is_asked_again(&self, statistic: f64, levels: &Levels) -> bool {
        self.is_open && (statistic - self.statistic).abs() > levels.minor * self.statistic
    }
}

/// The candidates of a round.
#[derive(Debug, Default)]
pub(super) struct Eligible {
    /// What the model has.
    taken: Vec<Slot>,
    /// What was refused since something was found where it acts.
    refused: Vec<Refused>,
}

impl Eligible {
    /// Given what was found and what was refused.
    pub(super) fn new(found: &[Found], refused: Vec<Refused>) -> Self {
        let taken = found.iter().map(|found| found.member.candidate.slot()).collect();
        Eligible { taken, refused }
    }

    /// Whether a candidate may win.
    pub(super) fn may_win(&self, candidate: &Candidate) -> bool {
        let slot = candidate.slot();
        self.may_be(candidate) && !self.refused.iter().any(|refused| refused.slot == slot)
    }

    /// Whether it may be another name for what wins.
    pub(super) fn may_be(&self, candidate: &Candidate) -> bool {
        let slot = candidate.slot();
        let (family, log) = slot;
        !self.refused.iter().any(|refused| refused.slot == slot && !refused.may_be)
            && !self.taken.iter().any(|(other, at)| *other == family && (*at == log || at.is_none()))
    }
}

/// What may come of a candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Standing {
    /// It may win a name.
    MayWin,
    /// These logs cannot show it: it may be another name for what wins.
    NotAsked,
    /// It fails a gate, and may be another name for what wins.
    Failed(Judgement),
    /// It fails a gate, and is no other name either.
    Excluded,
}

impl Standing {
    /// By the judgement of a candidate's level: what fails it may be another name up to the family-wise level `alpha`.
    pub(super) fn by(judgement: Judgement, alpha: f64) -> Self {
        match judgement.passed {
            true => Standing::MayWin,
            false if judgement.value <= alpha => Standing::Failed(judgement),
            false => Standing::Excluded,
        }
    }
}

/// Who may win a name.
#[derive(Debug)]
pub(super) struct Contenders<'a> {
    /// The best of every family that may, that first which chance alone would bring least.
    pub best: Vec<&'a Judged>,
    /// Family-wise level of the first; one where there is none.
    pub level: f64,
    /// Who may be another name.
    pub eligible: Eligible,
    /// Those that are significant at the family-wise level, and fail a gate: they are not at the share of it that their kind has, or too small.
    pub rejected: Vec<Rejected>,
}

impl<'a> Contenders<'a> {
    /// Those of a `scan` given what was `found`, and what was `refused` by these `levels`. `standing` is what may come of a candidate by its
    /// test and its family-wise level.
    pub(super) fn new(
        scan: &'a Scan,
        found: &[Found],
        (refused, levels): (&[Refused], &Levels),
        multiplicity: &Multiplicity,
        standing: impl Fn(&Judged, f64) -> Standing,
    ) -> Self {
        let level_of = |judged: &Judged| multiplicity.level(judged.candidate.family().effect, judged.test.log_p());
        let mut best = scan.best_per_family();
        let statistics: BTreeMap<Slot, f64> =
            best.iter().map(|judged| (judged.candidate.slot(), judged.test.statistic)).collect();
        let is_asked = |refused: &&Refused| {
            statistics.get(&refused.slot).is_some_and(|statistic| refused.is_asked_again(*statistic, levels))
        };
        let mut refused: Vec<Refused> = refused.iter().filter(|refused| !is_asked(refused)).cloned().collect();
        let mut rejected = Vec::new();
        for judged in &best {
            let candidate = &judged.candidate;
            match standing(judged, level_of(judged)) {
                Standing::MayWin => {}
                Standing::NotAsked => refused.push(Refused::faint(judged)),
                Standing::Failed(failed) => {
                    refused.push(Refused::faint(judged));
                    rejected.push(Rejected { slot: candidate.slot(), failed });
                }
                Standing::Excluded => refused.push(Refused::new(judged, false)),
            }
        }
        let eligible = Eligible::new(found, refused);
        best.retain(|judged| eligible.may_win(&judged.candidate));
        best.sort_by(|a, b| multiplicity.expected(a).total_cmp(&multiplicity.expected(b)));
        let level = best.first().map_or(1.0, |first| level_of(first));
        Contenders { best, level, eligible, rejected }
    }

    /// The winner of their comparison as refused, by its test in the scan: the comparison sees it in another noise.
    pub(super) fn refused(&self, winner: &Judged, may_be: bool) -> Refused {
        let in_scan = self.best.iter().find(|judged| judged.candidate.slot() == winner.candidate.slot());
        Refused::new(in_scan.unwrap_or(&winner), may_be)
    }

    /// The first as a candidate that is not significant at `alpha`.
    pub(super) fn not_significant(&self, alpha: f64) -> Option<Rejected> {
        let slot = self.best.first()?.candidate.slot();
        Some(Rejected { slot, failed: Judgement::at_most(Gate::FamilyWise, self.level, alpha) })
    }
}

/// Sizes below which nothing matters on the joints of some logs, in which rows, and the levels that judge. What is smaller never becomes a
/// finding, and each would cost a round of the search.
#[derive(Debug)]
pub(super) struct Sizes {
    floors: Vec<f64>,
    valid: Vec<Vec<bool>>,
    levels: Levels,
}

impl Sizes {
    /// Those of the training logs of `session`.
    pub(super) fn new(session: &Session) -> Self {
        let rows = &session.logs.train.rows;
        let torque = rms(&rows.valid, &Column::new(rows.torque.iter().cloned()));
        let floors = torque.iter().map(|torque| session.criteria.floor(*torque)).collect();
        Sizes { floors, valid: rows.valid.clone(), levels: session.criteria.levels }
    }

    /// What may come of a candidate by its size, and by whether it `is_significant`. A fit that changes the noise or the shapes changes its
    /// amplitudes too, by less than a factor of two. Shifts, which spoil other tests, events, which last for a few rows, and limits of torque
    /// are looked for at any size.
    pub(super) fn standing(&self, judged: &Judged, is_significant: bool) -> Standing {
        let Candidate { placed, columns, .. } = &judged.candidate;
        self.of_torque(placed.effect, &combined(columns, &judged.test.values), is_significant)
    }

    /// The factor on a torque from which it matters.
    pub(super) fn least_factor(&self, torque: &Column) -> f64 {
        1.0 / self.over_floor(torque)
    }

    /// The largest of the sizes of a torque on all joints over their floors.
    fn over_floor(&self, torque: &Column) -> f64 {
        let over = |(size, floor): (&f64, &f64)| if *size > 0.0 { size / floor } else { 0.0 };
        rms(&self.valid, torque).iter().zip(&self.floors).map(over).fold(0.0, f64::max)
    }

    /// The same by the torque of an effect.
    fn of_torque(&self, effect: &dyn Effect, torque: &Column, is_significant: bool) -> Standing {
        if is_shift(effect) || is_event(effect) || is_level(effect) {
            return Standing::MayWin;
        }
        let large = Judgement::at_least(Gate::Size, self.over_floor(torque), self.levels.most);
        match (large.passed, is_significant) {
            (true, _) => Standing::MayWin,
            (false, true) => Standing::Failed(large),
            (false, false) => Standing::Excluded,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::model::Family;

    #[test]
    fn what_is_less_than_half_the_floor_is_not_looked_for() {
        use crate::effects::find;
        let sizes = Sizes { floors: vec![2.0], valid: vec![vec![true; 4]], levels: Levels::default() };
        let standing = |name: &str, size: f64, significant: bool| {
            sizes.of_torque(find(name).unwrap(), &Column::on(0, vec![size, -size, size, -size]), significant)
        };
        assert_eq!(standing("torque_offset", 1.0 + 1e-9, true), Standing::MayWin);
        assert!(
            matches!(standing("torque_offset", 1.0 - 1e-9, true), Standing::Failed(failed) if failed.gate == Gate::Size)
        );
        assert_eq!(standing("torque_offset", 1.0 - 1e-9, false), Standing::Excluded);
        for at_any_size in ["time_delay", "external_contact", "torque_saturation"] {
            assert_eq!(standing(at_any_size, 1e-3, true), Standing::MayWin, "{at_any_size}");
        }
    }

    #[test]
    fn what_was_refused_is_asked_again_where_its_test_changes() {
        let slot = (Family { effect: "base_tilt", joint: 0 }, None);
        let mut refused = Refused { slot, joints: vec![0, 1], may_be: false, statistic: 100.0, is_open: false };
        let levels = Levels::default();
        refused.open_on(&[2]);
        assert!(!refused.is_asked_again(200.0, &levels));
        refused.open_on(&[1]);
        assert!(!refused.is_asked_again(109.9, &levels) && !refused.is_asked_again(90.1, &levels));
        assert!(refused.is_asked_again(110.1, &levels) && refused.is_asked_again(89.9, &levels));
    }

    #[test]
    fn what_fails_its_share_of_alpha_may_be_another_name_up_to_alpha() {
        let at_share = |level: f64| Judgement::at_most(Gate::FamilyWise, level, 5e-9);
        let standing = |level: f64| Standing::by(at_share(level), 0.05);
        assert_eq!((standing(1e-9), standing(0.051)), (Standing::MayWin, Standing::Excluded));
        assert_eq!(standing(0.05), Standing::Failed(at_share(0.05)));
        // What held-out logs can confirm is not judged by the training logs alone.
        assert_eq!(Standing::by(at_share(0.9).or(true), 0.05), Standing::MayWin);
    }
}
