//! The whole way from logs to the answer, and from the answer back to the simulator.

use super::accounted::share_accounted_for;
use super::described::as_described;
use super::diagnosis::{self, Diagnosis, Errors, LogSummary, OfSampling, Scope, withdraw};
use super::extended::ExtendedModel;
use super::inertias::{self, Free, Gain, all_inertias};
use super::outcome::{Conclusion, Measured};
use super::quantities::{Evidence, Residuals, derived, not_found, refused, residual_structure};
use super::resimulation::{Replay, joints_of};
use super::searched::{Searched, found_that_matter, map_on};
use super::words::{Sizes, next_experiment};
use crate::channels::Channels;
use crate::diagnosis::Options;
use crate::diagnosis::criteria::Judgement;
use crate::diagnosis::lack_of_fit::{Structure, above_noise, disagreement, not_separated};
use crate::diagnosis::logs::{Input, split};
use crate::diagnosis::model::{DataSet, Known, Member, Session};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::preparation::prepare;
use crate::diagnosis::regression::{Column, rms};
use crate::diagnosis::search::{Found, Rejected, Selection};
use crate::diagnosis::variance::ResidualMap;
use crate::diagnosis::watch::{Progress, Watch};
use crate::effects::Placed;
use crate::error::{Error, Result};
use crate::identification::effect_model::{Arm, Trust};
use crate::identification::model::Model;
use crate::payload::Payload;
use crate::recording::Recording;
use crate::robot::Robot;
use crate::signal::white_noise;

/// Slowest rate of a log: its rows are means over a fiftieth of a second, Hz; and by how much of itself a clock may go slow.
const SLOWEST_RATE_HZ: f64 = 50.0;
const SLOW_CLOCK: f64 = 0.01;

/// Rates closer than this factor are one.
const SAME_RATE: f64 = 1.2;

/// Least acceleration that a motion is allowed, rad/s2.
const SLOWEST: f64 = 0.5;

/// The answer with the session and the fits it rests on.
#[derive(Debug)]
pub(super) struct Concluded<'a> {
    /// The answer.
    pub(super) diagnosis: Diagnosis,
    session: Session<'a>,
    present: Vec<Placed>,
    members: Vec<Member>,
    whitener: Whitener,
    first_whitener: Whitener,
    seed: u64,
}

/// Diagnoses the arm of `model`; `watch` hears how far it has come, and may end the search.
///
/// # Errors
/// If there is no log, a log is too short or does not fit the arm, or a joint hardly moves.
pub(super) fn conclude<'a>(
    model: &'a Model,
    input: &Input<'a>,
    options: &Options,
    watch: &mut Watch,
) -> Result<Concluded<'a>> {
    let (known, before) = known_before(model, input, options, watch)?;
    let cut = split(&input.train);
    let (train, test) = halves(input, &cut);
    let mut session = prepare(model, options.trust, known.clone(), &train, &test, options.criteria)?;
    let simulation = as_described(&session, &input.present)?;
    let map = residual_map(&session, options)?;
    watch.tell(Progress::Map(map.clone()));
    let mut searched = Searched::new(&mut session, options, watch)?;
    let (mut inertias, mut rejected_inertias) = (None, None);
    if options.trust == Trust::Nominal && input.reference.is_empty() {
        let free = Known { arm: Arm::new(model.robot(), Trust::Structure), ..known };
        match all_inertias(&session, &searched, free, &train, &test, options, watch)? {
            inertias::Outcome::Accepted(free) => {
                let gain;
                Free { session, searched, gain } = *free;
                inertias = Some(gain);
            }
            inertias::Outcome::Refused(failed) => rejected_inertias = Some(failed),
            inertias::Outcome::NotAsked => {}
        }
    }
    let present = input.present.clone();
    let circumstances = Circumstances {
        simulation,
        before,
        inertias,
        rejected_inertias,
        held_out_from_training: input.test.is_empty(),
        present,
        map,
        unfinished: watch.has_ended(),
    };
    let mut concluded = answer(session, searched, circumstances, options)?;
    concluded.diagnosis.load = weighed(model.robot(), input, &concluded.diagnosis.found);
    Ok(concluded)
}

