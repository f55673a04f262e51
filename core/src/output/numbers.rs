//! Numbers in texts.

/// Three significant digits; a dash for what is not a number.
pub fn significant(value: f64) -> String {
    if value.is_nan() {
        return "-".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor();
    if (-3.0..5.0).contains(&exponent) {
        format!("{value:.*}", (2.0 - exponent).max(0.0) as usize)
    } else {
        format!("{value:.2e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits() {
        assert_eq!(significant(1234.5), "1234");
        assert_eq!(significant(12.345), "12.3");
        assert_eq!(significant(0.001234), "0.00123");
        assert_eq!(significant(1.2e-9), "1.20e-9");
    }
}
