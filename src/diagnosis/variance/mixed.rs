//! Restricted maximum likelihood of the strengths of random effects.

use super::design::Design;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Rounds of the fixed point; strengths that matter settle within half as many.
const ROUNDS: usize = 40;

/// Strength, over that of the noise, at which a kind counts as absent.
const ABSENT: f64 = 1e-6;

/// A mixed model fitted to one joint.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    /// Variance of each kind per row, (N m)^2; zero where absent.
    pub strengths: Vec<f64>,
    /// Variance of the noise per row, (N m)^2.
    pub noise: f64,
    /// Residual, N m.
    pub residual: DVector<f64>,
    /// Fitted part of each kind over the rows, N m.
    pub parts: Vec<DVector<f64>>,
    /// Degrees of freedom that the random effects take.
    pub freedom: f64,
}

/// The posterior of the random effects under given strengths: `A = Z'Z / noise + diag(1 / s^2)`, factored.
pub(super) struct Posterior {
    /// Their matrix.
    pub z: DMatrix<f64>,
    /// The factor of A.
    pub factor: Cholesky<f64, Dyn>,
}

impl Posterior {
    /// With the strengths of each kind; None where no kind is present or the matrix is singular.
    pub fn new(design: &Design, strengths: &[f64], noise: f64) -> Option<Self> {
        let mut columns = Vec::new();
        let mut prior = Vec::new();
        for ((_, range), &strength) in design.kinds.iter().zip(strengths) {
            if strength > ABSENT * noise {
                columns.extend(range.clone());
                prior.extend(range.clone().map(|_| 1.0 / strength));
            }
        }
        if columns.is_empty() {
            return None;
        }
        let z = design.z.select_columns(&columns);
        let a = z.tr_mul(&z) / noise + DMatrix::from_diagonal(&DVector::from_vec(prior));
        Some(Posterior { factor: a.cholesky()?, z })
    }

    /// Means of the random effects, given the torque.
    pub fn mean(&self, y: &DVector<f64>, noise: f64) -> DVector<f64> {
        self.factor.solve(&(self.z.tr_mul(y) / noise))
    }

    /// What is outside the reach of the random effects, shrunk as they are: `(I - Z A^-1 Z' / noise) columns`.
    pub fn residual_of(&self, columns: &DMatrix<f64>, noise: f64) -> DMatrix<f64> {
        columns - &self.z * self.factor.solve(&(self.z.tr_mul(columns) / noise))
    }
}

/// Fits strengths and noise.
pub(super) fn fit(design: &Design) -> Fit {
    let (rows, count) = (design.y.len(), design.kinds.len());
    let free = (rows.saturating_sub(design.rank)).max(1) as f64;
    let mut noise = (design.y.norm_squared() / free).max(f64::MIN_POSITIVE);
    let mut fit = Fit {
        strengths: vec![0.1 * noise; count],
        noise,
        residual: design.y.clone(),
        parts: vec![DVector::zeros(rows); count],
        freedom: 0.0,
    };
    for _ in 0..ROUNDS {
        let Some(posterior) = Posterior::new(design, &fit.strengths, noise) else {
            fit.strengths.fill(0.0);
            fit.parts.iter_mut().for_each(|part| part.fill(0.0));
            (fit.residual, fit.freedom, noise) = (design.y.clone(), 0.0, design.y.norm_squared() / free);
            break;
        };
        let mean = posterior.mean(&design.y, noise);
        let covariance = posterior.factor.inverse();
        fit.residual = &design.y - &posterior.z * &mean;
        fit.freedom = 0.0;
        let mut place = 0;
        for (k, (_, range)) in design.kinds.iter().enumerate() {
            let strength = fit.strengths[k];
            if strength <= ABSENT * noise {
                fit.strengths[k] = 0.0;
                fit.parts[k].fill(0.0);
                continue;
            }
            let own = place..place + range.len();
            place = own.end;
            let effects = mean.rows(own.start, own.len());
            let spread: f64 = own.clone().map(|i| covariance[(i, i)]).sum();
            let freedom = (own.len() as f64 - spread / strength).max(0.0);
            fit.freedom += freedom;
            fit.parts[k] = posterior.z.columns(own.start, own.len()) * effects;
            // The update of expectation maximisation: slower than MacKay's near the end, but it cannot overshoot from far away.
            let em = (effects.norm_squared() + spread) / own.len() as f64;
            let fixed_point = if freedom > 1e-3 { effects.norm_squared() / freedom } else { 0.0 };
            fit.strengths[k] = if fixed_point < em { fixed_point } else { (em * fixed_point).sqrt() };
        }
        noise = (fit.residual.norm_squared() / (free - fit.freedom).max(1.0)).max(f64::MIN_POSITIVE);
    }
    fit.noise = noise;
    fit
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::diagnosis::variance::kinds::Kind;
    use crate::random::stream;
    use rand_distr::{Distribution, StandardNormal};

    /// 600 rows of noise of standard deviation one, and of a part of standard deviation `size` that follows the first kind; the
    /// second plays no part.
    pub(in crate::diagnosis::variance) fn one_kind_of_two(size: f64, seed: u64) -> Design {
        let (rows, each) = (600, 6);
        let mut source = stream(seed, "mixed_model_test", 0);
        let mut normal = || -> f64 { StandardNormal.sample(&mut source) };
        let slow = |row: usize, k: usize| (0.01 * (k + 1) as f64 * row as f64 + k as f64).sin();
        let z = DMatrix::from_fn(rows, 2 * each, |row, k| (2.0f64 / each as f64).sqrt() * slow(row, k));
        let effects = DVector::from_fn(each, |_, _| normal());
        let mut part = z.columns(0, each) * effects;
        part *= size / (part.norm_squared() / rows as f64).sqrt();
        Design {
            y: part + DVector::from_fn(rows, |_, _| normal()),
            z,
            kinds: vec![(Kind::Position, 0..each), (Kind::Speed, each..2 * each)],
            rank: 0,
            runs: std::iter::once(0..rows).collect(),
            time: (0..rows).collect(),
            log: vec![0; rows],
        }
    }

    #[test]
    fn strength_and_noise_are_those_put_in() {
        for seed in 0..5 {
            let fit = fit(&one_kind_of_two(2.0, seed));
            let size = (fit.parts[0].norm_squared() / 600.0).sqrt();
            assert!((size - 2.0).abs() < 0.25, "{seed}: {size}");
            assert!((fit.noise.sqrt() - 1.0).abs() < 0.1, "{seed}: {}", fit.noise);
            assert!(fit.strengths[1] < 0.05 * fit.strengths[0], "{seed}: {:?}", fit.strengths);
        }
    }

    #[test]
    fn noise_alone_has_no_strength() {
        let small = |seed| {
            let fit = fit(&one_kind_of_two(0.0, seed));
            fit.parts.iter().all(|part| (part.norm_squared() / 600.0).sqrt() < 0.2)
        };
        assert!((0..10).filter(|&seed| small(seed)).count() >= 9);
    }
}
