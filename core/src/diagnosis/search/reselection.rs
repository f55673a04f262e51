//! Backward re-selection: the first finding was chosen without the later ones, so each model comparison is repeated with all others in
//! the model.

use super::acceptance::{Outcome, Refusal, Trial, is_confirmable};
use super::comparison::{Chosen, Comparison, InOwnNoise, compare};
use super::eligible::{Contenders, Standing};
use super::exchange::{exchanged, one_body};
use super::found::{Alternative, Found, Rejected, explained_by_play, members};
use super::parsimony::chosen;
use crate::diagnosis::Options;
use crate::diagnosis::criteria::Gate;
use crate::diagnosis::evidence::{Judged, Multiplicity, Scan};
use crate::diagnosis::model::{Candidate, Family, Fit, Member, MemberBlock, Session};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::Column;
use crate::diagnosis::watch::{Progress, Watch};
use crate::error::Result;
use rayon::prelude::*;

/// A model comparison for a finding with all others in the model.
struct Again {
    others: Vec<Found>,
    noise: Fit,
    comparison: Comparison,
}

impl Again {
    /// The model comparison for the finding at `index` among the candidates that act where it does; None where none can be tested. Those
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
        let noise = session.fit_under(&session.model.columns(&session.logs.train, &of_others)?);
        let finding = &found[index].member;
        // What acts elsewhere is no other name for what is seen here.
        let here = finding.candidate.joints();
        let mut all: Vec<Candidate> = everywhere.iter().filter(|candidate| candidate.acts_on(&here)).cloned().collect();
        let restricted = Restricted::new(session, &of_others, &noise, finding)?;
        all.retain(|candidate| restricted.comes_close(candidate, session.criteria.comparison.close));
        loop {
            let scan = Scan::new(session, &all, &noise.whitener, &noise.projection);
            let anyone = |_: &Judged, _| Standing::MayWin;
            let contenders = Contenders::new(&scan, &others, (&[], &session.criteria.levels), multiplicity, anyone);
            if contenders.best.is_empty() {
                return Ok(None);
            }
            let own_noise = &mut InOwnNoise::new();
            let comparison = compare(session, &of_others, &contenders, &scan, multiplicity, own_noise)?;
            let winner = &comparison.winner.candidate;
            if restricted.comes_close(winner, 1.0) {
                return Ok(Some(Again { others, noise, comparison }));
            }
            let family = winner.family();
            all.retain(|candidate| candidate.family() != family);
        }
    }
}

/// What a finding explains on the joints where it acts, the others in the model. A law that acts on more joints may win by what it
/// explains on those: that is another finding, and no other name for this one.
struct Restricted<'a> {
    noise: &'a Fit,
    /// The joints.
    here: Vec<usize>,
    /// Score statistic of the finding.
    statistic: f64,
}

impl<'a> Restricted<'a> {
    /// Of a `finding` with `others` in the model, in the noise under these.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    fn new(session: &Session, others: &[Member], noise: &'a Fit, finding: &Member) -> Result<Self> {
        let with: Vec<Member> = others.iter().chain([finding]).cloned().collect();
        let columns = session.model.columns(&session.logs.train, &with)?;
        let own = session.blocks(&with).members.last().map_or(0..0, MemberBlock::all);
        let mut restricted = Restricted { noise, here: finding.candidate.joints(), statistic: 0.0 };
        restricted.statistic = restricted.statistic_of(&columns[own]);
        Ok(restricted)
    }

    fn statistic_of(&self, columns: &[Column]) -> f64 {
        let Fit { whitener, projection } = self.noise;
        projection.test(&whitener.apply_all(columns)).map_or(0.0, |test| test.statistic)
    }

    /// Whether a candidate explains at least this share of it there; candidates that act nowhere else do.
    fn comes_close(&self, candidate: &Candidate, share: f64) -> bool {
        if candidate.joints().iter().all(|joint| self.here.contains(joint)) {
            return true;
        }
        let columns: Vec<Column> = candidate.columns.iter().map(|column| column.only(&self.here)).collect();
        self.statistic_of(&columns) >= share * self.statistic
    }
}

