//! What `tauscope diagnose` reports for people: a few lines.

mod faults;
mod findings;
mod gravity;
mod text;

pub(crate) use faults::stopped_lines;
pub(crate) use findings::{held, impacts, largest, place};
pub(crate) use text::{followed, lines, not_simulated};
