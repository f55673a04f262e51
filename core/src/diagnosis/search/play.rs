//! Gears with play, named by their impacts.

use super::found::{Alternative, Found, Rejected};
use super::verdict::Verdict;
use crate::diagnosis::Options;
use crate::diagnosis::criteria::{Criteria, Gate, Judgement, Levels};
use crate::diagnosis::evidence::{Play, Traces, family_wise};
use crate::diagnosis::model::{Candidate, DataSet, Family, Member, PreparedLogs, Session, columns, is_candidate};
use crate::diagnosis::regression::fisher;
use crate::effects::{self, Effect, Nature, Placed};
use crate::error::Result;

/// What impacts in the logs show.
#[derive(Default)]
pub(super) struct Impacts {
    /// Gears with play, the most significant first.
    pub found: Vec<Found>,
    /// The gear whose impacts failed a gate after them.
    pub rejected: Option<Rejected>,
    /// Joints whose gears may have play, though impacts do not show it significantly.
    pub open_play: Vec<usize>,
    /// The logs with the steady torque of these gears in their baselines and without the rows that impacts disturb; none without such
    /// gears.
    pub logs: Option<PreparedLogs>,
}

/// Gears with play by their impacts.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn rattling_gears(session: &Session, options: &Options) -> Result<Impacts> {
    let effect = effects::play();
    if !is_candidate(effect, options.trust, &options.candidates) {
        return Ok(Impacts::default());
    }
    let Criteria { search: criteria, levels, .. } = session.criteria;
    let dof = session.model.base.dof();
    let has_play = |placed: &&Placed| placed.effect.about().nature == Nature::Play;
    let known: Vec<usize> = session.model.known.effects.iter().filter(has_play).map(|placed| placed.joint).collect();
    let train = Traces::new(&session.model.arm, &session.logs.train.rows);
    let test = Traces::new(&session.model.arm, &session.logs.test.rows);
    let mut rattling: Vec<usize> = Vec::new();
    let (mut found, mut rejected) = (Vec::new(), None);
    while found.len() < options.max_findings {
        let open = (0..dof).filter(|joint| !known.contains(joint) && !rattling.contains(joint));
        // Nothing was fitted to the moments, so that those of all logs count.
        let log_p = |joint: usize, without: &[usize]| -> f64 {
            fisher([&train, &test].map(|traces| traces.log_p(joint, without)))
        };
        let mut all: Vec<(usize, f64)> = open.map(|joint| (joint, log_p(joint, &rattling))).collect();
        all.sort_by(|a, b| a.1.total_cmp(&b.1));
        let Some(&(joint, best)) = all.first() else { break };
        let level = family_wise(best, dof as f64);
        let each = [&train, &test].map(|traces| traces.log_p(joint, &rattling));
        tracing::debug!(joint, level, train = each[0].exp(), test = each[1].exp(), "impacts");
        let both = each.iter().all(|log_p| *log_p < levels.usual_p.ln());
        let limit = options.alpha * if both { criteria.impacts } else { criteria.unconfirmable };
        let alike = fisher([&train, &test].map(|traces| traces.log_p_among_alike(joint)));
        tracing::debug!(alike, "impacts among moments alike");
        let gates = [
            Judgement::at_most(Gate::Impacts, level, limit),
            impacts_again(each[1], test.changes(joint), &levels),
            Judgement::at_most(Gate::ImpactsAlike, alike.exp(), levels.strict_p),
        ];
        let timed = || {
            let play = train.play(joint, &session.model.arm, &session.logs.train.rows, levels.stands_out);
            let play = play.ok_or(Judgement::at_least(Gate::ImpactsTimed, 0.0, 1.0))?;
            let over = effect.over_limit(&[play.half_gap], joint, session.model.base.robot());
            let believable = Judgement::at_most(Gate::Believable, over, 1.0);
            Judgement::first_failed([believable]).map_or(Ok(play), Err)
        };
        let play = match Judgement::first_failed(gates).map_or_else(timed, Err) {
            Ok(play) => play,
            Err(failed) => {
                rejected = Some(Rejected { slot: (Family { effect: effect.about().name, joint }, None), failed });
                break;
            }
        };
        let rivals: Vec<usize> = all[1..]
            .iter()
            .filter(|(_, log_p)| family_wise(*log_p, dof as f64) < limit)
            .map(|(other, _)| *other)
            .filter(|other| log_p(joint, &[rattling.as_slice(), &[*other]].concat()) > levels.strict_p.ln())
            .collect();
        rattling.push(joint);
        rattling.extend(&rivals);
        found.push(named(effect, (joint, &rivals), &play, (level, test.share(joint))));
    }
    let named = |joint: &usize| found.iter().any(|one| one.member.placed.joint == *joint);
    let chance = |joint: usize| fisher([&train, &test].map(|traces| traces.log_p(joint, &rattling)));
    let open = (0..dof).filter(|joint| !known.contains(joint) && !named(joint) && chance(*joint) < levels.open_p.ln());
    let open_play = open.collect();
    let placed: Vec<Placed> = found.iter().map(|one| one.member.placed.clone()).collect();
    let joints: Vec<usize> = placed.iter().map(|placed| placed.joint).chain(known).collect();
    if joints.is_empty() {
        return Ok(Impacts { found, rejected, open_play, logs: None });
    }
    // Between the impacts the link lies on one side or the other, which looks like an encoder that is not true.
    let known_from = session.blocks(&[]).known.start;
    let steady = |data: &DataSet| -> Result<_> { Ok(columns(&session.model.arm, &data.rows, &placed)?.concat()) };
    let steady = [steady(&session.logs.train)?, steady(&session.logs.test)?];
    let mut logs = session.logs.clone().with(known_from, &steady);
    for (data, traces) in [(&mut logs.train, &train), (&mut logs.test, &test)] {
        joints.iter().for_each(|&joint| traces.leave_out(joint, &mut data.rows));
    }
    Ok(Impacts { found, rejected, open_play, logs: Some(logs) })
}

