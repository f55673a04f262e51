//! Restricted maximum likelihood of the strengths of random effects.
//!
//! The model is a linear mixed model per joint, `y = X b + sum_k Z_k u_k + e` with `u_k ~ N(0, s_k^2 I)`. Strengths are estimated by
//! restricted maximum likelihood (Patterson and Thompson, 1971; fixed point of MacKay, 1992). Each component is tested by its score (Lin,
//! 1997) with signs flipped block by block (wild cluster bootstrap: Cameron, Gelbach and Miller, 2008), so that neither the spectrum of the
//! noise nor its scale has to be known.

use super::design::Design;
use crate::linear::{Cholesky, transposed_product};
use nalgebra::{DMatrix, DVector};

/// Most rounds of the fixed point, and the change of every strength, over itself and the noise, at which it has converged.
const ROUNDS: usize = 40;
const SETTLED: f64 = 1e-3;

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
    /// Logarithm of the restricted likelihood, but for what no strength changes.
    pub log_likelihood: f64,
}

/// The posterior of the random effects under given strengths: `A = Z'Z / noise + diag(1 / s^2)`, factored.
pub(super) struct Posterior {
    /// Columns of the design that are present.
    pub columns: Vec<usize>,
    /// The factor of A.
    pub factor: Cholesky,
}

impl Posterior {
    /// With the strengths of each kind; None where no kind is present or the matrix is singular.
    pub(super) fn new(design: &Design, strengths: &[f64], noise: f64) -> Option<Self> {
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
        let mut a = design.gram.select_rows(&columns).select_columns(&columns) / noise;
        prior.into_iter().enumerate().for_each(|(k, precision)| a[(k, k)] += precision);
        Some(Posterior { factor: Cholesky::new(a)?, columns })
    }

    /// Means of the random effects, given the torque.
    fn mean(&self, design: &Design, noise: f64) -> DVector<f64> {
        self.factor.solve(&(design.right.select_rows(&self.columns) / noise))
    }

    /// What is outside the reach of the random effects, shrunk as they are: `(I - Z A^-1 Z' / noise) columns`.
    pub(super) fn residual_of(&self, design: &Design, columns: &DMatrix<f64>, noise: f64) -> DMatrix<f64> {
        let z = design.z.select_columns(&self.columns);
        columns - &z * self.factor.solve_columns(transposed_product(&z, columns) / noise)
    }

    /// Directions `W` that the random effects take of the rows: `W W' = Z A^-1 Z' / noise`.
    pub(super) fn directions(&self, design: &Design, noise: f64) -> DMatrix<f64> {
        let z = design.z.select_columns(&self.columns).transpose() / noise.sqrt();
        self.factor.solve_lower(z).transpose()
    }
}

/// Fits strengths and noise.
pub(super) fn fit(design: &Design) -> Fit {
    let free = (design.y.len().saturating_sub(design.rank())).max(1) as f64;
    let noise = (design.y.norm_squared() / free).max(f64::MIN_POSITIVE);
    fit_from(design, vec![0.1 * noise; design.kinds.len()], noise)
}

/// The same from these strengths and this noise; those that are absent stay so.
pub(super) fn fit_from(design: &Design, mut strengths: Vec<f64>, mut noise: f64) -> Fit {
    let free = (design.y.len().saturating_sub(design.rank())).max(1) as f64;
    let square = design.y.norm_squared();
    // A kind without functions, as of other joints where there are none, is absent.
    let empty = design.kinds.iter().zip(&mut strengths).filter(|((_, range), _)| range.is_empty());
    empty.for_each(|(_, strength)| *strength = 0.0);
    for _ in 0..ROUNDS {
        let before = (strengths.clone(), noise);
        let Some(posterior) = Posterior::new(design, &strengths, noise) else {
            strengths.fill(0.0);
            noise = (square / free).max(f64::MIN_POSITIVE);
            break;
        };
        let mean = posterior.mean(design, noise);
        let covariance = posterior.factor.inverse();
        let mut taken = 0.0;
        let mut place = 0;
        for ((_, range), strength) in design.kinds.iter().zip(&mut strengths) {
            if *strength <= ABSENT * noise {
                *strength = 0.0;
                continue;
            }
            let own = place..place + range.len();
            place = own.end;
            let size = mean.rows(own.start, own.len()).norm_squared();
            let spread: f64 = own.clone().map(|i| covariance[(i, i)]).sum();
            let freedom = (own.len() as f64 - spread / *strength).max(0.0);
            taken += freedom;
            // The update of expectation maximisation: slower than MacKay's near the end, but it cannot overshoot from far away.
            let em = (size + spread) / own.len() as f64;
            let fixed_point = if freedom > 1e-3 { size / freedom } else { 0.0 };
            *strength = if fixed_point < em { fixed_point } else { (em * fixed_point).sqrt() };
        }
        let gram = design.gram.select_rows(&posterior.columns).select_columns(&posterior.columns);
        let right = design.right.select_rows(&posterior.columns);
        let left = square - 2.0 * mean.dot(&right) + mean.dot(&(gram * &mean));
        noise = (left / (free - taken).max(1.0)).max(f64::MIN_POSITIVE);
        let moved = before.0.iter().zip(&strengths).map(|(old, new)| (new - old).abs() / (new + noise));
        if moved.fold((noise - before.1).abs() / noise, f64::max) < SETTLED {
            break;
        }
    }
    settled(design, strengths, noise)
}

