//! The compiled part of the Python package `tauscope`: robots and their dynamics on arrays, logs from arrays, and the commands.
//!
//! It is small on purpose. What users see is written in Python beside it, over the functions of this module.

mod arrays;
mod command;
mod dynamics;
mod error;
mod log;
mod robot;
mod toml_text;
mod warnings;
mod work;

use mimalloc::MiMalloc;
use pyo3::prelude::*;

/// As in the command: freed memory is kept for what comes next.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// The compiled part of tauscope.
#[pymodule]
mod _tauscope {
    #[pymodule_export]
    use super::command::{call, main};
    #[pymodule_export]
    use super::error::TauscopeError;
    #[pymodule_export]
    use super::log::{Held, hold, read_log};
    #[pymodule_export]
    use super::robot::{Arm, check_text};
    #[pymodule_export]
    use super::toml_text::{from_toml, to_toml};
    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python calls it so")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
