//! Thresholds of gears with play that impacts show.

use serde::Serialize;

/// Thresholds that decide whether impacts of gear teeth name play.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ImpactCriteria {
    /// Factor on alpha at which impacts are significant where the held-out logs have no change of sign of the load.
    pub unconfirmed: f64,
    /// Highest p-value without the moments at which another gear's load changes sign too, below which the other gear is no alternative; and
    /// among moments only in which the loads change as much.
    pub own_p: f64,
    /// Highest p-value at which impacts leave the play of a joint open: small play hardly rattles, and where it is an alternative to what
    /// was found it need not be significant.
    pub open_p: f64,
}

impl Default for ImpactCriteria {
    fn default() -> Self {
        ImpactCriteria { unconfirmed: 1e-6, own_p: 0.01, open_p: 0.1 }
    }
}
