//! Long work on a thread of its own, while the interpreter runs and hears ctrl-C.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Time between two looks at the signals of the interpreter.
const LOOK: Duration = Duration::from_millis(50);

/// Time that interrupted work has to end in good order; then it ends unheard.
const GRACE: Duration = Duration::from_secs(2);

/// Stack of the thread, bytes: what a program's first thread has.
const STACK: usize = 8 << 20;

/// Runs `work` without the interpreter's lock. On an interrupt `stop` is called, the work has a moment to end, and the interrupt is
/// raised.
///
/// # Errors
/// The interrupt; work that panicked.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    stop: impl Fn(),
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = mpsc::channel();
    let worker = std::thread::Builder::new().name("tauscope".into()).stack_size(STACK);
    worker
        .spawn(move || {
            // Nobody hears it after an interrupt.
            let _ = sender.send(work());
        })
        .map_err(|problem| PyRuntimeError::new_err(format!("no thread to work on: {problem}")))?;
    let receiver = std::sync::Mutex::new(receiver);
    let wait = |time| py.detach(|| receiver.lock().unwrap_or_else(|held| held.into_inner()).recv_timeout(time));
    loop {
        match wait(LOOK) {
            Ok(done) => return Ok(done),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("tauscope failed inside; its message is on standard error"));
            }
            Err(RecvTimeoutError::Timeout) => {
                if let Err(interrupt) = py.check_signals() {
                    stop();
                    let end = Instant::now() + GRACE;
                    let _ = wait(end.saturating_duration_since(Instant::now()));
                    return Err(interrupt);
                }
            }
        }
    }
}
