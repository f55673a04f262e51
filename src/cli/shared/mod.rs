//! What commands share. Options of the command line and the host come in; the arm, logs, progress, printed results and `corrected.toml`
//! go out.

mod arm;
pub(super) mod corrected;
mod global;
mod gravity;
mod host;
pub(super) mod interrupt;
mod logs;
pub(super) mod print;
pub(super) mod progress;
mod time;
pub(super) mod trust;

pub(crate) use arm::ArmArguments;
pub use global::{BAD_INPUT, DONE, FAILED, Global};
pub use host::{Host, Printed};
pub(crate) use logs::LogArguments;
pub(crate) use time::time;
