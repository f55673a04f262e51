//! Whether training logs agree on a parameter.
//!
//! A log by itself hardly determines all parameters, and what one of them lacks the others make up for. So one parameter at a time is left
//! to differ between the logs, all others being common: with a column for each log its estimates solve the normal equations of these
//! columns, the others projected out. Their covariance is cluster-robust, the clusters being blocks of a few seconds (Cameron and Miller,
//! A practitioner's guide to cluster-robust inference, Journal of Human Resources 50, 2015): what a model lacks is not white. With more
//! parameters than blocks a fit takes much of the residual of each, so that it is the one without the block in the fit (CR3, the
//! jackknife).

use super::blocks::{blocks_of, log_rows};
use crate::error::Result;
use crate::identification::numerics::scaled_normal::ScaledNormal;
use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::linear_problem::LinearProblem;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::ops::Range;

/// Rows of a log that are looked at: few determine whether a parameter is another.
const ROWS: usize = 4000;

/// Length of a block, s, longer than the correlation time of the residual; and fewest blocks of a log.
const BLOCK_S: f64 = 4.0;
const FEWEST_BLOCKS: f64 = 5.0;

/// Family-wise level at which logs disagree, shared among the parameters (Holm, Scandinavian Journal of Statistics 6, 1979), and the level
/// of the test that a single change is all of it.
const DISAGREE: f64 = 0.05;

/// Share of the torque of a joint, root mean square, that the error of a parameter may make for it to be pinned, and share of its value
/// for one that makes less torque: a simulation shows no more.
const OF_TORQUE: f64 = 0.02;
const OF_VALUE: f64 = 0.1;

/// Share of the torque of a joint from which a spread between logs counts: half of what a simulation shows, since it may grow from log to
/// log.
const SPREAD: f64 = 0.01;

/// Estimates of a parameter by all logs.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::effect_model::{Preparation, Trust};
/// use tauscope::identification::fit::{Logs, fit_effects};
/// use tauscope::identification::model::Model;
/// use tauscope::identification::fit::Agreement;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
/// # let other = recording::load("../tests/reference/payload/nothing.csv", None)?;
///
/// // Three logs of one arm. From the second on joint j1 has 2 N m more Coulomb friction.
/// let (mut second, mut third) = (other.clone(), log.clone());
/// for log in [&mut second, &mut third] {
///     let speed: Vec<f64> = log.q.channel(0).windows(2).map(|pair| pair[1] - pair[0]).collect();
///     log.tau.channel_mut(0).iter_mut().zip(speed).for_each(|(torque, speed)| *torque += 2.0 * speed.signum());
/// }
/// let logs = Logs { train: &[&log, &second, &third], test: &[] };
/// let fit = fit_effects(&Model::new(&robot), Trust::Structure, logs, Preparation::usual(&log), Vec::new())?.fit;
/// let friction = fit.names.iter().position(|name| name == "Fc1").expect("friction is a base parameter");
/// let agreement = fit.between_logs[friction].as_ref().expect("there are several logs").agreement;
/// assert_eq!(agreement, Agreement::Changed { after: 1 });
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case", tag = "verdict")]
pub enum Agreement {
    /// They agree, or differ by less than matters, and it is known well enough.
    Pinned,
    /// It is not known well enough, or differs between logs without order.
    NotPinned,
    /// It is one value up to a log and another after it.
    Changed {
        /// Number of logs before the change.
        after: usize,
    },
}

/// A parameter in each log, all others being common.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::effect_model::{Preparation, Trust};
/// use tauscope::identification::fit::{Logs, fit_effects};
/// use tauscope::identification::model::Model;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
/// # let other = recording::load("../tests/reference/payload/nothing.csv", None)?;
///
/// // The friction of joint j1 in each of two logs of the same arm, everything else being common.
/// let logs = Logs { train: &[&log, &other], test: &[] };
/// let fit = fit_effects(&Model::new(&robot), Trust::Structure, logs, Preparation::usual(&log), Vec::new())?.fit;
/// let friction = fit.names.iter().position(|name| name == "Fc1").expect("friction is a base parameter");
/// let between = fit.between_logs[friction].as_ref().expect("there are several logs");
/// assert!((between.values[0] - between.values[1]).abs() < 4.0 * between.std[0].hypot(between.std[1]));
/// assert!(between.p > 1e-3);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct BetweenLogs {
    /// Its value in each log.
    pub values: Vec<f64>,
    /// Standard deviation of each by the scatter between blocks of all logs.
    pub std: Vec<f64>,
    /// Standard deviation between logs beyond that.
    pub spread: f64,
    /// p-value of one value in all of them.
    pub p: f64,
    /// What that comes to.
    #[serde(flatten)]
    pub agreement: Agreement,
}

