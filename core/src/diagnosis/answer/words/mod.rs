//! The answer in words: findings with units, notices on the logs, what to do next.

mod findings;
mod next_experiment;
pub(crate) mod notices;

pub(super) use findings::law_of_inertias;
pub use findings::{Finding, NOT_SIZED, NamedAlternative, NamedParameter, finding, findings, joints};
pub(super) use next_experiment::{Sizes, next_experiment};
