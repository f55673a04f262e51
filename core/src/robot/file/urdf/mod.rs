//! URDF.
//!
//! In: the text of a URDF. Out: its description ([`read`]) or its visual shapes ([`looks`]). The text is settled first: numbers in SI units
//! and with all their digits, lines as in the file. A robot is written as a URDF ([`to_urdf`]), or into the one that it came from
//! ([`with_parameters`]).

mod angles;
mod clean;
mod edit;
mod edits;
mod elements;
mod numbers;
mod reader;
mod settled;
#[cfg(test)]
mod tests;
mod transmissions;
mod tree;
mod units;
mod write;

pub use edit::with_parameters;
pub(crate) use elements::pose_of;
pub(crate) use reader::{looks, read};
pub use write::to_urdf;
