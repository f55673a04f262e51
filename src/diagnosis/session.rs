//! The logs and the arm under diagnosis, and fits of the baseline with a few effects on top.

use super::arm::Arm;
use super::bodies;
use super::candidates::{Candidate, bends, columns_in, is_level, linear, shapes, straight_below, within_bounds};
use super::column::{Column, combined, rms};
use super::known::Known;
use super::rows::{FEWEST_ROWS, FEWEST_TEST_ROWS, Rows, WIDEST_HZ, cutoff, cutoffs_up_to};
use super::score::{Projection, Test};
use super::whitening::{Beside, Whitener};
use crate::effects::{Parameter, Placed, Role};
use crate::error::Result;
use crate::identification::effect_model::Trust;
use crate::identification::model::Model;
use crate::recording::Recording;
use crate::robot::Robot;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Smallest eigenvalue of the scaled normal matrix, over its largest, that still counts.
const SINGULAR: f64 = 1e-12;

/// Halvings of the step in the search for a shape.
const HALVINGS: usize = 6;

/// Times the size at which a departure's column is taken is moved to its estimate.
const SECANTS: usize = 3;

/// Share of a level within which its column's factor must lie: it is cut off wholly or not at all.
const LEVEL_FACTOR: std::ops::Range<f64> = 0.5..2.0;

/// Factor within which the estimate of a departure must agree with the size at which its column was taken.
const SIZE_FACTOR: f64 = 2.0;

/// Standard deviations by which an estimate may lie beyond a bound.
const BEYOND_BOUND: f64 = 3.0;

/// Mean square of a joint's whitened residual from which it counts as misfit, and rounds of growing the noise to it.
const MISFIT: f64 = 1.2;
const MISFIT_ROUNDS: usize = 2;

/// Share of a shape's value over which its derivative is taken.
const DIFFERENCE: f64 = 0.02;

/// One kind of logs with all that is the same for every fit.
#[derive(Debug)]
pub struct Side {
    /// The rows.
    pub rows: Rows,
    /// Columns of the baseline.
    pub baseline: Vec<Column>,
    /// Measured torque less what is believed.
    pub torque: Column,
    /// Whether it is identified from.
    pub training: bool,
}

/// What is under diagnosis.
#[derive(Debug)]
pub struct Session<'a> {
    /// The model of the arm.
    pub model: &'a Model,
    /// What is believed of it.
    pub trust: Trust,
    /// What is known before anything is tested.
    pub known: Known<'a>,
    /// The arm as found so far.
    pub arm: Arm,
    /// Logs that are identified from.
    pub train: Side,
    /// Logs to judge by.
    pub test: Side,
    /// Cut-off of the positions' low-pass, Hz.
    pub cutoff_hz: f64,
}

/// An effect in the model, with what it takes there.
#[derive(Debug, Clone)]
pub struct Member {
    /// The effect with its parameters as estimated.
    pub placed: Placed,
    /// Standard deviation of every parameter; zero for those held.
    pub std: Vec<f64>,
    /// Where its columns are taken.
    pub candidate: Candidate,
    /// Factors of the columns.
    pub factors: Vec<f64>,
}

/// The noise under a model and the model's fit in its units.
#[derive(Debug, Clone)]
pub struct Noise {
    /// Makes the noise white.
    pub whitener: Whitener,
    /// The fit of the model.
    pub fit: Projection,
}

/// A candidate with its test in some whitening.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The candidate.
    pub candidate: Candidate,
    /// Its columns, whitened.
    pub whitened: Vec<Column>,
    /// Its test.
    pub test: Test,
}

impl<'a> Session<'a> {
    /// Makes the logs ready.
    ///
    /// # Errors
    /// If a log is too short or a joint hardly moves.
    pub fn new(model: &'a Model, trust: Trust, train: &[&Recording], test: &[&Recording]) -> Result<Self> {
        Self::knowing(model, trust, Known::nothing(model.robot(), trust), train, test)
    }

