//! Thresholds that decide what is reported, each with its reason, and the judgement of a gate.
//!
//! In: the name of a gate, a number and its threshold. Out: whether it passes, and by how much.
//!
//! A number decides if it is compared with a statistic, an estimate or a residual, and the answer changes what is named, refused or left
//! out. These are here, and the threshold of every judgement comes from here (a test holds it). Other numbers stay where they are used, with
//! their reason:
//!
//! - bounds and priors of a law's parameters, which belong to the law ([`crate::effects`]);
//! - what a statistic or a log needs to exist: fewest rows, blocks and moments, shortest logs, slowest rate;
//! - how a statistic is made: lengths of blocks, grids of shapes, cut-offs and places, orders of filters and noise models;
//! - numerical limits: rank of a regressor, convergence of an iteration, rounding, memory;
//! - what is only shown: places of a table, definitions of figures that no finding depends on.

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
