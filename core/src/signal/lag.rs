//! First-order lag.

/// A signal behind a first-order lag, at rest with its first value before; `share` is the sampling period over the time constant.
pub(crate) fn first_order_lag(signal: impl Iterator<Item = f64>, share: f64) -> Vec<f64> {
    let kept = (-share).exp();
    let mut state = None;
    signal
        .map(|x| {
            let before = state.unwrap_or(x);
            *state.insert(kept * before + (1.0 - kept) * x)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delayed_step_comes_up_over_its_time_constant() {
        let step = (0..300).map(|k| if k < 100 { 0.0 } else { 1.0 });
        let out = first_order_lag(step, 0.02);
        assert_eq!(out[99], 0.0);
        let expected = 1.0 - (-1.0f64).exp();
        assert!((out[149] - expected).abs() < 1e-12, "{}", out[149]);
    }
}
