//! What a diagnosis is given: training, held-out and reference logs.

use crate::effects::Placed;
use crate::recording::Recording;

/// Share of a log that is held out where there is no other to judge by.
const HELD_OUT: f64 = 0.3;

/// What a diagnosis is given.
#[derive(Debug, Clone, Default)]
pub struct Input<'a> {
    /// Logs to find from.
    pub train: Vec<&'a Recording>,
    /// Logs of other motions to judge by; the last part of every training log where there are none.
    pub test: Vec<&'a Recording>,
    /// Logs from before a change: the question is then what changed since.
    pub reference: Vec<&'a Recording>,
    /// Effects that the simulation has already.
    pub present: Vec<Placed>,
}

/// The first and the last part of every log.
pub fn split(logs: &[&Recording]) -> (Vec<Recording>, Vec<Recording>) {
    let end = |log: &Recording| ((1.0 - HELD_OUT) * log.samples() as f64) as usize;
    logs.iter().map(|log| (log.slice(0..end(log)), log.slice(end(log)..log.samples()))).unzip()
}

/// The logs that a diagnosis judges by: the test logs, or else the last part of every training log.
pub fn held_out(input: &Input) -> Vec<Recording> {
    if input.test.is_empty() { split(&input.train).1 } else { input.test.iter().map(|&log| log.clone()).collect() }
}
