//! Output error by simulation (DIDIM: Gautier, Janot and Vandanjon, "A new closed-loop output error method for parameter
//! identification of robot dynamics", IEEE Transactions on Control Systems Technology 21, 2013).

use super::estimator::{Data, Estimator, MOST_ROUNDS, settled, unsettled};
use crate::error::Result;
use crate::identification::regression::least_squares::{
    Estimate, require_rows, residual_sigma, weighted_least_squares, weighted_solution,
};

/// The measured torque on the columns along the simulated motion: only torques are measured. Under a controller that makes
/// the arm follow its reference whatever its parameters, the simulated motion hardly depends on them, so that a linear
/// fit to iterate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Didim;

impl Estimator for Didim {
    fn name(&self) -> &'static str {
        "didim"
    }

    fn title(&self) -> &'static str {
        "output error by simulation in closed loop"
    }

    fn simulates(&self) -> bool {
        true
    }

    fn estimate(&self, data: &Data) -> Result<Estimate> {
        let simulated = data.require_simulation(self.name())?;
        let mut beta = data.start.to_vec();
        let mut sigma: Option<Vec<f64>> = None;
        for _ in 0..MOST_ROUNDS {
            let rows = simulated.rows(&beta)?;
            require_rows(&rows)?;
            let weights = sigma.unwrap_or_else(|| residual_sigma(&rows, &beta));
            let next = weighted_solution(&rows, &weights, data.names)?;
            if settled(&rows, &beta, &next, &weights) {
                return weighted_least_squares(&rows, data.names);
            }
            sigma = Some(residual_sigma(&rows, &next));
            beta = next;
        }
        Err(unsettled(self))
    }
}
