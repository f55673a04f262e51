//! What a run tells: tables on the console and JSON files.

pub mod console;
pub mod excitation;
pub mod fit;
mod markdown;
pub mod paper;
pub mod quality;
pub mod results;
pub mod svg;
