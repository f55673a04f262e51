//! The answer in a word.

/// What the diagnosis reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Effects are named.
    Named,
    /// For at least one effect a few names fit alike.
    OneOf,
    /// There is structure that no effect of the library carries.
    Unexplained,
    /// Nothing beyond the noise.
    None,
    /// Faults of the data forbid an answer.
    NotTestable,
}
