//! Tests of columns adjusted for what is not physics: the error of the smoothing, slow noise whose strength the rows determine poorly,
//! and noise that is stronger or of another colour in parts of the logs.

use super::blocks::BLOCK;
use super::generic::slow_cosines;
use super::judging::Judged;
use crate::diagnosis::logs::Rows;
use crate::diagnosis::model::{Candidate, Session, is_level};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection, Test, combined, joints_of};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Cosines over each log that span slow noise: one hertz over twenty seconds.
const SLOW: usize = 40;

/// Inverse degrees of freedom below which the strength of slow noise is as good as known.
const MATTERS: f64 = 1e-4;

/// Eigenvalue of a covariance, over its largest, below which a direction does not count.
const SINGULAR: f64 = 1e-10;

/// Blocks that short logs are cut into too, and the fewest rows of one: few scores have tails that hide everything.
const BLOCKS: usize = 40;
const SHORTEST_BLOCK: usize = 12;

/// Cosines over each log that span slow drifts where an event is tested.
const DRIFTS: usize = 10;

/// Logarithm of the probability of what a candidate explains, adjusted for errors of the smoothing and for slow noise of the
/// strength that it has once the candidate is in the model. An event of one log is also adjusted for slow drifts of all joints that
/// it acts on: the rows show well how sharply it begins and ends.
pub(crate) fn log_p_adjusted(session: &Session, whitener: &Whitener, fit: &Projection, candidate: &Judged) -> f64 {
    let rows = &session.logs.train.rows;
    let fit = if candidate.candidate.log.is_some() {
        let joints = candidate.candidate.joints();
        let drifts: Vec<Column> = joints.into_iter().flat_map(|joint| slow_cosines(rows, joint, 0..DRIFTS)).collect();
        fit.with(&whitener.apply_all(&drifts))
    } else {
        session.errors_with(&session.logs.train, &candidate.candidate.placed).adjust(fit, whitener)
    };
    let Some(judged) = session.judge(&candidate.candidate, whitener, &fit) else { return 0.0 };
    let slow = against_slow_noise(rows, whitener, &fit, &judged.whitened, &judged.test);
    if happens_anywhere(&candidate.candidate) {
        return slow;
    }
    let over = over_blocks(rows.len(), whitener, &fit, &judged.whitened, judged.test.freedom);
    tracing::debug!(smoothing = judged.test.log_p(), slow, over, "adjusted");
    slow.max(over)
}

