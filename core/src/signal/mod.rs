//! Filters and differences for uniformly sampled signals: pure functions on slices of f64, one channel at a time.

mod bandwidth;
pub(crate) mod decimate;
pub(crate) mod difference;
pub(crate) mod filter;
mod hat;
mod lag;
pub(crate) mod low_pass;
mod moving;
pub(crate) mod noise;
mod quantile;
mod quantum;
mod savitzky_golay;
pub(crate) mod spectrum;

pub use bandwidth::{Bandwidth, bandwidth};
pub use decimate::{block_means, downsample};
pub(crate) use difference::changes;
pub(crate) use difference::smooth_derivatives;
pub use difference::{first_derivative, second_derivative};
pub use filter::Filter;
pub(crate) use hat::hat;
pub(crate) use lag::first_order_lag;
pub use low_pass::ZeroPhaseLowPass;
pub(crate) use moving::moves_enough;
pub use moving::{NoiseGains, Slow};
pub use noise::{noise_floor, white_noise};
pub(crate) use quantile::size_quantile;
pub(crate) use quantum::{change_sizes, quantum, rounding};
pub(crate) use savitzky_golay::half_gain_hz;
pub(crate) use savitzky_golay::noise_share;
pub use savitzky_golay::{Edge, SavitzkyGolay, window_by_noise};
pub use spectrum::amplitude_density;

use crate::error::{Error, Result};

/// Refuses an output of another length than the input.
fn check_same_length(subject: &str, input: &[f64], output: &[f64]) -> Result<()> {
    if input.len() == output.len() {
        return Ok(());
    }
    Err(Error::request(
        subject,
        format!(
            "the output holds {} samples and the input {}; make the output as long as the input",
            output.len(),
            input.len()
        ),
    ))
}
