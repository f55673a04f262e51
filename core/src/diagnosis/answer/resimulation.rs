//! The extended model back in a simulator: the arm is driven along the measured held-out motion, and its motor torque compared with
//! the measured one.
//!
//! The arm follows the filtered measured positions under computed torque of its own model with feedback, so that its torque
//! is that of the simulator's forward dynamics and not of the regression that found the model.

use super::diagnosis::Diagnosis;
use super::extended::ExtendedModel;
use super::quantities::{Residuals, Share};
use crate::channels::Channels;
use crate::diagnosis::lack_of_fit::Unexplained;
use crate::diagnosis::logs::{Log, Rows};
use crate::diagnosis::regression::{Column, rms};
use crate::dynamics::Motion;
use crate::effects::Placed;
use crate::error::{Error, Result};
use crate::robot::Robot;
use rayon::prelude::*;

/// Time after the start until the loop has settled, s.
const SETTLING_S: f64 = 0.5;

/// Factor on the residual of the fitted model up to which that of its simulation is one of the same model. Beyond it there is no
/// resimulation; findings and verdict are those of the logs.
const STRAYS: f64 = 5.0;

/// Runs an arm along a motion that was measured. `EngineKind` of the crate `tauscope` is one.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Engine, ExtendedModel, Followed, Simulator};
/// use tauscope::{dynamics::Motion, effects::Placed, error::Result, robot::Robot};
///
/// /// An arm that follows every motion exactly, with the torque that it takes.
/// struct Exact;
///
/// impl Simulator for Exact {
///     fn engine(&self, _: &Robot) -> Engine {
///         Engine { key: "exact", name: "inverse dynamics" }
///     }
///
///     fn follow(&self, arm: &Robot, extra: &[Placed], motion: &Motion, start: f64, period: f64) -> Result<Followed> {
///         let time: Vec<f64> = (0..motion.samples()).map(|k| start + k as f64 * period).collect();
///         let model = ExtendedModel { robot: arm.clone(), effects: extra.to_vec() };
///         Ok(Followed { torque: model.torque(&time, motion), q: motion.q.clone() })
///     }
/// }
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # assert_eq!(Exact.follow(&robot, &[], &Motion::zeros(1, 3), 0.0, 0.01)?.torque.samples(), 3);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub trait Simulator: Sync {
    /// What moves `robot`.
    fn engine(&self, robot: &Robot) -> Engine;

    /// Lets `robot`, with `effects` in addition to the friction of its drives, follow `motion` (where the joints really were; the
    /// first sample at `start`, `period` seconds apart) under computed torque of its own model with feedback.
    ///
    /// # Errors
    /// If the simulator does not take the arm, or the simulation runs away.
    fn follow(&self, robot: &Robot, effects: &[Placed], motion: &Motion, start: f64, period: f64) -> Result<Followed>;
}

/// The forward dynamics of a simulator, by its names.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Engine;
///
/// // What a simulator calls itself: in files, and in texts.
/// let engine = Engine { key: "own", name: "own equations of motion" };
/// assert_eq!(format!("simulated with {}", engine.name), "simulated with own equations of motion");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Engine {
    /// In files.
    pub key: &'static str,
    /// In texts.
    pub name: &'static str,
}

/// What a simulated arm did, `[joint][time]`.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::channels::Channels;
/// use tauscope::diagnosis::{ExtendedModel, Followed};
/// use tauscope::dynamics::Motion;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
///
/// // A pendulum that stays at rest in two poses, as a simulator hands it over.
/// let motion = Motion::at_rest(Channels::from_vectors(&[vec![0.0, 1.0]]));
/// let model = ExtendedModel { robot, effects: Vec::new() };
/// let followed = Followed { torque: model.torque(&[0.0, 0.01], &motion), q: motion.q.clone() };
/// assert!((followed.torque.channel(0)[1] - 9.81 * 1f64.sin()).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// Motor torque as the sensors would log it, N m.
    pub torque: Channels,
    /// Motor positions, rad.
    pub q: Channels,
}

