//! Round numbers along an axis.

/// Values at a spacing of 1, 2 or 5 times a power of ten that lie between `low` and `high`, about `target` of them, with
/// their labels. An axis without extent or with bounds that are not finite has no ticks.
pub(super) fn ticks(low: f64, high: f64, target: usize) -> Vec<(f64, String)> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) {
        return Vec::new();
    }
    let rough = span / target.max(1) as f64;
    let decade = 10f64.powf(rough.log10().floor());
    // The nearest of the round steps, in ratio.
    let step = decade
        * match rough / decade {
            ratio if ratio < 2f64.sqrt() => 1.0,
            ratio if ratio < 10f64.sqrt() => 2.0,
            ratio if ratio < 50f64.sqrt() => 5.0,
            _ => 10.0,
        };
    let decimals = (-step.log10() - 1e-9).ceil().max(0.0) as usize;
    let slack = 1e-9 * span;
    let first = ((low - slack) / step).ceil() as i64;
    let last = ((high + slack) / step).floor() as i64;
    (first..=last)
        .map(|index| {
            let value = index as f64 * step;
            let label =
                if decimals > 4 || value.abs() >= 1e6 { format!("{value:.1e}") } else { format!("{value:.decimals$}") };
            (value, label)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, target: usize) -> Vec<String> {
        ticks(low, high, target).into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn round_steps_inside_the_axis() {
        assert_eq!(labels(0.0, 10.0, 5), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(-0.31, 0.28, 5), ["-0.3", "-0.2", "-0.1", "0.0", "0.1", "0.2"]);
        assert_eq!(labels(-54.0, 43.0, 4), ["-40", "-20", "0", "20", "40"]);
        assert_eq!(labels(-62.0, 72.0, 4), ["-50", "0", "50"]);
        assert_eq!(labels(0.0, 0.012, 4), ["0.000", "0.002", "0.004", "0.006", "0.008", "0.010", "0.012"]);
        assert_eq!(labels(1180.0, 2210.0, 4), ["1200", "1400", "1600", "1800", "2000", "2200"]);
        assert_eq!(labels(0.0, 3e-6, 3), ["0.0e0", "1.0e-6", "2.0e-6", "3.0e-6"]);
    }

    #[test]
    fn an_axis_without_extent_has_none() {
        assert!(ticks(1.0, 1.0, 5).is_empty());
        assert!(ticks(f64::NAN, 1.0, 5).is_empty());
        assert!(ticks(0.0, f64::INFINITY, 5).is_empty());
    }
}
