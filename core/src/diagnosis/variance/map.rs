//! The map of what is missing: per joint, the size of what the residual follows.

use super::design::{Design, Raw, Source, together};
use super::kinds::Kind;
use super::lines::{Line, lines};
use super::mixed::{Fit, fit};
use super::sign_flips::p_values;
use crate::diagnosis::criteria::{Criteria, StructureCriteria};
use crate::diagnosis::logs::Rows;
use crate::diagnosis::model::DataSet;
use crate::diagnosis::regression::{Column, Projection};
use crate::identification::effect_model::Arm;
use crate::linear::{inner_product, root_mean_square};
use nalgebra::DVector;
use rayon::prelude::*;
use serde::Serialize;

/// Times that the correlation of the noise is estimated.
const CORRELATION_ROUNDS: usize = 3;

/// Largest correlation of consecutive rows of noise: what lasts longer is structure, slow time among it.
const MOST_CORRELATED: f64 = 0.8;

/// What the residual of every joint follows.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Kind;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // What the baseline's residual follows on the pivot, in all logs and before any law: its position.
/// let largest = diagnosis.map.joints[0].reported().next().expect("there is a ripple");
/// assert_eq!(largest.follows, Kind::Position);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ResidualMap {
    /// The joints that have an equation.
    pub joints: Vec<JointMap>,
}

/// What the residual of one joint follows. Torques are root mean squares over means of 80 ms, or longer where torque was
/// low-pass filtered before it was logged, N m or N.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Kind;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // The ripple of the pivot is well above the noise, and follows the joint's position.
/// let joint = &diagnosis.map.joints[0];
/// assert!(joint.misfit && joint.residual > joint.noise);
/// assert!(joint.p(Kind::Position).is_some_and(|p| p < 1e-6));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointMap {
    /// The joint, counted from 0.
    pub joint: usize,
    /// Measured torque.
    pub torque: f64,
    /// Residual of the model.
    pub residual: f64,
    /// Residual of the mixed model: without all parts below.
    pub noise: f64,
    /// Correlation of consecutive rows of that.
    pub correlation: f64,
    /// White noise of the torque signal: what the sensors account for.
    pub sensor_noise: f64,
    /// Size from which a part or a line is reported.
    pub reported_from: f64,
    /// Whether the residual is well above the noise.
    pub misfit: bool,
    /// What the residual follows, the largest first.
    pub parts: Vec<Part>,
    /// Spectral lines.
    pub lines: Vec<Line>,
}

/// A part of the residual that follows one kind of generic functions.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Kind;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // The largest part of the pivot's residual: significant, and almost the whole.
/// let joint = &diagnosis.map.joints[0];
/// let part = &joint.parts[0];
/// assert_eq!((part.follows, part.significant), (Kind::Position, true));
/// assert!(part.rms > 0.8 * joint.residual);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// What it follows.
    pub follows: Kind,
    /// Its size: its share of the square of all parts' sum, so that parts that cancel do not count twice.
    pub rms: f64,
    /// Probability of as much without it, given all other kinds; None where the logs are too short for a test.
    pub p: Option<f64>,
    /// The same for the best of all kinds on all joints (Holm, 1979).
    pub family_wise_p: Option<f64>,
    /// Whether it is significant at the level of the diagnosis.
    pub significant: bool,
}

impl JointMap {
    /// The parts that are significant and stand clear of the noise, the largest first.
    pub fn reported(&self) -> impl Iterator<Item = &Part> {
        self.parts.iter().filter(|part| part.significant && part.rms >= self.reported_from)
    }

    /// The parts that stand clear of the noise, the largest first, where the residual is much larger than that and none of them is
    /// significant by itself: the logs are too short to separate them.
    pub fn unseparated(&self) -> impl Iterator<Item = &Part> {
        let open = self.misfit && self.reported().next().is_none();
        self.parts.iter().filter(move |part| open && part.rms >= self.reported_from)
    }

    /// The p-value of a kind, among all others but not adjusted for their number; None where it is not tested.
    pub fn p(&self, kind: Kind) -> Option<f64> {
        self.parts.iter().find(|part| part.follows == kind)?.p
    }

    /// The spectral lines that stand clear of the noise, the strongest first.
    pub fn reported_lines(&self) -> impl Iterator<Item = &Line> {
        self.lines.iter().filter(|line| line.rms >= self.reported_from)
    }
}

impl ResidualMap {
    /// The map of the residual of the torque of `data` under the columns `fixed`, along the torque of `arm`; `alpha` is the family-wise level.
    pub fn new(data: &DataSet, fixed: &[Column], arm: &Arm, criteria: &Criteria, alpha: f64, seed: u64) -> Self {
        let rows = &data.rows;
        let torque = torques(arm, rows);
        let source = Source { rows, torque: &data.torque, fixed, arm: &torque };
        let joints: Vec<usize> = (0..rows.dof()).filter(|&joint| rows.valid[joint].contains(&true)).collect();
        let tested = joints.len() as f64;
        let level = criteria.levels.certain * alpha;
        let mut joints: Vec<JointMap> = joints
            .into_par_iter()
            .map(|joint| {
                let mut map = of_joint(&source, joint, &criteria.structure, seed);
                let residual = residual(&source, joint);
                map.lines = lines(rows, joint, [&residual, &torque[joint]], &criteria.structure, level / tested);
                map
            })
            .collect();
        adjust(&mut joints, alpha);
        ResidualMap { joints }
    }
}

