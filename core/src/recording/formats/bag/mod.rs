//! Logs of ROS 2: MCAP files and bags (folders, `.mcap`, `.db3`) with sensor_msgs/JointState.
//!
//! In: the files of a log. Out: a [`Table`], in which a message is a row, or a recording. Time is that of the messages' headers, from
//! the first on; where nobody set it, that at which they were logged. Columns are `NAME_position`, `NAME_velocity`, `NAME_effort`,
//! whatever order the messages name their joints in. Several nodes may send different joints on one topic: messages with the same
//! joints belong together.

mod files;
mod groups;
mod joint_state;
mod read;
mod storage;
mod table;
#[cfg(test)]
mod tests;
pub(crate) mod write;

pub(crate) use files::is_bag;
pub(crate) use read::{provenance, read, recording};
pub(crate) use table::Table;
