//! The regressor of the arm and of effects.
//!
//! In: rows, an arm as identified so far, an effect at a place with its parameters. Out: columns of the baseline and of the
//! effect, errors in variables (nuisance columns), and fits of baseline and effects under a noise model.

#[cfg(test)]
mod agreement;
mod arm_columns;
mod arm_model;
mod blocks;
mod candidates;
mod cut_off;
mod data_set;
mod effect_columns;
mod errors_in_variables;
mod known;
mod member;
mod prepared;
mod roles;
mod session;
mod unseen;

pub(crate) use arm_columns::Moved;
pub(crate) use arm_model::ArmModel;
pub(crate) use blocks::{MemberBlock, ParameterBlocks};
pub use candidates::{Candidate, Family, is_candidate, places};
pub(crate) use candidates::{Slot, all_candidates, carried_on, columns, columns_in, extent, is_wanted, renewed};
pub(crate) use cut_off::{FlatLevel, flat_level, slope_beyond};
pub use data_set::DataSet;
pub(crate) use errors_in_variables::Nuisances;
pub(crate) use known::Known;
pub use member::Member;
pub(crate) use prepared::PreparedLogs;
pub use roles::is_level;
pub(crate) use roles::{
    ENDS_OF_EVENT_S, acts_upon_arm, bends, follows_estimate, is_event, is_gap, is_shift, linear, prior, shapes,
};
pub(crate) use session::Fit;
pub use session::Session;
