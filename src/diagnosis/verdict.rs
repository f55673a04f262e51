//! The answer: named, one of a few, unexplained, or none; with the evidence.

use super::Options;
use super::arm::Arm;
use super::candidates::{Family, is_candidate, places};
use super::column::{Column, combined};
use super::contest::Alternative;
use super::evidence::Evidence;
use super::selection::{Found, Selection, rms, select};
use super::session::{Member, Session, Side};
use super::unexplained::{Unexplained, unexplained};
use crate::effects::LIBRARY;
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::identification::model::Model;
use crate::recording::Recording;
use crate::robot::Robot;
use statrs::distribution::{ContinuousCDF, Normal};

/// Probability with which an effect of the minimum detectable size is found.
const POWER: f64 = 0.8;

/// Share of a log that is held out where there is no other to judge by.
const HELD_OUT: f64 = 0.3;

/// What the diagnosis says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Effects are named.
    Named,
    /// For at least one effect a few names fit alike.
    OneOf,
    /// There is structure that no effect of the library carries.
    Unexplained,
    /// Nothing beyond the noise.
    None,
}

/// An effect that was looked for and not found.
#[derive(Debug, Clone)]
pub struct NotFound {
    /// What and where.
    pub family: Family,
    /// The smallest value of its first parameter that would have been found with a probability of 80 %; None where the
    /// logs cannot tell it from the baseline.
    pub minimum_detectable: Option<f64>,
    /// Unit of that.
    pub unit: &'static str,
}

/// The whole answer. Root mean squares are of means over 20 ms, per joint, N m.
#[derive(Debug)]
pub struct Diagnosis {
    /// The answer in a word.
    pub verdict: Verdict,
    /// Level of false alarms.
    pub alpha: f64,
    /// Cut-off of the positions' low-pass, Hz.
    pub cutoff_hz: f64,
    /// Whether the last part of the training logs was held out for want of test logs.
    pub held_out_from_training: bool,
    /// Number of independent tests that the scan is worth.
    pub effective_tests: f64,
    /// Noise of the torque.
    pub noise_floor: Vec<f64>,
    /// What the arm as described leaves of the held-out logs.
    pub simulation_test_rms: Vec<f64>,
    /// What the fitted baseline leaves of the training logs and of the held-out logs.
    pub baseline_rms: [Vec<f64>; 2],
    /// What the model with all effects found leaves of the held-out logs.
    pub extended_test_rms: Vec<f64>,
    /// Share of the gap between baseline and noise floor that the effects found close on the held-out logs.
    pub gap_closed: f64,
    /// Effects found.
    pub found: Vec<Found>,
    /// Structure without a name.
    pub unexplained: Vec<Unexplained>,
    /// Effects not found.
    pub not_found: Vec<NotFound>,
    /// What to do next.
    pub next_experiment: String,
    /// What the answer rests on, row by row.
    pub evidence: Evidence,
}

/// Diagnoses `robot` from logs. Without `test` logs the last part of every training log is held out. `progress` is told
/// the number of effects found so far.
///
/// # Errors
/// If there is no log, a log is too short or does not fit the arm, or a joint hardly moves.
pub fn diagnose(
    robot: &Robot,
    train: &[&Recording],
    test: &[&Recording],
    options: &Options,
    progress: &mut dyn FnMut(usize),
) -> Result<Diagnosis> {
    if let Some(log) = train.iter().chain(test).find(|log| log.joints() != robot.dof()) {
        let problem = format!("has {} joints, the arm {}; give logs of this arm", log.joints(), robot.dof());
        return Err(Error::request("log", problem));
    }
    let model = Model::new(robot);
    let split: Vec<(Recording, Recording)> = match test {
        [] => train.iter().map(|log| split(log)).collect(),
        _ => Vec::new(),
    };
    let (early, late): (Vec<&Recording>, Vec<&Recording>) = split.iter().map(|(early, late)| (early, late)).unzip();
    let (train, test) = if test.is_empty() { (&early[..], &late[..]) } else { (train, test) };
    let mut session = Session::new(&model, options.trust, train, test)?;
    let described = as_described(&session, robot);
    let selection = select(&mut session, options, progress)?;
    answer(&session, selection, described, options, !split.is_empty())
}

fn split(log: &Recording) -> (Recording, Recording) {
    let end = ((1.0 - HELD_OUT) * log.samples() as f64) as usize;
    (log.slice(0..end), log.slice(end..log.samples()))
}

/// The logs that a diagnosis judges by: the `test` logs, or else the last part of every training log.
pub fn held_out(train: &[&Recording], test: &[&Recording]) -> Vec<Recording> {
    match test {
        [] => train.iter().map(|log| split(log).1).collect(),
        _ => test.iter().map(|&log| log.clone()).collect(),
    }
}

/// What the arm as its URDF describes it leaves of the held-out logs.
fn as_described(session: &Session, robot: &Robot) -> Column {
    let rows = &session.test.rows;
    let mut residual = Column::new(rows.torque.iter().cloned());
    let described = Arm::new(robot, Trust::Nominal);
    residual.add(-1.0, &described.believed(rows));
    let baseline = described.baseline(session.model, rows);
    residual.add(-1.0, &combined(&baseline, &drives(session.model, robot)));
    residual
}

