//! `paper.json`: everything the study found.

use super::verdict::PLANAR_CHAIN;
use super::{Verdict, planar, ratios, spatial};
use crate::identification::model::Model;
use crate::paper::equations::tables::{
    CORRECTED_TABLE_1, DenavitHartenberg, PARAMETERS, PRINTED_TABLE_1, PRINTED_TABLE_2, PRINTED_TABLE_3,
};
use crate::paper::equations::{self, DEPARTURES, PARAMETER_COUNT};
use crate::paper::planar::OtherStart;
use crate::paper::procedure::Stage;
use crate::paper::quality::Quality;
use crate::paper::single_move::MotionRank;
use crate::paper::{PaperStudy, SpatialFit};
use crate::scenario::Setup;
use crate::study::testbed::Variant;
use serde::Serialize;

/// Schema of `paper.json`.
pub(crate) const SCHEMA: &str = "tauscope.paper/1";

/// The content of `paper.json`.
#[derive(Debug, Serialize)]
pub(crate) struct PaperResults {
    scenario: String,
    robot: String,
    joints: Vec<String>,
    seed: u64,
    verdict: Verdict,
    procedure: Vec<StageTime>,
    definitions: Definitions,
    table_1: Table1,
    table_2: Vec<Table2Row>,
    table_3: Vec<Table3Row>,
    model_78: Vec<PlanarResult>,
    model_78_in_absolute_angles: Quality,
    why_it_fails: &'static str,
    other_starts: Vec<OtherStart>,
    spatial: Vec<SpatialResult>,
    single_move: MotionRank,
    sequence: MotionRank,
    departures: Vec<DepartureRow>,
}

#[derive(Debug, Serialize)]
struct StageTime {
    stage: &'static str,
    what: &'static str,
    seconds: f64,
}

#[derive(Debug, Serialize)]
struct Definitions {
    torque_std: &'static str,
    residual_rms: &'static str,
    unseen_share: &'static str,
    solver_difference: &'static str,
}

#[derive(Debug, Serialize)]
struct Table1 {
    printed: Vec<Table1Row>,
    corrected: Vec<Table1Row>,
}

#[derive(Debug, Serialize)]
struct Table1Row {
    linkage: usize,
    alpha_deg: f64,
    a_mm: f64,
    d_mm: f64,
    theta: String,
}

/// One of X1..X78: ours without and with smoothing, and the printed one.
#[derive(Debug, Serialize)]
struct Table2Row {
    symbol: &'static str,
    unit: &'static str,
    meaning: &'static str,
    as_printed: f64,
    consistent: f64,
    euler_lagrange: f64,
    printed: Option<f64>,
}

/// One joint: torque standard deviation without and with smoothing.
#[derive(Debug, Serialize)]
struct Table3Row {
    joint: String,
    model_78: [f64; 2],
    model_78_ratio: f64,
    spatial: [f64; 2],
    spatial_ratio: f64,
    printed: [f64; 2],
    printed_ratio: f64,
}

#[derive(Debug, Serialize)]
struct PlanarResult {
    variant: &'static str,
    parameters: usize,
    rank: usize,
    rank_on_motion: usize,
    null_dimension: usize,
    /// Parameters that only occur in one and the same sum, by number.
    sums: Vec<Vec<usize>>,
    fits: Vec<PlanarFitResult>,
}

#[derive(Debug, Serialize)]
struct PlanarFitResult {
    signals: &'static str,
    x: Vec<f64>,
    sigma_nm: Vec<f64>,
    iterations: usize,
    stop: String,
    reduced_chi2: Option<f64>,
    lambda_history: Vec<f64>,
    chi2_history: Vec<f64>,
    unseen_share: f64,
    quality: Quality,
}

#[derive(Debug, Serialize)]
struct SpatialResult {
    signals: &'static str,
    base_parameters: Vec<SpatialParameter>,
    sigma_nm: Vec<f64>,
    solver_difference: f64,
    quality: Quality,
}

#[derive(Debug, Serialize)]
struct SpatialParameter {
    name: String,
    unit: &'static str,
    value: f64,
    std: f64,
    truth: f64,
}

#[derive(Debug, Serialize)]
struct DepartureRow {
    place: &'static str,
    printed: &'static str,
    used: &'static str,
    why: &'static str,
    variants: Vec<&'static str>,
}

