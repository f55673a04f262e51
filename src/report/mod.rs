//! What a run tells: tables on the console and JSON files.

pub mod console;
pub mod excitation;
pub mod results;
