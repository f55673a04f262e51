//! Levels that several questions share.

use serde::Serialize;

/// Conventional levels. One kind of question has one level, whatever it is asked about.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Levels;
///
/// // From "as likely as not" to "with certainty".
/// let levels = Levels::default();
/// let ladder = [levels.even_p, levels.leaning_p, levels.open_p, levels.usual_p, levels.strict_p, levels.sure_p];
/// assert!(ladder.windows(2).all(|pair| pair[0] > pair[1]));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Levels {
    /// Highest p-value of the training logs, corrected for what was looked for there, at which held-out logs are asked: above it what they
    /// would confirm is as likely as not chance.
    pub even_p: f64,
    /// Highest p-value of the held-out logs at which they lean the same way: what goes with noise alone as often contradicts as it
    /// supports.
    pub leaning_p: f64,
    /// Highest p-value at which a test of low power leaves something open: it is looked at again, or stays an alternative.
    pub open_p: f64,
    /// The usual 5 %: held-out logs show the same again, or contradict it.
    pub usual_p: f64,
    /// The strict 1 %: what rests on one kind of data alone, or on the scatter between a few blocks.
    pub strict_p: f64,
    /// p-value below which one of two models is better with certainty: one of many comparisons in a search.
    pub sure_p: f64,
    /// Least difference of the logarithms of two likelihoods at which the larger is preferred: odds of 20 to 1.
    pub log_odds: f64,
    /// Standard deviations of the one-sided bound of a gain or a growth: one (84 %), since the level of false alarms is that of the test on
    /// the training logs, and the held-out logs, often fewer, must not contradict it.
    pub bound_std: f64,
    /// Factor on the noise from which a residual holds something else.
    pub misfit: f64,
}

impl Default for Levels {
    fn default() -> Self {
        Levels {
            even_p: 0.5,
            leaning_p: 0.2,
            open_p: 0.1,
            usual_p: 0.05,
            strict_p: 0.01,
            sure_p: 1e-3,
            log_odds: 3.0,
            bound_std: 1.0,
            misfit: 1.5,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_become_stricter() {
        let Levels { even_p, leaning_p, open_p, usual_p, strict_p, sure_p, .. } = Levels::default();
        assert!([even_p, leaning_p, open_p, usual_p, strict_p, sure_p].is_sorted_by(|a, b| a > b));
    }
}
