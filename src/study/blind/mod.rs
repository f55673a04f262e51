//! Blind runs: effects are hidden in simulated logs, or faults put into them, and the diagnosis, which sees the arm's
//! description and the logs alone, has to name them.
//!
//! | step | file |
//! |---|---|
//! | what the runs of a study hide, by class | [`plan`] |
//! | one run as it is drawn | [`case`](mod@case) |
//! | serial arms drawn at random | [`arm`] |
//! | motions drawn at random, whole or cut out of longer ones | [`motion`] |
//! | laws that the library does not have | [`outside`] |
//! | effects at the size that is asked for | [`sizing`] |
//! | how often they could be named at all | [`mod@power`] |
//! | faults of the data | [`fault`] |
//! | simulation, screening and diagnosis | [`blind_run`] |
//! | the answer against the truth | [`outcome`] |
//! | a run as a line of a file, and lines as they are finished | [`row`], [`journal`] |
//! | counts with intervals, the confusion matrix | [`summary`] |
//!
//! Every random number comes from the study's seed and the run's index, so that a run is replayed alone by its index.

pub(crate) mod arm;
pub(crate) mod blind_run;
pub(crate) mod case;
pub mod fault;
pub(crate) mod journal;
pub(crate) mod motion;
pub(crate) mod outcome;
pub mod outside;
pub(crate) mod plan;
pub mod power;
pub(crate) mod row;
pub(crate) mod sizing;
pub(crate) mod summary;

pub use blind_run::{BlindRun, run};
pub use case::{ArmKind, Case, Class, MotionKind, draw};
pub use outcome::{Judgement, Outcome};
pub use plan::Plan;