/// Whether the held-out logs show impacts too, by the logarithm of their p-value; with no change of sign of the load they cannot.
fn impacts_again(log_p: f64, changes: usize, levels: &Levels) -> Judgement {
    Judgement::at_most(Gate::ImpactsAgain, log_p.exp(), levels.usual_p).or(changes == 0)
}

fn named(
    effect: &'static dyn Effect,
    (joint, rivals): (usize, &[usize]),
    play: &Play,
    (level, share): (f64, f64),
) -> Found {
    let placed = Placed { parameters: vec![play.half_gap], ..Placed::typical(effect, joint) };
    let candidate = Candidate { placed: placed.clone(), log: None, columns: Default::default() };
    let member = Member {
        placed,
        std: vec![play.std],
        candidate,
        factors: Vec::new(),
        shifts: Vec::new(),
        held: true,
        fixed: Vec::new(),
    };
    let alternatives: Vec<Alternative> = rivals
        .iter()
        .map(|&joint| Alternative { family: Family { effect: effect.about().name, joint }, relative_likelihood: 1.0 })
        .collect();
    Found {
        verdict: if alternatives.is_empty() { Verdict::Named } else { Verdict::OneOf },
        member,
        alternatives,
        family_wise_p: level,
        gain_lower_bound: share,
        rms: Default::default(),
        withdrawn: None,
        impacts: Some(play.clone()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_side_of_impacts_again() {
        let levels = Levels::default();
        let passes = |p: f64, changes: usize| impacts_again(p.ln(), changes, &levels).passed;
        assert!(passes(levels.usual_p - 1e-9, 3) && !passes(levels.usual_p + 1e-9, 3));
        assert!(passes(1.0, 0));
    }
}
