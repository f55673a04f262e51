//! What columns take beside what is not physics: the error of the smoothing, slow noise whose strength the rows tell poorly,
//! and noise that is stronger or of another colour in parts of the logs.

use super::candidates::Candidate;
use super::column::{Column, combined};
use super::generic::slow_cosines;
use super::judging::Judged;
use super::roles::is_level;
use super::rows::Rows;
use super::score::{Projection, Test};
use super::session::Session;
use super::stretches::STRETCH;
use super::whitening::Whitener;
use crate::error::Result;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Cosines over each log that stand for slow noise: one hertz over twenty seconds.
const SLOW: usize = 40;

/// Inverse degrees of freedom below which the strength of slow noise is as good as known.
const MATTERS: f64 = 1e-4;

/// Eigenvalue of a covariance, over its largest, below which a direction does not count.
const SINGULAR: f64 = 1e-10;

/// Cosines over each log that stand for slow drifts beside an event.
const DRIFTS: usize = 10;

/// Logarithm of the probability of what a candidate takes beside the error of the smoothing, by the strength that slow noise
/// is seen to have once the candidate is in the model. An event of one log must also show beside slow drifts of all joints
/// that it acts on: how sharply it begins and ends the rows tell well.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn beside(session: &Session, whitener: &Whitener, fit: &Projection, candidate: &Judged) -> Result<f64> {
    let rows = &session.train.rows;
    let of_joints = |column: Column| column.parts.into_iter().map(|(joint, signal)| Column::on(joint, signal));
    let mut nuisances: Vec<Column> = Vec::new();
    if candidate.candidate.log.is_some() {
        let joints = candidate.candidate.joints();
        nuisances.extend(joints.into_iter().flat_map(|joint| slow_cosines(rows, joint, 0..DRIFTS)));
    } else if !is_level(candidate.candidate.placed.effect) {
        // Where a torque is cut off the smoothing errs too.
        nuisances.extend(of_joints(session.arm.smoothing_error(rows)?));
    }
    let fit = fit.with(&whitener.apply_all(&nuisances));
    let Some(judged) = session.judge(&candidate.candidate, whitener, &fit) else { return Ok(0.0) };
    let slow = against_slow_noise(rows, whitener, &fit, &judged.whitened, &judged.test);
    Ok(match happens_anywhere(&candidate.candidate) {
        true => slow,
        false => slow.max(over_stretches(rows.len(), whitener, &fit, &judged.whitened, judged.test.freedom)),
    })
}

/// Logarithm of the probability of what whitened `columns` take beyond `fit`, by a Wald test whose covariance is that of the
/// scores of whole stretches of the logs: right whatever the noise is within them, and however strong in each (Liang and
/// Zeger, Biometrika 73, 1986).
fn over_stretches(rows: usize, whitener: &Whitener, fit: &Projection, columns: &[Column], freedom: usize) -> f64 {
    let columns: Vec<Column> = columns.iter().map(|column| fit.left_of(column.clone())).collect();
    let residual = Projection::new(&columns, &fit.residual).residual;
    let (count, stretches) = (columns.len(), rows / STRETCH + 1);
    let mut scores = vec![DVector::<f64>::zeros(count); stretches];
    for (joint, left) in &residual.parts {
        for (index, column) in columns.iter().enumerate() {
            let Some(values) = column.part(*joint) else { continue };
            for ((place, r), z) in whitener.places(*joint).iter().zip(left).zip(values) {
                scores[place / STRETCH][index] += r * z;
            }
        }
    }
    let used = scores.iter().filter(|score| score.norm_squared() > 0.0).count();
    if used <= 2 * freedom {
        return 0.0;
    }
    let mut covariance = DMatrix::zeros(count, count);
    scores.iter().for_each(|score| covariance += score * score.transpose());
    let total = DVector::from_iterator(count, columns.iter().map(|column| column.dot(&fit.residual)));
    // Directions in which the columns say nothing have no scatter either.
    let eigen = SymmetricEigen::new(covariance);
    let least = SINGULAR * eigen.eigenvalues.max();
    let statistic: f64 = (0..count)
        .filter(|&k| eigen.eigenvalues[k] > least)
        .map(|k| eigen.eigenvectors.column(k).dot(&total).powi(2) / eigen.eigenvalues[k])
        .sum();
    let (freedom, left) = (freedom as f64, (used - freedom) as f64);
    let ratio = statistic / freedom * left / used as f64;
    match FisherSnedecor::new(freedom, left) {
        Ok(chance) => chance.sf(ratio).max(f64::MIN_POSITIVE).ln(),
        Err(_) => 0.0,
    }
}

/// Whether an effect may show in a moment of the logs alone: what happened once, and what happens where the torque is largest.
pub fn happens_anywhere(candidate: &Candidate) -> bool {
    candidate.log.is_some() || is_level(candidate.placed.effect)
}

/// Logarithm of the probability of the test of whitened `columns` beyond `fit`, by an F test against the slow part of what is
/// left with them, as far as they are slow themselves.
///
/// White noise has as much in each cosine; where the whitening knows the slow noise badly there is more, and the number of
/// cosines limits how well that is known.
pub fn against_slow_noise(rows: &Rows, whitener: &Whitener, fit: &Projection, columns: &[Column], test: &Test) -> f64 {
    let predicted = fit.left_of(combined(columns, &test.values));
    let all = predicted.dot(&predicted);
    if !(all > 0.0) {
        return 0.0;
    }
    let with = fit.with(columns);
    let (mut excess, mut certainty) = (0.0, 0.0);
    for (joint, _) in &predicted.parts {
        let own = predicted.only(&[*joint]);
        let cosines = whitener.apply_all(&slow_cosines(rows, *joint, 1..SLOW + 1));
        let slow = 1.0 - Projection::new(&cosines, &own).left() / own.dot(&own).max(f64::MIN_POSITIVE);
        let share = slow.clamp(0.0, 1.0) * own.dot(&own) / all;
        let Some(strength) = with.test(&cosines) else { continue };
        let freedom = strength.freedom as f64;
        excess += share * (strength.statistic / freedom - 1.0).max(0.0);
        certainty += share * share / freedom;
    }
    let freedom = test.freedom as f64;
    let ratio = test.statistic / freedom / (1.0 + excess);
    match FisherSnedecor::new(freedom, 1.0 / certainty.max(f64::MIN_POSITIVE)) {
        Ok(chance) if certainty > MATTERS => chance.sf(ratio).max(f64::MIN_POSITIVE).ln(),
        _ => test.log_p(),
    }
}
