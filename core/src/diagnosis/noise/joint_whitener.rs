//! The noise of one joint: an autoregressive model from the residual of a rich regression.
//!
//! From the residual of the plain baseline the noise model would swallow what is to be found: a constant offset looks like
//! very slow noise. The residual of a regression on much more than the baseline is little but noise; that it also takes some of the
//! noise with it, slow noise most of all, is made good frequency by frequency (`noise_spectrum`).

use super::innovations::InnovationsFilter;
use super::noise_spectrum::corrected;
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::Column;
use crate::identification::noise::AutoregressiveNoise;
use crate::linear::OrthonormalBasis;
use rayon::prelude::*;
use std::sync::Arc;

/// Order of the noise models.
const ORDER: usize = 6;

/// Times that the spectrum is corrected for what the rich regression takes of the noise.
const SPECTRUM_ROUNDS: usize = 2;

/// Smallest share of degrees of freedom that the regression is taken to leave.
const LEAST_FREE: f64 = 0.25;

/// Share of a column's norm that must be left for it to count as independent of those before.
const INDEPENDENT: f64 = 1e-6;

/// Speed over which the low-speed part of friction fades in the rich regression, rad/s.
const SLOW: f64 = 0.1;

/// Turns the noise of one joint into white noise.
#[derive(Debug, Clone)]
pub(super) struct JointWhitener {
    pub(super) filter: Arc<InnovationsFilter>,
    /// Misfit: factor by which the residual exceeds the noise's standard deviation.
    pub(super) misfit: f64,
}

impl JointWhitener {
    pub(super) fn of(rows: &Rows, torque: &Column, present: &[Column], joint: usize) -> Self {
        // One after the other: joints are whitened in parallel, and a thread that took up another joint while it waits here would wait
        // for itself.
        let rich = rows.rich.get_or_init(|| (0..rows.dof()).map(|joint| rich(rows, joint)).collect());
        let mut columns: Vec<Vec<f64>> =
            present.iter().filter_map(|column| column.part(joint)).map(<[f64]>::to_vec).collect();
        columns.extend_from_slice(&rich[joint]);
        let signal = torque.part(joint).map_or_else(|| vec![0.0; rows.len()], <[f64]>::to_vec);
        let (valid, share) = (&rows.valid[joint], rows.share_as_logged());
        if !valid.contains(&true) {
            return JointWhitener::without_rows(valid, &rows.starts);
        }
        JointWhitener::new(valid, &rows.starts, &signal, rows.apart(columns), share)
    }

    /// Of a joint without an equation: there is nothing to make white.
    fn without_rows(valid: &[bool], starts: &[usize]) -> Self {
        let noise = AutoregressiveNoise { coefficients: Vec::new(), innovation_std: 1.0 };
        JointWhitener { filter: Arc::new(InnovationsFilter::new(noise, valid, starts)), misfit: 1.0 }
    }

    fn new(valid: &[bool], starts: &[usize], torque: &[f64], columns: Vec<Vec<f64>>, share: f64) -> Self {
        let masked = |signal: &[f64]| -> Vec<f64> {
            signal.iter().zip(valid).map(|(&x, &ok)| if ok { x } else { 0.0 }).collect()
        };
        let columns: Vec<Vec<f64>> = columns.iter().map(|column| masked(column)).collect();
        let basis = orthonormal(&columns);
        let observed = before_low_pass(lags(&basis.residual(&masked(torque)), valid), share);
        let mut noise = AutoregressiveNoise::from_autocovariance(&observed);
        // In white noise all frequencies are alike.
        let rounds = if share < 1.0 { 0 } else { SPECTRUM_ROUNDS };
        let seen_in = |mut noise: AutoregressiveNoise| {
            noise.innovation_std = noise.innovation_std.max(f64::MIN_POSITIVE);
            let filter = InnovationsFilter::new(noise, valid, starts);
            let white: Vec<Vec<f64>> = columns.par_iter().map(|column| filter.apply(column)).collect();
            let basis = orthonormal(&white);
            let left = basis.residual(&filter.apply(torque));
            (filter, basis.directions, left)
        };
        for _ in 0..rounds {
            let (filter, basis, left) = seen_in(noise);
            noise = corrected(filter.noise(), &left, &basis, ORDER);
        }
        // The scale once more from what is white: a model of low order does not have the whole spectrum.
        let (mut filter, basis, left) = seen_in(noise);
        // Noise that went through a low-pass has fewer directions than rows.
        let count = left.len() as f64;
        let freedom = (count - basis.len() as f64 / share).max(LEAST_FREE * count).max(1.0);
        let scale = (left.iter().map(|x| x * x).sum::<f64>() / freedom).sqrt();
        if scale > 0.0 {
            filter.scale_noise(scale);
        }
        JointWhitener { filter: Arc::new(filter), misfit: 1.0 }
    }

    pub(super) fn apply(&self, signal: &[f64]) -> Vec<f64> {
        let mut white = self.filter.apply(signal);
        white.iter_mut().for_each(|x| *x /= self.misfit);
        white
    }
}

/// Autocovariances of noise before it went through a low-pass that passes `share` of white noise: taken for white, since the
/// pass-band holds too few directions to estimate a spectrum.
///
/// The noise that is left has next to nothing above the pass-band. Made white, that nothing would outweigh all that the logs
/// hold: what counted would be the error of the filter that is taken for the one that was used.
fn before_low_pass(mut covariance: Vec<f64>, share: f64) -> Vec<f64> {
    if share < 1.0 {
        covariance[1..].fill(0.0);
    }
    covariance
}

