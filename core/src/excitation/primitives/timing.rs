//! Timing of a joint's successive segments: from durations to the knots between them, and back from a time to a segment.

use crate::error::{Error, Result};

/// How far the durations of a joint may differ in sum from the duration of the motion, as a share of it.
const SUM_TOLERANCE: f64 = 1e-9;

/// Refuses a quantity that is not finite and above zero.
pub(crate) fn require_positive(subject: &str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::request(subject, format!("must be a finite number above zero, found {value}")))
}

/// Refuses values that are not finite.
pub(crate) fn require_finite(subject: &str, values: &[f64]) -> Result<()> {
    match values.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(k) => {
            Err(Error::request(subject, format!("entry {} must be a finite number, found {}", k + 1, values[k])))
        }
    }
}

/// Refuses a number of values that is not one less than the number of segments between them.
pub(crate) fn require_one_fewer(subject: &str, values: usize, segments: usize) -> Result<()> {
    if values + 1 == segments {
        return Ok(());
    }
    Err(Error::request(
        subject,
        format!("has {values} entries for {segments} durations; give one fewer than durations, as both ends are zero"),
    ))
}

/// Knots 0 = t_0 < t_1 < ... = `duration_s` of segments of the given durations.
///
/// # Errors
/// Names `joint` when there are no segments, one has no length, or they do not add up to `duration_s`.
pub(crate) fn knots(joint: &str, durations_s: &[f64], duration_s: f64) -> Result<Vec<f64>> {
    let subject = format!("{joint}: duration_s");
    if durations_s.is_empty() {
        return Err(Error::request(subject, "is empty; give at least one duration"));
    }
    let mut knots = vec![0.0];
    let mut end = 0.0;
    for (k, duration) in durations_s.iter().enumerate() {
        require_positive(&format!("{subject}: entry {}", k + 1), *duration)?;
        end += duration;
        knots.push(end);
    }
    if (end - duration_s).abs() > SUM_TOLERANCE * duration_s {
        return Err(Error::request(
            subject,
            format!("the durations add up to {end} s, but the motion lasts {duration_s} s; let them agree"),
        ));
    }
    let last = durations_s.len();
    if knots[last - 1] >= duration_s {
        return Err(Error::request(subject, "the last duration is too short to differ from zero; lengthen it"));
    }
    knots[last] = duration_s;
    Ok(knots)
}

/// Index of the segment that holds `t_s`; the first or the last one for a time outside all.
pub(crate) fn segment(knots: &[f64], t_s: f64) -> usize {
    let after = knots.partition_point(|knot| *knot <= t_s);
    after.clamp(1, knots.len() - 1) - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_found_at_and_between_knots() {
        let knots = knots("joint 1", &[1.0, 0.5, 2.0], 3.5).unwrap();
        assert_eq!(knots, [0.0, 1.0, 1.5, 3.5]);
        for (t, expected) in [(-1.0, 0), (0.0, 0), (0.99, 0), (1.0, 1), (1.5, 2), (3.5, 2), (9.0, 2)] {
            assert_eq!(segment(&knots, t), expected, "at {t}");
        }
    }

    #[test]
    fn wrong_durations_are_named() {
        for (durations, word) in [
            (&[][..], "empty"),
            (&[1.0, -1.0, 3.5], "entry 2"),
            (&[1.0, f64::NAN], "entry 2"),
            (&[1.0, 2.0], "add up to 3"),
            (&[3.5, 1e-20], "too short"),
        ] {
            let error = knots("joint 4", durations, 3.5).unwrap_err().to_string();
            assert!(error.contains("joint 4") && error.contains(word), "{error}");
        }
    }
}
