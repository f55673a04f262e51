//! Weighted least squares along a motion without a regressor: blocks of base columns go from the kernel that makes them
//! straight into one Gram matrix per joint, from which the solution for any weights follows.
//!
//! For signals that are smooth already and need no filter of torque and columns. The sums of fixed sections of the log are
//! put together in their order, so that the result does not depend on the number of threads.

use super::inverse_dynamics::Model;
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::error::{Error, Result};
use crate::identification::numerics::gram::Gram;
use crate::identification::numerics::tsqr::Triangle;
use crate::identification::regression::joint_sums::{JointSums, Sums};
use crate::identification::regression::least_squares::REWEIGHTINGS;
use crate::lane::{Aligned, Lanes};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::ops::Range;

/// Samples in the cache at once.
const BLOCK: usize = super::base_columns::BLOCK;

/// Most blocks of a section that one thread does: many of them to a log, so that threads are done at about the same time.
const SECTION: usize = 21;

/// A motion with the torque it took.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dynamics::Motion;
/// use tauscope::identification::fused::{self, Log};
/// use tauscope::identification::model::Model;
/// use tauscope::robot::{self, InertiaCheck};
/// # let mut motion = Motion::zeros(1, 400);
/// # for k in 0..400 {
/// #     let (t, [a, b]) = (0.01 * k as f64, [1.0f64, 2.3]);
/// #     motion.q.set(k, &[(a * t).sin() + 0.5 * (b * t).cos()]);
/// #     motion.qd.set(k, &[a * (a * t).cos() - 0.5 * b * (b * t).sin()]);
/// #     motion.qdd.set(k, &[-a * a * (a * t).sin() - 0.5 * b * b * (b * t).cos()]);
/// # }
/// # let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
///
/// // The first half of a log alone counts.
/// let model = Model::new(&pendulum);
/// let truth = model.base().values(&Model::standard_values(&pendulum));
/// let mut torque = fused::predicted(&model, &motion, &truth);
/// torque.channel_mut(0)[200..].fill(0.0);
/// let valid = [(0..400).map(|k| k < 200).collect()];
/// let log = Log { motion: &motion, torque: &torque, valid: Some(&valid) };
/// let found = fused::weighted_least_squares(&model, log)?.beta;
/// assert!(found.iter().zip(&truth).all(|(found, truth)| (found - truth).abs() < 1e-6));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Log<'a> {
    /// Positions, velocities and accelerations.
    pub motion: &'a Motion,
    /// Torque, `[joint][time]`.
    pub torque: &'a Channels,
    /// Samples that count, for every joint; all of them where absent.
    pub valid: Option<&'a [Vec<bool>]>,
}

/// Base parameters with what white noise in the torque makes of them.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dynamics::Motion;
/// use tauscope::identification::fused::{self, Log};
/// use tauscope::identification::model::Model;
/// use tauscope::robot::{self, InertiaCheck};
/// # let mut motion = Motion::zeros(1, 400);
/// # for k in 0..400 {
/// #     let (t, [a, b]) = (0.01 * k as f64, [1.0f64, 2.3]);
/// #     motion.q.set(k, &[(a * t).sin() + 0.5 * (b * t).cos()]);
/// #     motion.qd.set(k, &[a * (a * t).cos() - 0.5 * b * (b * t).sin()]);
/// #     motion.qdd.set(k, &[-a * a * (a * t).sin() - 0.5 * b * b * (b * t).cos()]);
/// # }
/// # let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
///
/// // 4 s of torque with a noise of 0.1 N m: the errors are as large as the covariance indicates.
/// let model = Model::new(&pendulum);
/// let truth = model.base().values(&Model::standard_values(&pendulum));
/// let mut torque = fused::predicted(&model, &motion, &truth);
/// let mut noise = [0.0; 400];
/// tauscope::random::normals(1, "torque", 0).fill(&mut noise);
/// torque.channel_mut(0).iter_mut().zip(noise).for_each(|(torque, noise)| *torque += 0.1 * noise);
///
/// let found = fused::weighted_least_squares(&model, Log { motion: &motion, torque: &torque, valid: None })?;
/// assert!((found.sigma[0] - 0.1).abs() < 0.01);
/// let deviations = (0..5).map(|k| (found.beta[k] - truth[k]) / found.covariance[(k, k)].sqrt());
/// assert!(deviations.into_iter().all(|deviation| deviation.abs() < 4.0));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Solution {
    /// Base parameters.
    pub beta: Vec<f64>,
    /// Their covariance, if the residual is white noise.
    pub covariance: DMatrix<f64>,
    /// Standard deviation of the residual of each joint, N m.
    pub sigma: Vec<f64>,
    /// Condition number of the regressor with rows divided by sigma and columns of unit length.
    pub condition_number: f64,
}

