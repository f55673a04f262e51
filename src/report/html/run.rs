//! The report of a scenario run.

use super::evidence::{self, Contender, Joint, rms};
use super::{Block, Page, Provenance, Section, Tone};
use crate::error::Result;
use crate::identification::model::Model;
use crate::identification::smoothing_choice::Described;
use crate::report::console::{self, significant};
use crate::report::results::{AtEffortLimit, SmoothingGain};
use crate::report::svg::Color;
use crate::scenario::Setup;
use crate::signal::block_means;
use crate::study::testbed::{Runs, Scored, Variant};

/// Time over which rows are means, s.
const ROW_S: f64 = 0.02;

/// What was found in a run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found<'a> {
    /// The model that was identified.
    pub model: &'a Model,
    /// All variants.
    pub scored: &'a [Scored],
    /// What smoothing brings.
    pub gain: &'a SmoothingGain,
    /// How often drives were at their limits.
    pub limited: &'a AtEffortLimit,
    /// Why nothing was identified with the usual low-pass, if so.
    pub missing: Option<&'a str>,
}

/// The report of a run.
///
/// # Errors
/// If the signals cannot be prepared.
pub(crate) fn page(setup: &Setup, runs: &Runs, found: Found, provenance: Provenance) -> Result<Page> {
    let best = found.scored.iter().find(|one| one.variant == Variant::SavitzkyGolay).unwrap_or(&found.scored[0]);
    let (good, verdict) = console::verdict(setup, best);
    let (joints, contenders) = rows(setup, runs, found.model, best)?;
    let nominal = joints.iter().map(|joint| rms(&valid(joint, 0))).zip(&joints).map(|(rms, joint)| rms / joint.noise);
    let worst = nominal.fold(0.0, f64::max);
    let limits = console::at_effort_limit(setup, found.limited);
    let mut sections = vec![scores(setup, found, best, &joints)];
    sections.extend(evidence::sections(&joints, &contenders, ROW_S));
    sections.push(parameters(setup, found.model, best));
    sections.push(quality(setup, runs, &limits));
    Ok(Page {
        kind: format!("Identification of {} in simulation: {}", setup.plant.name, setup.scenario.name),
        verdict,
        tone: if good { Tone::Good } else { Tone::Warn },
        lead: vec![
            format!(
                "{} base parameters of {} joints were identified from {:.1} s of motion with Savitzky-Golay smoothing and \
                 judged on another {:.1} s. The distance from the true parameters, d_beta, is {} (0 at best, 2 at worst).",
                best.estimate.beta.len(),
                setup.plant.dof(),
                duration(&runs.training.truth.time),
                duration(&runs.held_out.truth.time),
                significant(best.score.d_beta)
            ),
            format!(
                "The model the controller used leaves residuals of up to {} times the noise floor on that motion.",
                significant(worst)
            ),
        ],
        next: None,
        sections,
        provenance,
    })
}

fn duration(time: &[f64]) -> f64 {
    time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first)
}

fn valid(joint: &Joint, contender: usize) -> Vec<f64> {
    let rows = joint.residuals[contender].iter().zip(&joint.valid);
    rows.filter(|(_, ok)| **ok).map(|(&residual, _)| residual).collect()
}

/// Rows of the held-out motion, means over 20 ms: what the controller's model and the identified model leave.
fn rows(setup: &Setup, runs: &Runs, model: &Model, best: &Scored) -> Result<(Vec<Joint>, Vec<Contender>)> {
    let run = &runs.held_out;
    let seen = best.seen(setup, run)?;
    let nominal = model.base().values(&Model::standard_values(&setup.nominal));
    let models = [seen.predict(model, &nominal), seen.predict(model, &best.estimate.beta)];
    let block = ((ROW_S * setup.scenario.sensors.rate_hz).round() as usize).max(1);
    let means = |signal: &[f64]| block_means(signal, block);
    let mut joints = Vec::new();
    for (index, about) in setup.plant.joints.iter().enumerate() {
        let torque = means(run.recording.tau.channel(index))?;
        let truth = means(run.truth.signals.tau.channel(index))?;
        let moving: Vec<f64> = seen.moving(index).into_iter().map(|ok| if ok { 1.0 } else { 0.0 }).collect();
        let less = |model: &[f64]| -> Vec<f64> { torque.iter().zip(model).map(|(a, b)| a - b).collect() };
        joints.push(Joint {
            name: about.name.clone(),
            effort_unit: about.effort_unit(),
            position_unit: about.position_unit(),
            time: means(&run.truth.time)?,
            q: means(seen.motion.q.channel(index))?,
            qd: means(seen.motion.qd.channel(index))?,
            residuals: models
                .iter()
                .map(|table| Ok(less(&means(table.channel(index))?)))
                .collect::<Result<Vec<Vec<f64>>>>()?,
            valid: means(&moving)?.into_iter().map(|share| share > 0.999).collect(),
            noise: rms(&less(&truth)),
            torque,
        });
    }
    let contenders = [("controller's model", Color::Blue), ("identified", Color::Orange)];
    Ok((joints, contenders.map(|(name, color)| Contender { name: name.into(), color }).to_vec()))
}

