//! Ctrl-C, or a kill (SIGTERM), as a request to stop in good order.

use super::global::Global;
use crate::error::{Error, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The flag that a program raises that runs the command inside itself. On a terminal ctrl-C ends the command at once.
pub(crate) fn of_host(global: &Global) -> Option<Arc<AtomicBool>> {
    global.host.as_ref().map(|host| host.flag())
}

/// A flag that ctrl-C or a kill raises; a second one ends the program at once. Inside a program it is the program that raises it.
pub(crate) fn flag(global: &Global) -> Result<Arc<AtomicBool>> {
    if let Some(host) = &global.host {
        return Ok(host.flag());
    }
    let flag = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if raised.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })
    .map_err(|problem| Error::request("ctrl-C", format!("cannot be caught: {problem}")))?;
    Ok(flag)
}