/// Weighted least squares, the weights from each joint's own residual.
///
/// A residual below a thousandth of the torque is not resolved: the joint is then weighted as if it were that large.
///
/// # Errors
/// Names the parameters the motion does not excite, or the joint with too few samples.
///
/// # Panics
/// If motion, torque and valid samples do not fit the model.
pub fn weighted_least_squares(model: &Model, log: Log) -> Result<Solution> {
    let names: Vec<String> = model.base().groupings().iter().map(|grouping| grouping.name.clone()).collect();
    let joints = joint_sums(Lanes::best(), model, log);
    for (joint, spec) in joints.iter().zip(&model.robot().joints) {
        if joint.rows < 2 * joint.parameters.len() {
            let problem =
                format!("{} samples for {} parameters; take a longer log", joint.rows, joint.parameters.len());
            return Err(Error::request(&spec.name, problem));
        }
    }
    let sums = Sums::new(joints, || triangles(model, log));
    let mut sigma = vec![1.0; model.dof()];
    for _ in 0..REWEIGHTINGS {
        let beta = sums.solution(&sigma, &names)?;
        sigma = sums.joints().iter().map(|joint| sigma_of(joint, beta.as_slice())).collect();
    }
    let (beta, scaled) = sums.solve(&sigma, &names)?;
    Ok(Solution {
        beta: beta.as_slice().to_vec(),
        covariance: scaled.inverse(),
        condition_number: scaled.condition_number,
        sigma,
    })
}

fn sigma_of(joint: &JointSums, beta: &[f64]) -> f64 {
    let freedom = (joint.rows - joint.parameters.len()) as f64;
    let sum = joint.residual(beta).unwrap_or_else(|| joint.least_residual());
    (sum / freedom).sqrt().max(f64::MIN_POSITIVE)
}

/// Every joint's Gram matrix of its base columns and its torque, in lanes of one kind.
///
/// # Panics
/// If motion, torque and valid samples do not fit the model.
pub fn joint_sums(lanes: Lanes, model: &Model, log: Log) -> Vec<JointSums> {
    let columns = model.base_columns();
    let sizes: Vec<usize> = (0..model.dof()).map(|joint| columns.parameters(joint).len() + 1).collect();
    let sections: Vec<Vec<DMatrix<f64>>> = sections(log)
        .into_par_iter()
        .with_max_len(1)
        .map(|section| {
            let mut grams: Vec<Gram> = sizes.iter().map(|&size| Gram::new_in(lanes, size)).collect();
            blocks(lanes, model, log, section, |joint, table, rows| grams[joint].add(table, rows));
            grams.iter().map(Gram::matrix).collect()
        })
        .collect();
    (0..model.dof())
        .map(|joint| {
            let mut gram = DMatrix::zeros(sizes[joint], sizes[joint]);
            sections.iter().for_each(|section| gram += &section[joint]);
            let rows = log.valid.map_or(log.motion.samples(), |all| all[joint].iter().filter(|&&ok| ok).count());
            JointSums { parameters: columns.parameters(joint).to_vec(), rows, gram }
        })
        .collect()
}

/// Every joint's triangle of its base columns and its torque: the Gram matrix is R'R.
///
/// # Panics
/// If motion, torque and valid samples do not fit the model.
pub fn triangles(model: &Model, log: Log) -> Vec<DMatrix<f64>> {
    let columns = model.base_columns();
    let new = || -> Vec<Triangle> {
        (0..model.dof()).map(|joint| Triangle::new(columns.parameters(joint).len() + 1)).collect()
    };
    let sections: Vec<Vec<DMatrix<f64>>> = sections(log)
        .into_par_iter()
        .with_max_len(1)
        .map(|section| {
            let mut triangles = new();
            blocks(Lanes::best(), model, log, section, |joint, table, rows| triangles[joint].add(table, rows));
            triangles.into_iter().map(Triangle::factor).collect()
        })
        .collect();
    let mut all = new();
    for section in &sections {
        for (triangle, part) in all.iter_mut().zip(section) {
            triangle.add(part.as_slice(), part.nrows());
        }
    }
    all.into_iter().map(Triangle::factor).collect()
}