/// Sums over a block of rows.
struct Block {
    log: usize,
    /// J'W J.
    normal: DMatrix<f64>,
    /// J'W r.
    score: DVector<f64>,
    /// Makes of a score the one of the fit without this block: (I - J'W J N^-1)^-1.
    without: DMatrix<f64>,
}

/// Normal matrices of the logs, and the scores of their blocks, of one fit.
struct Sums<'a> {
    normals: Vec<DMatrix<f64>>,
    blocks: Vec<Block>,
    inverse: DMatrix<f64>,
    beta: &'a [f64],
    /// Torque of the joints that a unit of a parameter makes, as a share of theirs, on the joint where that is most.
    reach: Vec<f64>,
}

/// A parameter in each log with the covariance of these values, not judged yet.
struct Tested {
    values: Vec<f64>,
    std: Vec<f64>,
    spread: f64,
    p: f64,
    covariance: DMatrix<f64>,
}

/// Every parameter of a weighted fit, `beta` with the standard deviations `sigma` of the joints, in each of several logs, whose rows have
/// these `times`; None where the logs do not separate it.
///
/// # Errors
/// If the logs together do not separate the parameters.
pub(super) fn between_logs(
    joints: &[JointRegression],
    [beta, sigma]: [&[f64]; 2],
    times: &[f64],
    names: &[String],
) -> Result<Vec<Option<BetweenLogs>>> {
    let logs = log_rows(times);
    if logs.len() < 2 {
        return Ok(vec![None; names.len()]);
    }
    let sums = Sums::new(joints, [beta, sigma], times, &logs, names)?;
    let tested: Vec<Option<Tested>> = (0..names.len()).map(|k| sums.of(k)).collect();
    let mut order: Vec<usize> = (0..names.len()).filter(|&k| tested[k].is_some()).collect();
    let p = |k: usize| tested[k].as_ref().map_or(1.0, |tested| tested.p);
    order.sort_by(|&a, &b| p(a).total_cmp(&p(b)));
    let disagree = order.iter().enumerate().take_while(|(place, k)| p(**k) <= DISAGREE / (order.len() - place) as f64);
    let disagree: Vec<usize> = disagree.map(|(_, &k)| k).collect();
    let judged = tested.into_iter().enumerate().map(|(k, tested)| {
        let tested = tested?;
        let agreement = sums.agreement(k, &tested, disagree.contains(&k));
        let Tested { values, std, spread, p, .. } = tested;
        Some(BetweenLogs { values, std, spread, p, agreement })
    });
    Ok(judged.collect())
}

