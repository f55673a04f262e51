//! What `tauscope diagnose` reports for people: a few lines.

mod gravity;
mod text;

pub(crate) use text::{followed, impacts, largest, lines, not_simulated, place, stopped_lines};