/// Stretches of whole blocks, an even number of about equal ones where there are several: two threads then have as much to do.
fn sections(log: Log) -> Vec<Range<usize>> {
    let samples = log.motion.samples();
    let blocks = samples.div_ceil(BLOCK);
    let least = blocks.div_ceil(SECTION);
    let count = if least > 1 { least.next_multiple_of(2) } else { least };
    let border = |section: usize| samples.min(section * blocks / count * BLOCK);
    (0..count).map(|section| border(section)..border(section + 1)).collect()
}

/// Hands out, block by block, each joint's columns with its torque behind them, `[column][row]`; what does not count is
/// zero.
fn blocks(lanes: Lanes, model: &Model, log: Log, section: Range<usize>, mut visit: impl FnMut(usize, &[f64], usize)) {
    let columns = model.base_columns();
    let mut table = Aligned::zeros(columns.places() * BLOCK);
    for start in section.clone().step_by(BLOCK) {
        let here = start..section.end.min(start + BLOCK);
        let rows = here.len();
        let table = &mut table[..columns.places() * rows];
        columns.write(lanes, model.chain(), [log.motion; 2], 0.0, here.clone(), table);
        for joint in 0..model.dof() {
            let share = columns.of(joint);
            let own = &mut table[share.start * rows..(share.end + 1) * rows];
            own[share.len() * rows..].copy_from_slice(&log.torque.channel(joint)[here.clone()]);
            if let Some(valid) = log.valid {
                let left_out = valid[joint][here.clone()].iter().enumerate().filter(|(_, ok)| !**ok);
                for (row, _) in left_out {
                    own.iter_mut().skip(row).step_by(rows).for_each(|value| *value = 0.0);
                }
            }
            visit(joint, own, rows);
        }
    }
}

