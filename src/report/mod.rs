//! What a run tells: tables on the console and JSON files.

pub mod blind;
pub mod console;
pub mod diagnosis;
pub mod excitation;
pub mod fit;
pub mod html;
mod markdown;
pub mod measured;
pub mod montecarlo;
pub mod paper;
pub mod quality;
pub mod results;
pub mod robot;
pub mod svg;
pub mod viewer;