/// Logarithm of the probability of what whitened `columns` take beyond `fit`, by a Wald test whose covariance is that of the
/// scores of whole blocks of the logs: right whatever the noise is within them, and however strong in each (Liang and
/// Zeger, Biometrika 73, 1986).
fn over_blocks(rows: usize, whitener: &Whitener, fit: &Projection, columns: &[Column], freedom: usize) -> f64 {
    let columns = fit.left_of(columns.to_vec());
    let residual = Projection::new(&columns, &fit.residual).residual;
    let width = (rows / BLOCKS).clamp(SHORTEST_BLOCK, BLOCK);
    let (count, blocks) = (columns.len(), rows / width + 1);
    let mut scores = vec![DVector::<f64>::zeros(count); blocks];
    for (joint, left) in &residual.parts {
        let places = whitener.places(*joint);
        for (index, column) in columns.iter().enumerate() {
            let Some(values) = column.part(*joint) else { continue };
            for ((r, z), place) in left.iter().zip(values).zip(places) {
                scores[place / width][index] += r * z;
            }
        }
    }
    // What is known beforehand is no part of any block.
    scores.push(DVector::from_iterator(count, columns.iter().map(|column| column.dot_beforehand(&residual))));
    let used = scores.iter().filter(|score| score.norm_squared() > 0.0).count();
    if used <= 2 * freedom {
        return 0.0;
    }
    let mut covariance = DMatrix::zeros(count, count);
    scores.iter().for_each(|score| covariance += score * score.transpose());
    let total = DVector::from_iterator(count, columns.iter().map(|column| column.dot(&fit.residual)));
    // Directions in which the columns have no information have no scatter either.
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
fn happens_anywhere(candidate: &Candidate) -> bool {
    candidate.log.is_some() || is_level(candidate.placed.effect)
}

/// Logarithm of the probability of the test of whitened `columns` beyond `fit`, by an F test against the slow part of what is
/// left with them, as far as they are slow themselves.
///
/// White noise has as much in each cosine; where the whitening knows the slow noise badly there is more, and the number of
/// cosines limits how well that is known. A sum of cosines that is nearly a column of the fit holds no information: its
/// residual is what that column has beyond slow motion. That is the noise of the encoders above all, which is in the residual of the torque
/// too.
pub(crate) fn against_slow_noise(
    rows: &Rows,
    whitener: &Whitener,
    fit: &Projection,
    columns: &[Column],
    test: &Test,
) -> f64 {
    let predicted = fit.left_of(vec![combined(columns, &test.values)]).remove(0);
    let all = predicted.dot(&predicted);
    if all.is_nan() || all <= 0.0 {
        return 0.0;
    }
    let with = fit.with(columns);
    // What the fit takes back on other joints is small.
    let joints: Vec<usize> = joints_of(columns).into_iter().collect();
    let of_joint = |&joint: &usize| {
        let own = predicted.only(&[joint]);
        let cosines = whitener.apply_all(&slow_cosines(rows, joint, 1..SLOW + 1));
        let slow = 1.0 - Projection::new(&cosines, &own).left() / own.dot(&own).max(f64::MIN_POSITIVE);
        let share = slow.clamp(0.0, 1.0) * own.dot(&own) / all;
        let strength = with.test_of_what_is_mostly_left(&cosines)?;
        let freedom = strength.freedom as f64;
        tracing::debug!(joint, slow, strength = strength.statistic / freedom, freedom, "slow");
        Some([share * (strength.statistic / freedom - 1.0).max(0.0), share * share / freedom])
    };
    let each: Vec<Option<[f64; 2]>> = joints.par_iter().map(of_joint).collect();
    let [excess, certainty] = each.into_iter().flatten().fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
    let freedom = test.freedom as f64;
    let ratio = test.statistic / freedom / (1.0 + excess);
    match FisherSnedecor::new(freedom, 1.0 / certainty.max(f64::MIN_POSITIVE)) {
        Ok(chance) if certainty > MATTERS => chance.sf(ratio).max(f64::MIN_POSITIVE).ln(),
        _ => test.log_p(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::diagnosis::logs::FEWEST_ROWS;
    use crate::random;
    use crate::recording::Recording;
    use rand_distr::{Distribution, StandardNormal};

    /// Probabilities of a slow column in white noise with a push of two seconds in forty: of the score test, and over blocks.
    fn probabilities(seed: u64, size: f64) -> [f64; 2] {
        let mut source = random::stream(seed, "pushes", 0);
        let time: Vec<f64> = (0..20_000).map(|k| f64::from(k) / 500.0).collect();
        let slow = |t: f64| (0.8 * (t - 12.0)).cos();
        let push: f64 = StandardNormal.sample(&mut source);
        let torque = |&t: &f64| {
            let noise: f64 = StandardNormal.sample(&mut source);
            size * slow(t) + noise + if (11.0..13.0).contains(&t) { 2.0 * push } else { 0.0 }
        };
        let tau = Channels::from_vectors(&[time.iter().map(torque).collect()]);
        let q = Channels::from_vectors(&[time.iter().map(|t| t.sin()).collect()]);
        let log = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        let rows = Rows::new(&[&log], 10.0, FEWEST_ROWS).unwrap();
        let whitener = Whitener::new(&rows, &Column::new(rows.torque.iter().cloned()), &[]);
        let fit = whitener.fit(&[], &Column::new(rows.torque.iter().cloned()));
        let column = rows.signal(|log| log.time.iter().map(|&t| slow(t)).collect());
        let columns = whitener.apply_all(&[Column::on(0, column)]);
        let test = fit.test(&columns).unwrap();
        [test.log_p(), over_blocks(rows.len(), &whitener, &fit, &columns, test.freedom)].map(f64::exp)
    }

    #[test]
    fn a_push_is_no_evidence_over_blocks() {
        let runs = 300;
        let (mut plain, mut sober) = (0, 0);
        for seed in 0..runs {
            let [score, over] = probabilities(seed, 0.0);
            plain += usize::from(score < 0.01);
            sober += usize::from(over < 0.01);
        }
        assert!(plain > 9, "the score test takes the push for evidence: {plain} of {runs}");
        assert!(sober <= 9, "{sober} of {runs} below 1 %");
    }

    #[test]
    fn what_is_there_all_the_time_is_seen_despite_a_push() {
        let seen = (0..20).filter(|&seed| probabilities(seed, 0.7)[1] < 1e-3).count();
        assert!(seen >= 14, "{seen} of 20");
    }
}