/// What is known of the arm of `model` before its training logs, and the effects that reference logs show.
///
/// # Errors
/// If a log is too short, too slow or does not fit the arm.
pub(super) fn known_before<'a>(
    model: &'a Model,
    input: &Input<'a>,
    options: &Options,
    watch: &mut Watch,
) -> Result<(Known<'a>, Vec<Found>)> {
    let robot = model.robot();
    let mut logs = input.train.iter().chain(&input.test).chain(&input.reference);
    if let Some(log) = logs.find(|log| log.joints() != robot.dof()) {
        let problem = format!("has {} joints, the arm {}; give logs of this arm", log.joints(), robot.dof());
        return Err(Error::request("log", problem));
    }
    let mut logs = input.train.iter().chain(&input.test).chain(&input.reference);
    if let Some(log) = logs.find(|log| log.rate_hz() < (1.0 - SLOW_CLOCK) * SLOWEST_RATE_HZ) {
        let problem = format!(
            "is sampled at {:.3} Hz, and a diagnosis needs {SLOWEST_RATE_HZ} Hz or more: it follows torque in steps of a \
             fiftieth of a second, and could not separate starts, stops and reversals, impacts, ripple or delays from \
             each other; log faster, or use `tauscope identify`, which takes any rate",
            log.rate_hz()
        );
        return Err(Error::request("log", problem));
    }
    let described = Known { effects: input.present.clone(), ..Known::nothing(robot, options.trust) };
    match input.reference.is_empty() {
        true => Ok((described, Vec::new())),
        false => identified(model, described, &input.reference, options, watch),
    }
}

/// Logs to identify from and held-out logs: those that are given, else the parts into which the training logs are `cut`.
pub(super) fn halves<'b>(
    input: &'b Input,
    (early, late): &'b (Vec<Recording>, Vec<Recording>),
) -> (Vec<&'b Recording>, Vec<&'b Recording>) {
    match input.test.is_empty() {
        true => (early.iter().collect(), late.iter().collect()),
        false => (input.train.clone(), input.test.clone()),
    }
}

/// The load since the reference logs where one was `found`: with no other effect to share it with, and as a body that can exist.
fn weighed(robot: &Robot, input: &Input, found: &[Found]) -> Option<Payload> {
    let has_load = found.iter().any(|found| found.member.placed.effect.is_load());
    if input.reference.is_empty() || !has_load {
        return None;
    }
    let after = input.train.iter().chain(&input.test).copied();
    let weighed = Payload::between(robot).before(input.reference.iter().copied()).after(after).run();
    // What it cannot weigh is in its own words of no use here: the finding stands.
    weighed.inspect_err(|problem| tracing::debug!(%problem, "the load is not weighed")).ok()
}

/// The arm as its reference logs show it, with the effects found there: they were there before the change.
fn identified<'a>(
    model: &'a Model,
    described: Known<'a>,
    reference: &[&'a Recording],
    options: &Options,
    watch: &mut Watch,
) -> Result<(Known<'a>, Vec<Found>)> {
    let (early, late) = split(reference);
    let (early, late): (Vec<&Recording>, Vec<&Recording>) = (early.iter().collect(), late.iter().collect());
    let mut effects = described.effects.clone();
    let session = prepare(model, options.trust, described.clone(), &early, &late, options.criteria);
    // Short logs have too little in their last parts: then nothing is held out, and the level of the tests alone decides.
    let mut session = match session {
        Ok(session) => session,
        Err(_) => prepare(model, options.trust, described, reference, reference, options.criteria)?,
    };
    let found = found_that_matter(&mut session, options, watch)?.0.found;
    effects.extend(found.iter().map(|found| found.member.placed.clone()));
    Ok((Known { arm: session.into_state().model.arm, effects, reference: reference.to_vec() }, found))
}

/// What the residual of the baseline follows in all logs.
fn residual_map(session: &Session, options: &Options) -> Result<ResidualMap> {
    let mut all = session.over_all_logs();
    let noise = all.noise_under(&all.logs.train.baseline);
    all.settle(&mut [], &noise)?;
    map_on(&all, &all.logs.train, &[], options)
}

/// What is known besides the result of the search.
struct Circumstances {
    /// Residual of the arm as described on the held-out logs.
    simulation: Column,
    /// Effects that were there before a change.
    before: Vec<Found>,
    /// What re-identified inertias gain where those trusted are wrong as a whole.
    inertias: Option<Gain>,
    /// The gate at which it was refused that they are.
    rejected_inertias: Option<Judgement>,
    /// Whether parts of the training logs were held out.
    held_out_from_training: bool,
    /// Effects that the simulation has already.
    present: Vec<Placed>,
    /// What the residual of the baseline follows.
    map: ResidualMap,
    /// Whether the search was ended before it was done.
    unfinished: bool,
}

