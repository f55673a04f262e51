//! The regressor of the arm and of effects.
//!
//! In: rows, an arm as identified so far, an effect at a place with its parameters. Out: columns of the baseline and of the
//! effect, errors in variables (nuisance columns), and fits of baseline and effects under a noise model.

mod arm;
mod arm_model;
mod blocks;
mod candidates;
mod cut_off;
mod data_set;
mod errors_in_variables;
mod grid;
mod known;
mod member;
mod prepared;
mod roles;
mod session;

pub use arm::{Arm, Moved};
pub use arm_model::{ArmModel, bounded};
pub use blocks::{MemberBlock, ParameterBlocks};
pub use candidates::{
    Candidate, Family, Slot, all_candidates, carried_on, columns, columns_in, is_candidate, is_wanted, places, renewed,
};
pub use cut_off::{FLAT, slope_beyond};
pub use data_set::DataSet;
pub use errors_in_variables::Nuisances;
pub use grid::{sizes, within_bounds};
pub use known::Known;
pub use member::Member;
pub use prepared::PreparedLogs;
pub use roles::{bends, is_event, is_level, is_shift, linear, prior, shapes};
pub use session::{Fit, Session};