/// The fit under strengths and noise that have converged.
fn settled(design: &Design, strengths: Vec<f64>, noise: f64) -> Fit {
    let (rows, square) = (design.y.len(), design.y.norm_squared());
    let free = (rows.saturating_sub(design.rank())).max(1) as f64;
    let mut fit = Fit {
        residual: design.y.clone(),
        parts: vec![DVector::zeros(rows); strengths.len()],
        log_likelihood: -0.5 * (free * noise.ln() + square / noise),
        strengths,
        noise,
    };
    let Some(posterior) = Posterior::new(design, &fit.strengths, noise) else { return fit };
    let mean = posterior.mean(design, noise);
    let mut place = 0;
    let mut log_prior = 0.0;
    for (k, (_, range)) in design.kinds.iter().enumerate() {
        let strength = fit.strengths[k];
        if strength <= ABSENT * noise {
            continue;
        }
        let own = place..place + range.len();
        place = own.end;
        fit.parts[k] = design.z.columns(range.start, range.len()) * mean.rows(own.start, own.len());
        fit.residual -= &fit.parts[k];
        log_prior += own.len() as f64 * strength.ln();
    }
    // The marginal covariance of the torque is V = noise I + sum s^2 Z Z': log |V| = rows log noise + log |A| + sum log s^2.
    let along = mean.dot(&design.right.select_rows(&posterior.columns)) / noise;
    fit.log_likelihood =
        -0.5 * (free * noise.ln() + posterior.factor.log_determinant() + log_prior + square / noise - along);
    fit
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::design::ConstantOfLaw;
    use super::super::kinds::Kind;
    use super::*;
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
        let y = part + DVector::from_fn(rows, |_, _| normal());
        Design {
            gram: z.tr_mul(&z),
            right: z.tr_mul(&y),
            y,
            z,
            kinds: vec![(Some(Kind::Position), 0..each), (Some(Kind::Speed), each..2 * each)],
            basis: DMatrix::zeros(rows, 0),
            runs: std::iter::once(0..rows).collect(),
            time: (0..rows).collect(),
            log: vec![0; rows],
            together: 4,
            constant: ConstantOfLaw::No,
            squares: vec![[1.0; 2]; 12],
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

    #[test]
    fn a_kind_without_functions_is_absent() {
        let mut design = one_kind_of_two(1.0, 2);
        design.kinds.push((None, 12..12));
        let fit = fit(&design);
        assert!(fit.strengths[2] == 0.0 && fit.log_likelihood.is_finite(), "{fit:?}");
    }

    /// The density of a multivariate normal with the marginal covariance, worked out row by row.
    #[test]
    fn the_likelihood_is_that_of_the_marginal_covariance() {
        let mut design = one_kind_of_two(1.0, 3);
        let keep: Vec<usize> = (0..60).collect();
        design.z = design.z.select_rows(&keep);
        design.y = design.y.select_rows(&keep);
        (design.gram, design.right) = (design.z.tr_mul(&design.z), design.z.tr_mul(&design.y));
        let (strengths, noise) = (vec![0.7, 0.2], 1.3);
        let mut covariance = DMatrix::identity(60, 60) * noise;
        for ((_, range), strength) in design.kinds.iter().zip(&strengths) {
            let z = design.z.columns(range.start, range.len());
            covariance += z * z.transpose() * *strength;
        }
        let factor = covariance.cholesky().unwrap();
        let log_determinant = 2.0 * factor.l().diagonal().iter().map(|x: &f64| x.ln()).sum::<f64>();
        let expected = -0.5 * (log_determinant + design.y.dot(&factor.solve(&design.y)));
        let found = settled(&design, strengths, noise).log_likelihood;
        assert!((found - expected).abs() < 1e-9 * expected.abs(), "{found} {expected}");
    }
}