fn answer<'a>(
    session: Session<'a>,
    searched: Searched,
    circumstances: Circumstances,
    options: &Options,
) -> Result<Concluded<'a>> {
    let Circumstances {
        simulation,
        before,
        inertias,
        rejected_inertias,
        held_out_from_training,
        present,
        map,
        unfinished,
    } = circumstances;
    let Searched { selection, minor, structure, map: left } = searched;
    let Structure { mut unexplained, rejected: mut rejected_structure } = structure;
    let Selection {
        mut found,
        is_full,
        mut rejected,
        whitener,
        first_whitener,
        held_out: extended,
        multiplicity,
        ranking,
        sensitivity,
        ..
    } = selection;
    let members: Vec<Member> = found.iter().map(|found| found.member.clone()).collect();
    let valid = |data: &'_ DataSet| data.rows.valid.clone();
    let train = session.baseline_residual_on(&session.logs.train, &first_whitener)?;
    let baseline = session.baseline_residual_on(&session.logs.test, &first_whitener)?;
    let mut evidence = Evidence::new(&session, &members, ranking, [&simulation, &baseline, &extended])?;
    let noise_floor = whitener.noise_std();
    let test = &session.logs.test.rows;
    let solved = session.solved(&members, &whitener)?;
    let prediction_std = solved.prediction_std(&session.model.columns(&session.logs.test, &members)?, &test.valid);
    let trained = session.residual_on(&session.logs.train, &members, &whitener)?;
    let model = (members.as_slice(), &whitener);
    // What a search that was ended has not looked for is no disagreement.
    let disagreement = match unfinished {
        true => Structure::default(),
        false => disagreement(&session, model, [&trained, &extended], &baseline, &prediction_std)?,
    };
    rejected_structure.extend(disagreement.rejected);
    for other in disagreement.unexplained {
        unexplained.retain(|left| left.joint != other.joint || !left.instead_of.is_empty());
        unexplained.push(other);
    }
    rejected_structure.retain(|one| unexplained.iter().all(|left| left.joint != one.joint));
    let slow = not_separated(&left, &unexplained, &options.criteria);
    unexplained.extend(slow);
    let extended_test_rms = rms(&test.valid, &extended);
    if unfinished {
        let open = above_noise(&extended_test_rms, &noise_floor, &unexplained, &options.criteria.structure);
        unexplained.extend(open);
    }
    let mut structure = Structure { unexplained, rejected: rejected_structure };
    structure.leave_out_small(&left, &options.criteria);
    let Structure { unexplained, rejected: rejected_structure } = structure;
    let residuals = Residuals { before: &baseline, after: &extended, valid: &test.valid, noise: &noise_floor };
    let gap_closed = residuals.gap_closed(&joints_of(&unexplained), options.seed);
    let baseline_test_rms = rms(&test.valid, &baseline);
    let simulation_test_rms = rms(&test.valid, &simulation);
    withdraw(&mut found, &unexplained, [&baseline_test_rms, &extended_test_rms], &noise_floor, &options.criteria);
    let derived = derived(
        &members,
        &solved,
        &session.blocks(&members).members,
        session.model.base.robot(),
        &options.criteria.levels,
    );
    let (mut named, mut of_sampling) = (Vec::new(), Vec::new());
    for ((found, derived), effect) in found.into_iter().zip(derived).zip(std::mem::take(&mut evidence.effects)) {
        match diagnosis::beyond_sampling(&session, &found, &noise_floor)?.filter(|judgement| !judgement.passed) {
            Some(failed) => {
                of_sampling.push(OfSampling::new(&found.member));
                rejected.push(Rejected { slot: found.member.candidate.slot(), failed });
            }
            None => named.push(((found, derived), effect)),
        }
    }
    let ((found, derived), effects): ((Vec<Found>, Vec<_>), Vec<_>) = named.into_iter().unzip();
    evidence.effects = effects;
    let next_experiment = next_experiment(
        &found,
        &unexplained,
        (session.model.base.robot(), session.model.trust, session.logs.train.rows.of_change()),
        Sizes { described: &simulation_test_rms, left: &extended_test_rms, noise: &noise_floor },
        &options.criteria.levels,
    );
    let errors = Errors {
        test_torque_rms: rms(&test.valid, &Column::new(test.torque.iter().cloned())),
        simulation_test_rms,
        baseline_rms: [rms(&valid(&session.logs.train), &train), baseline_test_rms],
        extended_test_rms,
        prediction_std,
        gap_closed,
        structure: [residual_structure(test, &simulation), residual_structure(test, &extended)],
        sensor_noise: (0..session.model.base.dof()).map(|joint| session.logs.sensor_noise(joint)).collect(),
        noise_floor,
    };
    let scope = Scope {
        alpha: options.alpha,
        candidates: options.candidates.clone(),
        against_reference: session.logs.train.rows.of_change(),
        equal_states: session.logs.train.rows.equal_states,
        effective_tests: multiplicity.all(),
        criteria: options.criteria,
    };
    let logs = LogSummary {
        rates_hz: rates_hz(&session),
        cutoffs_hz: session.logs.cutoffs_hz.clone(),
        passband: session.logs.passband,
        coulomb_rounding: session.model.arm.coulomb_rounding.clone(),
        equations: (0..session.model.base.dof()).map(|joint| session.model.base.has_equation(joint)).collect(),
        held_out_from_training,
    };
    let refused = refused(&minor, &rejected);
    let diagnosis = Diagnosis {
        verdict: diagnosis::verdict(&found, inertias.is_some(), &unexplained),
        scope,
        logs,
        errors,
        not_found: not_found(&session, (&found, &refused), &multiplicity, &sensitivity, options),
        before,
        found,
        derived,
        of_sampling,
        inertias,
        rejected_inertias,
        minor,
        rejected,
        unexplained,
        rejected_structure,
        map,
        load: None,
        unfinished,
        is_full,
        next_experiment,
        evidence,
    };
    Ok(Concluded { diagnosis, session, present, members, whitener, first_whitener, seed: options.seed })
}

