//! Which samples of a joint surely move, and which rows see enough of them: friction's sign is the only column that a
//! velocity near zero can get wrong.
//!
//! The sign column goes through the filter of the torque, so a row near a reversal is as good as any other as long as the
//! moment of the reversal is known. It is known to where the velocity exceeds its own noise.

use crate::error::Result;
use crate::signal::Filter;

/// Speed below which the direction of a joint is not certain.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::prepare::{self, Smoothing};
/// use tauscope::identification::reversals::Band;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
///
/// // The wider the band of speeds, the fewer samples have a direction that is certain.
/// let smoothing = Smoothing::SavitzkyGolay { window: 11, order: 4, decimation: 4 };
/// let moving = |band: Band| prepare::measured(&log, &smoothing, band).map(|log| log.moving(0));
/// let samples = |band| Ok::<_, tauscope::error::Error>(moving(band)?.iter().filter(|moves| **moves).count());
/// assert!(samples(Band::Given(0.5))? < samples(Band::Given(0.05))?);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Band {
    /// The same for every joint, rad/s or m/s. No row whose filter reaches a slower sample is used.
    Given(f64),
    /// Each joint's own, from the noise of its velocity and its own speed. A row whose filter reaches a quick reversal is
    /// used; where the residual of a fit is much larger near reversals, only rows in which the joint surely moves are.
    OfNoise,
}

impl From<f64> for Band {
    fn from(speed: f64) -> Self {
        Band::Given(speed)
    }
}

/// Part of the filter's weight in a row that may lie on uncertain samples. The crossing of zero is known to a sixth of the time
/// within the band or so, which gives an error of a hundredth or two in the filtered sign.
const MOST_UNCERTAIN: f64 = 0.05;

/// Samples after which the response to an impulse has died away.
const MOST_RESPONSE: usize = 4096;

/// Sizes of the weights with which a filter takes the `reach` samples on either side of a row, and its own in the middle.
///
/// # Errors
/// Those of the filter: there are too few samples for it.
pub fn weights(filter: &Filter, reach: usize, samples: usize) -> Result<Vec<f64>> {
    let mut impulse = vec![0.0; samples.min(MOST_RESPONSE + 2 * reach)];
    let middle = impulse.len() / 2;
    if middle < reach || middle + reach >= impulse.len() {
        return Ok(Vec::new());
    }
    impulse[middle] = 1.0;
    let mut response = impulse.clone();
    filter.apply(&impulse, &mut response)?;
    // An output after the impulse has it among the inputs before it.
    Ok(response[middle - reach..=middle + reach].iter().rev().map(|weight| weight.abs()).collect())
}

/// Every `step`-th sample whose row may be used: the filter, which sees `reach` samples to either side with these `weights`, fits
/// into the log, and the direction is certain in all that it sees, or `quick` reversals excepted.
pub(crate) fn rows_to_use(moving: &[bool], (reach, weights): (usize, &[f64]), step: usize, quick: bool) -> Vec<bool> {
    let mut uncertain_before = vec![0usize; moving.len() + 1];
    for (sample, &ok) in moving.iter().enumerate() {
        uncertain_before[sample + 1] = uncertain_before[sample] + usize::from(!ok);
    }
    let is_certain = |sample: usize| {
        let seen = sample - reach..sample + reach + 1;
        if uncertain_before[seen.end] == uncertain_before[seen.start] {
            return true;
        }
        let uncertain = |(weight, ok): (&f64, &bool)| if *ok { 0.0 } else { *weight };
        quick && moving[sample] && weights.iter().zip(&moving[seen]).map(uncertain).sum::<f64>() <= MOST_UNCERTAIN
    };
    (0..moving.len())
        .step_by(step)
        .map(|sample| sample >= reach && sample + reach < moving.len() && is_certain(sample))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::{Edge, SavitzkyGolay};

    #[test]
    fn quick_reversals_stay_and_standing_does_not() {
        let mut moving = vec![true; 400];
        moving[50] = false;
        moving[100..160].fill(false);
        // A mean over 41 samples, of which two may be uncertain.
        let mean = vec![1.0 / 41.0; 41];
        let rows = rows_to_use(&moving, (20, &mean), 1, true);
        assert!(!rows[19] && rows[20] && rows[49] && !rows[50] && rows[51]);
        assert!(rows[81] && !rows[82] && !rows[130] && !rows[177] && rows[178] && !rows[380]);
        let given = rows_to_use(&moving, (20, &mean), 1, false);
        assert!(!given[45] && !given[70] && given[71] && !given[81]);
        // A short window gives so much weight to each that none may be.
        let short = rows_to_use(&moving, (1, &[0.2, 0.6, 0.2]), 1, true);
        assert!(short[48] && !short[49] && !short[51] && short[52]);
    }

    #[test]
    fn weights_are_those_of_the_filter() {
        let smoother = SavitzkyGolay::new(9, 4, 0, 0.01, Edge::Polynomial).unwrap();
        let sizes: Vec<f64> = smoother.coefficients().iter().map(|weight| weight.abs()).collect();
        let found = weights(&Filter::SavitzkyGolay(smoother), 4, 1000).unwrap();
        assert!(found.iter().zip(&sizes).all(|(a, b)| (a - b).abs() < 1e-12) && found.len() == 9);
        assert_eq!(weights(&Filter::None, 1, 100).unwrap(), [0.0, 1.0, 0.0]);
        assert!(weights(&Filter::None, 10, 5).unwrap().is_empty());
    }
}
