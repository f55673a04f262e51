//! Thresholds of gears with play that impacts show.

use serde::Serialize;

/// Thresholds that decide whether impacts of gear teeth name play.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Criteria, ImpactCriteria};
///
/// // Impacts that no held-out log can confirm must be far more certain.
/// assert!(Criteria::default().impacts.unconfirmed < 1e-3);
/// let criteria = Criteria { impacts: ImpactCriteria { unconfirmed: 1e-3 }, ..Criteria::default() };
/// assert_eq!(criteria.impacts.unconfirmed, 1e-3);
/// ```
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
