//! What commands share. Options of the command line and the host come in; the arm, logs, progress, printed results and `corrected.toml`
//! go out.

mod arm;
pub mod corrected;
mod global;
mod gravity;
mod host;
pub mod interrupt;
mod logs;
pub mod print;
pub mod progress;

pub use arm::ArmArguments;
pub use global::{BAD_INPUT, DONE, FAILED, Global};
pub use host::{Host, Printed};
pub use logs::LogArguments;
