//! The JSON results of a scenario run.

use crate::identification::model::Model;
use crate::identification::smoothing_choice::Described;
use crate::paper::equations::tables::PRINTED_TABLE_3;
use crate::robot::Joint;
use crate::scenario::Setup;
use crate::study::testbed::{self, Runs, Score, Scored};
use serde::Serialize;

/// Schema of `identification.json`.
pub(crate) const IDENTIFICATION_SCHEMA: &str = "tauscope.identification/1";

/// Schema of `score.json`.
pub(crate) const SCORE_SCHEMA: &str = "tauscope.score/1";

/// `identification.json`: what each variant found.
#[derive(Debug, Serialize)]
pub(crate) struct Identification {
    scenario: String,
    robot: String,
    joints: Vec<String>,
    /// Units of the quantities per joint whose names end in `_nm`: N for joints that slide.
    effort_units: Vec<&'static str>,
    seed: u64,
    estimator: &'static str,
    standard_parameters: usize,
    base_parameters: usize,
    variants: Vec<VariantParameters>,
}

#[derive(Debug, Serialize)]
struct VariantParameters {
    signals: &'static str,
    condition_number: f64,
    /// Standard deviation of each joint's residual, the inverse root of its weight.
    sigma_nm: Vec<f64>,
    residual_rms_nm: Vec<f64>,
    rows: Vec<usize>,
    parameters: Vec<Parameter>,
}

#[derive(Debug, Serialize)]
struct Parameter {
    name: String,
    unit: &'static str,
    value: f64,
    std: f64,
    interval_95: [f64; 2],
    truth: f64,
}

/// `score.json`: how close each variant came.
#[derive(Debug, Serialize)]
pub(crate) struct Scores {
    scenario: String,
    robot: String,
    joints: Vec<String>,
    /// Units of the quantities per joint whose names end in `_nm`: N for joints that slide.
    effort_units: Vec<&'static str>,
    seed: u64,
    definitions: Definitions,
    at_effort_limit: AtEffortLimit,
    /// Whether the Savitzky-Golay window was chosen by the noise of the positions; else the scenario gives it.
    window_chosen_by_noise: bool,
    variants: Vec<VariantScore>,
    /// Why nothing was identified with the usual low-pass; null where something was.
    butterworth_problem: Option<String>,
    smoothing_gain: SmoothingGain,
}

#[derive(Debug, Serialize)]
struct Definitions {
    d_beta: &'static str,
    relative_errors: &'static str,
    torque_std: &'static str,
    at_effort_limit: &'static str,
}

/// How often the drives gave all they can, per joint.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct AtEffortLimit {
    /// On the training motion.
    pub training: Vec<f64>,
    /// On the held-out motion.
    pub held_out: Vec<f64>,
}

impl AtEffortLimit {
    /// The results of both runs of a scenario.
    pub(crate) fn new(setup: &Setup, runs: &Runs) -> Self {
        AtEffortLimit {
            training: testbed::at_effort_limit(setup, &runs.training),
            held_out: testbed::at_effort_limit(setup, &runs.held_out),
        }
    }
}

#[derive(Debug, Serialize)]
struct VariantScore {
    signals: &'static str,
    /// Null where signals are not smoothed.
    smoothing: Option<Described>,
    #[serde(flatten)]
    score: Score,
    parameters: Vec<String>,
    residual_rms_nm: Vec<f64>,
    condition_number: f64,
    seconds: f64,
}

/// Torque standard deviation with Savitzky-Golay over that without, per joint, with the paper's for comparison.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct SmoothingGain {
    /// On the training motion.
    pub training: Vec<f64>,
    /// On the held-out motion.
    pub held_out: Vec<f64>,
    /// With Savitzky-Golay over that with the usual Butterworth low-pass, on the training motion; empty where nothing was identified
    /// with the latter.
    pub over_butterworth_training: Vec<f64>,
    /// The same on the held-out motion.
    pub over_butterworth_held_out: Vec<f64>,
    /// From the paper's Table 3; empty for an arm that does not have the six joints of the paper's.
    pub paper_table_3: Vec<f64>,
}

/// Names and units of the base parameters, with their true values.
fn parameters(setup: &Setup, model: &Model) -> Vec<(String, &'static str, f64)> {
    let truth = model.base().values(&Model::standard_values(&setup.plant));
    model
        .base()
        .groupings()
        .iter()
        .zip(truth)
        .map(|(grouping, value)| (grouping.name.clone(), model.unit_on_joint(grouping.leader), value))
        .collect()
}

