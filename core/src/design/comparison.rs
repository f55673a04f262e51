//! The parametrisations side by side at equal length and limits, with random motions and the single move of the paper.
//!
//! Held-out torque error: the standard deviation of predicted torque along other, random motions in units of sigma, root
//! mean square over all of their rows, when the parameters were identified from the motion in question.

use super::criterion::{condition_number, log_determinant, relative_deviations};
use super::excite::{Request, Watch, excite};
use super::families::Family;
use super::information::Information;
use super::problem::Problem;
use crate::error::Result;
use crate::excitation::encoding::random_point;
use crate::excitation::freudenstein::{Move, PEAK_ACCELERATION, PEAK_VELOCITY};
use crate::excitation::{JointLimits, Motion, Reference};
use serde::Serialize;

/// Random motions that form the median, and as many others that are held out.
const RANDOM_MOTIONS: usize = 40;

/// Draws a random motion may take until one is inside all limits.
const DRAWS: u64 = 200;

/// Moves a second and joint of random sequences.
const RANDOM_MOVES_PER_SECOND: f64 = 0.6;

/// What one motion, or the median of several, achieves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Which motion.
    pub name: String,
    /// Parameters that can be separated.
    pub rank: usize,
    /// Condition number.
    pub condition_number: f64,
    /// D, nats a parameter.
    pub d: f64,
    /// Highest acceleration of any joint, rad/s^2.
    pub peak_acceleration: f64,
    /// The largest share of any joint's acceleration limit.
    pub acceleration_used: f64,
    /// Median relative standard deviation of the parameters.
    pub median_deviation: f64,
    /// Largest relative standard deviation of the parameters.
    pub worst_deviation: f64,
    /// Torque error on held-out motions, in sigma; none where no random motion keeps the limits.
    pub held_out: Option<f64>,
    /// The same over that of the median random motion, minus one.
    pub held_out_change: Option<f64>,
}

/// The table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Number of base parameters.
    pub parameters: usize,
    /// Length of all motions, s.
    pub duration_s: f64,
    /// The best of each parametrisation, the median random sequence, the single move.
    pub rows: Vec<Row>,
}

/// Searches in every parametrisation as `request` asks (its own is not looked at), and judges the results on the rate of
/// the log.
///
/// # Errors
/// Those of [`excite`].
pub fn compare(problem: &Problem, request: &Request, watch: &mut Watch) -> Result<Comparison> {
    let judge = Judge::new(problem, request)?;
    let mut rows = Vec::new();
    for family in Family::ALL {
        let request = Request { family, size: None, ..request.clone() };
        let outcome = excite(problem, &request, watch)?;
        rows.push(judge.row(family.name(), &outcome.motion));
        if outcome.stopped {
            break;
        }
    }
    rows.extend(judge.random_median.clone());
    rows.push(judge.row("single move", &SingleMove::of(problem.envelope.joints(), request.duration_s)));
    Ok(Comparison { parameters: problem.experiment.beta().len(), duration_s: request.duration_s, rows })
}

/// What motions are judged on.
pub struct Judge<'a> {
    problem: &'a Problem,
    held_out: Option<Information>,
    random_median: Option<Row>,
}

impl<'a> Judge<'a> {
    /// Draws the held-out motions and those the median random motion is taken of, all as long as in `request`.
    ///
    /// # Errors
    /// Names the limits that no motion can keep.
    pub fn new(problem: &'a Problem, request: &Request) -> Result<Self> {
        let held_out = random_motions(problem, request, "held-out excitation")?
            .iter()
            .map(|motion| problem.observe(motion).0)
            .reduce(|sum, information| sum.joined(&information));
        let mut judge = Judge { problem, held_out, random_median: None };
        let rows: Vec<Row> =
            random_motions(problem, request, "random excitation")?.iter().map(|m| judge.row("random", m)).collect();
        judge.random_median = median_row(&rows);
        Ok(judge)
    }

    /// The median of random sequences; none where no random sequence keeps the limits.
    pub fn random_median(&self) -> Option<&Row> {
        self.random_median.as_ref()
    }

