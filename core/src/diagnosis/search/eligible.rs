//! Which candidates may win a model comparison, and which stay as alternatives only.

use super::found::{Found, Rejected};
use crate::diagnosis::criteria::{Gate, Judgement};
use crate::diagnosis::evidence::{Judged, Multiplicity, Scan};
use crate::diagnosis::model::{Candidate, Slot, is_level};

/// A candidate that was refused.
#[derive(Debug, Clone)]
pub(super) struct Refused {
    /// What it was.
    pub slot: Slot,
    /// The joints that it acts on.
    pub joints: Vec<usize>,
    /// Whether it may act all the same: the logs are too few to decide, and it stays an alternative to what is found in its place.
    pub may_be: bool,
}

impl Refused {
    /// A candidate that may be so all the same, or not.
    pub(super) fn new(candidate: &Candidate, may_be: bool) -> Self {
        Refused { slot: candidate.slot(), joints: candidate.joints(), may_be }
    }

    /// One that is not significant: it may act, but a saturation limit cannot be judged by a few rows.
    pub(super) fn faint(candidate: &Candidate) -> Self {
        Self::new(candidate, !is_level(candidate.placed.effect))
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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    /// It may win a name.
    MayWin,
    /// It is too faint for that, and may be another name for what wins.
    NotSignificant,
    /// It is too faint for either.
    Excluded,
}

/// Who may win a name.
#[derive(Debug)]
pub(super) struct Contenders<'a> {
    /// The best of every family that may, that first which chance alone would bring least.
    pub best: Vec<&'a Judged>,
    /// Family-wise level of the first.
    pub level: f64,
    /// Who may be another name.
    pub eligible: Eligible,
}

impl<'a> Contenders<'a> {
    /// Those of a `scan` given what was `found` and what was `refused`; None where there are none. `standing` says what may
    /// come of a candidate by its family-wise level.
    pub(super) fn new(
        scan: &'a Scan,
        found: &[Found],
        refused: &[Refused],
        multiplicity: &Multiplicity,
        standing: impl Fn(&Candidate, f64) -> Standing,
    ) -> Option<Self> {
        let level_of = |judged: &Judged| multiplicity.level(judged.candidate.family().effect, judged.test.log_p());
        let mut best = scan.best_per_family();
        let faint = best.iter().filter_map(|judged| match standing(&judged.candidate, level_of(judged)) {
            Standing::MayWin => None,
            Standing::NotSignificant => Some(Refused::faint(&judged.candidate)),
            Standing::Excluded => Some(Refused::new(&judged.candidate, false)),
        });
        let eligible = Eligible::new(found, refused.iter().cloned().chain(faint).collect());
        best.retain(|judged| eligible.may_win(&judged.candidate));
        best.sort_by(|a, b| multiplicity.expected(a).total_cmp(&multiplicity.expected(b)));
        let level = level_of(best.first()?);
        Some(Contenders { best, level, eligible })
    }

    /// The first as a candidate that is not significant at `alpha`.
    pub(super) fn not_significant(&self, alpha: f64) -> Option<Rejected> {
        let slot = self.best.first()?.candidate.slot();
        Some(Rejected { slot, failed: Judgement::at_most(Gate::FamilyWise, self.level, alpha) })
    }
}
