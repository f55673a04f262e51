//! Which candidates may win a contest for a name, and which stay as other names only.

use super::candidates::{Candidate, Slot};
use super::found::Found;
use super::judging::Judged;
use super::roles::is_level;

/// A candidate that was refused.
#[derive(Debug, Clone)]
pub struct Refused {
    /// What it was.
    pub slot: Slot,
    /// The joints that it acts on.
    pub joints: Vec<usize>,
    /// Whether it may be so all the same: the logs are too few to tell, and it stays another name for what is found in its place.
    pub may_be: bool,
}

impl Refused {
    /// One that is too faint to be sure of: it may be so, but a level tells nothing of a few rows.
    pub fn faint(judged: &Judged) -> Self {
        let candidate = &judged.candidate;
        Refused { slot: candidate.slot(), joints: candidate.joints(), may_be: !is_level(candidate.placed.effect) }
    }
}

/// The candidates of a round.
#[derive(Debug, Default)]
pub struct Eligible {
    /// What the model has.
    taken: Vec<Slot>,
    /// What was refused since something was found where it acts.
    refused: Vec<Refused>,
    /// What only the training logs could show, and do not.
    hopeless: Vec<Slot>,
}

impl Eligible {
    /// Beside what was found and what was refused.
    pub fn new(found: &[Found], refused: &[Refused], hopeless: Vec<Slot>) -> Self {
        let taken = found.iter().map(|found| found.member.candidate.slot()).collect();
        Eligible { taken, refused: refused.to_vec(), hopeless }
    }

    /// Whether a candidate may win.
    pub fn may_win(&self, candidate: &Candidate) -> bool {
        let slot = candidate.slot();
        self.may_be(candidate) && !self.refused.iter().any(|refused| refused.slot == slot)
    }

    /// Whether it may be another name for what wins.
    pub fn may_be(&self, candidate: &Candidate) -> bool {
        let slot = candidate.slot();
        let (family, log) = slot;
        !self.hopeless.contains(&slot)
            && !self.refused.iter().any(|refused| refused.slot == slot && !refused.may_be)
            && !self.taken.iter().any(|(other, at)| *other == family && (*at == log || at.is_none()))
    }
}