/// Autocovariances from the pairs of which both count.
fn lags(signal: &[f64], valid: &[bool]) -> Vec<f64> {
    (0..=ORDER)
        .map(|lag| {
            let pairs = (lag..signal.len()).filter(|&t| valid[t] && valid[t - lag]);
            let (sum, count) = pairs.fold((0.0, 0usize), |(s, n), t| (s + signal[t] * signal[t - lag], n + 1));
            sum / count.max(1) as f64
        })
        .collect()
}

/// What smooth functions of a joint's own motion can do, friction-like and position-like, `[column][row]`.
pub(crate) fn rich(rows: &Rows, joint: usize) -> Vec<Vec<f64>> {
    let law = |f: &dyn Fn(f64, f64) -> f64| {
        rows.signal(|log| {
            let (q, v) = (log.motion.q.channel(joint), log.motion.qd.channel(joint));
            q.iter().zip(v).map(|(&q, &v)| f(q, v)).collect()
        })
    };
    let mut columns = vec![
        law(&|_, _| 1.0),
        law(&|_, v| v.abs()),
        law(&|q, _| q),
        law(&|_, v| (-v.abs() / SLOW).exp() * v.signum()),
        law(&|_, v| v * v.abs()),
    ];
    let positions: [fn(f64) -> f64; 4] = [f64::cos, f64::sin, |q| (2.0 * q).cos(), |q| (2.0 * q).sin()];
    for position in positions {
        let at = rows.logs.iter().map(|log| log.motion.q.channel(joint).iter().map(|&q| position(q)).collect());
        let at: Vec<Vec<f64>> = at.collect();
        let factors: [fn(f64) -> f64; 3] = [|_| 1.0, f64::signum, |v| v];
        for factor in factors {
            let logs = rows.logs.iter().zip(&at).flat_map(|(log, at)| {
                let speed = log.motion.qd.channel(joint);
                log.as_logged(&at.iter().zip(speed).map(|(at, &v)| at * factor(v)).collect::<Vec<f64>>())
            });
            columns.push(logs.collect());
        }
    }
    columns
}

/// An orthonormal basis of the columns' span.
fn orthonormal(columns: &[Vec<f64>]) -> OrthonormalBasis {
    OrthonormalBasis::new(&columns.iter().map(Vec::as_slice).collect::<Vec<&[f64]>>(), INDEPENDENT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::length;
    use crate::random;

    /// Slow noise under columns that take much of it: the model found is that of the noise, not of the residual.
    #[test]
    fn noise_is_found_under_what_the_regression_takes() {
        let truth = AutoregressiveNoise { coefficients: vec![0.85], innovation_std: 2.0 };
        let samples = 1500;
        let columns: Vec<Vec<f64>> = (0..40)
            .map(|k| (0..samples).map(|t| (std::f64::consts::PI * f64::from(k) * t as f64 / 1500.0).cos()).collect())
            .collect();
        let valid: Vec<bool> = (0..samples).map(|t| t % 100 > 6).collect();
        let (mut first, mut scale) = (0.0, 0.0);
        let runs = 20;
        for run in 0..runs {
            let noise = truth.simulate(samples, &mut random::stream(3, "whitening", run));
            let found = JointWhitener::new(&valid, &[0, samples], &noise, columns.clone(), 1.0);
            let lag = AutoregressiveNoise::from_autocovariance(&lags(&noise, &valid));
            first += (found.filter.noise().coefficients[0] - lag.coefficients[0]) / runs as f64;
            scale += found.filter.noise().std() / runs as f64;
        }
        let stationary = 2.0 / (1.0f64 - 0.85 * 0.85).sqrt();
        assert!(first.abs() < 0.03, "{first}");
        assert!((scale / stationary - 1.0).abs() < 0.1, "{scale} against {stationary}");
    }

    /// Noise that went through a low-pass under columns that went through it too: they take many of the few directions that it
    /// has, and its strength is found all the same.
    #[test]
    fn noise_of_filtered_torque_is_not_taken_for_what_the_columns_leave() {
        let (samples, share) = (1200, 0.1);
        // White noise and columns in the lowest tenth of all frequencies.
        let cosine = |k: usize, t: usize| (std::f64::consts::PI * k as f64 * (t as f64 + 0.5) / samples as f64).cos();
        let columns: Vec<Vec<f64>> =
            (0..120).step_by(2).map(|k| (0..samples).map(|t| cosine(k, t)).collect()).collect();
        let white = AutoregressiveNoise { coefficients: vec![], innovation_std: 1.0 };
        let (mut found, mut left) = (0.0, 0.0);
        let runs = 10;
        for run in 0..runs {
            let size = white.simulate(120, &mut random::stream(5, "filtered noise", run));
            let noise: Vec<f64> =
                (0..samples).map(|t| size.iter().enumerate().map(|(k, s)| s * cosine(k, t)).sum()).collect();
            let rms = length(&noise) / (samples as f64).sqrt();
            let whitener = JointWhitener::new(&vec![true; samples], &[0, samples], &noise, columns.clone(), share);
            found += whitener.filter.noise().std() / rms / runs as f64;
            let rest = orthonormal(&columns).residual(&noise);
            left += length(&rest) / (samples as f64).sqrt() / rms / runs as f64;
        }
        assert!((found - 1.0).abs() < 0.15, "{found}");
        assert!(left < 0.8, "{left}");
    }
}
