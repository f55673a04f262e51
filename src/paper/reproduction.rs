//! The whole study: both motions simulated and measured, the 78-parameter model and the spatial model fitted and judged.

use super::equations::structure::{RankStructure, random_states, rank_structure};
use super::equations::{self, JOINTS};
use super::planar::{self, OtherStart, PlanarFit, options};
use super::procedure::{Procedure, Stage};
use super::quality::{Quality, Seen};
use super::single_move::{MotionRank, motion_rank, sampled, single_move};
use crate::dynamics::Motion;
use crate::error::{Error, Result};
use crate::excitation::Reference;
use crate::identification::least_squares::{Estimate, weighted_least_squares};
use crate::identification::levenberg_marquardt::{Options, minimize};
use crate::identification::linear_problem::LinearProblem;
use crate::identification::model::Model;
use crate::scenario::{Setup, measure, simulate};
use crate::study::testbed::{Run, Runs, Variant};

/// Random states at which the rank of the 78-parameter model is taken.
const PROBES: usize = 200;

/// One variant of the 78-parameter model.
#[derive(Debug, Clone)]
pub(crate) struct PlanarModel {
    /// How far misprints are corrected.
    pub variant: equations::Variant,
    /// Rank and groups over random states: what any motion could show.
    pub structure: RankStructure,
    /// Rank on the training motion.
    pub rank_on_motion: usize,
    /// Fitted to the raw and to the smoothed log.
    pub fits: Vec<PlanarFit>,
}

/// The spatial model on the same log.
#[derive(Debug, Clone)]
pub(crate) struct SpatialFit {
    /// Raw or smoothed.
    pub signals: Variant,
    /// Base parameters by weighted least squares.
    pub estimate: Estimate,
    /// Residuals and errors of the torque.
    pub quality: Quality,
    /// Largest difference of a base parameter found by Levenberg-Marquardt, relative to its size or to its standard
    /// deviation where that is larger.
    pub solver_difference: f64,
}

/// Signals of the training motion for the figures.
#[derive(Debug, Clone)]
pub(crate) struct Signals {
    /// What the controller was asked to follow.
    pub reference: Motion,
    /// As measured.
    pub disturbed: Motion,
    /// After Savitzky-Golay.
    pub smoothed: Motion,
    /// The measured torque after Savitzky-Golay.
    pub smoothed_torque: crate::channels::Channels,
}

/// Everything the study found.
pub(crate) struct PaperStudy {
    /// The spatial model.
    pub model: Model,
    /// Both motions.
    pub runs: Runs,
    /// Training signals.
    pub signals: Signals,
    /// The 78-parameter model, one entry per variant.
    pub planar: Vec<PlanarModel>,
    /// The 78 parameters in absolute angles, fitted to the smoothed log.
    pub absolute_angles: Quality,
    /// The spatial model, raw and smoothed.
    pub spatial: Vec<SpatialFit>,
    /// The consistent variant, smoothed, fitted from elsewhere.
    pub other_starts: Vec<OtherStart>,
    /// The paper's own excitation.
    pub single_move: MotionRank,
    /// The sequence of moves that the scenario uses instead.
    pub sequence: MotionRank,
    /// Stages and times.
    pub procedure: Procedure,
}

