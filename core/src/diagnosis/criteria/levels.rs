//! Levels that several questions share.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};

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
    /// Highest p-value at which logs lean one way, and others can confirm it: held-out logs what training logs show, and the other way
    /// round. What goes with noise alone as often contradicts as it supports, and above it one of both would decide alone.
    pub leaning_p: f64,
    /// Highest p-value at which a test of low power leaves something open: it is looked at again, or stays an alternative.
    pub open_p: f64,
    /// The usual 5 %: held-out logs show the same again, or contradict it.
    pub usual_p: f64,
    /// The strict 1 %: what rests on one kind of data alone, or on the scatter between a few blocks.
    pub strict_p: f64,
    /// p-value below which one of two models is better with certainty, and above which a finding is superfluous with all others in the
    /// model: one of many comparisons in a search.
    pub sure_p: f64,
    /// Share of alpha of what is to be certain: structure that training logs show by themselves, spectral lines, and what comes after an
    /// earlier finding, of which what is not quite right remains in the residual. Noise that is not stationary makes p-values too small.
    pub certain: f64,
    /// Least difference of the logarithms of two likelihoods at which the larger is preferred: odds of 20 to 1.
    pub log_odds: f64,
    /// Standard deviations of the one-sided bound of a gain or a growth: one (84 %), since the level of false alarms is that of the test on
    /// the training logs, and the held-out logs, often fewer, must not contradict it.
    pub bound_std: f64,
    /// Factor on the noise from which a residual holds something else.
    pub misfit: f64,
    /// Share from which on a part is most of the whole.
    pub most: f64,
    /// Share up to which a part is minor: a tenth of what is missing matters, and less than a tenth of the noise does not. The parameters of
    /// the arm are estimated together, so that every joint's prediction moves by a few percent with any finding.
    pub minor: f64,
    /// Number of parts (blocks, joints, bodies) that may be single cases: what rests on no more of them is no property of the whole.
    pub few: usize,
    /// Factor on what is expected, or number of standard deviations, from which a value is far from it, whatever the noise model lacks.
    pub far: f64,
    /// Factor on the usual size of noise, in squares for bands and jumps, from which a single value stands out as something else: normal
    /// noise exceeds seven standard deviations, ten times its median size, in no log.
    pub stands_out: f64,
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
            certain: 0.02,
            log_odds: 3.0,
            bound_std: 1.0,
            misfit: 1.5,
            most: 0.5,
            minor: 0.1,
            few: 2,
            far: 3.0,
            stands_out: 10.0,
        }
    }
}

impl Levels {
    /// Standard deviations from zero at which a parameter is significant: two-sided at the usual level.
    pub(crate) fn significant_std(&self) -> f64 {
        Normal::standard().inverse_cdf(1.0 - 0.5 * self.usual_p)
    }

    /// Factor on the power of an encoder's noise from which motion is clear of it for shifts in time. A position controller answers to the
    /// noise too, and its torque goes with the position's rate as that of a shift does with the jerk: where the noise is a share of a
    /// motion, the shift is off by that share of the controller's time constant, which is tens of milliseconds.
    pub(crate) fn clear(&self) -> f64 {
        self.stands_out / self.minor
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

    #[test]
    fn a_parameter_is_significant_at_the_usual_level() {
        // The normal distribution's two-sided 5 %, from tables.
        assert!((Levels::default().significant_std() - 1.959_963_985).abs() < 1e-8);
    }
}