/// Predicted torque of a solution, `[joint][time]`.
pub fn predicted(model: &Model, motion: &Motion, beta: &[f64]) -> Channels {
    super::linear_model::LinearModel::torque(model, motion, &[], beta)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::regression::joint_regression::JointRegression;
    use crate::identification::regression::least_squares;
    use crate::random;
    use crate::robot::{self, InertiaCheck};
    use nalgebra::DVector;
    use rand::RngExt;

    fn arm() -> Model {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        Model::new(&robot::load(path, InertiaCheck::Required).unwrap())
    }

    /// A motion with the torque of the arm and noise on it, and which samples count.
    fn log(model: &Model, samples: usize, amplitude: f64) -> (Motion, Channels, Vec<Vec<bool>>) {
        let mut source = random::stream(4, "fused", samples as u64);
        let mut motion = Motion::zeros(model.dof(), samples);
        for signals in [&mut motion.q, &mut motion.qd, &mut motion.qdd] {
            signals.as_mut_slice().fill_with(|| source.random_range(-amplitude..amplitude));
        }
        let beta = model.base().values(&Model::standard_values(model.robot()));
        let mut torque = predicted(model, &motion, &beta);
        torque.as_mut_slice().iter_mut().for_each(|value| *value += source.random_range(-1.0..1.0));
        let valid = (0..model.dof()).map(|joint| (0..samples).map(|k| (k + joint) % 11 != 3).collect()).collect();
        (motion, torque, valid)
    }

    fn rows(model: &Model, log: Log) -> Vec<JointRegression> {
        let tables = model.columns(log.motion, 0.0);
        let joint = |(joint, columns): (usize, Channels)| JointRegression {
            joint: format!("joint {joint}"),
            parameters: model.active(joint),
            torque: log.torque.channel(joint).to_vec(),
            valid: log.valid.map_or_else(|| vec![true; columns.samples()], |valid| valid[joint].clone()),
            columns,
        };
        tables.into_iter().enumerate().map(joint).collect()
    }

    #[test]
    fn sums_are_plain_products_in_all_lanes() {
        let model = arm();
        for samples in [1, 37, 128, 131, SECTION + 5] {
            let (motion, torque, valid) = log(&model, samples, 2.0);
            for valid in [None, Some(valid.as_slice())] {
                let log = Log { motion: &motion, torque: &torque, valid };
                let tables = model.columns(&motion, 0.0);
                for lanes in Lanes::available() {
                    for (joint, sums) in joint_sums(lanes, &model, log).iter().enumerate() {
                        let x = DMatrix::from_fn(samples, sums.parameters.len() + 1, |r, c| {
                            let ok = valid.is_none_or(|valid| valid[joint][r]);
                            let signal = if c < sums.parameters.len() {
                                tables[joint].channel(c)
                            } else {
                                torque.channel(joint)
                            };
                            if ok { signal[r] } else { 0.0 }
                        });
                        let plain = x.transpose() * &x;
                        let scale = plain.amax().max(1e-9);
                        assert!((&sums.gram - plain).amax() < 1e-11 * scale, "{lanes:?}, {samples} samples");
                    }
                }
                let plain = joint_sums(Lanes::best(), &model, log);
                for (r, sums) in triangles(&model, log).iter().zip(&plain) {
                    assert!((r.transpose() * r - &sums.gram).amax() < 1e-10 * sums.gram.amax().max(1e-9));
                }
            }
        }
    }

    #[test]
    fn the_solution_is_that_of_the_rows() {
        let model = arm();
        let (motion, torque, valid) = log(&model, 3000, 2.0);
        let log = Log { motion: &motion, torque: &torque, valid: Some(&valid) };
        let names: Vec<String> = model.base().groupings().iter().map(|g| g.name.clone()).collect();
        let fused = weighted_least_squares(&model, log).unwrap();
        let plain = least_squares::weighted_least_squares(&rows(&model, log), &names).unwrap();
        for ((a, b), std) in fused.beta.iter().zip(&plain.beta).zip(plain.std()) {
            assert!((a - b).abs() < 1e-7 * std, "{a} {b} {std}");
        }
        for (a, b) in fused.sigma.iter().zip(&plain.sigma) {
            assert!((a / b - 1.0).abs() < 1e-9);
        }
        assert!((fused.condition_number / plain.condition_number - 1.0).abs() < 1e-9);
    }

    #[test]
    fn weights_are_those_of_a_plain_weighted_regression() {
        let model = arm();
        let (motion, torque, valid) = log(&model, 900, 2.0);
        let log = Log { motion: &motion, torque: &torque, valid: Some(&valid) };
        let sigma = [3.0, 1.0, 0.5, 0.2, 0.1, 0.7];
        let names: Vec<String> = model.base().groupings().iter().map(|g| g.name.clone()).collect();
        let sums = Sums::new(joint_sums(Lanes::best(), &model, log), || triangles(&model, log));
        let (beta, _) = sums.solve(&sigma, &names).unwrap();
        let (by_triangles, _) = sums.solve_by_triangles(&sigma, &names).unwrap();
        let mut all = DMatrix::zeros(900 * 6, names.len());
        let mut right = DVector::zeros(900 * 6);
        for ((joint, row), s) in rows(&model, log).iter().enumerate().zip(sigma) {
            for sample in (0..900).filter(|&sample| row.valid[sample]) {
                for (&parameter, column) in row.parameters.iter().zip(row.columns.iter()) {
                    all[(joint * 900 + sample, parameter)] = column[sample] / s;
                }
                right[joint * 900 + sample] = row.torque[sample] / s;
            }
        }
        let plain = all.svd(true, true).solve(&right, 0.0).unwrap();
        for k in 0..names.len() {
            assert!((beta[k] - plain[k]).abs() < 1e-9 * plain.amax(), "{}", names[k]);
            assert!((by_triangles[k] - plain[k]).abs() < 1e-9 * plain.amax(), "{}", names[k]);
        }
    }

    /// Two columns that differ by a part in ten million: the Gram matrix does not separate them, the triangles do.
    #[test]
    fn ill_conditioned_rows_go_by_triangles() {
        let (rows, small) = (2000, 3e-7);
        let mut source = random::stream(9, "ill", 0);
        let mut draw = || -> Vec<f64> { (0..rows).map(|_| source.random_range(-1.0..1.0)).collect() };
        let (x, z) = (draw(), draw());
        let y: Vec<f64> = x.iter().zip(&z).map(|(x, z)| x + small * z).collect();
        let torque: Vec<f64> = x.iter().zip(&y).map(|(x, y)| 2.0 * x + 3.0 * y).collect();
        let joint = JointRegression {
            joint: "one".to_owned(),
            parameters: vec![0, 1],
            columns: Channels::from_vectors(&[x, y]),
            torque,
            valid: vec![true; rows],
        };
        let names = ["a".to_owned(), "b".to_owned()];
        let beta = least_squares::weighted_solution(&[joint], &[1.0], &names).unwrap();
        assert!((beta[0] - 2.0).abs() < 1e-7 && (beta[1] - 3.0).abs() < 1e-7, "{beta:?}");
    }
}
