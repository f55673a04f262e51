//! The whole way from logs to the answer.
//!
//! In: the arm, logs and options. Out: an [`Answer`]: faults of the data, verdict, findings with what derives from them, gap
//! closed on held-out rows, what could not have been found, and the extended model, ready to run in the simulator.

mod accounted;
mod builder;
mod conclusion;
mod described;
mod diagnosis;
mod document;
mod equations;
mod estimated;
mod extended;
mod inertias;
mod mounting;
mod outcome;
mod quantities;
mod resimulation;
mod searched;
pub(crate) mod words;

pub use builder::DiagnosisBuilder;
pub use diagnosis::{Diagnosis, Errors, LogSummary, OfSampling, Scope};
pub use document::{DIAGNOSIS_SCHEMA, EXTENDED_MJCF, EXTENDED_SCENARIO, EXTENDED_URDF};
pub use estimated::{Estimated, EstimatedEffect, LeftOut};
pub use extended::ExtendedModel;
pub use inertias::Gain;
pub use outcome::{Answer, Conclusion, Measured, Outcome};
pub use quantities::{Derived, Evidence, Follows, NotFound, ResidualStructure, Share, Worst};
pub use resimulation::{Engine, Followed, Resimulation, Simulator};
pub use words::{Finding, NOT_SIZED, NamedAlternative, NamedParameter, finding, findings, joints};
