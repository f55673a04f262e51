//! A description that was judged.

use super::change::Description;
use super::compare::EXPLAINED;
use super::fitting::{Evaluation, Fit, Physics, Rows};
use super::verdict::Alternative;

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

    /// Whether it explains half of the torques at least: friction may make those of small joints.
    pub(super) fn explains_half(&self) -> bool {
        let shares: Vec<f64> = self.evaluation.unexplained.iter().copied().flatten().collect();
        2 * shares.iter().filter(|share| **share < EXPLAINED).count() >= shares.len().max(1)
    }

    /// The same as an alternative in a verdict.
    pub(super) fn alternative(self) -> Alternative {
        Alternative { unexplained: self.share(), changes: self.description.changes }
    }

    /// Geometric mean over the torques of the shares left unexplained.
    pub(super) fn share(&self) -> f64 {
        let logs: Vec<f64> = self.evaluation.unexplained.iter().flatten().map(|share| share.max(1e-9).ln()).collect();
        (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp()
    }
}
