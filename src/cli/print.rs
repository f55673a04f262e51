//! Writing to standard output, which may be a pipe that nobody reads any longer.

use super::Global;
use crate::error::{Error, Result};
use crate::output;
use serde::Serialize;
use std::io::{self, ErrorKind, Write};

/// Prints what a command found: nothing under `--quiet`, `value` under `--json`, else the text for people. A closed pipe
/// (`tauscope | head`) is not an error: the reader has had enough.
///
/// # Errors
/// If standard output cannot be written, as on a full disk.
pub fn result(global: &Global, schema: &str, value: &impl Serialize, text: impl FnOnce() -> String) -> Result<()> {
    let mut bytes = Vec::new();
    let made = match (global.quiet, global.json) {
        (true, _) => return Ok(()),
        (false, true) => output::json(&mut bytes, schema, value),
        (false, false) => writeln!(bytes, "{}", text()),
    };
    let mut out = io::stdout().lock();
    match made.and_then(|()| out.write_all(&bytes)).and_then(|()| out.flush()) {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => {
            Err(Error::io("standard output", "print the result", source))
        }
        _ => Ok(()),
    }
}