    /// Makes the logs ready with what is known beside the robot description.
    ///
    /// # Errors
    /// If a log is too short or a joint hardly moves.
    pub fn knowing(
        model: &'a Model,
        trust: Trust,
        known: Known<'a>,
        train: &[&Recording],
        test: &[&Recording],
    ) -> Result<Self> {
        let arm = known.arm.clone();
        let before = known.reference.len();
        let train: Vec<&Recording> = known.reference.iter().chain(train).copied().collect();
        let (train, all): (&[&Recording], Vec<&Recording>) = (&train, train.iter().chain(test).copied().collect());
        let side = |logs: &[&Recording], before: usize, cutoff_hz: f64, fewest: usize| -> Result<Side> {
            let mut rows = Rows::new(logs, cutoff_hz, fewest)?;
            rows.before = before;
            let mut torque = Column::new(rows.torque.iter().cloned());
            torque.add(-1.0, &arm.believed(&rows));
            torque.add(-1.0, &known.torque(&rows)?);
            let mut baseline = arm.baseline(model, &rows);
            baseline.extend(known.derivatives(&rows)?);
            Ok(Side { baseline, torque, rows, training: fewest == FEWEST_ROWS })
        };
        // The torque itself tells which cut-off serves it best: too low distorts the accelerations, too high lets the
        // encoder's noise into them.
        let both = |hz: f64| -> Result<[Side; 2]> {
            Ok([side(train, before, hz, FEWEST_ROWS)?, side(test, 0, hz, FEWEST_TEST_ROWS)?])
        };
        let mut best: Option<(f64, f64, [Side; 2])> = None;
        for hz in cutoffs_up_to(cutoff(&all)?) {
            let Ok(sides) = both(hz) else { continue };
            let [Side { rows, torque, baseline, .. }, _] = &sides;
            let unexpected = Whitener::new(rows, torque, baseline, Beside::RichColumns).mean_log_scale();
            tracing::debug!(hz, unexpected, "cut-off");
            if best.as_ref().is_none_or(|(least, ..)| unexpected < *least) {
                best = Some((unexpected, hz, sides));
            }
        }
        let (cutoff_hz, [train, test]) = match best {
            Some((_, hz, sides)) => (hz, sides),
            // No cut-off leaves enough rows; the widest tells best why.
            None => (WIDEST_HZ, both(WIDEST_HZ)?),
        };
        Ok(Session { model, trust, known, arm, train, test, cutoff_hz })
    }

    /// Takes the arm's parameters from `robot` instead of from a fit.
    pub fn believe(&mut self, robot: &Robot) {
        self.arm = Arm::new(robot, self.trust);
    }

    /// Largest torque of a joint of the arm as found, on the training rows, N m.
    pub fn largest_torque(&self, joint: usize) -> f64 {
        let torque = self.arm.all_torque(&self.train.rows);
        torque.part(joint).unwrap_or_default().iter().fold(0.0f64, |m, v| m.max(v.abs()))
    }

