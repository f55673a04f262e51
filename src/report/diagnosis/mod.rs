//! What `tauscope diagnose` reports for people: a few lines.

mod faults;
mod gravity;
mod text;

pub(crate) use faults::stopped_lines;
pub(crate) use text::{followed, held, impacts, largest, lines, not_simulated, place};
