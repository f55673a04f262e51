//! Effects, probabilities and sentences in words.

use crate::diagnosis::Family;
use crate::internal::diagnosis::joints;
use crate::report::console::significant;
use crate::robot::Robot;

/// 97.5 % point of the normal distribution.
pub(super) const NORMAL_95: f64 = 1.959_964;

/// An effect with its joints, in words.
pub(super) fn named(robot: &Robot, family: Family) -> String {
    let joints = joints(robot, family);
    let on = if joints.is_empty() { String::new() } else { format!(" on {}", joints.join(" and ")) };
    spaced(family.effect) + &on
}

/// Name of an effect in words.
pub(super) fn spaced(name: &str) -> String {
    name.replace('_', " ")
}

pub(super) fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    let end = if text.ends_with(['.', '!', '?']) { "" } else { "." };
    format!("{first}{}{end}", letters.as_str())
}

/// A probability from its decimal logarithm: one that underflows is still printed.
pub(super) fn probability(log10: f64) -> String {
    match log10 {
        p if p < -300.0 => "<1e-300".into(),
        p if p < -3.0 => format!("1e{:.0}", p.ceil()),
        p => significant(10f64.powf(p)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_that_underflow_are_told() {
        assert_eq!(probability(-520.3), "<1e-300");
        assert_eq!(probability(f64::NEG_INFINITY), "<1e-300");
        assert_eq!(probability(-12.3), "1e-12");
        assert_eq!(probability(-1.0), "0.100");
    }

    #[test]
    fn sentences() {
        assert_eq!(sentence("move joint 1"), "Move joint 1.");
        assert_eq!(sentence(""), ".");
    }
}
