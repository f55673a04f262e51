//! What a search found, as it goes into the model and the answer.

use super::acceptance::Accepted;
use super::verdict::Verdict;
use crate::diagnosis::criteria::Judgement;
use crate::diagnosis::evidence::Play;
use crate::diagnosis::model::{Candidate, Family, Member, Session, Slot};
use crate::effects::{self, Nature};

/// Another effect that explains the same.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Alternative, Diagnosis};
///
/// // What else the effects found may be, the likeliest first.
/// fn others(diagnosis: &Diagnosis) -> Vec<String> {
///     let all = diagnosis.found.iter().flat_map(|found| &found.alternatives);
///     let line = |Alternative { family, relative_likelihood }: &Alternative| {
///         format!("{} on joint {}: {relative_likelihood}", family.effect, family.joint)
///     };
///     all.map(line).collect()
/// }
/// ```
#[derive(Debug, Clone)]
pub struct Alternative {
    /// What and where.
    pub family: Family,
    /// Likelihood over that of the effect found, each parameter paid for.
    pub relative_likelihood: f64,
}

/// The best candidate of a round, which failed a gate.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Diagnosis, Rejected};
///
/// // What came close to being found, and why it was not.
/// fn close(diagnosis: &Diagnosis) -> Vec<String> {
///     let line = |Rejected { slot: (family, _), failed }: &Rejected| {
///         format!("{}: {}", family.effect, failed.gate.reason())
///     };
///     diagnosis.rejected.iter().map(line).collect()
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rejected {
    /// What and where, and in which log.
    pub slot: Slot,
    /// The gate.
    pub failed: Judgement,
}

/// The last rejection of every candidate that was not found in the end, in the order of rejection.
pub(super) fn in_the_end(rejected: Vec<Rejected>, found: &[Found]) -> Vec<Rejected> {
    let is_found = |one: &Rejected| found.iter().any(|found| found.member.candidate.slot() == one.slot);
    let later = |k: usize| rejected[k + 1..].iter().any(|other| other.slot == rejected[k].slot);
    (0..rejected.len()).filter(|&k| !is_found(&rejected[k]) && !later(k)).map(|k| rejected[k]).collect()
}

/// An effect that was found.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // The pivot has a ripple of seven periods a turn; with it the held-out residual falls to a tenth.
/// let found = &diagnosis.found[0];
/// assert!(found.alternatives.is_empty() && found.withdrawn.is_none());
/// assert!(found.family_wise_p < 1e-6 && found.rms[1][0] < 0.1 * found.rms[0][0]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Found {
    /// The effect in the model.
    pub member: Member,
    /// What else explains the data, the likeliest first; empty where the data name the effect.
    pub alternatives: Vec<Alternative>,
    /// Probability of as good a best candidate without any effect.
    pub family_wise_p: f64,
    /// Lower bound (84 %) of the share of the held-out sum of squares that it takes away.
    pub gain_lower_bound: f64,
    /// Root mean square of the held-out residual with those found before and with this one too, `[joint]`, N m; known when
    /// the search has ended.
    pub rms: [Vec<f64>; 2],
    /// Named, one of a few, or unexplained: the nearest law to something that it explains in part only.
    pub verdict: Verdict,
    /// The gate that it failed once all was known; its verdict is then unexplained.
    pub withdrawn: Option<Judgement>,
    /// Its impacts, where these are what shows it.
    pub impacts: Option<Play>,
}

impl Found {
    /// Whether it can be selected again: not one that impacts show, nor an event.
    pub(super) fn can_be_asked(&self) -> bool {
        !self.member.held && self.member.candidate.log.is_none()
    }

    /// What a trial accepted.
    pub(crate) fn new(accepted: Accepted, alternatives: Vec<Alternative>) -> Self {
        let Accepted { member, gain_lower_bound, level } = accepted;
        let mut found = Found {
            member,
            alternatives: Vec::new(),
            family_wise_p: level,
            gain_lower_bound,
            rms: Default::default(),
            verdict: Verdict::Named,
            withdrawn: None,
            impacts: None,
        };
        found.set_alternatives(alternatives);
        found
    }

    /// With the effects that explain the data no worse: where there is none, the effect is named.
    pub(super) fn set_alternatives(&mut self, alternatives: Vec<Alternative>) {
        self.verdict = if alternatives.is_empty() { Verdict::Named } else { Verdict::OneOf };
        self.alternatives = alternatives;
    }

    /// Withdraws the finding by a gate that fails once all is known. It is the nearest law to something that it explains in part only.
    pub(crate) fn withdraw(&mut self, failed: Judgement) {
        self.verdict = Verdict::Unexplained;
        self.withdrawn = Some(failed);
    }

    /// With one more effect that explains the data no worse.
    pub(super) fn may_also_be(&mut self, family: Family) {
        let others = self.alternatives.iter().filter(|other| other.family != family).cloned();
        self.set_alternatives([Alternative { family, relative_likelihood: 1.0 }].into_iter().chain(others).collect());
    }
}

/// What was found as members of the model.
pub(crate) fn members(found: &[Found]) -> Vec<Member> {
    found.iter().map(|found| found.member.clone()).collect()
}

/// The alternatives of a new member, and the play of its gear where that has one or impacts leave it open: how the teeth give under
/// load looks like more of either, and a link that lies on one side of its play or the other like an encoder that is not true.
pub(super) fn explained_by_play(
    session: &Session,
    found: &[Found],
    member: &Member,
    mut alternatives: Vec<Alternative>,
) -> Vec<Alternative> {
    let Candidate { placed, .. } = &member.candidate;
    if placed.effect.gear(&placed.parameters).is_some() {
        let rattling =
            found.iter().filter(|other| other.impacts.is_some()).map(|other| other.member.candidate.family());
        let own = rattling.filter(|family| family.joint == placed.joint);
        alternatives.extend(own.map(|family| Alternative { family, relative_likelihood: 1.0 }));
    }
    let play = Family { effect: effects::play().about().name, joint: placed.joint };
    let is_open = placed.effect.about().nature == Nature::LikePlay && session.model.open_play.contains(&placed.joint);
    if is_open && alternatives.iter().all(|other| other.family != play) {
        alternatives.push(Alternative { family: play, relative_likelihood: 1.0 });
    }
    alternatives
}
