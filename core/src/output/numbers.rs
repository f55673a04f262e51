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

/// A value with its standard deviation, both to two digits of the latter: "1.8982 +- 0.0013".
pub fn measured(value: f64, std: f64) -> String {
    if !(value.is_finite() && std.is_finite() && std > 0.0) {
        return format!("{} +- {}", significant(value), significant(std));
    }
    let exponent = |x: f64| if x == 0.0 { i32::MIN } else { x.abs().log10().floor() as i32 };
    let (own, of_std) = (exponent(value), exponent(std));
    if (-3..7).contains(&own.max(of_std)) {
        let digits = (1 - of_std).max(0) as usize;
        format!("{value:.digits$} +- {std:.digits$}")
    } else {
        let digits = (own.max(of_std) - of_std + 1) as usize;
        format!("{value:.digits$e} +- {std:.1e}")
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

    #[test]
    fn values_have_two_digits_of_their_deviation() {
        assert_eq!(measured(1.898_234, 0.001_34), "1.8982 +- 0.0013");
        assert_eq!(measured(-6.68e-4, 0.0053), "-0.0007 +- 0.0053");
        assert_eq!(measured(123_456.0, 10_045.0), "123456 +- 10045");
        assert_eq!(measured(1.5312e-4, 7.31e-6), "1.531e-4 +- 7.3e-6");
        assert_eq!(measured(0.0, 0.25), "0.00 +- 0.25");
        assert_eq!(measured(1.898_234, f64::INFINITY), "1.90 +- inf");
    }
}
