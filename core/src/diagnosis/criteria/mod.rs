//! Thresholds that decide what is reported, each with its reason, and the judgement of a gate.
//!
//! In: the name of a gate, a number and its threshold. Out: whether it passes, and by how much. Bounds of a law's parameters, and the
//! places where a statistic is taken, belong to the law and the statistic: they are no thresholds. So do the fewest blocks from which a
//! statistic exists, the shares from which a direction of a regressor is determined, and steps at which an estimate counts as converged.

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
