//! Thresholds of the forward search.

use serde::Serialize;

/// Thresholds that decide whether a candidate is taken into the model.
///
/// The first four are shares of the family-wise alpha, one for each way in which a candidate can pass: their sum is one. The factors
/// after them make single kinds of effects stricter within the first share, because an error that the tests do not model looks like them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SearchCriteria {
    /// Share of alpha for what the training logs show: the tests take the noise for known, and it is estimated.
    pub training: f64,
    /// Share of alpha for what training and held-out logs show together: there the scatter over blocks stands in for the noise.
    pub confirmed: f64,
    /// Share of alpha for what all logs show together, each judged by the others.
    pub pooled: f64,
    /// Share of alpha for gears with play that impacts show.
    pub impacts: f64,
    /// Factor on alpha for an event in one log: no other log can confirm it.
    pub event: f64,
    /// Factor on alpha for gears: they act where smoothed positions err most, around reversals and jerks.
    pub gear: f64,
    /// Factor on alpha for torque saturation: rows in which the model's torque is extreme are also those in which its error is.
    pub saturation: f64,
    /// Factor on alpha for friction that builds up after reversals, near which smoothed positions err most.
    pub after_reversals: f64,
    /// Factor on alpha for a second law of friction over speed on one joint: books write such curves in many forms, and none is
    /// that of a gear.
    pub second_form: f64,
    /// Factor on alpha for what base parameters hide in part: the little that remains is also what smoothed positions make of the part
    /// that is hidden.
    pub hidden: f64,
    /// Largest share of alpha after an earlier finding (delays, which sampling brings, do not count): what is not quite right with that
    /// one remains in the residual.
    pub later: f64,
    /// Most that the statistic may lose where a shape at a bound of its law is moved inside: chi-square of one degree of freedom at 1 %. A
    /// law that is better at its bound than inside is not the law that acts; one that the logs do not determine loses nothing.
    pub at_bound: f64,
    /// Highest p-value without the blocks that show a candidate best; on the training logs alone, and where held-out logs confirm it.
    pub influence_p: [f64; 2],
    /// Family-wise p-value of the training logs below which the held-out logs need only not contradict it.
    pub beyond_chance: f64,
    /// Highest family-wise p-value of the training logs that held-out logs can confirm: above it one log alone would decide.
    pub confirmable_p: f64,
    /// Least share of the residual that a candidate must explain where the residual is well above the noise: there all that is small
    /// fits a little. Twice as much in the presence of constants.
    pub share_of_misfit: f64,
}

impl Default for SearchCriteria {
    fn default() -> Self {
        SearchCriteria {
            training: 0.2,
            confirmed: 0.4,
            pooled: 0.38,
            impacts: 0.02,
            event: 1e-7,
            gear: 1e-7,
            saturation: 1e-9,
            after_reversals: 1e-4,
            second_form: 1e-5,
            hidden: 1e-3,
            later: 0.02,
            at_bound: 6.63,
            influence_p: [0.01, 0.05],
            beyond_chance: 1e-6,
            confirmable_p: 0.3,
            share_of_misfit: 0.05,
        }
    }
}

impl SearchCriteria {
    /// Share of alpha that all ways of passing spend together.
    pub fn spent(&self) -> f64 {
        self.training + self.confirmed + self.pooled + self.impacts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_than_alpha_is_spent() {
        let criteria = SearchCriteria::default();
        assert!(criteria.spent() <= 1.0 + 1e-12, "{}", criteria.spent());
        let stricter =
            [criteria.event, criteria.gear, criteria.saturation, criteria.after_reversals, criteria.second_form];
        assert!(stricter.iter().chain([&criteria.hidden]).all(|factor| *factor < criteria.training));
    }
}
