//! Thresholds that decide what is reported, each with its reason, and the judgement of a gate: whether a number passes, and by how much.
//!
//! A number decides if it is compared with a statistic, an estimate or a residual, and the answer changes what is named or refused. These are
//! here, and the threshold of every judgement comes from here (a test holds it). `docs/decisions.md` lists the numbers that stay where they
//! are used. Screening has thresholds of its own (`core/src/quality`). They decide which samples and logs are used, not which effect is named,
//! and are no part of [`Criteria`].

mod comparison;
mod document;
mod estimate;
mod judgement;
mod levels;
mod search;
mod structure;
mod thresholds;
mod verdict;

pub use comparison::ComparisonCriteria;
pub use estimate::EstimateCriteria;
pub use judgement::{Gate, Judgement};
pub use levels::Levels;
pub use search::SearchCriteria;
pub use structure::StructureCriteria;
pub use thresholds::Criteria;
pub use verdict::VerdictCriteria;
