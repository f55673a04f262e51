//! A linear regression as a problem for Levenberg-Marquardt.

use super::least_squares::{JointRegression, weighted_normal_equations};
use super::levenberg_marquardt::{LeastSquaresProblem, NormalEquations};
use crate::error::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// The rows of all joints, weighted with 1 / sigma^2 per joint. J is the regressor and does not depend on the
/// parameters, so J'WJ is formed once; residuals are taken anew at every point, which keeps the last digits that a
/// difference of large sums of squares would lose.
pub struct RegressionProblem<'a> {
    joints: &'a [JointRegression],
    weights: Vec<f64>,
    jtwj: DMatrix<f64>,
}

impl<'a> RegressionProblem<'a> {
    /// The problem of finding `parameters` parameters from `joints`, whose residuals have the standard deviations
    /// `sigma` (N m).
    ///
    /// # Errors
    /// Not one sigma per joint, or one that is not a positive number.
    pub fn new(joints: &'a [JointRegression], sigma: &[f64], parameters: usize) -> Result<Self> {
        let subject = "weights of the regression";
        if sigma.len() != joints.len() {
            let problem = format!("{} standard deviations for {} joints; give one each", sigma.len(), joints.len());
            return Err(Error::request(subject, problem));
        }
        if let Some(joint) = sigma.iter().position(|s| !(s.is_finite() && *s > 0.0)) {
            let problem = format!("the standard deviation of joint {} is {}; give a positive number", joint + 1, sigma[joint]);
            return Err(Error::request(subject, problem));
        }
        let grams: Vec<_> = joints.iter().map(JointRegression::gram).collect();
        let (jtwj, _) = weighted_normal_equations(joints, &grams, sigma, parameters);
        let weights = sigma.iter().map(|s| 1.0 / (s * s)).collect();
        Ok(RegressionProblem { joints, weights, jtwj })
    }

    /// Residual of `joint` at `p`, zero where a row does not count.
    fn residual(&self, joint: &JointRegression, p: &[f64]) -> Vec<f64> {
        let residual = joint.residual(p);
        residual.into_iter().zip(&joint.valid).map(|(value, &ok)| if ok { value } else { 0.0 }).collect()
    }
}

impl LeastSquaresProblem for RegressionProblem<'_> {
    fn parameters(&self) -> usize {
        self.jtwj.nrows()
    }

    fn measurements(&self) -> usize {
        self.joints.iter().map(JointRegression::rows).sum()
    }

    fn normal_equations(&mut self, p: &[f64]) -> Result<NormalEquations> {
        let mut jtwr = DVector::zeros(self.parameters());
        let mut chi2 = 0.0;
        for (joint, weight) in self.joints.iter().zip(&self.weights) {
            let residual = self.residual(joint, p);
            chi2 += weight * dot(&residual, &residual);
            for (&parameter, column) in joint.parameters.iter().zip(joint.columns.iter()) {
                jtwr[parameter] += weight * dot(column, &residual);
            }
        }
        Ok(NormalEquations { jtwj: self.jtwj.clone(), jtwr, chi2 })
    }

    fn chi2(&mut self, p: &[f64]) -> Result<f64> {
        let squares = self.joints.iter().map(|joint| {
            let residual = self.residual(joint, p);
            dot(&residual, &residual)
        });
        Ok(squares.zip(&self.weights).map(|(sum, weight)| sum * weight).sum())
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::identification::least_squares::weighted_solution;
    use crate::identification::levenberg_marquardt::{Damping, Options, Scaling, minimize};
    use crate::random;
    use rand::RngExt;
    use rand_distr::{Distribution, StandardNormal};

    /// Two joints that share parameter 1, with noise of very different size and some rows that do not count.
    fn regression() -> Vec<JointRegression> {
        let truth = [2.0, -30.0, 0.004];
        let mut source = random::stream(5, "regression", 0);
        [(vec![0, 1], 0.3), (vec![1, 2], 20.0)]
            .into_iter()
            .map(|(parameters, noise)| {
                let columns = Channels::from_vectors(&[
                    (0..200).map(|_| source.random_range(-1.0..1.0)).collect(),
                    (0..200).map(|_| source.random_range(-900.0..900.0)).collect(),
                ]);
                let valid: Vec<bool> = (0..200).map(|row| row % 7 != 3).collect();
                let torque = (0..200)
                    .map(|row| {
                        let model: f64 = parameters.iter().zip(columns.iter()).map(|(&k, c)| truth[k] * c[row]).sum();
                        let white: f64 = StandardNormal.sample(&mut source);
                        if valid[row] { model + noise * white } else { f64::from(1 << 20) }
                    })
                    .collect();
                JointRegression { parameters, columns, torque, valid }
            })
            .collect()
    }

    #[test]
    fn levenberg_marquardt_finds_the_weighted_least_squares_solution() {
        let joints = regression();
        let names = ["a", "b", "c"].map(str::to_owned);
        let sigma = [0.3, 20.0];
        let expected = weighted_solution(&joints, &sigma, &names).unwrap();
        for scaling in [Scaling::Identity, Scaling::Diagonal] {
            for damping in [Damping::default(), Damping::Quadratic, Damping::Nielsen] {
                let options = Options { scaling, damping, ..Options::default() };
                let mut problem = RegressionProblem::new(&joints, &sigma, 3).unwrap();
                let fit = minimize(&mut problem, &[0.0; 3], &options).unwrap();
                assert!(fit.stop.converged(), "{:?}", fit.stop);
                for (found, wanted) in fit.parameters.iter().zip(&expected) {
                    assert!((found / wanted - 1.0).abs() < 1e-9, "{scaling:?} {damping:?}: {found} {wanted}");
                }
                let freedom = (problem.measurements() - 3) as f64;
                assert!((fit.chi2() / freedom - 1.0).abs() < 0.2, "weights of the true size give chi2 near its freedom");
            }
        }
    }

    #[test]
    fn the_gradient_is_that_of_chi2() {
        let joints = regression();
        let mut problem = RegressionProblem::new(&joints, &[0.3, 20.0], 3).unwrap();
        let p = [1.0, -20.0, 0.1];
        let normal = problem.normal_equations(&p).unwrap();
        assert!((normal.chi2 / problem.chi2(&p).unwrap() - 1.0).abs() < 1e-14);
        for k in 0..3 {
            let (mut before, mut after) = (p, p);
            let step = 1e-4 * p[k];
            before[k] -= step;
            after[k] += step;
            // Central differences of a parabola are exact.
            let slope = (problem.chi2(&after).unwrap() - problem.chi2(&before).unwrap()) / (2.0 * step);
            assert!((slope / (-2.0 * normal.jtwr[k]) - 1.0).abs() < 1e-6, "parameter {k}: {slope}");
        }
    }

    #[test]
    fn unusable_weights_are_refused() {
        let joints = regression();
        let message = |sigma: &[f64]| RegressionProblem::new(&joints, sigma, 3).err().unwrap().to_string();
        assert!(message(&[1.0]).contains("1 standard deviations for 2 joints"));
        assert!(message(&[1.0, 0.0]).contains("joint 2 is 0"));
    }
}