fn scores(setup: &Setup, found: Found, best: &Scored, joints: &[Joint]) -> Section {
    let find = |variant| found.scored.iter().find(|one| one.variant == variant);
    let (raw, usual) = (find(Variant::Raw).unwrap_or(best), find(Variant::Butterworth));
    let rows = setup.plant.joints.iter().enumerate().map(|(j, about)| {
        vec![
            format!("{}, {}", about.name, about.effort_unit()),
            significant(rms(&joints[j].torque)),
            significant(raw.score.torque_std_held_out_nm[j]),
            significant(usual.map_or(f64::NAN, |usual| usual.score.torque_std_held_out_nm[j])),
            significant(best.score.torque_std_held_out_nm[j]),
            significant(setup.sensors[j].torque_noise),
            format!("{:.3}", found.gain.held_out[j]),
            found.gain.over_butterworth_held_out.get(j).map_or("-".to_owned(), |ratio| format!("{ratio:.3}")),
        ]
    });
    let header = [
        "joint",
        "torque, rms",
        "error, raw signals",
        "error, Butterworth",
        "error, Savitzky-Golay",
        "sensor noise",
        "S-G / raw",
        "S-G / Butterworth",
    ];
    let per_variant = found.scored.iter().map(|one| {
        vec![
            one.variant.name().replace('_', " "),
            significant(one.score.d_beta),
            format!("{:.2}", one.estimate.condition_number),
        ]
    });
    let described: Vec<Option<Described>> = found.scored.iter().map(|one| one.described.clone()).collect();
    let by_noise = setup.scenario.identification.smoothing_window.is_none();
    Section::new(
        "How good the model is",
        vec![
            Block::text(
                "Standard deviation of predicted minus noise-free torque on the held-out motion, while the joint moves.",
            ),
            Block::table(header, rows.collect()),
            Block::table(["signals", "d_beta", "condition number"], per_variant.collect()),
            Block::List(console::smoothings(&described, by_noise, found.missing)),
        ],
    )
}

fn parameters(setup: &Setup, model: &Model, best: &Scored) -> Section {
    let truth = model.base().values(&Model::standard_values(&setup.plant));
    let estimate = &best.estimate;
    let rows: Vec<Vec<String>> = model
        .base()
        .groupings()
        .iter()
        .enumerate()
        .map(|(k, grouping)| {
            let (value, std, [low, high]) = (estimate.beta[k], estimate.std()[k], estimate.intervals()[k]);
            vec![
                grouping.name.clone(),
                model.unit_on_joint(grouping.leader).to_owned(),
                significant(value),
                significant(std),
                significant(low),
                significant(high),
                significant(truth[k]),
                significant((value - truth[k]) / std),
            ]
        })
        .collect();
    let inside = rows.len() - estimate.intervals().iter().zip(&truth).filter(|([l, h], t)| *t < l || *t > h).count();
    let header = ["base parameter", "unit", "value", "std", "95 % from", "to", "truth", "error / std"];
    Section::new(
        "Parameters",
        vec![
            Block::text(format!(
                "{inside} of the {} intervals hold the truth. The intervals know of the torque noise, not of errors in the \
                 smoothed accelerations.",
                rows.len()
            )),
            Block::Folded(format!("All {} base parameters", rows.len()), vec![Block::table(header, rows)]),
        ],
    )
}

fn quality(setup: &Setup, runs: &Runs, limits: &str) -> Section {
    let logs = [("training", &runs.training), ("held out", &runs.held_out)].map(|(name, run)| {
        let log = &run.recording;
        vec![
            name.to_owned(),
            log.samples().to_string(),
            format!("{:.1} s", log.duration()),
            format!("{:.0} Hz", log.rate_hz()),
        ]
    });
    let sensors = setup.plant.joints.iter().zip(&setup.sensors).map(|(joint, sensor)| {
        vec![joint.name.clone(), format!("{} {}", significant(sensor.torque_noise), joint.effort_unit())]
    });
    let limits = if limits.is_empty() { "No drive was at its torque limit." } else { limits };
    Section::new(
        "Data quality",
        vec![
            Block::table(["log", "samples", "length", "rate"], logs.to_vec()),
            Block::text(limits.trim()),
            Block::Folded("Sensor noise".into(), vec![Block::table(["joint", "torque noise, std"], sensors.collect())]),
        ],
    )
}
