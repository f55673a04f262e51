//! Which screened logs a diagnosis takes: long enough, and each given once.

use super::screening::Screened;
use crate::error::{Error, Result};
use crate::recording::{Once, Recording};

/// Shortest time that logs to identify from may last together, s.
const SHORTEST_S: f64 = 5.0;

/// Shortest time of held-out logs together, s: a moment does not show whether a model predicts.
const SHORTEST_HELD_OUT_S: f64 = 2.0;

/// Refuses logs to identify from that are too short together; `what` names them.
///
/// # Errors
/// If they are shorter than five seconds.
pub(crate) fn check_length(what: &str, logs: &[Screened]) -> Result<()> {
    let seconds = seconds(logs);
    if logs.is_empty() || seconds >= SHORTEST_S {
        return Ok(());
    }
    let problem = format!(
        "the logs last {seconds:.1} s together; a diagnosis needs {SHORTEST_S} s at the least, and two motions of 20 s to be \
         worth while"
    );
    Err(Error::request(what, problem))
}

/// Refuses held-out logs that are too short together; `what` names them.
///
/// # Errors
/// If they are shorter than two seconds.
pub(crate) fn check_held_out(what: &str, logs: &[Screened]) -> Result<()> {
    let seconds = seconds(logs);
    if logs.is_empty() || seconds >= SHORTEST_HELD_OUT_S {
        return Ok(());
    }
    let problem = format!(
        "the logs last {seconds:.1} s together; give {SHORTEST_HELD_OUT_S} s at the least, or none: 30 % of every \
         training log is held out then"
    );
    Err(Error::request(what, problem))
}

fn seconds(logs: &[Screened]) -> f64 {
    logs.iter().flat_map(|log| &log.pieces).map(Recording::duration).sum()
}

/// Refuses a log that is given twice; each of `given` has what names its logs.
///
/// # Errors
/// Those of [`Once::take`].
pub(crate) fn refuse_twice(given: [(&str, &[Screened]); 3]) -> Result<()> {
    let mut once = Once::default();
    let mut logs = given.into_iter().flat_map(|(what, logs)| logs.iter().map(move |log| (what, log)));
    logs.try_for_each(|(what, log)| once.take(format!("{what} {}", log.name), &log.pieces))
}