/// The content of `identification.json`.
pub(crate) fn identification(setup: &Setup, model: &Model, scored: &[Scored]) -> Identification {
    let named = parameters(setup, model);
    let variants = scored
        .iter()
        .map(|result| {
            let estimate = &result.estimate;
            let parameters = named
                .iter()
                .zip(estimate.beta.iter().zip(estimate.std()).zip(estimate.intervals()))
                .map(|((name, unit, truth), ((&value, std), interval_95))| Parameter {
                    name: name.clone(),
                    unit,
                    value,
                    std,
                    interval_95,
                    truth: *truth,
                })
                .collect();
            VariantParameters {
                signals: result.variant.name(),
                condition_number: estimate.condition_number,
                sigma_nm: estimate.sigma.clone(),
                residual_rms_nm: result.residual_rms.clone(),
                rows: estimate.rows.clone(),
                parameters,
            }
        })
        .collect();
    Identification {
        scenario: setup.scenario.name.clone(),
        robot: setup.plant.name.clone(),
        joints: setup.plant.joint_names(),
        effort_units: setup.plant.joints.iter().map(Joint::effort_unit).collect(),
        seed: setup.scenario.seed,
        estimator: "weighted_least_squares",
        standard_parameters: model.names().len(),
        base_parameters: model.base().len(),
        variants,
    }
}

/// The content of `score.json`. `gain` is [`smoothing_gain`]'s; `missing` is why there is no identification with the usual low-pass.
pub(crate) fn scores(
    setup: &Setup,
    model: &Model,
    (scored, missing): (&[Scored], Option<&str>),
    gain: SmoothingGain,
    at_effort_limit: AtEffortLimit,
) -> Scores {
    let names: Vec<String> = parameters(setup, model).into_iter().map(|(name, _, _)| name).collect();
    Scores {
        scenario: setup.scenario.name.clone(),
        robot: setup.plant.name.clone(),
        joints: setup.plant.joint_names(),
        effort_units: setup.plant.joints.iter().map(Joint::effort_unit).collect(),
        seed: setup.scenario.seed,
        definitions: Definitions {
            d_beta: "(2 / p) sum |beta - est| / (|beta| + |est|) over the base parameters; 0 is perfect, 2 the worst; \
                     zero to rounding in both counts as right",
            relative_errors: "(estimate - truth) / |truth|; null where the truth is zero and the estimate is not",
            torque_std: "standard deviation of predicted minus noise-free motor torque, over the samples at which the \
                         joint is faster than the reversal band",
            at_effort_limit: "share of the samples at which the drive gave its largest torque",
        },
        at_effort_limit,
        window_chosen_by_noise: setup.scenario.identification.smoothing_window.is_none(),
        variants: scored
            .iter()
            .map(|result| VariantScore {
                signals: result.variant.name(),
                smoothing: result.described.clone(),
                score: result.score.clone(),
                parameters: names.clone(),
                residual_rms_nm: result.residual_rms.clone(),
                condition_number: result.estimate.condition_number,
                seconds: result.seconds,
            })
            .collect(),
        butterworth_problem: missing.map(str::to_owned),
        smoothing_gain: gain,
    }
}

/// Ratios of the torque standard deviations, smoothed over raw and over the usual low-pass, with the paper's for comparison.
pub(crate) fn smoothing_gain(raw: &Scored, usual: Option<&Scored>, smoothed: &Scored) -> SmoothingGain {
    let printed = PRINTED_TABLE_3.iter().map(|[alone, smoothed]| smoothed / alone);
    let comparable = raw.residual_rms.len() == PRINTED_TABLE_3.len();
    let ratio = |with: &[f64], without: &[f64]| -> Vec<f64> { with.iter().zip(without).map(|(a, b)| a / b).collect() };
    SmoothingGain {
        training: ratio(&smoothed.score.torque_std_training_nm, &raw.score.torque_std_training_nm),
        held_out: ratio(&smoothed.score.torque_std_held_out_nm, &raw.score.torque_std_held_out_nm),
        over_butterworth_training: usual.map_or_else(Vec::new, |usual| {
            ratio(&smoothed.score.torque_std_training_nm, &usual.score.torque_std_training_nm)
        }),
        over_butterworth_held_out: usual.map_or_else(Vec::new, |usual| {
            ratio(&smoothed.score.torque_std_held_out_nm, &usual.score.torque_std_held_out_nm)
        }),
        paper_table_3: if comparable { printed.collect() } else { Vec::new() },
    }
}
