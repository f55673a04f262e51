//! The filter that the torque and every regressor column go through alike.

use super::{Edge, SavitzkyGolay, ZeroPhaseLowPass, check_same_length, downsample};
use crate::error::{Error, Result};

/// Samples after which the response to an impulse has died away.
const MOST_RESPONSE: usize = 16_384;

/// The filter between the recording and the estimate.
///
/// Identification solves tau = Y(q, qd, qdd) beta for beta. A linear filter F leaves the equation true only if both
/// sides go through it: F tau = (F Y) beta, column by column. To filter the torque but not a column invents physics. The
/// clearest case is Coulomb friction: a low-passed torque passes through a reversal as a smooth ramp while sign(v) still
/// jumps, and the difference looks like a friction law that depends on acceleration, or like an inertia that is off. So
/// a column, the sign(v) one included, is first computed from its kinematics and then filtered exactly like the torque.
/// This is the parallel filtering of M. Gautier, "Dynamic identification of robots with power model", IEEE
/// International Conference on Robotics and Automation, 1997.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::signal::{Filter, ZeroPhaseLowPass};
///
/// // Torque of Coulomb friction, 4 N m, around a reversal. Filtered alike, torque and column still fit together.
/// let column: Vec<f64> = (0..100).map(|k| if k < 50 { 1.0 } else { -1.0 }).collect();
/// let torque: Vec<f64> = column.iter().map(|sign| 4.0 * sign).collect();
///
/// let filter = Filter::LowPass(ZeroPhaseLowPass::new(4, 10.0, 100.0)?);
/// let [mut smooth_column, mut smooth_torque] = [[0.0; 100]; 2];
/// filter.apply(&column, &mut smooth_column)?;
/// filter.apply(&torque, &mut smooth_torque)?;
/// assert!(smooth_torque.iter().zip(smooth_column).all(|(torque, column)| (torque - 4.0 * column).abs() < 1e-9));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Filter {
    /// Signals stay as they are.
    #[default]
    None,
    /// Least-squares polynomial over a sliding window.
    SavitzkyGolay(SavitzkyGolay),
    /// Butterworth low-pass, forward and backward.
    LowPass(ZeroPhaseLowPass),
    /// Mean of a sample and those after it, so many together, fewer at the end: every n-th output is a mean over a block.
    Means(usize),
}

impl Filter {
    /// Filters `input` into `output`, both `[time]`. Call it with the torque and with every column of the regressor.
    ///
    /// # Errors
    /// When the lengths differ, the signal is too short for the filter, or a Savitzky-Golay filter differentiates or
    /// continues the signal with a constant other than zero: then filtered columns no longer add up to the filtered
    /// torque, or no longer in its units.
    pub fn apply(&self, input: &[f64], output: &mut [f64]) -> Result<()> {
        match self {
            Filter::None => {
                check_same_length("filter", input, output)?;
                output.copy_from_slice(input);
                Ok(())
            }
            Filter::SavitzkyGolay(filter) => {
                check_smooths_linearly(filter)?;
                filter.apply(input, output)
            }
            Filter::LowPass(filter) => filter.apply(input, output),
            Filter::Means(samples) => {
                check_same_length("filter", input, output)?;
                means(input, *samples, 0, 1, output);
                Ok(())
            }
        }
    }

    /// Samples on either side that an output depends on; None where it is all of them.
    pub fn reach(&self) -> Option<usize> {
        match self {
            Filter::None => Some(0),
            Filter::SavitzkyGolay(filter) => Some(filter.window() / 2),
            Filter::LowPass(_) => None,
            Filter::Means(samples) => Some(samples.saturating_sub(1)),
        }
    }

    /// Outputs `first`, `first` + `step`, ... of a part of a signal, one per place of `output`. Where a window does not
    /// fit, the part must end where the signal does. For filters that have a [`Filter::reach`], linear ones.
    pub(crate) fn rows(&self, part: &[f64], first: usize, step: usize, output: &mut [f64]) {
        match self {
            Filter::SavitzkyGolay(filter) => filter.rows(part, first, step, output),
            Filter::Means(samples) => means(part, *samples, first, step, output),
            Filter::None | Filter::LowPass(_) => {
                output.iter_mut().zip(part[first..].iter().step_by(step)).for_each(|(y, x)| *y = *x);
            }
        }
    }

    /// Every `step`-th output of [`Filter::apply`], to rounding: samples 0, `step`, 2 `step`, ...
    ///
    /// # Errors
    /// As [`Filter::apply`]; when `step` is zero.
    pub(crate) fn apply_every(&self, input: &[f64], step: usize) -> Result<Vec<f64>> {
        match self {
            Filter::None => downsample(input, step),
            Filter::SavitzkyGolay(filter) => {
                check_smooths_linearly(filter)?;
                filter.apply_every(input, step)
            }
            Filter::LowPass(filter) => {
                let mut output = vec![0.0; input.len()];
                filter.apply(input, &mut output)?;
                downsample(&output, step)
            }
            Filter::Means(samples) => {
                let mut output = downsample(input, step)?;
                means(input, *samples, 0, step, &mut output);
                Ok(output)
            }
        }
    }

    /// Standard deviation of unit white noise after the filter, away from the ends of a signal of `samples`.
    ///
    /// # Errors
    /// As [`Filter::apply`].
    pub(crate) fn noise_gain(&self, samples: usize) -> Result<f64> {
        let mut impulse = vec![0.0; samples.min(MOST_RESPONSE)];
        if let Some(middle) = impulse.len().checked_sub(1) {
            impulse[middle / 2] = 1.0;
        }
        let mut response = impulse.clone();
        self.apply(&impulse, &mut response)?;
        Ok(response.iter().map(|h| h * h).sum::<f64>().sqrt())
    }
}

