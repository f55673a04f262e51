//! The answer in a word.

/// What the diagnosis reports.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Verdict;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
///
/// // Asked for a ripple alone, the diagnosis names one; asked for an effect that is not there, it does not.
/// assert_eq!(answer.verdict(), Verdict::Named);
/// let without = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["backlash"]).run()?;
/// assert_ne!(without.verdict(), Verdict::Named);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
