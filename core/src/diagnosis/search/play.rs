//! Gears with play, named by their impacts.

use super::found::{Alternative, Found, Rejected};
use super::verdict::Verdict;
use crate::diagnosis::Options;
use crate::diagnosis::criteria::{Criteria, Gate, Judgement, Levels};
use crate::diagnosis::evidence::{Play, Traces, family_wise};
use crate::diagnosis::logs::{Log, Rows};
use crate::diagnosis::model::{
    ArmModel, Candidate, DataSet, Family, Member, PreparedLogs, Session, columns, extent, is_candidate,
};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Projection, fisher};
use crate::effects::{self, Effect, Nature, Placed};
use crate::error::Result;
use crate::identification::effect_model::Arm;
use rayon::prelude::*;

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

/// Shares that the rotor may have of the inertia about a joint: the torque of an impact loses half where the share is a fifth off.
const ROTORS: [f64; 7] = [0.0, 0.12, 0.24, 0.36, 0.48, 0.6, 0.72];

/// Moves inertia between link and rotor where the gears of `joints` may have play, where only the sum of both is determined and play
/// explains most of the torque with it: the load that a gear carries changes its sign earlier or later by it. Returns whether any was moved.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn rotors_behind_play(
    session: &mut Session,
    joints: &[usize],
    (whitener, fit): &(Whitener, Projection),
) -> Result<bool> {
    let mut divided = false;
    for &joint in joints {
        let ArmModel { arm, base, .. } = &session.model;
        let rows = &session.logs.train.rows;
        let rotor = arm.found().joints[joint].drive.armature;
        let inertia = typical_inertia(arm, rows, joint) + rotor;
        let sizes = extent(rows, joint).grid(effects::play(), joint, 0.0);
        let explained = |share: &f64| -> Result<Option<(f64, f64)>> {
            let more = share * inertia - rotor;
            let Some(arm) = arm.with_more_in_rotor(base, joint, more) else { return Ok(None) };
            let candidates = sizes.iter().cloned().zip(columns(&arm, rows, &sizes)?);
            let candidates =
                candidates.map(|(placed, columns)| Candidate { placed, log: None, columns: columns.into() });
            let judged = candidates.filter_map(|candidate| session.judge(&candidate, whitener, fit));
            let best = judged.map(|judged| judged.test.statistic).max_by(f64::total_cmp);
            Ok(best.map(|statistic| (statistic, more)))
        };
        let each = ROTORS.par_iter().map(explained).collect::<Result<Vec<_>>>()?;
        let best = each.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0));
        tracing::debug!(joint, inertia, rotor, ?best, "inertia that the rotor has more");
        if let Some((_, more)) = best {
            session.move_inertia_to_rotor(joint, more);
            divided = true;
        }
    }
    Ok(divided)
}

/// Inertia of the arm as found about a joint in the middle of the first log, kg m2 (kg).
fn typical_inertia(arm: &Arm, rows: &Rows, joint: usize) -> f64 {
    let middle = |log: &Log| arm.inertia_along(joint, &log.motion, log.motion.samples() / 2);
    rows.logs.first().map_or(0.0, middle)
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
    use crate::diagnosis::logs::FEWEST_ROWS;
    use crate::diagnosis::model::Fit;
    use crate::diagnosis::test_logs::log;
    use crate::identification::effect_model::Trust;
    use crate::identification::model::Model;
    use crate::robot::{InertiaCheck, load};

    #[test]
    fn either_side_of_impacts_again() {
        let levels = Levels::default();
        let passes = |p: f64, changes: usize| impacts_again(p.ln(), changes, &levels).passed;
        assert!(passes(levels.usual_p - 1e-9, 3) && !passes(levels.usual_p + 1e-9, 3));
        assert!(passes(1.0, 0));
    }

    /// A description without rotors, whose bodies are a quarter too heavy: the rotor that impacts in the second gear show is the real one.
    /// Under little gravity its load changes its sign, and when depends on what the link weighs: on a vertical axis it does not.
    #[test]
    fn impacts_show_what_a_rotor_has_of_the_inertia() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let mut real = load(path, InertiaCheck::Required).unwrap();
        let of_links = Arm::new(&real, Trust::Nominal).inertia_about(1, &[0.0; 6]);
        real.gravity *= 0.1;
        real.joints[1].drive.armature = 0.5 * of_links;
        let mut described = real.clone();
        for joint in &mut described.joints {
            joint.drive.armature = 0.0;
            joint.inertia.0.iter_mut().for_each(|parameter| *parameter *= 1.25);
        }
        let arm = Arm::new(&real, Trust::Nominal);
        let gear = effects::play().gear(&[1e-3]).unwrap();
        let logs = [1, 2, 3].map(|seed| {
            let mut log = log(&arm, seed);
            let rows = Rows::new(&[&log], 20.0, FEWEST_ROWS).unwrap();
            let carried = arm.load(&rows.logs[0].motion);
            let change = arm.behind_gear(1, gear, &rows.logs[0], &carried).unwrap();
            log.tau.as_mut_slice().iter_mut().zip(change.as_slice()).for_each(|(tau, change)| *tau += change);
            log
        });
        let model = Model::new(&described);
        let mut session = Session::new(&model, Trust::Structure, &[&logs[0], &logs[1]], &[&logs[2]]).unwrap();
        let Fit { whitener, projection } = session.fit_under(&session.logs.train.baseline);
        session.settle(&mut [], &whitener).unwrap();
        let (rotor, all) = (0.5 * of_links, 1.5 * of_links);
        assert!(rotors_behind_play(&mut session, &[1], &(whitener, projection)).unwrap());
        let found = session.model.arm.rotor(1).unwrap();
        assert!((found - rotor).abs() < 0.12 * all, "{found} of {rotor}, of {all} in all");
    }
}