/// Gathers the content of `paper.json`.
pub(crate) fn results(setup: &Setup, study: &PaperStudy, verdict: &Verdict) -> PaperResults {
    PaperResults {
        scenario: setup.scenario.name.clone(),
        robot: setup.plant.name.clone(),
        joints: setup.plant.joint_names(),
        seed: setup.scenario.seed,
        verdict: verdict.clone(),
        procedure: Stage::ALL
            .into_iter()
            .map(|stage| StageTime { stage: stage.name(), what: stage.what(), seconds: study.procedure.seconds(stage) })
            .collect(),
        definitions: Definitions {
            torque_std: "standard deviation of predicted minus noise-free motor torque, over the samples at which the \
                         joint is faster than the reversal band; pairs are without and with Savitzky-Golay",
            residual_rms: "root mean square of measured minus predicted torque, both through the same filter, over the \
                           samples that the identification uses",
            unseen_share: "length of the part of X that no torque of the log shows, over the length of X; zero means that X \
                           is the shortest of all that fit equally well",
            solver_difference: "largest difference between Levenberg-Marquardt and weighted least squares on the base \
                                parameters, relative to the parameter or its standard deviation, whichever is larger",
        },
        table_1: Table1 { printed: table_1(&PRINTED_TABLE_1), corrected: table_1(&CORRECTED_TABLE_1) },
        table_2: table_2(study),
        table_3: table_3(setup, study),
        model_78: study.planar.iter().map(planar_result).collect(),
        model_78_in_absolute_angles: study.absolute_angles.clone(),
        why_it_fails: PLANAR_CHAIN,
        other_starts: study.other_starts.clone(),
        spatial: study.spatial.iter().map(|fit| spatial_result(setup, study, fit)).collect(),
        single_move: study.single_move.clone(),
        sequence: study.sequence.clone(),
        departures: DEPARTURES
            .iter()
            .map(|departure| DepartureRow {
                place: departure.equation,
                printed: departure.printed,
                used: departure.used,
                why: departure.why,
                variants: departure.variants.iter().map(|variant| variant.name()).collect(),
            })
            .collect(),
    }
}

fn table_1(rows: &[DenavitHartenberg]) -> Vec<Table1Row> {
    rows.iter()
        .map(|row| Table1Row {
            linkage: row.linkage,
            alpha_deg: row.alpha_deg,
            a_mm: row.a_mm,
            d_mm: row.d_mm,
            theta: super::tables::theta(row),
        })
        .collect()
}

fn table_2(study: &PaperStudy) -> Vec<Table2Row> {
    let x = |variant, k: usize| planar(study, variant, Variant::SavitzkyGolay).fit.parameters[k];
    PARAMETERS
        .iter()
        .enumerate()
        .map(|(k, parameter)| Table2Row {
            symbol: parameter.symbol,
            unit: parameter.unit,
            meaning: parameter.meaning,
            as_printed: x(equations::Variant::AsPrinted, k),
            consistent: x(equations::Variant::Consistent, k),
            euler_lagrange: x(equations::Variant::EulerLagrange, k),
            printed: PRINTED_TABLE_2[k],
        })
        .collect()
}

fn table_3(setup: &Setup, study: &PaperStudy) -> Vec<Table3Row> {
    let both = [Variant::Raw, Variant::SavitzkyGolay];
    let paper_model =
        both.map(|signals| &planar(study, equations::Variant::Consistent, signals).quality.training.torque_std_nm);
    let arm = both.map(|signals| &spatial(study, signals).quality.training.torque_std_nm);
    let paper_ratio = ratios(paper_model[1], paper_model[0]);
    let arm_ratio = ratios(arm[1], arm[0]);
    setup
        .plant
        .joint_names()
        .into_iter()
        .zip(PRINTED_TABLE_3)
        .enumerate()
        .map(|(j, (joint, printed))| Table3Row {
            joint,
            model_78: paper_model.map(|std| std[j]),
            model_78_ratio: paper_ratio[j],
            spatial: arm.map(|std| std[j]),
            spatial_ratio: arm_ratio[j],
            printed,
            printed_ratio: printed[1] / printed[0],
        })
        .collect()
}

fn planar_result(model: &crate::paper::PlanarModel) -> PlanarResult {
    PlanarResult {
        variant: model.variant.name(),
        parameters: PARAMETER_COUNT,
        rank: model.structure.rank,
        rank_on_motion: model.rank_on_motion,
        null_dimension: model.structure.null_dimension,
        sums: model.structure.groups.iter().filter(|group| group.len() > 1).cloned().collect(),
        fits: model
            .fits
            .iter()
            .map(|fit| PlanarFitResult {
                signals: fit.signals.name(),
                x: fit.fit.parameters.clone(),
                sigma_nm: fit.sigma.clone(),
                iterations: fit.fit.iterations,
                stop: format!("{:?}", fit.fit.stop).to_lowercase(),
                reduced_chi2: fit.fit.reduced_chi2,
                lambda_history: fit.fit.lambda_history.clone(),
                chi2_history: fit.fit.chi2_history.clone(),
                unseen_share: fit.unseen_share,
                quality: fit.quality.clone(),
            })
            .collect(),
    }
}

fn spatial_result(setup: &Setup, study: &PaperStudy, fit: &SpatialFit) -> SpatialResult {
    let base = study.model.base();
    let truth = base.values(&Model::standard_values(&setup.plant));
    let estimate = &fit.estimate;
    let base_parameters = base
        .groupings()
        .iter()
        .zip(estimate.beta.iter().zip(estimate.std()))
        .zip(truth)
        .map(|((grouping, (&value, std)), truth)| SpatialParameter {
            name: grouping.name.clone(),
            unit: Model::unit(grouping.leader).name(),
            value,
            std,
            truth,
        })
        .collect();
    SpatialResult {
        signals: fit.signals.name(),
        base_parameters,
        sigma_nm: estimate.sigma.clone(),
        solver_difference: fit.solver_difference,
        quality: fit.quality.clone(),
    }
}
