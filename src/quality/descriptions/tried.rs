//! A description that was judged.

use super::change::Description;
use super::fitting::{Evaluation, Fit, Physics, Rows};

/// A description with its residuals.
pub(super) struct Tried {
    /// The description.
    pub description: Description,
    /// Residuals of the torques on held-out blocks.
    pub evaluation: Evaluation,
}

impl Tried {
    /// Judges a description; none where nothing can be fitted.
    pub(super) fn new(physics: &Physics, rows: &Rows, description: Description) -> Option<Tried> {
        let tables = physics.tables(rows, &description);
        let evaluation = Fit::new(&tables, rows, &description).evaluate()?;
        Some(Tried { description, evaluation })
    }

    /// Geometric mean over the torques of the shares left unexplained.
    pub(super) fn share(&self) -> f64 {
        let logs: Vec<f64> = self.evaluation.unexplained.iter().flatten().map(|share| share.max(1e-9).ln()).collect();
        (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp()
    }
}
