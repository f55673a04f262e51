//! A robot as its file describes it: a tree of links and joints of every kind, before it is decided which joints move.
//!
//! In: a file ([`read`]) or its text ([`parse`]). Out: a [`Description`] with links, joints and notes on what was read otherwise than it
//! is written. [`Description::robot`] makes the robot of the joints under study.

mod joints;
mod mimics;
mod tree;

pub use super::file::{parse, read};
pub(super) use mimics::settle_mimics;
pub use tree::{Description, JointDescription, LinkDescription, Mimic, Missing, Motion};
