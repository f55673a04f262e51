//! Limits of what a machine can have of a law.

use serde::Serialize;

/// A limit of a quantity of a law, beyond the bounds of its parameters: what a machine can have, and what logs can show.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Backlash, Effect, Limit};
///
/// // Half a gap of twice the least one is half of what would be refused; one that is negative can never be.
/// let [limit] = Backlash.limits() else { panic!("it has one limit") };
/// let Limit { least: Some(least), most: None, .. } = *limit else { panic!("it is a lower one") };
/// assert_eq!((limit.over(2.0 * least), limit.over(-least)), (0.5, f64::INFINITY));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    /// What is limited, with its unit.
    pub quantity: &'static str,
    /// The least that it must be; None where nothing is too little.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least: Option<f64>,
    /// The most that it can be; None where nothing is too much.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub most: Option<f64>,
}

impl Limit {
    /// A quantity that can be too little.
    pub(super) const fn least(quantity: &'static str, least: f64) -> Self {
        Limit { quantity, least: Some(least), most: None }
    }

    /// A quantity that can be too much.
    pub(super) const fn most(quantity: &'static str, most: f64) -> Self {
        Limit { quantity, least: None, most: Some(most) }
    }

    /// A value over the most that it can be, or the least that it must be over the value: at most one within the limit, infinite where a
    /// value that must be positive is not, and of no number.
    pub fn over(&self, value: f64) -> f64 {
        let most = self.most.map_or(0.0, |most| value / most);
        let least = self.least.map_or(0.0, |least| if value > 0.0 { least / value } else { f64::INFINITY });
        if value.is_nan() { f64::INFINITY } else { most.max(least) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_side_of_a_limit() {
        let (least, most) = (Limit::least("gap", 2.0), Limit::most("error", 2.0));
        assert_eq!([least.over(4.0), least.over(2.0), least.over(1.0)], [0.5, 1.0, 2.0]);
        assert_eq!([least.over(0.0), least.over(-4.0)], [f64::INFINITY; 2]);
        assert_eq!(most.over(f64::NAN), f64::INFINITY);
        assert_eq!([most.over(1.0), most.over(2.0), most.over(4.0), most.over(-4.0)], [0.5, 1.0, 2.0, 0.0]);
    }
}