/// Rates of all logs, each once, the lowest first; clocks are never alike to the last digit.
fn rates_hz(session: &Session) -> Vec<f64> {
    let logs = session.logs.train.rows.logs.iter().chain(&session.logs.test.rows.logs);
    let mut rates_hz: Vec<f64> = logs.map(|log| 1.0 / log.period).collect();
    rates_hz.sort_by(f64::total_cmp);
    rates_hz.dedup_by(|high, low| *high < SAME_RATE * *low);
    rates_hz
}

impl Concluded<'_> {
    /// The same without the session: with the extended model, what the training logs `train` measure, and the share of the
    /// effects `truth` that it accounts for, where there are any.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn into_conclusion(self, train: &[&Recording], truth: &[Placed]) -> Result<Conclusion> {
        let extended = (self.members.as_slice(), &self.whitener);
        let noise = &self.diagnosis.errors.noise_floor;
        let share = || share_accounted_for(&self.session, truth, &self.first_whitener, extended, noise);
        let accounted_for = if truth.is_empty() { None } else { Some(share()?) };
        let measured = self.measured(train);
        let extended = ExtendedModel::new(&self.session, &self.members, &self.whitener);
        let baseline = ExtendedModel::new(&self.session, &[], &self.first_whitener);
        let described = ExtendedModel::described(self.session.model.base.robot(), &self.present);
        let of_bands = |members: &[Member], whitener: &Whitener| -> Result<Column> {
            Ok(self.session.of_bands(&self.session.logs.test, &self.session.solved(members, whitener)?))
        };
        let of_encoders = [of_bands(&[], &self.first_whitener)?, of_bands(&self.members, &self.whitener)?];
        let Concluded { diagnosis, session, seed, .. } = self;
        let replay =
            Replay { described, baseline, extended, rows: session.into_state().logs.test.rows, of_encoders, seed };
        Ok(Conclusion { diagnosis, measured, accounted_for, resimulation: None, replay })
    }

    /// Rate, accelerations and noise of the training logs `train`.
    fn measured(&self, train: &[&Recording]) -> Measured {
        let rows = &self.session.logs.train.rows;
        let period = rows.logs.first().map_or(1.0, |log| log.period);
        let joints = 0..rows.dof();
        let fastest = |joint: usize| {
            let all = rows.logs.iter().flat_map(|log| log.motion.qdd.channel(joint));
            all.fold(0.0f64, |most, a| most.max(a.abs())).max(SLOWEST)
        };
        let noise = |signal: fn(&Recording) -> &Channels, joint: usize| {
            let each = train.iter().map(|log| white_noise(signal(log).channel(joint)));
            each.sum::<f64>() / train.len().max(1) as f64
        };
        Measured {
            rate_hz: 1.0 / period,
            acceleration: joints.clone().map(fastest).collect(),
            position_noise: joints.clone().map(|joint| noise(|log| &log.q, joint)).collect(),
            torque_noise: joints
                .map(|joint| noise(|log| &log.tau, joint).max(self.diagnosis.errors.noise_floor[joint]))
                .collect(),
        }
    }
}