/// Torque of an arm on every joint over rows, `[joint][row]`, N m.
pub(crate) fn torques(arm: &Arm, rows: &Rows) -> Vec<Vec<f64>> {
    let torque = arm.all_torque(rows);
    let part = |joint| torque.part(joint).map_or_else(|| vec![0.0; rows.len()], <[f64]>::to_vec);
    (0..rows.dof()).map(part).collect()
}

/// The regression made white with the first-order correlation of its own residual, the fit, and that correlation.
pub(super) fn coloured_fit(raw: &Raw) -> (Design, Fit, f64) {
    let mut rho = 0.0;
    let mut design = raw.design(rho);
    let mut fitted = fit(&design);
    for _ in 1..CORRELATION_ROUNDS {
        let correlated = correlation(&design, &fitted, rho);
        if correlated == rho {
            break;
        }
        rho = correlated;
        design = raw.design(rho);
        fitted = fit(&design);
    }
    (design, fitted, rho)
}

fn of_joint(source: &Source, joint: usize, criteria: &StructureCriteria, seed: u64) -> JointMap {
    let raw = Raw::new(source, joint);
    let (design, fitted, rho) = coloured_fit(&raw);
    let p = p_values(&design, &fitted, seed, joint);
    let all = coloured((&design.y - &fitted.residual).as_slice(), &design, rho);
    // Parts that cancel each other count for what they add to the sum: the shares of the sum's square add up to it.
    let size = |part: &DVector<f64>| {
        let part = coloured(part.as_slice(), &design, rho);
        (inner_product(&part, &all) / all.len().max(1) as f64).max(0.0).sqrt()
    };
    let mut parts: Vec<Part> = design
        .kinds
        .iter()
        .zip(&fitted.parts)
        .zip(p)
        .filter_map(|(((kind, _), part), p)| {
            let follows = (*kind)?;
            Some(Part { follows, rms: size(part), p, family_wise_p: None, significant: false })
        })
        .collect();
    parts.sort_by(|a, b| b.rms.total_cmp(&a.rms));
    let rows = source.rows;
    let valid = rows.torque[joint].iter().zip(&rows.valid[joint]).filter(|(_, ok)| **ok).map(|(x, _)| *x);
    let sensor_noise = rows.sensor_noise(joint, together(rows));
    let residual = root_mean_square(&coloured(design.y.as_slice(), &design, rho));
    let noise = (fitted.noise / (1.0 - rho * rho)).sqrt();
    JointMap {
        joint,
        torque: root_mean_square(&valid.collect::<Vec<f64>>()),
        residual,
        noise,
        correlation: rho,
        sensor_noise,
        reported_from: criteria.clear * noise,
        misfit: residual >= criteria.above_noise * noise,
        parts,
        lines: Vec::new(),
    }
}

/// Correlation of consecutive rows of noise, given that the rows were whitened with `rho`.
fn correlation(design: &Design, fit: &Fit, rho: f64) -> f64 {
    let noise = coloured(fit.residual.as_slice(), design, rho);
    let (mut together, mut all) = (0.0, 0.0);
    for run in &design.runs {
        for row in run.clone().skip(1) {
            together += noise[row] * noise[row - 1];
            all += 0.5 * (noise[row].powi(2) + noise[row - 1].powi(2));
        }
    }
    if all > 0.0 { (together / all).clamp(0.0, MOST_CORRELATED) } else { 0.0 }
}

/// Undoes the whitening of [`Raw::design`].
fn coloured(white: &[f64], design: &Design, rho: f64) -> Vec<f64> {
    let mut signal = white.to_vec();
    for run in &design.runs {
        signal[run.start] /= (1.0 - rho * rho).sqrt();
        for row in run.clone().skip(1) {
            signal[row] += rho * signal[row - 1];
        }
    }
    signal
}

/// Torque of a joint over the rows without its best fit by the fixed columns; zero in rows that are not valid.
fn residual(source: &Source, joint: usize) -> Vec<f64> {
    let valid = &source.rows.valid[joint];
    let masked = |signal: &[f64]| signal.iter().zip(valid).map(|(&x, &ok)| if ok { x } else { 0.0 }).collect();
    let zeros = vec![0.0; source.rows.len()];
    let torque: Vec<f64> = masked(source.torque.part(joint).unwrap_or(&zeros));
    let fixed = source.fixed.iter().filter_map(|column| column.part(joint)).map(|part| Column::on(0, masked(part)));
    let fit = Projection::new(&fixed.collect::<Vec<Column>>(), &Column::on(0, torque));
    fit.residual.part(0).map_or(zeros, <[f64]>::to_vec)
}

/// Adjusts the p-values for the number of kinds and joints, the smallest first.
fn adjust(joints: &mut [JointMap], alpha: f64) {
    let parts = joints.iter_mut().flat_map(|joint| &mut joint.parts);
    let mut tested: Vec<(f64, &mut Part)> = parts.filter_map(|part| Some((part.p?, part))).collect();
    tested.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (count, mut least) = (tested.len(), 0.0f64);
    for (rank, (p, part)) in tested.into_iter().enumerate() {
        least = least.max((count - rank) as f64 * p).min(1.0);
        part.family_wise_p = Some(least);
        part.significant = least <= alpha;
    }
}
