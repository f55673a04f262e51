//! Ctrl-C as a request to stop in good order.

use super::global::Global;
use crate::error::{Error, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that ctrl-C raises; a second ctrl-C ends the program at once. Inside a program it is the program that raises it.
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