    /// Columns of the model with effects: baseline, every effect's columns, derivatives to their shapes.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn all_columns(&self, side: &Side, members: &[Member]) -> Result<Vec<Column>> {
        let mut all = side.baseline.clone();
        for member in members {
            if side.training || member.candidate.log.is_none() {
                let Candidate { placed, log, .. } = &member.candidate;
                all.extend(columns_in(&self.arm, &side.rows, *log, std::slice::from_ref(placed))?.concat());
                all.extend(self.tangents(side, &member.candidate, &member.factors)?);
            } else {
                // What happened in a training log did not happen here.
                let effect = member.placed.effect;
                all.extend(vec![Column::default(); linear(effect).len() + shapes(effect).len()]);
            }
        }
        Ok(all)
    }

    /// Derivatives of an effect's torque to its shapes.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn tangents(&self, side: &Side, candidate: &Candidate, factors: &[f64]) -> Result<Vec<Column>> {
        let Candidate { placed, log, .. } = candidate;
        let mut tangents = Vec::new();
        for index in shapes(placed.effect) {
            let parameter = &placed.effect.parameters()[index];
            let step = DIFFERENCE * placed.parameters[index].abs().max(0.1 * parameter.typical.abs());
            let moved = |by: f64| {
                let mut moved = placed.clone();
                moved.parameters[index] = bounded(parameter, placed.parameters[index] + by);
                moved
            };
            let (ahead, behind) = (moved(step), moved(-step));
            let apart = ahead.parameters[index] - behind.parameters[index];
            let both = columns_in(&self.arm, &side.rows, *log, &[ahead, behind])?;
            let mut tangent = combined(&both[0], factors);
            tangent.add(-1.0, &combined(&both[1], factors));
            tangent.scale(1.0 / apart);
            tangents.push(tangent);
        }
        Ok(tangents)
    }

    /// The noise under the columns of a model, each joint's grown to what the model leaves there where that is more: a joint
    /// that is understood badly must not lend its excess to what is tested on it, nor pull at parameters it shares.
    pub fn noise_under(&self, present: &[Column]) -> Noise {
        self.noise_beside(present, Beside::RichColumns)
    }

    fn noise_beside(&self, present: &[Column], beside: Beside) -> Noise {
        let mut whitener = Whitener::new(&self.train.rows, &self.train.torque, present, beside);
        let mut fit = whitener.fit(present, &self.train.torque);
        for _ in 0..MISFIT_ROUNDS {
            let excess: Vec<f64> = whitener
                .rows()
                .into_iter()
                .enumerate()
                .map(|(joint, count)| {
                    let left: f64 = fit.residual.part(joint).unwrap_or_default().iter().map(|r| r * r).sum();
                    left / count.max(1) as f64
                })
                .collect();
            if excess.iter().all(|mean| *mean < MISFIT) {
                break;
            }
            let factors: Vec<f64> = excess.iter().map(|mean| mean.max(1.0).sqrt()).collect();
            whitener = whitener.with_misfit(&factors);
            fit = whitener.fit(present, &self.train.torque);
        }
        Noise { whitener, fit }
    }

    /// Tests a candidate; None where it cannot be told from what the fit has, or its estimate makes no sense.
    pub fn judge(&self, candidate: &Candidate, whitener: &Whitener, fit: &Projection) -> Option<Judged> {
        let mut candidate = candidate.clone();
        let mut whitened = whitener.apply_all(&candidate.columns);
        let effect = candidate.placed.effect;
        let change = self.train.rows.before > 0;
        let spread = bodies::prior(self.model.robot(), &candidate.placed);
        loop {
            let test = fit.test_with_prior(&whitened, &spread)?;
            if !test.values.iter().all(|value| value.is_finite()) {
                return None;
            }
            if is_physical(&candidate, &test, change) {
                let mut placed = candidate.placed.clone();
                linear(effect).iter().zip(&test.values).for_each(|(&index, &value)| placed.parameters[index] = value);
                let believable = is_level(effect)
                    || bodies::is_believable(self.model.robot(), &placed) && self.is_in_proportion(&candidate, &test);
                return believable.then_some(Judged { candidate, whitened, test });
            }
            // An amplitude beyond its bound is one that is not there; the others may do without it.
            let parameters = effect.parameters();
            let beyond = linear(effect).into_iter().enumerate().filter(|(k, index)| {
                let Parameter { role, lower, upper, .. } = parameters[*index];
                let there = role == Role::Amplitude && !whitened[*k].parts.is_empty();
                there && lower <= 0.0 && upper >= 0.0 && !(lower..=upper).contains(&test.values[*k])
            });
            let (worst, _) = beyond.max_by(|(a, _), (b, _)| {
                (test.values[*a] / test.std[*a]).abs().total_cmp(&(test.values[*b] / test.std[*b]).abs())
            })?;
            candidate.columns[worst] = Column::default();
            whitened[worst] = Column::default();
            if !whitened.iter().any(Column::is_sound) {
                return None;
            }
        }
    }

    /// Whether the torque of an estimate is not more than what can be of its joint's.
    fn is_in_proportion(&self, candidate: &Candidate, test: &Test) -> bool {
        let Some(share) = bodies::largest_share(&candidate.placed) else { return true };
        let valid = &self.train.rows.valid;
        let joint = candidate.placed.joint;
        let of_effect = rms(valid, &combined(&candidate.columns, &test.values))[joint];
        let all = Column::on(joint, self.train.rows.torque[joint].clone());
        of_effect <= share * rms(valid, &all)[joint]
    }

    /// Moves the shapes and sizes of a candidate to where its test is largest.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn refined(&self, start: Judged, whitener: &Whitener, fit: &Projection) -> Result<Judged> {
        let effect = start.candidate.placed.effect;
        let (log, joint) = (start.candidate.log, start.candidate.placed.joint);
        let mut best = start;
        let at = |placed: Placed| -> Result<Option<Judged>> {
            let columns = columns_in(&self.arm, &self.train.rows, log, std::slice::from_ref(&placed))?.concat();
            Ok(self.judge(&Candidate { placed, log, columns }, whitener, fit))
        };
        let shapes = shapes(effect);
        let mut share = 0.25;
        for _ in 0..HALVINGS {
            for &index in &shapes {
                let parameter = &effect.parameters()[index];
                for sign in [1.0, -1.0] {
                    let mut placed = best.candidate.placed.clone();
                    let value = &mut placed.parameters[index];
                    let wanted = moved(parameter, *value, sign * share);
                    *value = within_bounds(effect, index, wanted, joint, &self.train.rows);
                    if let Some(judged) = at(placed)?
                        && judged.test.statistic > best.test.statistic
                    {
                        best = judged;
                        break;
                    }
                }
            }
            share *= 0.5;
            if shapes.is_empty() {
                break;
            }
        }
        let departs = linear(effect).iter().any(|&k| effect.parameters()[k].role == Role::Departure);
        for _ in 0..if departs && !is_level(effect) { SECANTS } else { 0 } {
            let mut placed = best.candidate.placed.clone();
            for (&index, &value) in linear(effect).iter().zip(&best.test.values) {
                let parameter = &effect.parameters()[index];
                // A size of next to nothing drowns in rounding.
                let least = 1e-3 * parameter.typical.abs();
                let size = if value.abs() < least { least } else { value };
                placed.parameters[index] = bounded(parameter, size);
            }
            match at(placed)? {
                Some(judged) => best = judged,
                None => break,
            }
        }
        Ok(best)
    }

    /// Solves for all parameters with the members in the model and writes the estimates back; the arm takes its own.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn settle(&mut self, members: &mut [Member], whitener: &Whitener) -> Result<()> {
        let columns = self.all_columns(&self.train, members)?;
        let solved = solve(&whitener.apply_all(&columns), &whitener.apply(&self.train.torque));
        self.arm.take(self.model, &solved.values);
        let mut place = self.train.baseline.len();
        for member in members {
            let effect = member.placed.effect;
            for (k, index) in linear(effect).into_iter().enumerate() {
                member.factors[k] = solved.values[place];
                if !is_level(effect) {
                    member.placed.parameters[index] = solved.values[place];
                    member.std[index] = solved.std[place];
                }
                place += 1;
            }
            for index in shapes(effect) {
                member.placed.parameters[index] = member.candidate.placed.parameters[index];
                member.std[index] = solved.std[place];
                place += 1;
            }
        }
        Ok(())
    }

    /// What the model leaves on the held-out rows when it is fitted to the training rows.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn held_out_residual(&self, members: &[Member], whitener: &Whitener) -> Result<Column> {
        self.residual_on(&self.test, members, whitener)
    }

    /// What the model leaves on either kind of rows.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn residual_on(&self, side: &Side, members: &[Member], whitener: &Whitener) -> Result<Column> {
        let columns = self.all_columns(&self.train, members)?;
        let solved = solve(&whitener.apply_all(&columns), &whitener.apply(&self.train.torque));
        let mut residual = side.torque.clone();
        for (column, value) in self.all_columns(side, members)?.iter().zip(solved.values) {
            residual.add(-value, column);
        }
        Ok(residual)
    }
}

