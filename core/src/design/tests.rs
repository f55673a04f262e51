//! The information matrix and the criteria against the stacked regressor, and their values on known motions.

use super::comparison::SingleMove;
use super::criterion::{self, Criterion};
use super::families::Family;
use super::{Envelope, Experiment, Information, Problem, Workspace};
use crate::dynamics::Motion as Sampled;
use crate::excitation::encoding::random_point;
use crate::excitation::freudenstein::{FreudensteinSequence, JointMoves};
use crate::excitation::{JointLimits, Motion, Reference};
use crate::robot::{self, InertiaCheck, Robot};
use nalgebra::DMatrix;

pub(super) const NOISE: [f64; 6] = [3.0, 4.0, 2.0, 0.45, 0.35, 0.18];
pub(super) const RATE: f64 = 500.0;

pub(super) fn irb1600() -> Robot {
    robot::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf"), InertiaCheck::Required).unwrap()
}

pub(super) fn limits(robot: &Robot) -> Vec<JointLimits> {
    let accelerations = [10.0, 10.0, 12.0, 35.0, 40.0, 50.0];
    let joints = robot.joints.iter().zip(accelerations);
    joints
        .map(|(joint, acceleration)| JointLimits {
            lower: joint.limits.lower,
            upper: joint.limits.upper,
            velocity: joint.limits.velocity,
            acceleration,
        })
        .collect()
}

pub(super) const WORKSPACE: Workspace = Workspace { floor_m: 0.0, column_radius_m: 0.35, column_top_m: 0.7 };

pub(super) fn problem(criterion: Criterion) -> Problem {
    let robot = irb1600();
    let experiment = Experiment::new(&robot, &NOISE, RATE).unwrap();
    let envelope = Envelope::new(&robot, &limits(&robot), Some(WORKSPACE)).unwrap();
    Problem::new(experiment, envelope, criterion, 50.0, 0.03).unwrap()
}

fn random_motion(index: u64) -> Motion {
    let encoding = Family::Freudenstein.encoding(&limits(&irb1600()), 10.0, 6).unwrap();
    encoding.decode(&random_point(&*encoding, 1, "design tests", index))
}

/// All rows of the regressor on the base columns, divided by sigma, from the model that identification uses.
fn stacked(experiment: &Experiment, motion: &dyn Reference, grid_hz: f64) -> DMatrix<f64> {
    let model = experiment.model();
    let samples = (motion.duration_s() * grid_hz).round() as usize + 1;
    let mut sampled = Sampled::zeros(6, samples);
    let time: Vec<f64> = (0..samples).map(|k| k as f64 / grid_hz).collect();
    let [mut q, mut qd, mut qdd] = [[0.0; 6]; 3];
    for (k, &t) in time.iter().enumerate() {
        motion.at(t, &mut q, &mut qd, &mut qdd);
        sampled.q.set(k, &q);
        sampled.qd.set(k, &qd);
        sampled.qdd.set(k, &qdd);
    }
    let mut rows = DMatrix::zeros(6 * samples, model.base().len());
    for (joint, columns) in model.columns(&sampled, 0.0).iter().enumerate() {
        for (&parameter, column) in model.active(joint).iter().zip(columns.iter()) {
            for (k, y) in column.iter().enumerate() {
                rows[(joint * samples + k, parameter)] = y / NOISE[joint];
            }
        }
    }
    rows
}

#[test]
fn criteria_agree_with_the_singular_values_of_the_stacked_regressor() {
    let problem = problem(Criterion::default());
    let experiment = &problem.experiment;
    let motion = random_motion(0);
    let grid = 100.0;
    let information = experiment.information(&motion, grid);
    let rows = stacked(experiment, &motion, grid) * (RATE / grid).sqrt();
    let p = rows.ncols() as f64;
    let singular = rows.clone().svd(false, false).singular_values;
    let d = -singular.iter().map(|s| s.ln()).sum::<f64>() / p;
    assert!((criterion::log_determinant(&information) - d).abs() < 1e-9, "D {d}");

    let mut unit = rows.clone();
    unit.column_iter_mut().for_each(|mut column| {
        let length = column.norm();
        column /= length;
    });
    let singular = unit.svd(false, false).singular_values;
    let kappa = singular.max() / singular.min();
    assert!((criterion::condition_number(&information) / kappa - 1.0).abs() < 1e-8, "kappa {kappa}");
    let hadamard = -singular.iter().map(|s| s.ln()).sum::<f64>() / p;
    assert!((criterion::hadamard(&information) - hadamard).abs() < 1e-9, "Hadamard {hadamard}");
    let compromise = Criterion::default().value(&information, problem.sizes());
    assert!((compromise - (d + 0.15 * kappa.ln())).abs() < 1e-9);

    let covariance = rows.tr_mul(&rows).try_inverse().unwrap();
    let deviations = information.standard_deviations();
    for (k, deviation) in deviations.iter().enumerate() {
        assert!((deviation / covariance[(k, k)].sqrt() - 1.0).abs() < 1e-8, "parameter {k}");
    }
    let worst = deviations.iter().zip(problem.sizes()).map(|(s, size)| s / size).fold(0.0, f64::max);
    assert!((Criterion::WorstDeviation.value(&information, problem.sizes()) - worst).abs() < 1e-12);
}

