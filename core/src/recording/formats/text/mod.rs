//! Tables in text as programs write them.
//!
//! In: the bytes of a file. Out: a [`Text`], whose header names the columns, and its rows as numbers with their lines. Understood
//! are other encodings and separators, comments and titles above the header, a second line of units, lists within cells, and
//! messages without a header, units behind the numbers. Rows without a number in every column are reported one by one.

mod cells;
mod comments;
mod encoding;
mod header;
mod notation;
mod quotes;
mod separators;
mod table;

pub(crate) use table::Text;
