//! What reading a log shows: rows that were left out, its clock, columns without use, and the names of its joints.
//!
//! In: the log as it was read. Out: findings.

pub(super) mod clock;
pub(super) mod cycles;
pub(super) mod joint_names;
pub(super) mod unused_columns;
