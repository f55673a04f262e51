//! Columns of a table as signals of joints.
//!
//! In: the header of a table, and the joints that are wanted. Out: a [`Layout`], which column is which signal of which joint, with notes
//! on how names were understood; or an error that names what is missing. With the values it gives the recording. Names are those of
//! many programs ([`names`]), or given in a data set ([`ColumnMap`]).

mod addresses;
mod bare;
mod families;
mod flat;
pub(super) mod labels;
mod layout;
mod left_out;
mod map;
pub(super) mod names;
mod notes;
mod prefixes;
mod resolve;
mod search;
mod spelling;
mod twice;

pub(crate) use addresses::placed;
pub use families::JointNames;
pub(crate) use families::joint_names;
pub(crate) use layout::{ABSENT, Layout};
pub use map::{Column, ColumnMap};
pub(crate) use search::Demand;
