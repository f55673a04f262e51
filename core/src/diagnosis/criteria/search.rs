//! Thresholds of the forward search.

use serde::Serialize;

/// Thresholds that decide whether a candidate is taken into the model.
///
/// The first four are shares of the family-wise alpha, one for each way in which a candidate can pass: their sum is four fifths, and structure
/// that no effect explains has the last one. The factors after them make single kinds of effects stricter within the first share, because an
/// error that the tests do not model looks like them.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::SearchCriteria;
///
/// // The ways in which a candidate can pass share alpha with structure that no effect explains.
/// let search = SearchCriteria::default();
/// assert!((search.training + search.confirmed + search.pooled + search.impacts - 0.8).abs() < 1e-12);
/// ```
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
    /// Factor on alpha for what held-out logs cannot confirm. That is an event in one log, and impacts of gears whose load changes no sign in
    /// the held-out logs. Gears act where smoothed positions err most, around reversals and jerks. Torque saturation shows in rows in which
    /// the model's torque is extreme, as its error is. Below the same factor held-out logs need only not contradict what training logs show.
    pub unconfirmable: f64,
    /// Factor on alpha for what is hidden or imitated in part. Friction that builds up after reversals acts where smoothed positions err
    /// most. A second law of friction over speed on one joint fits the residual of the first, since books write such curves in many forms.
    /// Of what base parameters hide in part, smoothed positions make the little that remains, too.
    pub in_part: f64,
    /// Least share of the residual that a candidate must explain where the residual is well above the noise: there all that is small
    /// fits a little.
    pub share_of_misfit: f64,
    /// Factor by which the level of a second attempt at held-out logs is below that of the only one. The first has the rest of the level,
    /// so that a second one is possible and the first hardly pays for it.
    pub second_attempt: f64,
    /// Candidates that may be refused one after the other before the search ends; and in a search that adds to that over the training logs:
    /// over all logs, and for events that the noise model holds.
    pub refusals: [usize; 2],
}

impl Default for SearchCriteria {
    fn default() -> Self {
        SearchCriteria {
            training: 0.2,
            confirmed: 0.4,
            pooled: 0.18,
            impacts: 0.02,
            unconfirmable: 1e-7,
            in_part: 1e-4,
            share_of_misfit: 0.05,
            second_attempt: 5.0,
            refusals: [12, 3],
        }
    }
}

impl SearchCriteria {
    /// The shares of alpha that the ways of passing have.
    pub(crate) fn shares(&self) -> [f64; 4] {
        [self.training, self.confirmed, self.pooled, self.impacts]
    }

    /// Factors on the held-out p-value by attempt, under which the attempts share one level.
    pub(crate) fn attempts(&self) -> [f64; 2] {
        [1.0 / (1.0 - 1.0 / self.second_attempt), self.second_attempt]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_kinds_are_stricter_than_their_share() {
        let SearchCriteria { unconfirmable, in_part, training, .. } = SearchCriteria::default();
        assert!(unconfirmable < in_part && in_part < training);
    }

    #[test]
    fn attempts_share_the_level() {
        let attempts = SearchCriteria::default().attempts();
        assert!((attempts.iter().map(|factor| 1.0 / factor).sum::<f64>() - 1.0).abs() < 1e-12, "{attempts:?}");
        assert_eq!(attempts[1], 5.0);
    }
}
