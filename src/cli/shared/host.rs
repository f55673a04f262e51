//! A program that runs commands inside itself, in the place of a terminal: it takes answers, and may ask to stop.

use crate::error::{Error, Result};
use crate::output;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// What a command printed.
///
/// ```
/// use std::sync::Arc;
/// use tauscope::cli::{self, Host};
///
/// // One answer, for programs and for people.
/// let host = Arc::new(Host::default());
/// cli::call(["robot", "tests/reference/pendulum.urdf"], &host)?;
/// let printed = host.take().expect("the command printed");
/// assert!(printed.json.starts_with('{') && printed.text.contains("pendulum"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Printed {
    /// The result as `--json` prints it.
    pub json: String,
    /// The same for people.
    pub text: String,
}

/// Takes what a command prints, and asks it to stop. See [`call`](crate::cli::call).
///
/// ```
/// use std::sync::Arc;
/// use tauscope::cli::{self, Host};
///
/// let host = Arc::new(Host::default());
/// assert_eq!(cli::call(["effects", "backlash"], &host)?, cli::DONE);
///
/// // What was printed is handed over once.
/// assert!(host.take().is_some());
/// assert!(host.take().is_none());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct Host {
    stop: Arc<AtomicBool>,
    printed: Mutex<Option<Printed>>,
}

impl Host {
    /// Asks the command to stop, as ctrl-C does on a terminal. A diagnosis, an identification, a search or a study ends soon, others do
    /// not hear it.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// What the command printed, once.
    pub fn take(&self) -> Option<Printed> {
        self.printed.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// The flag that [`Host::stop`] raises.
    pub(super) fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// Takes a result.
    ///
    /// # Errors
    /// If it has no JSON form.
    pub(super) fn print(&self, schema: &str, value: &impl Serialize, text: String) -> Result<()> {
        let mut bytes = Vec::new();
        output::json(&mut bytes, schema, value)
            .map_err(|problem| Error::io("the result", "write it as JSON", problem))?;
        let json = String::from_utf8_lossy(&bytes).into_owned();
        *self.printed.lock().unwrap_or_else(PoisonError::into_inner) = Some(Printed { json, text });
        Ok(())
    }
}
