//! Thresholds of gears with play that impacts show.

use serde::Serialize;

/// Thresholds that decide whether impacts of gear teeth name play.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ImpactCriteria {
    /// Factor on alpha at which impacts are significant where the held-out logs have no change of sign of the load.
    pub unconfirmed: f64,
}

impl Default for ImpactCriteria {
    fn default() -> Self {
        ImpactCriteria { unconfirmed: 1e-6 }
    }
}
