//! The whole way from logs to the identified arm.
//!
//! In: the arm, logs, effects to fit and options. Out: an [`Identification`]: the fits without and with effects, bodies that can exist, the
//! identified arm, and notes.

mod builder;
mod identified;
mod wanted;

pub use builder::IdentificationBuilder;
pub use identified::{Identification, Progress};
pub use wanted::Wanted;