/// Runs the study on a scenario. `procedure` has the time it took to load `setup`; `progress` hears of every stage as
/// it begins, and in the simulation of the samples done.
///
/// # Errors
/// An arm that does not have the paper's six joints; errors of simulation, preparation and identification.
pub(crate) fn study(
    setup: &Setup,
    mut procedure: Procedure,
    progress: &mut dyn FnMut(Stage, usize),
) -> Result<PaperStudy> {
    if setup.plant.dof() != JOINTS {
        let problem =
            format!("the paper's model is for {JOINTS} joints, this arm has {}; use another arm", setup.plant.dof());
        return Err(Error::request(&setup.plant.name, problem));
    }
    progress(Stage::Model, 0);
    let model = procedure.time(Stage::Model, || Model::new(&setup.plant));
    let states = random_states(setup.scenario.seed, PROBES);
    let structures = procedure.time(Stage::Model, || -> Result<Vec<_>> {
        equations::Variant::ALL.into_iter().map(|variant| Ok((variant, rank_structure(variant, &states)?))).collect()
    })?;
    let rate_hz = setup.scenario.sensors.rate_hz;
    let single_move = single_move(&model, &setup.limits, rate_hz);
    let sequence = motion_rank(&model, &setup.motion, rate_hz);

    let runs = record(setup, &mut procedure, progress)?;
    progress(Stage::Smoothing, 0);
    let raw = Seen::new(setup, &runs, Variant::Raw, &mut procedure)?;
    let smoothed = Seen::new(setup, &runs, Variant::SavitzkyGolay, &mut procedure)?;
    progress(Stage::LevenbergMarquardt, 0);
    let mut planar = Vec::new();
    for (variant, structure) in structures {
        let rank_on_motion = planar::rank_on_motion(variant, &smoothed)?;
        let fits = [&raw, &smoothed]
            .map(|seen| planar::fit(variant, rank_on_motion, seen, &mut procedure))
            .into_iter()
            .collect::<Result<_>>()?;
        planar.push(PlanarModel { variant, structure, rank_on_motion, fits });
    }
    let other_starts = match planar.iter().find(|model| model.variant == equations::Variant::Consistent) {
        Some(model) => {
            let reference = &model.fits[1];
            planar::other_starts(model.variant, reference, &smoothed, setup.scenario.seed, &mut procedure)?
        }
        None => Vec::new(),
    };
    let absolute_angles = planar::in_absolute_angles(&smoothed, &mut procedure)?;
    progress(Stage::LeastSquares, 0);
    let spatial =
        [&raw, &smoothed].map(|seen| spatial_fit(&model, seen, &mut procedure)).into_iter().collect::<Result<_>>()?;
    let signals = Signals {
        reference: sampled(&setup.motion, &runs.training.truth.time),
        disturbed: raw.training.1.motion.clone(),
        smoothed: smoothed.training.1.motion.clone(),
        smoothed_torque: smoothed.training.1.filtered_torque()?,
    };
    Ok(PaperStudy {
        model,
        signals,
        planar,
        absolute_angles,
        spatial,
        other_starts,
        single_move,
        sequence,
        procedure,
        runs,
    })
}

fn record(setup: &Setup, procedure: &mut Procedure, progress: &mut dyn FnMut(Stage, usize)) -> Result<Runs> {
    let mut done = 0;
    let mut one = |motion: &dyn Reference, run: u64| -> Result<Run> {
        let truth = procedure.time(Stage::Simulation, || {
            simulate(setup, motion, &mut |samples| progress(Stage::Simulation, done + samples))
        })?;
        done += truth.time.len();
        let recording = procedure.time(Stage::Measurement, || measure(setup, &truth, run))?;
        Ok(Run { truth, recording })
    };
    Ok(Runs { training: one(&setup.motion, 0)?, held_out: one(&setup.held_out, 1)? })
}

fn spatial_fit(model: &Model, seen: &Seen, procedure: &mut Procedure) -> Result<SpatialFit> {
    let names: Vec<String> = model.base().groupings().iter().map(|grouping| grouping.name.clone()).collect();
    let regression = procedure.time(Stage::Regression, || seen.training.1.regression(model))?;
    let estimate = procedure.time(Stage::LeastSquares, || weighted_least_squares(&regression, &names))?;
    let found = procedure.time(Stage::LevenbergMarquardt, || {
        let mut problem = LinearProblem::new(&regression, &estimate.sigma, names.len());
        minimize(&mut problem, &vec![0.0; names.len()], &options(Options::default().initial_lambda))
    })?;
    let solver_difference = found
        .parameters
        .iter()
        .zip(estimate.beta.iter().zip(estimate.std()))
        .fold(0.0, |most: f64, (lm, (wls, std))| most.max((lm - wls).abs() / wls.abs().max(std)));
    let quality = procedure.time(Stage::Validation, || Quality::new(model, &estimate.beta, seen, &regression))?;
    Ok(SpatialFit { signals: seen.signals, estimate, quality, solver_difference })
}