/// Repeats the model comparison for every finding with all others in the model, among the candidates `everywhere`; returns
/// whether a name has changed. What would replace a finding and fails a gate is added to `rejected`; what fails it since it makes others
/// unidentifiable may replace these too.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn reselect(
    session: &Session,
    found: &mut Vec<Found>,
    everywhere: &[Candidate],
    multiplicity: &Multiplicity,
    options: &Options,
    rejected: &mut Vec<Rejected>,
    watch: &mut Watch,
) -> Result<bool> {
    let alpha = options.alpha;
    let mut changed = false;
    if found.len() < 2 {
        return Ok(changed);
    }
    while !watch.is_over()
        && let Some(exchange) = one_body(session, found, everywhere, (multiplicity, alpha), rejected)?
    {
        let first = exchange.places[0];
        exchange.make(found, first);
        changed = true;
    }
    let mut next = 0;
    while next < found.len() && !watch.is_over() {
        let index = next;
        next += 1;
        if !found[index].can_be_asked() {
            continue;
        }
        watch.tell(Progress::Found(found.len()));
        let Some(Again { others, noise: Fit { whitener, projection: fit }, comparison }) =
            Again::new(session, found, index, everywhere, multiplicity)?
        else {
            continue;
        };
        let of_others = members(&others);
        let Chosen { winner, alternatives, whitener: under } = chosen(session, &of_others, &comparison)?;
        let (old, new) = (found[index].member.candidate.family(), winner.candidate.family());
        tracing::debug!(?old, ?new, ?alternatives, "comparison with all others in the model");
        if old == new {
            let alternatives = explained_by_play(session, &others, &found[index].member, alternatives);
            found[index].set_alternatives(alternatives);
            continue;
        }
        let (whitener, fit, members) = (&whitener, &fit, &of_others[..]);
        let trial = Trial { session, members, whitener, fit, multiplicity, alpha, tries: None };
        let level = multiplicity.level(new.effect, winner.test.log_p());
        match trial.of(&winner, level, under)? {
            Outcome::Accepted(accepted) => {
                let alternatives = explained_by_play(session, &others, &accepted.member, alternatives);
                found[index] = Found::new(*accepted, alternatives);
                changed = true;
            }
            Outcome::Refused(Refusal { may_be, failed, .. }) => {
                rejected.push(Rejected { slot: winner.candidate.slot(), failed });
                if failed.gate == Gate::EarlierParameters
                    && let Some(exchange) = exchanged(session, found, index, &winner, (multiplicity, alpha), rejected)?
                {
                    (next, changed) = (exchange.make(found, index) + 1, true);
                    continue;
                }
                // It explains the residual better than the finding does, and is not significant enough to replace it.
                if may_be {
                    found[index].may_also_be(new);
                }
            }
        }
    }
    Ok(changed)
}

/// Asks the logs that `session` is identified from what else explains each finding, among the candidates `everywhere` along these, where
/// `whitener` is the noise with all findings. What errors of the smoothing imitate is so in all logs: they add no information on gears.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn list_alternatives(
    session: &Session,
    found: &mut [Found],
    (everywhere, whitener): (&[Candidate], &Whitener),
    multiplicity: &Multiplicity,
    watch: &mut Watch,
) -> Result<()> {
    // Where the residual is well above the noise, more rows separate rivals by what is wrong with both.
    let open = |found: &Found| {
        let misfit = whitener.is_misfit(&found.member.candidate.joints(), session.criteria.levels.misfit);
        let is_reported = !session.sampling_makes(&found.member.placed);
        found.can_be_asked() && is_confirmable(&found.member.candidate) && !misfit && is_reported
    };
    let imitated =
        |family: Family| everywhere.iter().any(|candidate| candidate.family() == family && !is_confirmable(candidate));
    // Alternatives of one play no part in those of another.
    let indices: Vec<usize> = (0..found.len()).filter(|&index| open(&found[index])).collect();
    let mut compared = Vec::new();
    for together in indices.chunks(rayon::current_num_threads()) {
        if watch.is_over() {
            break;
        }
        watch.tell(Progress::Found(found.len()));
        let known = &*found;
        let again =
            together.par_iter().map(|&index| Ok((index, Again::new(session, known, index, everywhere, multiplicity)?)));
        compared.extend(again.collect::<Result<Vec<_>>>()?);
    }
    for (index, again) in compared {
        let Some(Again { others, comparison: Comparison { winner, alternatives, .. }, .. }) = again else { continue };
        let known = &mut found[index];
        let (old, new) = (known.member.candidate.family(), winner.candidate.family());
        tracing::debug!(?old, ?new, ?alternatives, "other names over all logs");
        let stay = known.alternatives.iter().filter(|other| imitated(other.family));
        let stay = stay.filter(|other| alternatives.iter().all(|own| own.family != other.family));
        let alternatives: Vec<Alternative> = alternatives.iter().chain(stay).cloned().collect();
        if old == new {
            known.set_alternatives(explained_by_play(session, &others, &known.member, alternatives));
            continue;
        }
        // One that all logs do not separate from the best of them keeps the alternatives that remain.
        if alternatives.iter().any(|other| other.family == old) {
            let left = alternatives.into_iter().filter(|other| other.family != old).collect();
            known.set_alternatives(explained_by_play(session, &others, &known.member, left));
        }
        known.may_also_be(new);
    }
    Ok(())
}
