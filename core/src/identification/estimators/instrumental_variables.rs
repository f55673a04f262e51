//! Instrumental variables from the simulated arm (IDIM-IV: Janot, Vandanjon and Gautier, "A generic instrumental variable
//! approach for industrial robot identification", IEEE Transactions on Control Systems Technology 22, 2014).

use super::covariance::{MomentEquations, assemble};
use super::estimator::{Data, Estimator, MOST_ROUNDS, settled, unsettled};
use crate::error::Result;
use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::least_squares::{Estimate, require_rows, residual_sigma};

/// Z'W (tau - Y beta) = 0 with instruments Z, the columns along the motion that the arm with the present estimate makes in
/// simulation: they follow the true columns but not the noise in the measured ones, which biases least squares.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InstrumentalVariables;

impl Estimator for InstrumentalVariables {
    fn name(&self) -> &'static str {
        "iv"
    }

    fn title(&self) -> &'static str {
        "instrumental variables from simulation"
    }

    fn simulates(&self) -> bool {
        true
    }

    fn estimate(&self, data: &Data) -> Result<Estimate> {
        let simulated = data.require_simulation(self.name())?;
        let mut beta = data.start.to_vec();
        let mut sigma: Option<Vec<f64>> = None;
        for _ in 0..MOST_ROUNDS {
            let instruments = simulated.rows(&beta)?;
            require_rows(&instruments)?;
            let rows: Vec<JointRegression> = data
                .rows
                .iter()
                .zip(&instruments)
                .map(|(joint, z)| JointRegression { valid: z.valid.clone(), ..joint.clone() })
                .collect();
            let weights = sigma.unwrap_or_else(|| residual_sigma(&rows, &beta));
            let next = MomentEquations::new(&instruments, &rows, &weights, beta.len()).solve()?;
            let done = settled(&instruments, &beta, &next, &weights);
            sigma = Some(residual_sigma(&rows, &next));
            beta = next;
            if done {
                return assemble(&instruments, &rows, beta, &weights, data.names);
            }
        }
        Err(unsettled(self))
    }
}