impl Member {
    /// A judged candidate as part of the model.
    pub fn new(judged: &Judged) -> Self {
        let placed = judged.candidate.placed.clone();
        Member {
            std: vec![0.0; placed.parameters.len()],
            factors: judged.test.values.clone(),
            candidate: judged.candidate.clone(),
            placed,
        }
    }
}

/// A least-squares solution.
#[derive(Debug, Clone)]
pub struct Solved {
    /// Factors of the columns.
    pub values: Vec<f64>,
    /// Their standard deviations.
    pub std: Vec<f64>,
}

/// Fits whitened torque by whitened columns; directions that the rows cannot tell are left at zero.
pub fn solve(columns: &[Column], torque: &Column) -> Solved {
    let count = columns.len();
    let norms: Vec<f64> = columns.iter().map(|c| c.dot(c).sqrt()).map(|n| if n > 0.0 { n } else { 1.0 }).collect();
    let mut gram =
        DMatrix::from_fn(
            count,
            count,
            |r, c| {
                if r <= c { columns[r].dot(&columns[c]) / (norms[r] * norms[c]) } else { 0.0 }
            },
        );
    gram.fill_lower_triangle_with_upper_triangle();
    let right = DVector::from_fn(count, |k, _| columns[k].dot(torque) / norms[k]);
    let eigen = SymmetricEigen::new(gram);
    let least = SINGULAR * eigen.eigenvalues.max();
    let inverse = DVector::from_fn(count, |k, _| {
        let value = eigen.eigenvalues[k];
        if value > least { 1.0 / value } else { 0.0 }
    });
    let rotated = eigen.eigenvectors.tr_mul(&right).component_mul(&inverse);
    let values = &eigen.eigenvectors * rotated;
    let variance = |k: usize| -> f64 {
        eigen.eigenvectors.row(k).iter().zip(inverse.iter()).map(|(v, inverse)| v * v * inverse).sum()
    };
    Solved {
        values: values.iter().zip(&norms).map(|(value, norm)| value / norm).collect(),
        std: (0..count).map(|k| variance(k).sqrt() / norms[k]).collect(),
    }
}

