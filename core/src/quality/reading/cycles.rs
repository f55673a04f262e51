//! Time that counts the cycles of a controller: their length is found from the torques, or asked for.

use crate::quality::finding::{Finding, Kind, Severity};

/// A cycle lasts a whole number of ms, to within what the torques show of it.
const WHOLE: f64 = 0.05;

/// A count is not taken for ms where half of the joints that move exceed their limits of speed by this then.
const NOT_FASTER: f64 = 1.5;

/// True ms of a cycle that torques show to be about so long.
pub(crate) fn length_ms(shown: f64) -> f64 {
    let whole = shown.round().max(1.0);
    if (shown / whole).ln().abs() < WHOLE { whole } else { shown }
}

/// What is said of cycles that are no ms.
pub(crate) fn text(ms: f64) -> String {
    let digits = crate::quality::velocity::digits(ms);
    format!(
        "the column of time counts, and its steps are cycles of about {digits} ms, as inertia and gravity in the torques show. Set [units] time_factor = \
         {digits} in a dataset (times one ms), or log true time stamps"
    )
}

/// A finding where the counts are no ms, and nothing shows what they are: joints of which these are the speeds in ms, over their limits,
/// would be too fast.
pub(crate) fn too_fast(speeds: impl Iterator<Item = f64>) -> Option<Finding> {
    let mut speeds: Vec<f64> = speeds.collect();
    speeds.sort_by(f64::total_cmp);
    // Half of the joints are as fast, or faster.
    let half = *speeds.get(speeds.len() / 2)?;
    let text = format!(
        "the column of time counts, and where a step is 1 ms, half of the joints are {half:.1} times as fast as their limits or more: it counts longer \
         cycles of the controller. Give their length, in ms, as [units] time_factor in a dataset; torques are not compared with motion without it"
    );
    (half > NOT_FASTER).then(|| Finding::new(Kind::ClockFactor, Severity::Warning, "t", text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_last_whole_milliseconds() {
        assert_eq!([8.3, 7.7, 3.9, 1.03, 0.97].map(length_ms), [8.0, 8.0, 4.0, 1.0, 1.0]);
        assert_eq!([1.7, 2.2, 0.4].map(length_ms), [1.7, 2.2, 0.4]);
    }

    #[test]
    fn counts_are_no_milliseconds_where_half_of_the_joints_would_be_too_fast() {
        let found = |speeds: &[f64]| too_fast(speeds.iter().copied()).is_some();
        assert!(found(&[1.6; 6]) && !found(&[1.4; 6]) && !found(&[]));
        assert!(found(&[4.0, 4.0, 0.1, 0.1]) && !found(&[4.0, 4.0, 0.1, 0.1, 0.1]));
    }
}