/// Means over `samples` values from `first`, `first` + `step`, ... on, over those that there are at the end.
fn means(input: &[f64], samples: usize, first: usize, step: usize, output: &mut [f64]) {
    for (k, mean) in output.iter_mut().enumerate() {
        let start = first + k * step;
        let block = &input[start..input.len().min(start + samples.max(1))];
        *mean = block.iter().sum::<f64>() / block.len() as f64;
    }
}

fn check_smooths_linearly(filter: &SavitzkyGolay) -> Result<()> {
    if filter.derivative() != 0 {
        return Err(Error::request(
            "filter",
            format!("it takes derivative {} of torque and regressor; take derivative 0", filter.derivative()),
        ));
    }
    match filter.edge() {
        Edge::Constant(value) if value != 0.0 => Err(Error::request(
            "filter",
            format!(
                "it continues torque and regressor columns alike with {value}, which their equation does not hold for; \
                 take another edge"
            ),
        )),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn savitzky_golay(derivative: usize, edge: Edge) -> Filter {
        Filter::SavitzkyGolay(SavitzkyGolay::new(9, 3, derivative, 0.01, edge).unwrap())
    }

    fn filtered(filter: &Filter, input: &[f64]) -> Vec<f64> {
        let mut output = vec![f64::NAN; input.len()];
        filter.apply(input, &mut output).unwrap();
        output
    }

    #[test]
    fn none_copies_and_the_others_delegate() {
        let input: Vec<f64> = (0..50).map(|t| ((t * t) % 13) as f64).collect();
        assert_eq!(filtered(&Filter::default(), &input), input);
        let mut want = vec![0.0; input.len()];
        let smoother = SavitzkyGolay::new(9, 3, 0, 0.01, Edge::Polynomial).unwrap();
        smoother.apply(&input, &mut want).unwrap();
        assert_eq!(filtered(&Filter::SavitzkyGolay(smoother), &input), want);
        let low_pass = ZeroPhaseLowPass::new(3, 10.0, 100.0).unwrap();
        low_pass.apply(&input, &mut want).unwrap();
        assert_eq!(filtered(&Filter::LowPass(low_pass), &input), want);
    }

    #[test]
    fn means_are_those_of_blocks_where_every_nth_is_taken() {
        let input = [1.0, 2.0, 6.0, -1.0, 0.0, 4.0, 100.0];
        let means = Filter::Means(3);
        assert_eq!(means.apply_every(&input, 3).unwrap(), [3.0, 1.0, 100.0]);
        assert_eq!(filtered(&means, &input)[..2], [3.0, 7.0 / 3.0]);
        assert_eq!((means.reach(), Filter::Means(1).reach()), (Some(2), Some(0)));
        assert_eq!(filtered(&Filter::Means(1), &input), input);
        assert!((means.noise_gain(200).unwrap() - (1.0f64 / 3.0).sqrt()).abs() < 1e-12);
    }

    /// Least squares project: the sum of the squared weights of a smoother is its middle weight.
    #[test]
    fn noise_after_a_smoother_is_the_root_of_its_middle_weight() {
        let smoother = SavitzkyGolay::new(9, 3, 0, 0.01, Edge::Polynomial).unwrap();
        let middle = smoother.coefficients()[4];
        let gain = Filter::SavitzkyGolay(smoother).noise_gain(200).unwrap();
        assert!((gain - middle.sqrt()).abs() < 1e-12, "{gain} {middle}");
        assert_eq!(Filter::None.noise_gain(200).unwrap(), 1.0);
        assert!(Filter::LowPass(ZeroPhaseLowPass::new(3, 10.0, 100.0).unwrap()).noise_gain(3).is_err());
    }

    #[test]
    fn what_would_break_the_equation_is_refused() {
        let (input, mut output) = ([1.0; 30], [0.0; 30]);
        let message = savitzky_golay(1, Edge::Mirror).apply(&input, &mut output).unwrap_err().to_string();
        assert!(message.contains("derivative 1"), "{message}");
        let message = savitzky_golay(0, Edge::Constant(2.0)).apply(&input, &mut output).unwrap_err().to_string();
        assert!(message.contains("with 2"), "{message}");
        savitzky_golay(0, Edge::Constant(0.0)).apply(&input, &mut output).unwrap();
        let message = Filter::None.apply(&input, &mut output[1..]).unwrap_err().to_string();
        assert!(message.contains("output holds 29"), "{message}");
    }

    proptest! {
        /// The point of it: filtered columns still add up to the filtered torque, with the same parameters.
        #[test]
        fn filtered_columns_add_up_to_the_filtered_torque(
            inertia in prop::collection::vec(-1.0..1.0_f64, 60), beta in prop::array::uniform2(-10.0..10.0_f64),
        ) {
            let sign: Vec<f64> = (0..60).map(|t| if (t / 11) % 2 == 0 { 1.0 } else { -1.0 }).collect();
            let torque: Vec<f64> = inertia.iter().zip(&sign).map(|(i, s)| beta[0] * i + beta[1] * s).collect();
            let low_pass = Filter::LowPass(ZeroPhaseLowPass::new(4, 8.0, 100.0).unwrap());
            for filter in [Filter::None, savitzky_golay(0, Edge::Polynomial), low_pass, Filter::Means(5)] {
                let (tau, inertia, sign) =
                    (filtered(&filter, &torque), filtered(&filter, &inertia), filtered(&filter, &sign));
                for t in 0..60 {
                    prop_assert!((tau[t] - beta[0] * inertia[t] - beta[1] * sign[t]).abs() < 1e-11);
                }
            }
        }
    }
}
