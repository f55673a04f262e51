//! Signals that are sampled at different rates in one table.
//!
//! In: columns as the file has them. Out: columns at the rows of the slower of positions and torques, the others interpolated, and a
//! note on what was done. Four cases: rows of two sources with blanks, values that are repeated while the other signals go on,
//! rows that repeat whole, and rows of zeros.

mod blanks;
mod digits;
mod repeats;
mod rows;
#[cfg(test)]
mod tests;
mod unfilled;
mod whole;

pub(crate) use blanks::without_blanks;
pub(crate) use repeats::without_repeats;
pub(crate) use unfilled::without_unfilled;
pub(crate) use whole::without_whole;
