//! Recordings as Parquet: the columns of [`csv`](crate::recording::csv), and with them robot, joint names and provenance.
//!
//! In: a recording or a file. Out: the file, or the recording with notes on what was not used. Files of other programs are read too:
//! columns hold numbers, or lists of them.

mod metadata;
mod read;
mod table;
#[cfg(test)]
mod tests;
mod values;
mod write;

pub use read::read;
pub(in crate::recording) use table::Table;
pub use write::write;
pub(crate) use write::write_named;