/// Residuals of the models on the held-out logs when the simulator runs them along the motions.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Engine, Followed, Simulator};
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # use tauscope::diagnosis::ExtendedModel;
/// # use tauscope::{dynamics::Motion, effects::Placed, error::Result, robot::Robot};
/// # struct Exact;
/// # impl Simulator for Exact {
/// #     fn engine(&self, _: &Robot) -> Engine { Engine { key: "exact", name: "inverse dynamics" } }
/// #     fn follow(&self, arm: &Robot, extra: &[Placed], motion: &Motion, start: f64, period: f64) -> Result<Followed> {
/// #         let time: Vec<f64> = (0..motion.samples()).map(|k| start + k as f64 * period).collect();
/// #         let model = ExtendedModel { robot: arm.clone(), effects: extra.to_vec() };
/// #         Ok(Followed { torque: model.torque(&time, motion), q: motion.q.clone() })
/// #     }
/// # }
///
/// // `Exact` simulates arms that follow every motion exactly. With the ripple it comes nearer to the held-out log.
/// let mut conclusion = answer.into_conclusion()?;
/// let resimulation = conclusion.resimulate(Exact)?;
/// assert_eq!(resimulation.engine.key, "exact");
/// assert!(resimulation.extended_rms[0] < resimulation.baseline_rms[0] && resimulation.gain.value > 0.0);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Resimulation {
    /// The forward dynamics.
    pub engine: Engine,
    /// Root mean square of the arm as described, per joint, N m; None where it cannot be simulated.
    pub described_rms: Option<Vec<f64>>,
    /// That of the fitted baseline.
    pub baseline_rms: Vec<f64>,
    /// That of the extended model.
    pub extended_rms: Vec<f64>,
    /// Share of the baseline's weighted sum of squares that the extended model gains.
    pub gain: Share,
    /// Share of the gap between baseline and noise floor that it closes.
    pub gap_closed: Share,
    /// Positions of the extended model's arm along every held-out log, rad.
    pub positions: Vec<Channels>,
}

/// What is needed to run the models along the held-out motions.
#[derive(Debug)]
pub(super) struct Replay {
    /// The arm as described.
    pub described: ExtendedModel,
    /// The fitted baseline, if it has bodies that can exist.
    pub baseline: Result<ExtendedModel>,
    /// The extended model, if it has.
    pub extended: Result<ExtendedModel>,
    /// The held-out rows.
    pub rows: Rows,
    /// Torque of the fitted baseline and of the extended model there that comes of the noise of the encoders: no simulated arm has it.
    pub of_encoders: [Column; 2],
    /// Seed of the bootstrap.
    pub seed: u64,
}

impl Replay {
    /// Runs the models in a simulator.
    ///
    /// # Errors
    /// If the baseline or the extended model cannot be simulated.
    pub(super) fn run(&self, diagnosis: &Diagnosis, simulator: &impl Simulator) -> Result<Resimulation> {
        let [baseline, extended] = [&self.baseline, &self.extended].map(|model| model.as_ref().map_err(Error::clone));
        let mut models = vec![baseline?, extended?];
        // Where nothing was found they are the same.
        models.dedup();
        let fitted = resimulate(simulator, &models, &self.rows)?;
        let of_model = |place: usize, of_encoders: &Column| {
            let mut run: Resimulated = fitted[place].clone();
            run.residual.add(-1.0, of_encoders);
            run
        };
        let [baseline, extended] =
            [of_model(0, &self.of_encoders[0]), of_model(models.len() - 1, &self.of_encoders[1])];
        let noise = &diagnosis.errors.noise_floor;
        let (before, after) = (&baseline.residual, &extended.residual);
        let residuals = Residuals { before, after, valid: &baseline.valid, noise };
        let extended_rms = rms(&extended.valid, &extended.residual);
        let of_fit = &diagnosis.errors.extended_test_rms;
        let strays = |joint: usize| extended_rms[joint] > STRAYS * of_fit[joint].max(noise[joint]);
        if let Some(joint) = (0..extended_rms.len()).find(|&joint| strays(joint)) {
            let problem = "the simulated arm does not follow the fitted model: the logs determine its drives or bodies too poorly \
                           for a simulation (friction or inertia that would have to be negative)";
            return Err(Error::request(format!("joint `{}`", self.described.robot.joints[joint].name), problem));
        }
        let described = resimulate(simulator, &[&self.described], &self.rows).ok();
        Ok(Resimulation {
            engine: simulator.engine(&self.described.robot),
            described_rms: described.map(|runs| rms(&runs[0].valid, &runs[0].residual)),
            baseline_rms: rms(&baseline.valid, &baseline.residual),
            extended_rms,
            gain: residuals.gain(self.seed),
            gap_closed: residuals.gap_closed(&joints_of(&diagnosis.unexplained), self.seed),
            positions: extended.positions.clone(),
        })
    }
}

