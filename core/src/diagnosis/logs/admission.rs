//! Which screened logs a diagnosis takes: long enough, and each given once.

use super::screening::Screened;
use crate::error::{Error, Result};
use crate::recording::Recording;
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hasher};

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

/// Refuses a log that is given twice, as a whole or in part: it validates nothing, and counts once. Two recordings have
/// hardly a sample in common.
///
/// # Errors
/// If a log has more than half of the samples of another, or the other of its; both are named.
pub(crate) fn refuse_twice(given: [(&str, &[Screened]); 3]) -> Result<()> {
    let mut seen: Vec<(String, HashSet<u64>)> = Vec::new();
    for (what, logs) in given {
        for log in logs {
            let samples = samples(log);
            let twice = seen.iter().find(|(_, other)| {
                let common = samples.intersection(other).count();
                2 * common > samples.len().min(other.len())
            });
            let name = format!("{what} {}", log.name);
            if let Some((other, _)) = twice {
                let problem = format!("has the samples of {other}; give every log once, and judge by another motion");
                return Err(Error::request(name, problem));
            }
            seen.push((name, samples));
        }
    }
    Ok(())
}

/// The samples of a log whatever their time: hashes of positions and torques to the last bit.
fn samples(log: &Screened) -> HashSet<u64> {
    let of_piece = |piece: &Recording| -> Vec<u64> {
        let hash = |k: usize| {
            let mut hasher = DefaultHasher::new();
            piece.q.iter().chain(piece.tau.iter()).for_each(|signal| hasher.write_u64(signal[k].to_bits()));
            hasher.finish()
        };
        (0..piece.samples()).map(hash).collect()
    };
    log.pieces.iter().flat_map(of_piece).collect()
}
