//! Play of a gear, as the impacts of its teeth show it.

/// A gear's play as its impacts show it.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Play;
///
/// // As `Found::impacts` has it: 0.5 mrad, from teeth that met after 18 of 40 changes of the load's sign.
/// let play = Play { half_gap: 2.5e-4, std: 4e-5, changes: 40, impacts: 18 };
/// assert!(play.half_gap > 3.0 * play.std && play.impacts <= play.changes);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Play {
    /// Half the play, rad.
    pub half_gap: f64,
    /// Its standard deviation, rad.
    pub std: f64,
    /// Changes of sign of the gear's load that can be looked at.
    pub changes: usize,
    /// Those among the moments after which the torque jumps most.
    pub impacts: usize,
}
