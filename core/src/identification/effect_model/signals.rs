//! Signals of one joint.

/// One signal less another.
pub(super) fn difference(signal: &[f64], other: &[f64]) -> Vec<f64> {
    signal.iter().zip(other).map(|(a, b)| a - b).collect()
}
