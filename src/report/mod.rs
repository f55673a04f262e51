//! Results of a run: tables on the console and JSON files.

pub(crate) mod blind;
pub(crate) mod console;
pub(crate) mod diagnosis;
pub(crate) mod excitation;
pub mod fit;
pub(crate) mod html;
mod markdown;
pub(crate) mod measured;
pub(crate) mod montecarlo;
pub(crate) mod paper;
pub(crate) mod payload;
pub(crate) mod quality;
pub(crate) mod results;
pub(crate) mod robot;
pub(crate) mod svg;
pub mod viewer;