/// Joints with unexplained structure.
pub(super) fn joints_of(unexplained: &[Unexplained]) -> Vec<usize> {
    unexplained.iter().map(|left| left.joint).collect()
}

/// Residual of a simulated model over the rows; rows in which the loop still settles are not in `valid`.
#[derive(Debug, Clone)]
struct Resimulated {
    /// Measured less simulated torque.
    residual: Column,
    /// Valid rows, `[joint][row]`.
    pub valid: Vec<Vec<bool>>,
    /// Positions of the simulated arm along every log, `[joint][time]`, rad.
    pub positions: Vec<Channels>,
}

/// Runs `models` along the motions of all logs of `rows`.
///
/// # Errors
/// If the simulator does not take a model, or a simulation runs away; `models` are named by their place.
fn resimulate(simulator: &impl Simulator, models: &[&ExtendedModel], rows: &Rows) -> Result<Vec<Resimulated>> {
    let jobs: Vec<(usize, &Log)> =
        (0..models.len()).flat_map(|model| rows.logs.iter().map(move |log| (model, log))).collect();
    let runs: Vec<(Channels, Channels)> =
        jobs.into_par_iter().map(|(k, log)| along(simulator, models[k], log)).collect::<Result<_>>()?;
    let mut valid = rows.valid.clone();
    for (log, &start) in rows.logs.iter().zip(&rows.starts) {
        let settling = log.blocks(&log.time).iter().filter(|&&t| t < log.time[0] + SETTLING_S).count();
        valid.iter_mut().for_each(|valid| valid[start..start + settling].fill(false));
    }
    let logs = runs.chunks_exact(rows.logs.len());
    Ok(logs
        .map(|logs| {
            let mut residual = Column::new(rows.torque.iter().cloned());
            let simulated = Column::new((0..rows.dof()).map(|joint| {
                let each = rows.logs.iter().zip(logs);
                each.flat_map(|(log, (torque, _))| log.as_logged(torque.channel(joint))).collect()
            }));
            residual.add(-1.0, &simulated);
            let positions = logs.iter().map(|(_, q)| q.clone()).collect();
            Resimulated { residual, valid: valid.clone(), positions }
        })
        .collect())
}

/// Motor torque as the sensors would log it, when the arm follows the motion of a log, and its positions, `[joint][time]`.
fn along(simulator: &impl Simulator, model: &ExtendedModel, log: &Log) -> Result<(Channels, Channels)> {
    let motion = true_motion(&model.effects, log)?;
    let Followed { torque, q } = simulator.follow(&model.robot, &model.effects, &motion, log.time[0], log.period)?;
    Ok((torque, q))
}

/// Where the joints really were when the encoders read the motion of a log.
fn true_motion(effects: &[Placed], log: &Log) -> Result<Motion> {
    Ok(log.behind_encoders(effects)?.unwrap_or_else(|| log.motion.clone()))
}
