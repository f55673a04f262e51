//! Generic functions of one joint as random effects: the part of the errors of a model that no law explains.

use super::design::{Raw, Source, smoothing};
use super::kinds::{Kind, Signals};
use super::laws::SMOOTH;
use super::map::coloured_fit;
use super::mixed::fit;
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::Column;
use nalgebra::DMatrix;

/// Share of a function's square that the model takes from which it is left out: it is one of the model's own columns, as a constant is an
/// offset, and a law must not be tested against itself.
const TAKEN: f64 = 0.9;

/// Generic functions of `joint` over the rows, each times the standard deviation of its factor: the errors of the model there have the
/// covariance of their sum with independent standard normal factors, and noise besides. `fixed` are the columns
/// of the model of its `torque`, and `arm` is the torque of the arm as identified, `[joint][row]`.
///
/// Functions of the joint's own state alone are among them, since blocks of the logs agree on the errors that these make: what differs from
/// block to block is in the scatter between blocks, and slow noise, in which restricted maximum likelihood finds all kinds, is in the noise.
///
/// The sizes are those that restricted maximum likelihood gives the residual, where what follows the position is as smooth as is likeliest.
/// They hold for the part of the functions that the model cannot take, and the part that it takes is as large per function.
pub(crate) fn random_effects(
    rows: &Rows,
    torque: &Column,
    fixed: &[Column],
    arm: &[Vec<f64>],
    joint: usize,
) -> Vec<Column> {
    let source = Source { rows, torque, fixed, arm };
    let raw = Raw::new(&source, joint);
    let (design, rough, rho) = coloured_fit(&raw);
    let mut best = (None, design, rough);
    for knots in SMOOTH {
        let design = raw.clone().smooth(knots).design(rho);
        let smooth = fit(&design);
        if smooth.log_likelihood > best.2.log_likelihood {
            best = (Some(knots), design, smooth);
        }
    }
    let (knots, design, fitted) = best;
    let signals = Signals { rows: source.rows, torque: source.arm, joint };
    let mut columns = Vec::new();
    for (k, (kind, own)) in design.kinds.iter().enumerate() {
        let Some(kind) = kind.filter(|kind| kind.repeats() && fitted.strengths[k] > 0.0) else { continue };
        let smooth = knots.filter(|_| kind == Kind::Position);
        let [all, left] = [0, 1].map(|side| own.clone().map(|place| design.squares[place][side]).collect::<Vec<f64>>());
        // Functions that are mixed are of one kind of smoothness: what is seen of some holds for all.
        let stays: Vec<bool> =
            all.iter().zip(&left).map(|(all, left)| smooth.is_some() || *left > (1.0 - TAKEN) * all).collect();
        let size: f64 = all.iter().zip(&stays).filter(|(_, stays)| **stays).map(|(all, _)| all).sum();
        if size == 0.0 {
            continue;
        }
        let factor = (fitted.strengths[k] / size).sqrt();
        let functions = signals.functions(kind);
        let weights = match smooth {
            Some(knots) => factor * smoothing(functions.len(), knots),
            None => DMatrix::from_diagonal_element(functions.len(), functions.len(), factor),
        };
        let kept = weights.column_iter().zip(stays).filter(|(_, stays)| *stays);
        columns.extend(kept.map(|(weights, _)| Column::on(joint, weighted(&functions, weights.as_slice()))));
    }
    columns
}

/// Sum of signals times weights.
fn weighted(signals: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; signals.first().map_or(0, Vec::len)];
    for (signal, weight) in signals.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
        sum.iter_mut().zip(signal).for_each(|(sum, value)| *sum += weight * value);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::diagnosis::logs::FEWEST_ROWS;
    use crate::random;
    use crate::recording::Recording;
    use rand_distr::{Distribution, StandardNormal};

    /// Error of the factor of `cos q`, fitted alone to a torque of nothing but noise of 0.05 and `structure` in place of a smooth function of
    /// q, and its variance by random effects.
    fn error_and_variance(structure: f64, seed: u64) -> (f64, f64) {
        let mut source = random::stream(seed, "random_effects", 0);
        let mut draw = || StandardNormal.sample(&mut source);
        let time: Vec<f64> = (0..20_000).map(|k| f64::from(k) / 500.0).collect();
        let q: Vec<f64> = time.iter().map(|t| 1.2 * t.sin() + 0.5 * (0.37 * t).sin()).collect();
        let log = Recording {
            joints: vec!["a".into()],
            q: Channels::from_vectors(&[q]),
            tau: Channels::from_vectors(&[vec![0.0; time.len()]]),
            time,
            ..Default::default()
        };
        let rows = Rows::new(&[&log], 10.0, FEWEST_ROWS).unwrap();
        let of_place =
            |f: &dyn Fn(f64) -> f64| rows.signal(|log| log.motion.q.channel(0).iter().map(|&q| f(q)).collect());
        let factors: Vec<[f64; 2]> = (0..5).map(|_| [draw(), draw()]).collect();
        let smooth = of_place(&|q| {
            let terms = factors.iter().zip(1..).map(|([a, b], k)| {
                let phase = 0.9 * f64::from(k) * q;
                (a * phase.cos() + b * phase.sin()) / f64::from(k)
            });
            structure * terms.sum::<f64>()
        });
        let torque: Vec<f64> = smooth.iter().map(|x| x + 0.05 * draw()).collect();
        let column = Column::on(0, of_place(&f64::cos));
        let torque = Column::on(0, torque);
        let error = column.dot(&torque) / column.dot(&column);
        let arm = [vec![0.0; rows.len()]];
        let effects = random_effects(&rows, &torque, std::slice::from_ref(&column), &arm, 0);
        let changes = effects.iter().map(|effect| (column.dot(effect) / column.dot(&column)).powi(2));
        (error, changes.sum())
    }

    #[test]
    fn errors_of_a_factor_under_structure_are_as_large_as_their_deviation() {
        for size in [0.1, 0.3, 1.0] {
            let each: Vec<(f64, f64)> = (0..40).map(|seed| error_and_variance(size, seed)).collect();
            let error = (each.iter().map(|(error, _)| error * error).sum::<f64>() / 40.0).sqrt();
            let deviation = each.iter().map(|(_, variance)| variance.sqrt()).sum::<f64>() / 40.0;
            // Strengths rest on a few functions each, so that single deviations are up to a few times too small.
            assert!(deviation > 0.6 * error && deviation < 1.6 * error, "{size}: {deviation} {error}");
            let beyond = each.iter().filter(|(error, variance)| error * error > 9.0 * variance).count();
            assert!(beyond <= 6, "{size}: {beyond}");
        }
    }

    #[test]
    fn without_structure_noise_decides() {
        for seed in 0..5 {
            // 2000 rows of noise of 0.05: a standard deviation of the factor of about 0.0017.
            let (_, variance) = error_and_variance(0.0, seed);
            assert!(variance.sqrt() < 0.0035, "{seed}: {}", variance.sqrt());
        }
    }
}