/// Whether the estimate can be: within its bounds to within its uncertainty. A `change` of an amplitude may go either way.
fn is_physical(candidate: &Candidate, test: &Test, change: bool) -> bool {
    let effect = candidate.placed.effect;
    if is_level(effect) {
        let sizes = linear(effect).into_iter().map(|index| candidate.placed.parameters[index]);
        return test.values.iter().zip(sizes).all(|(value, size)| LEVEL_FACTOR.contains(&(value / size)));
    }
    if candidate.one_sided() && !change && test.values[0] <= 0.0 {
        return false;
    }
    if let [only] = linear(effect)[..]
        && bends(effect, only)
    {
        // The column is that of one size; an estimate of another size is of something else. The smallest column is as good
        // as straight, and stands for everything below it.
        let (size, smallest) = (candidate.placed.parameters[only], straight_below(effect, only));
        let share = test.values[0] / size;
        if !(share.abs() < SIZE_FACTOR && (share > 1.0 / SIZE_FACTOR || size.abs() <= smallest)) {
            return false;
        }
    }
    let estimates = test.values.iter().zip(&test.std);
    linear(effect).into_iter().zip(estimates).all(|(index, (value, std))| {
        let Parameter { lower, upper, role, .. } = effect.parameters()[index];
        (change && role == Role::Amplitude)
            || (value + BEYOND_BOUND * std >= lower && value - BEYOND_BOUND * std <= upper)
    })
}

/// A value moved by a share of itself where it is positive and wide, else of its range.
fn moved(parameter: &Parameter, value: f64, share: f64) -> f64 {
    let (low, high) = (parameter.lower, parameter.upper);
    match parameter.unit {
        "1/turn" => value + 2.0 * share,
        "s" if low == 0.0 => value + 4.0 * share,
        _ if low >= 0.0 && (low == 0.0 || high / low > 10.0) => value * (4.0 * share).exp(),
        _ => value + 0.4 * share * (high - low),
    }
}

fn bounded(parameter: &Parameter, value: f64) -> f64 {
    value.clamp(parameter.lower, parameter.upper)
}
