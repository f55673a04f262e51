//! Formats of files.
//!
//! In: a file. Out: a table, that is the names of its columns and their values; in text, arrays of numpy, Parquet, or a log of ROS 2.
//! The content decides which it is ([`of`]); files of other kinds are named, with the command that converts them. CSV, Parquet and
//! logs of ROS 2 are written too.

#[cfg(feature = "bags")]
pub(super) mod bag;
pub mod csv;
mod kind;
pub(super) mod numpy;
#[cfg(feature = "parquet")]
pub mod parquet;
pub(super) mod text;
pub(super) mod written;

pub(crate) use kind::{Format, not_written, of, unknown_format};
