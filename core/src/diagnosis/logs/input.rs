//! What a diagnosis is given: training, held-out and reference logs.

use crate::effects::Placed;
use crate::recording::Recording;

/// Share of a log that is held out where no other is held out.
const HELD_OUT: f64 = 0.3;

/// What a diagnosis is given.
#[derive(Debug, Clone, Default)]
pub struct Input<'a> {
    /// Logs to find from.
    pub train: Vec<&'a Recording>,
    /// Held-out logs of other motions; the last part of every training log where there are none.
    pub test: Vec<&'a Recording>,
    /// Logs from before a change: the question is then what changed since.
    pub reference: Vec<&'a Recording>,
    /// Effects that the simulation has already.
    pub present: Vec<Placed>,
}

/// The first and the last part of every log.
pub(crate) fn split(logs: &[&Recording]) -> (Vec<Recording>, Vec<Recording>) {
    let end = |log: &Recording| ((1.0 - HELD_OUT) * log.samples() as f64) as usize;
    logs.iter().map(|log| (log.slice(0..end(log)), log.slice(end(log)..log.samples()))).unzip()
}

/// The logs as a diagnosis uses them: corrected, cut at long gaps, at even steps; torque that must not be used is not a
/// number.
#[derive(Debug, Clone, Default)]
pub struct CleanLogs {
    /// Logs to identify from.
    pub train: Vec<Recording>,
    /// Held-out logs that were given.
    pub test: Vec<Recording>,
    /// Logs from before a change.
    pub reference: Vec<Recording>,
}

impl CleanLogs {
    /// The held-out logs: those given, else the last part of every training log.
    pub fn held_out(&self) -> Vec<Recording> {
        if self.test.is_empty() { split(&self.train.iter().collect::<Vec<_>>()).1 } else { self.test.clone() }
    }

    /// All logs: training, test, reference.
    pub fn all(&self) -> impl Iterator<Item = &Recording> {
        self.train.iter().chain(&self.test).chain(&self.reference)
    }

    /// What a diagnosis is given where the simulation has the effects `present` already.
    pub fn input(&self, present: Vec<Placed>) -> Input<'_> {
        let [train, test, reference] = [&self.train, &self.test, &self.reference].map(|logs| logs.iter().collect());
        Input { train, test, reference, present }
    }
}
