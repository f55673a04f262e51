//! Logs that are to be given once each: the same log again validates nothing, and counts twice.

use super::Recording;
use crate::error::{Error, Result};
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hasher};

/// The logs that were given so far, by their names.
#[derive(Debug, Default)]
pub(crate) struct Once {
    seen: Vec<(String, HashSet<u64>)>,
}

impl Once {
    /// Takes another log in its pieces, and refuses one that is given twice, as a whole or in part. Two recordings have hardly a sample in
    /// common.
    ///
    /// # Errors
    /// If the log has more than half of the samples of one before, or that one of its; both are named.
    pub(crate) fn take(&mut self, name: String, pieces: &[Recording]) -> Result<()> {
        let samples: HashSet<u64> = pieces.iter().flat_map(samples).collect();
        let twice = self.seen.iter().find(|(_, other)| {
            let common = samples.intersection(other).count();
            2 * common > samples.len().min(other.len())
        });
        if let Some((other, _)) = twice {
            let problem = format!("has the samples of {other}; give every log once, and judge by another motion");
            return Err(Error::request(name, problem));
        }
        self.seen.push((name, samples));
        Ok(())
    }
}

/// The samples of a recording whatever their time: hashes of positions and torques to the last bit.
fn samples(recording: &Recording) -> impl Iterator<Item = u64> {
    (0..recording.samples()).map(|k| {
        let mut hasher = DefaultHasher::new();
        recording.q.iter().chain(recording.tau.iter()).for_each(|signal| hasher.write_u64(signal[k].to_bits()));
        hasher.finish()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(samples: std::ops::Range<i32>) -> Vec<Recording> {
        let q: Vec<f64> = samples.map(f64::from).collect();
        let time: Vec<f64> = (0..q.len()).map(|k| 0.01 * k as f64).collect();
        let tau = q.iter().map(|q| 2.0 * q).collect::<Vec<f64>>();
        vec![Recording::new(["a"], time, [q], [tau]).unwrap()]
    }

    #[test]
    fn a_log_that_was_given_is_refused_whole_and_in_part() {
        let mut once = Once::default();
        once.take("a.csv".into(), &log(0..100)).unwrap();
        for again in [0..100, 40..60, 60..120, 30..300] {
            let refused = once.take("b.csv".into(), &log(again)).unwrap_err().to_string();
            assert!(refused.starts_with("b.csv: has the samples of a.csv; give every log once"), "{refused}");
        }
        once.take("c.csv".into(), &log(90..200)).unwrap();
    }
}