    /// Judges one motion on the rate of the log.
    pub fn row(&self, name: &str, motion: &dyn Reference) -> Row {
        let experiment = &self.problem.experiment;
        let limits = self.problem.envelope.joints();
        let mut accelerations = vec![0.0f64; limits.len()];
        let information = experiment.scan(motion, experiment.rate_hz(), &mut |samples| {
            for (most, signal) in accelerations.iter_mut().zip(samples.motion.qdd.iter()) {
                *most = signal.iter().fold(*most, |m, a| m.max(a.abs()));
            }
        });
        let deviations = relative_deviations(&information, self.problem.sizes());
        let held_out = self.held_out.as_ref().map(|other| information.prediction_error(other));
        let median_held_out = self.random_median.as_ref().and_then(|row| row.held_out);
        Row {
            name: name.to_owned(),
            rank: information.rank(),
            condition_number: condition_number(&information),
            d: log_determinant(&information),
            peak_acceleration: accelerations.iter().copied().fold(0.0, f64::max),
            acceleration_used: accelerations.iter().zip(limits).map(|(a, l)| a / l.acceleration).fold(0.0, f64::max),
            worst_deviation: deviations.iter().copied().fold(0.0, f64::max),
            median_deviation: median(deviations),
            held_out,
            held_out_change: held_out.zip(median_held_out).map(|(own, median)| own / median - 1.0),
        }
    }
}

/// The medians of every column; none of no rows.
fn median_row(rows: &[Row]) -> Option<Row> {
    let middle = |value: &dyn Fn(&Row) -> f64| median(rows.iter().map(value).collect());
    Some(Row {
        name: "random, median".to_owned(),
        rank: rows.iter().map(|row| row.rank).min()?,
        condition_number: middle(&|row| row.condition_number),
        d: middle(&|row| row.d),
        peak_acceleration: middle(&|row| row.peak_acceleration),
        acceleration_used: middle(&|row| row.acceleration_used),
        median_deviation: middle(&|row| row.median_deviation),
        worst_deviation: middle(&|row| row.worst_deviation),
        held_out: Some(middle(&|row| row.held_out.unwrap_or(f64::NAN))),
        held_out_change: Some(0.0),
    })
}

/// Random 1-3-5 sequences inside all limits.
fn random_motions(problem: &Problem, request: &Request, label: &str) -> Result<Vec<Motion>> {
    let size = ((RANDOM_MOVES_PER_SECOND * request.duration_s).round() as usize).max(2);
    let encoding = Family::Freudenstein.encoding(problem.envelope.joints(), request.duration_s, size)?;
    Ok((0..DRAWS)
        .map(|index| encoding.decode(&random_point(&*encoding, request.seed, label, index)))
        .filter(|motion| problem.observe(motion).1.is_none())
        .take(RANDOM_MOTIONS)
        .collect())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// One move per joint from zero to halfway to its upper limit, all with the same timing: the motion of the paper, whose
/// (17) would even have it end where it starts. All joints move in proportion, so that parallel joints cannot be separated.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SingleMove {
    moves: Vec<Move>,
}

impl SingleMove {
    /// The move that takes `duration_s`, inside the velocity and acceleration limits.
    pub(crate) fn of(limits: &[JointLimits], duration_s: f64) -> Self {
        let moves = limits
            .iter()
            .map(|limits| {
                let reach = (limits.velocity * duration_s / PEAK_VELOCITY)
                    .min(limits.acceleration * duration_s * duration_s / PEAK_ACCELERATION);
                Move { from: 0.0, to: reach.min(0.5 * limits.upper), start_s: 0.0, duration_s }
            })
            .collect();
        SingleMove { moves }
    }
}

impl Reference for SingleMove {
    fn joints(&self) -> usize {
        self.moves.len()
    }

    fn duration_s(&self) -> f64 {
        self.moves.first().map_or(0.0, |first| first.duration_s)
    }

    fn at(&self, t_s: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let t = t_s.clamp(0.0, self.duration_s());
        for (joint, movement) in self.moves.iter().enumerate() {
            [q[joint], qd[joint], qdd[joint]] = movement.at(t);
        }
    }
}
