//! The words of a column's name, and its unit.

use std::borrow::Cow;

/// What stands between words.
pub(super) const SEPARATORS: [char; 6] = ['/', '.', '_', ' ', '[', ']'];

/// The words of a name in small letters, also of `jointPositions`.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut small = false;
    for letter in name.chars() {
        // A controller's own variables begin with a dollar sign.
        let separates = SEPARATORS.contains(&letter) || matches!(letter, '-' | '$');
        if separates || (letter.is_uppercase() && small) {
            out.push(String::new());
        }
        small = letter.is_lowercase();
        if !separates {
            out.last_mut().into_iter().for_each(|word| word.extend(letter.to_lowercase()));
        }
    }
    out.retain(|word| !word.is_empty());
    out
}

/// The name of a column that is a tuple of labels, as pandas writes those of several levels: `q_0` of `('q', 0)`, and `t` of `('t', '')`.
pub(super) fn without_tuple(name: &str) -> Cow<'_, str> {
    let Some(inside) = name.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) else { return name.into() };
    let label = |part: &str| part.trim().trim_matches(['\'', '"']).trim().to_owned();
    let labels: Vec<String> = inside.split(',').map(label).filter(|label| !label.is_empty()).collect();
    let is_number = |label: &String| label.bytes().all(|byte| byte.is_ascii_digit());
    match labels.last() {
        Some(last) if inside.contains(',') => labels.join(if is_number(last) { "_" } else { "/" }).into(),
        _ => name.into(),
    }
}

/// A name without the unit in brackets or behind a blank at its end, and the unit: `q1 [rad]`, `time (ms)`.
pub(super) fn without_unit(name: &str) -> (&str, Option<&str>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        let Some(inside) = name.strip_suffix(close) else { continue };
        let Some((stem, unit)) = inside.rsplit_once(open) else { continue };
        let letters = unit.chars().any(|letter| letter.is_alphabetic() || ['°', '%'].contains(&letter));
        if letters && !stem.trim().is_empty() {
            return (stem.trim(), Some(unit.trim()));
        }
    }
    (name, None)
}

/// A name without the unit in brackets at its end.
pub(crate) fn without_unit_of(name: &str) -> &str {
    without_unit(name).0
}

/// The unit in brackets at the end of a name.
pub(crate) fn unit_of(name: &str) -> Option<&str> {
    without_unit(name).1
}
