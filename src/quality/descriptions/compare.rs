//! Whether one description is clearly better than another: a paired comparison over blocks of time.

use super::fit::Evaluation;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Probability with which a search accuses right logs, over all descriptions that it tries.
pub const ALPHA: f64 = 0.01;

/// The held-out residual of at least one torque must fall by this factor. A wrong description costs more; smaller gains are
/// those of friction, elasticity or a payload that the models do not hold.
const FALLS: f64 = 1.3;

/// No torque's held-out residual may grow by more than this factor: what makes one joint better at the cost of another
/// explains nothing.
const GROWS: f64 = 1.2;

/// A description is clearly worse than another where all torques together (product of the factors) gain this.
const DISTINCT: f64 = 1.3;

/// Fewer blocks allow no comparison.
const LEAST_BLOCKS: usize = 4;

/// The gain of a description over another, in logarithms of the mean square.
pub struct Comparison {
    /// Mean over the blocks of the sum over the torques.
    pub gain: f64,
    /// One-sided probability of such a gain where there is none; the blocks are the independent observations.
    pub p: f64,
    /// Mean gain of every torque channel.
    pub channels: Vec<Option<f64>>,
    /// Least mean gain of a log.
    pub least_of_logs: f64,
}

/// Compares what `reference` leaves with what `candidate` leaves. `log` is the log of every block.
pub fn compare(reference: &Evaluation, candidate: &Evaluation, log: &[usize]) -> Option<Comparison> {
    let channels = reference.held_out.len();
    let mut each = vec![Vec::new(); channels];
    let mut blocks: Vec<(usize, f64)> = Vec::new();
    for block in 0..log.len() {
        let mut gain = None;
        for (channel, of_channel) in each.iter_mut().enumerate() {
            if let (Some(before), Some(after)) = (reference.held_out[channel][block], candidate.held_out[channel][block]) {
                of_channel.push(before - after);
                *gain.get_or_insert(0.0) += before - after;
            }
        }
        blocks.extend(gain.map(|gain| (log[block], gain)));
    }
    if blocks.len() < LEAST_BLOCKS {
        return None;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let gains: Vec<f64> = blocks.iter().map(|(_, gain)| *gain).collect();
    let (count, gain) = (gains.len() as f64, mean(&gains));
    let deviation = (gains.iter().map(|g| (g - gain).powi(2)).sum::<f64>() / (count - 1.0) / count).sqrt();
    let t = gain / deviation.max(f64::MIN_POSITIVE);
    let p = StudentsT::new(0.0, 1.0, count - 1.0).map_or(1.0, |t_law| t_law.sf(t));
    let of_log = |wanted: usize| {
        let own: Vec<f64> = blocks.iter().filter(|(log, _)| *log == wanted).map(|(_, gain)| *gain).collect();
        if own.is_empty() { f64::INFINITY } else { mean(&own) }
    };
    let least_of_logs = log.iter().map(|&wanted| of_log(wanted)).fold(f64::INFINITY, f64::min);
    let channels = each.iter().map(|gains| (!gains.is_empty()).then(|| mean(gains))).collect();
    Some(Comparison { gain, p, channels, least_of_logs })
}

impl Comparison {
    /// Whether the candidate explains the torques clearly better, among so many that were tried.
    pub fn is_better(&self, tried: usize) -> bool {
        let of_rms = |factor: f64| 2.0 * factor.ln();
        let gains = || self.channels.iter().flatten();
        self.p * (tried as f64) < ALPHA
            && gains().any(|gain| *gain > of_rms(FALLS))
            && gains().all(|gain| *gain > -of_rms(GROWS))
            && self.least_of_logs > -of_rms(GROWS)
    }

    /// Whether the reference is clearly worse than the candidate, which is to be told from it.
    pub fn is_distinct(&self) -> bool {
        self.p < ALPHA && self.gain > 2.0 * DISTINCT.ln()
    }
}