/// Friction and rotors of the URDF in the order of a trusted arm's baseline.
fn drives(model: &Model, robot: &Robot) -> Vec<f64> {
    let standard = Model::standard_values(robot);
    let friction = (0..model.base().len()).filter(|&b| model.is_friction(b)).map(|b| standard[model.base().kept()[b]]);
    friction.chain(robot.joints.iter().map(|joint| joint.drive.armature)).collect()
}

fn answer(
    session: &Session,
    selection: Selection,
    described: Column,
    options: &Options,
    held_out_from_training: bool,
) -> Result<Diagnosis> {
    let Selection { found, whitener, first_whitener, tests, ranking, sensitivity } = selection;
    let members: Vec<Member> = found.iter().map(|found| found.member.clone()).collect();
    let unexplained = unexplained(session, &members, &whitener, options.alpha)?;
    let baseline = |side: &Side| session.residual_on(side, &[], &first_whitener);
    let unseen = baseline(&session.test)?;
    let baseline_rms =
        [rms(&session.train.rows.valid, &baseline(&session.train)?), rms(&session.test.rows.valid, &unseen)];
    let extended = session.held_out_residual(&members, &whitener)?;
    let extended_test_rms = rms(&session.test.rows.valid, &extended);
    let simulation_test_rms = rms(&session.test.rows.valid, &described);
    let evidence = Evidence::new(session, &members, ranking, [&described, &unseen, &extended])?;
    let noise_floor = whitener.noise_std();
    let verdict = match (found.is_empty(), unexplained.is_empty()) {
        (false, _) if found.iter().any(|found| !found.alternatives.is_empty()) => Verdict::OneOf,
        (false, _) => Verdict::Named,
        (true, false) => Verdict::Unexplained,
        (true, true) => Verdict::None,
    };
    let normal = Normal::standard();
    let factor = normal.inverse_cdf(1.0 - options.alpha / (2.0 * tests)) + normal.inverse_cdf(POWER);
    let taken: Vec<Family> = found
        .iter()
        .flat_map(|found| {
            let others = found.alternatives.iter().map(|Alternative { family, .. }| *family);
            [found.member.candidate.family()].into_iter().chain(others)
        })
        .collect();
    let not_found = LIBRARY
        .iter()
        .filter(|effect| is_candidate(**effect, options.trust, &options.candidates))
        .flat_map(|effect| {
            places(*effect, session.model.dof())
                .map(move |joint| (effect, Family { effect: effect.about().name, joint }))
        })
        .filter(|(_, family)| !taken.contains(family))
        .map(|(effect, family)| {
            let seen = sensitivity.get(&family);
            let index = seen.map_or(0, |(index, _)| *index);
            let minimum_detectable = seen.map(|(_, std)| factor * std).filter(|size| size.is_finite() && *size > 0.0);
            NotFound { family, minimum_detectable, unit: effect.parameters()[index].unit }
        })
        .collect();
    Ok(Diagnosis {
        verdict,
        alpha: options.alpha,
        cutoff_hz: session.cutoff_hz,
        held_out_from_training,
        effective_tests: tests,
        gap_closed: gap_closed(&baseline_rms[1], &extended_test_rms, &noise_floor),
        next_experiment: next_experiment(&found, &unexplained, session.model.robot()),
        noise_floor,
        simulation_test_rms,
        baseline_rms,
        extended_test_rms,
        found,
        unexplained,
        not_found,
        evidence,
    })
}

/// Share of the gap to the noise floor that is closed, the joints weighted by their noise.
fn gap_closed(baseline: &[f64], extended: &[f64], floor: &[f64]) -> f64 {
    let excess = |rms: &[f64]| -> f64 { rms.iter().zip(floor).map(|(rms, floor)| (rms / floor).powi(2) - 1.0).sum() };
    let gap = excess(baseline);
    if gap <= 0.0 { 0.0 } else { (1.0 - excess(extended) / gap).clamp(0.0, 1.0) }
}

fn next_experiment(found: &[Found], unexplained: &[Unexplained], robot: &Robot) -> String {
    let tied = found.iter().find_map(|found| Some((found, found.alternatives.first()?)));
    if let Some((found, other)) = tied {
        let about = found.member.placed.effect.about();
        let told = about.rivals.iter().find(|rival| rival.name == other.family.effect).map(|rival| rival.how_to_tell);
        let told = told.unwrap_or("record motions of other speeds, ranges and loads");
        return format!("to tell {} from {}: {told}", about.name, other.family.effect);
    }
    if let Some(left) = unexplained.first() {
        let joint = &robot.joints[left.joint].name;
        return format!(
            "move {joint} alone over its whole range, slowly and fast, both ways: what is left {}",
            left.structure
        );
    }
    match found.is_empty() {
        true => "a longer or livelier motion lowers the minimum detectable sizes".into(),
        false => "repeat the diagnosis with the extended model on a new motion".into(),
    }
}
