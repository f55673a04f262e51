//! Monte Carlo studies: the same identification on many draws of noise and, where the scenario asks for it, of plants, motions
//! and starts.
//!
//! Every trial draws from random streams of its own, keyed by the seed and its index, so that a trial can be replayed alone
//! and the results do not depend on the number of threads or machines.

mod files;
mod folder;
mod held_out;
mod join;
mod plan;
mod shard;
mod study;
mod summary;
mod table;
mod trial;

pub use files::SUMMARY_SCHEMA;
pub use folder::{Progress, StudyFolder};
pub use join::{Report, merge};
pub use plan::{Identity, Overrides, Plan};
pub use shard::Shard;
pub use study::Study;
pub use summary::{BestWindow, Cell, Quantiles, Summary};
pub use table::Timings;
pub use trial::{Found, Row};
