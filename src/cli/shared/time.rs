//! Times on the command line.

use std::time::Duration;

/// A time in seconds, milliseconds or minutes: "60", "60s", "500ms", "1.5min".
pub(crate) fn time(text: &str) -> std::result::Result<Duration, String> {
    let number = text.trim_end_matches(char::is_alphabetic);
    let unit = match &text[number.len()..] {
        "ms" => 1e-3,
        "" | "s" => 1.0,
        "min" | "m" => 60.0,
        _ => f64::NAN,
    };
    let seconds = number.trim().parse::<f64>().map_or(f64::NAN, |value| value * unit);
    let time = Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero());
    time.ok_or_else(|| "give a time above zero, as 60s or 2min".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_in_seconds_and_minutes() {
        for (text, seconds) in [("60", 60), ("60s", 60), ("2min", 120), ("0.5m", 30), ("3000ms", 3)] {
            assert_eq!(time(text), Ok(Duration::from_secs(seconds)), "{text}");
        }
        assert!(["", "0", "-1s", "nan", "5 parsecs", "s"].iter().all(|text| time(text).is_err()));
    }
}