impl<'a> Sums<'a> {
    fn new(
        joints: &[JointRegression],
        [beta, sigma]: [&'a [f64]; 2],
        times: &[f64],
        logs: &[Range<usize>],
        names: &[String],
    ) -> Result<Self> {
        let count = names.len();
        let (mut normals, mut sums) = (Vec::new(), Vec::new());
        for (log, rows) in logs.iter().enumerate() {
            let step = rows.len().div_ceil(ROWS).max(1);
            let mut normal = DMatrix::zeros(count, count);
            let seconds = times[rows.end - 1] - times[rows.start];
            for block in blocks_of(rows, (seconds / BLOCK_S).floor().max(FEWEST_BLOCKS) as usize) {
                let parts: Vec<JointRegression> = joints.iter().map(|joint| joint.part(block.clone(), step)).collect();
                let problem = LinearProblem::new(&parts, sigma, count);
                let residuals: Vec<Vec<f64>> = parts.iter().map(|part| part.residual(beta)).collect();
                normal += problem.normal();
                sums.push((log, problem.normal().clone(), problem.right(&residuals)));
            }
            normals.push(normal);
        }
        let all: DMatrix<f64> = normals.iter().sum();
        let inverse = ScaledNormal::new(&all, names)?.inverse();
        let blocks = sums.into_iter().map(|(log, normal, score)| {
            // Where one block alone determines a parameter there is no fit without it, and no standard deviation.
            let without = (DMatrix::identity(count, count) - &normal * &inverse).try_inverse();
            let without = without.unwrap_or_else(|| DMatrix::from_element(count, count, f64::NAN));
            Block { log, normal, score, without }
        });
        let blocks = blocks.collect();
        let mut reach = vec![0.0f64; count];
        for joint in joints {
            let torque = joint.dot(&joint.torque, &joint.torque);
            for (&parameter, column) in joint.parameters.iter().zip(joint.columns.iter()) {
                let own = (joint.dot(column, column) / torque).sqrt();
                reach[parameter] = reach[parameter].max(if own.is_finite() { own } else { 0.0 });
            }
        }
        Ok(Sums { normals, blocks, inverse, beta, reach })
    }

    /// A parameter in each log; None where these do not separate it.
    fn of(&self, k: usize) -> Option<Tested> {
        let logs = self.normals.len();
        let columns: Vec<DVector<f64>> = self.normals.iter().map(|normal| normal.column(k).into_owned()).collect();
        let cross = DMatrix::from_columns(&columns);
        let projected = &self.inverse * &cross;
        let mut gram = -cross.tr_mul(&projected);
        (0..logs).for_each(|log| gram[(log, log)] += self.normals[log][(k, k)]);
        // A value that is common to all logs is in the fit already: that direction is none of the differences.
        let inverse = gram.clone().pseudo_inverse(1e-9 * gram.diagonal().max()).ok()?;
        let of_columns = |log: usize, score: &DVector<f64>| {
            let mut own = -projected.tr_mul(score);
            own[log] += score[k];
            own
        };
        let scores: DVector<f64> = self.blocks.iter().map(|block| of_columns(block.log, &block.score)).sum();
        let differences = &inverse * scores;
        // What differs is no scatter: the scores are those of the residual with the differences in the model.
        let common = &projected * &differences;
        let mut scatter = DMatrix::zeros(logs, logs);
        for Block { log, normal, score, without } in &self.blocks {
            let explained = normal.column(k) * differences[*log] - normal * &common;
            let own = of_columns(*log, &(without * (score - explained)));
            scatter += &own * own.transpose();
        }
        let blocks = self.blocks.len() as f64;
        let covariance = &inverse * scatter * &inverse * ((blocks - 1.0) / blocks);
        let std: Vec<f64> = (0..logs).map(|log| covariance[(log, log)].max(0.0).sqrt()).collect();
        if !std.iter().all(|std| std.is_finite() && *std > 0.0) {
            return None;
        }
        let p = self.p(&differences, &covariance)?;
        let between = differences.norm_squared() - covariance.trace();
        Some(Tested {
            values: differences.iter().map(|difference| self.beta[k] + difference).collect(),
            std,
            spread: (between.max(0.0) / (logs - 1) as f64).sqrt(),
            p,
            covariance,
        })
    }

    /// p-value of differences that are zero, of which one less than there are is free.
    fn p(&self, differences: &DVector<f64>, covariance: &DMatrix<f64>) -> Option<f64> {
        let freedom = differences.len().checked_sub(1).filter(|freedom| *freedom > 0)?;
        let largest = covariance.diagonal().max();
        let inverse = covariance.clone().pseudo_inverse(1e-9 * largest).ok()?;
        let statistic = differences.dot(&(inverse * differences)) / freedom as f64;
        let law = FisherSnedecor::new(freedom as f64, self.blocks.len() as f64 - 1.0).ok()?;
        statistic.is_finite().then(|| law.sf(statistic))
    }

    fn agreement(&self, k: usize, found: &Tested, disagree: bool) -> Agreement {
        let error = |size: f64| size * self.reach[k] > OF_TORQUE && size > OF_VALUE * self.beta[k].abs();
        if disagree && found.spread * self.reach[k] > SPREAD {
            let values = DVector::from_column_slice(&found.values);
            let logs = values.len();
            let alike = |rows: Range<usize>| {
                let (own, part) =
                    (values.rows_range(rows.clone()), found.covariance.view_range(rows.clone(), rows.clone()));
                let about_mean = own.add_scalar(-own.mean());
                // Differences from the mean, of which the covariance is that of the values less that of their mean.
                let centre = DMatrix::identity(rows.len(), rows.len()).add_scalar(-1.0 / rows.len() as f64);
                rows.len() < 2 || self.p(&about_mean, &(&centre * part * &centre)).is_some_and(|p| p > DISAGREE)
            };
            let apart = |after: usize| {
                let mean = |rows: Range<usize>| values.rows_range(rows).mean();
                (mean(after..logs) - mean(0..after)).abs()
            };
            let changes = (1..logs).filter(|&after| alike(0..after) && alike(after..logs));
            return match changes.max_by(|&a, &b| apart(a).total_cmp(&apart(b))) {
                Some(after) => Agreement::Changed { after },
                None => Agreement::NotPinned,
            };
        }
        // The error of the common value: that of the values over the root of their number.
        let squares: f64 = found.std.iter().map(|std| std * std).sum();
        match error((squares / (found.std.len() * found.std.len()) as f64).sqrt()) {
            true => Agreement::NotPinned,
            false => Agreement::Pinned,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};

    const LOG: usize = 2000;

    /// Logs of 20 s of friction in the direction of motion, of which each has its own, of a wave, and of `more` slow ones that play no
    /// part; noise of one.
    fn logs(friction: &[f64], more: usize, seed: u64) -> (JointRegression, Vec<f64>) {
        let mut source = random::stream(seed, "between logs", 0);
        let rows = LOG * friction.len();
        let wave = |rate: f64| (0..rows).map(|k| (rate * k as f64).sin()).collect::<Vec<f64>>();
        let mut columns = vec![(0..rows).map(|k| (0.017 * k as f64).cos().signum()).collect(), wave(0.031)];
        columns.extend((0..more).map(|k| wave(0.0013 * (k + 1) as f64)));
        let torque = (0..rows).map(|k| {
            let noise: f64 = StandardNormal.sample(&mut source);
            friction[k / LOG] * columns[0][k] - 9.0 * columns[1][k] + noise
        });
        let torque = torque.collect();
        let joint = JointRegression {
            joint: "a".into(),
            parameters: (0..columns.len()).collect(),
            columns: Channels::from_vectors(&columns),
            torque,
            valid: vec![true; rows],
        };
        // Logs begin at zero: a row without a time is between them in a fit.
        let times = (0..rows).map(|k| if k % LOG == 0 { f64::NAN } else { 0.01 * (k % LOG) as f64 });
        (joint, times.collect())
    }

    fn found(friction: &[f64], seed: u64) -> Vec<Option<BetweenLogs>> {
        found_among(friction, 0, seed)
    }

    fn found_among(friction: &[f64], more: usize, seed: u64) -> Vec<Option<BetweenLogs>> {
        let (joint, times) = logs(friction, more, seed);
        let names: Vec<String> = (0..2 + more).map(|k| k.to_string()).collect();
        let normal = LinearProblem::new(std::slice::from_ref(&joint), &[1.0], names.len());
        let right = normal.right(std::slice::from_ref(&joint.torque));
        let beta = normal.solve(&right, &names).unwrap();
        between_logs(&[joint], [beta.as_slice(), &[1.0]], &times, &names).unwrap()
    }

    #[test]
    fn a_change_shows_after_which_log_and_by_how_much() {
        let all = found(&[3.0, 3.0, 4.0, 4.0], 1);
        let friction = all[0].as_ref().unwrap();
        assert_eq!(friction.agreement, Agreement::Changed { after: 2 });
        for (value, truth) in friction.values.iter().zip([3.0, 3.0, 4.0, 4.0]) {
            assert!((value - truth).abs() < 0.15, "{friction:?}");
        }
        assert!((friction.spread - 0.5 * (4.0f64 / 3.0).sqrt()).abs() < 0.1, "{friction:?}");
        assert_eq!(all[1].as_ref().unwrap().agreement, Agreement::Pinned, "the wave is the same in all");
        let to_and_fro = found(&[3.0, 4.0, 3.0, 4.0], 2);
        assert_eq!(to_and_fro[0].as_ref().unwrap().agreement, Agreement::NotPinned);
        // It differs significantly and makes less than 1 % of the torque.
        let little = found(&[3.0, 3.0, 3.08, 3.08], 3);
        let little = little[0].as_ref().unwrap();
        assert!(little.p < 0.05 && little.agreement == Agreement::Pinned, "{little:?}");
    }

    #[test]
    fn more_parameters_than_blocks_do_not_make_logs_disagree() {
        let p = |seed: u64| found_among(&[3.0; 3], 24, 900 + seed)[0].as_ref().map_or(1.0, |found| found.p);
        let below = (0..60).map(p).filter(|p| *p < 0.1).count();
        // 6 are expected at most, with a standard deviation of 2.3.
        assert!(below <= 12, "{below}");
    }

    #[test]
    fn one_value_in_all_logs_is_rejected_as_often_as_asked() {
        let p: Vec<f64> = (0..200).map(|seed| found(&[3.0; 3], 100 + seed)[0].as_ref().unwrap().p).collect();
        let below = p.iter().filter(|p| **p < 0.1).count();
        // 20 are expected, with a standard deviation of 4.2.
        assert!((8..=33).contains(&below), "{below}");
        let (joint, times) = logs(&[3.0], 0, 5);
        let names = ["friction", "wave"].map(str::to_owned);
        assert_eq!(between_logs(&[joint], [&[3.0, -9.0], &[1.0]], &times, &names).unwrap(), [None, None]);
    }
}
