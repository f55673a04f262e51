//! Fewer samples from many: every n-th sample, or means of blocks.

use crate::error::{Error, Result};

/// Samples 0, n, 2n, ... of `input`.
///
/// Nothing is filtered: what the signal holds above half the new rate is folded onto lower frequencies. Filter it with
/// [`super::ZeroPhaseLowPass`] first, or take [`block_means`].
///
/// # Errors
/// When `n` is zero.
pub fn downsample(input: &[f64], n: usize) -> Result<Vec<f64>> {
    Ok(input.iter().step_by(checked_factor(n)?).copied().collect())
}

/// Means over consecutive blocks of `n` samples that do not overlap; a last block that is not full is left out.
///
/// The mean k stands for the middle of its block, the time of sample k n + (n - 1) / 2. White noise falls by sqrt(n).
///
/// # Errors
/// When `n` is zero.
pub fn block_means(input: &[f64], n: usize) -> Result<Vec<f64>> {
    Ok(input.chunks_exact(checked_factor(n)?).map(|block| block.iter().sum::<f64>() / n as f64).collect())
}

fn checked_factor(n: usize) -> Result<usize> {
    if n == 0 {
        return Err(Error::request("decimation", "the factor is 0; take 1 to keep every sample, or more"));
    }
    Ok(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_third_sample_begins_with_the_first() {
        let input = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(downsample(&input, 3).unwrap(), [0.0, 3.0, 6.0]);
        assert_eq!(downsample(&input[..6], 3).unwrap(), [0.0, 3.0]);
        assert_eq!(downsample(&input, 1).unwrap(), input);
    }

    #[test]
    fn block_means_leave_out_the_incomplete_block() {
        let input = [1.0, 2.0, 6.0, -1.0, 0.0, 4.0, 100.0];
        assert_eq!(block_means(&input, 3).unwrap(), [3.0, 1.0]);
        assert_eq!(block_means(&input, 1).unwrap(), input);
        assert!(block_means(&input, 8).unwrap().is_empty());
    }

    #[test]
    fn a_factor_of_zero_is_refused() {
        assert!(downsample(&[1.0], 0).unwrap_err().to_string().contains("factor is 0"));
        assert!(block_means(&[1.0], 0).unwrap_err().to_string().contains("factor is 0"));
    }
}