#[test]
fn the_torque_shown_is_that_of_the_parameters() {
    let problem = problem(Criterion::default());
    let motion = random_motion(1);
    let rows = stacked(&problem.experiment, &motion, 100.0);
    let beta = nalgebra::DVector::from_column_slice(problem.experiment.beta());
    let expected = rows * beta;
    let mut k = 0;
    problem.experiment.scan(&motion, 100.0, &mut |samples| {
        for (joint, torque) in samples.torque.iter().enumerate() {
            for (offset, tau) in torque.iter().enumerate() {
                let wanted = expected[joint * 1001 + k + offset] * NOISE[joint];
                assert!((tau - wanted).abs() < 1e-9, "joint {joint}: {tau} against {wanted}");
            }
        }
        k += samples.time.len();
    });
    assert_eq!(k, 1001);
}

#[test]
fn logs_add_up_and_a_coarse_grid_stands_for_the_log() {
    let experiment = problem(Criterion::default()).experiment;
    let (a, b) = (random_motion(2), random_motion(3));
    let [first, second] = [&a, &b].map(|motion| experiment.information(motion, RATE));
    let both = first.clone().joined(&second);
    assert!((both.matrix() - (first.matrix() + second.matrix())).norm() < 1e-12 * both.matrix().norm());
    let twice = first.clone().joined(&first);
    let gain = criterion::log_determinant(&first) - criterion::log_determinant(&twice);
    assert!((gain - 0.5 * 2f64.ln()).abs() < 1e-9, "twice the log, {gain}");
    let coarse = experiment.information(&a, 50.0);
    let difference = criterion::log_determinant(&coarse) - criterion::log_determinant(&first);
    assert!(difference.abs() < 0.01, "{difference}");
    // Predicting its own rows costs sqrt(p / rows).
    let own = first.prediction_error(&first);
    assert!((own - (52.0 / (5001.0 * 6.0f64)).sqrt()).abs() < 1e-9, "{own}");
}

#[test]
fn one_move_per_joint_with_common_timing_has_rank_51_of_52() {
    let experiment = problem(Criterion::default()).experiment;
    let motion = SingleMove::of(&limits(&irb1600()), 10.0);
    let singular = {
        let mut rows = stacked(&experiment, &motion, 100.0);
        rows.column_iter_mut().for_each(|mut column| {
            let length = column.norm();
            column /= length;
        });
        rows.svd(false, false).singular_values
    };
    let rank = singular.iter().filter(|&&s| s > 1e-9 * singular.max()).count();
    assert_eq!(rank, 51, "{singular}");
    let information = experiment.information(&motion, 100.0);
    assert_eq!(information.rank(), 51);
    assert_eq!(criterion::log_determinant(&information), f64::INFINITY);
    assert_eq!(criterion::condition_number(&information), f64::INFINITY);
    assert!(information.standard_deviations().iter().all(|s| s.is_infinite()));
    assert_eq!(experiment.information(&random_motion(0), 100.0).rank(), 52);
}

#[test]
fn a_joint_that_stands_still_is_not_excited() {
    let experiment = problem(Criterion::default()).experiment;
    let Motion::Freudenstein(sequence) = random_motion(0) else { panic!("another kind") };
    let mut joints = sequence.joint_moves().to_vec();
    joints[5] = JointMoves { duration_s: vec![10.0], via: vec![] };
    let still = FreudensteinSequence::new(10.0, joints).unwrap();
    let information = experiment.information(&still, 100.0);
    for criterion in [Criterion::default(), Criterion::ConditionNumber, Criterion::LogDeterminant, Criterion::Hadamard]
    {
        assert_eq!(criterion.value(&information, &[1.0; 52]), f64::INFINITY, "{}", criterion.name());
    }
    assert!(information.rank() < 52);
    assert_eq!(Information::none(3).rank(), 0);
}

#[test]
fn hadamards_ratio_is_zero_for_orthogonal_columns_and_grows_with_their_likeness() {
    let ratio = |rho: f64| {
        let information = Information::of(DMatrix::from_row_slice(2, 2, &[4.0, 6.0 * rho, 6.0 * rho, 9.0]), 2.0);
        criterion::hadamard(&information)
    };
    assert!(ratio(0.0).abs() < 1e-15);
    // det / product of the diagonal = 1 - rho^2, over 2 p = 4.
    assert!((ratio(0.6) - (-(1.0 - 0.36f64).ln() / 4.0)).abs() < 1e-12);
}

#[test]
fn unusable_noise_is_refused() {
    let robot = irb1600();
    let message = |noise: &[f64]| Experiment::new(&robot, noise, RATE).unwrap_err().to_string();
    assert!(message(&NOISE[..5]).contains("5 values for 6 joints"));
    let mut noise = NOISE;
    noise[3] = 0.0;
    assert!(message(&noise).contains("joint_4"));
}
