//! Names given again once all is known: what was named first was named beside everything that was found after it.

use super::acceptance::{Outcome, Trial, is_confirmable};
use super::comparison::{Chosen, Contest, InOwnNoise, better_unseen, contest};
use super::eligible::{Contenders, Standing};
use super::found::{Alternative, Found, beside_play, members};
use super::round::Round;
use crate::diagnosis::Options;
use crate::diagnosis::evidence::{Multiplicity, Scan};
use crate::diagnosis::model::{Candidate, Family, Noise, Session};
use crate::diagnosis::watch::{Progress, Watch};
use crate::error::Result;

/// What a contest for the name of a finding came to beside all others.
struct Again {
    others: Vec<Found>,
    noise: Noise,
    contest: Contest,
}

impl Again {
    /// The contest for the finding at `index` among the candidates that act where it does; None where nothing can be told. Those
    /// `everywhere` are all candidates along the rows that `session` is identified from.
    fn new(
        session: &Session,
        found: &[Found],
        index: usize,
        everywhere: &[Candidate],
        multiplicity: &Multiplicity,
    ) -> Result<Option<Self>> {
        let others: Vec<Found> =
            found.iter().enumerate().filter(|(k, _)| *k != index).map(|(_, other)| other.clone()).collect();
        let of_others = members(&others);
        let noise = session.noise_under(&session.all_columns(&session.train, &of_others)?);
        // What acts elsewhere is no other name for what is seen here.
        let here = found[index].member.candidate.joints();
        let all: Vec<Candidate> = everywhere.iter().filter(|candidate| candidate.acts_on(&here)).cloned().collect();
        let scan = Scan::new(session, &all, &noise.whitener, &noise.fit);
        let anyone = |_: &Candidate, _| Standing::MayWin;
        let Some(contenders) = Contenders::new(&scan, &others, &[], multiplicity, anyone) else { return Ok(None) };
        let contest = contest(session, &of_others, &contenders, &all, multiplicity, &mut InOwnNoise::new())?;
        Ok(Some(Again { others, noise, contest }))
    }
}

/// Whether the name of a finding can be asked for again: not what impacts tell, nor what happened once.
fn can_be_asked(found: &Found) -> bool {
    !found.member.held && found.member.candidate.log.is_none()
}

/// Holds the contest for the name of every finding once more beside all others, among the candidates that there are `everywhere`; tells
/// whether a name has changed.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn rename(
    session: &Session,
    found: &mut [Found],
    everywhere: &[Candidate],
    multiplicity: &Multiplicity,
    options: &Options,
    watch: &mut Watch,
) -> Result<bool> {
    let (alpha, criteria) = (options.alpha, &options.criteria.search);
    let mut changed = false;
    if found.len() < 2 {
        return Ok(changed);
    }
    for index in (0..found.len()).filter(|&index| can_be_asked(&found[index])).collect::<Vec<_>>() {
        if watch.is_over() {
            break;
        }
        watch.tell(Progress::Found(found.len()));
        let Some(Again { others, noise: Noise { whitener, fit }, contest }) =
            Again::new(session, found, index, everywhere, multiplicity)?
        else {
            continue;
        };
        let of_others = members(&others);
        let Chosen { winner, alternatives, whitener: under } = better_unseen(session, &of_others, contest)?;
        let known = &mut found[index];
        let (old, new) = (known.member.candidate.family(), winner.candidate.family());
        tracing::debug!(?old, ?new, ?alternatives, "name beside the others");
        if old == new {
            known.set_alternatives(beside_play(session, &others, &known.member, alternatives));
            continue;
        }
        let (whitener, fit, members) = (&whitener, &fit, &of_others[..]);
        let trial = Trial { session, members, whitener, fit, multiplicity, alpha, criteria, tries: None };
        let level = multiplicity.level(new.effect, winner.test.log_p());
        match trial.of(&winner, level, under)? {
            Outcome::Accepted(accepted) => {
                let alternatives = beside_play(session, &others, &accepted.member, alternatives);
                *known = Found::new(*accepted, alternatives);
                changed = true;
            }
            // It explains what is left better than the name does, and is not sure enough to take its place.
            Outcome::Refused(refusal) if refusal.may_be => known.may_also_be(new),
            Outcome::Refused(_) => {}
        }
    }
    Ok(changed)
}

/// Asks the logs that `session` is identified from, as `round` sees them, what else explains each finding. What the smoothing mimics is
/// so in all logs: they tell nothing more of gears.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn narrow(
    session: &Session,
    found: &mut [Found],
    round: &Round,
    multiplicity: &Multiplicity,
    watch: &mut Watch,
) -> Result<()> {
    // Where much is left, rows tell rivals apart by what is wrong with both.
    let open = |found: &Found| {
        let much_left = round.whitener.much_is_left(&found.member.candidate.joints());
        can_be_asked(found) && is_confirmable(&found.member.candidate) && !much_left
    };
    let mimicked =
        |family: Family| round.all.iter().any(|candidate| candidate.family() == family && !is_confirmable(candidate));
    for index in (0..found.len()).filter(|&index| open(&found[index])).collect::<Vec<_>>() {
        if watch.is_over() {
            break;
        }
        watch.tell(Progress::Found(found.len()));
        let Some(Again { others, contest: Contest { winner, alternatives, .. }, .. }) =
            Again::new(session, found, index, &round.all, multiplicity)?
        else {
            continue;
        };
        let known = &mut found[index];
        let (old, new) = (known.member.candidate.family(), winner.candidate.family());
        tracing::debug!(?old, ?new, ?alternatives, "other names over all logs");
        let stay = known.alternatives.iter().filter(|other| mimicked(other.family));
        let stay = stay.filter(|other| alternatives.iter().all(|own| own.family != other.family));
        let alternatives: Vec<Alternative> = alternatives.iter().chain(stay).cloned().collect();
        if old == new {
            known.set_alternatives(beside_play(session, &others, &known.member, alternatives));
            continue;
        }
        // One that all logs let stand beside the best of them has the names that they leave.
        if alternatives.iter().any(|other| other.family == old) {
            let left = alternatives.into_iter().filter(|other| other.family != old).collect();
            known.set_alternatives(beside_play(session, &others, &known.member, left));
        }
        known.may_also_be(new);
    }
    Ok(())
}
