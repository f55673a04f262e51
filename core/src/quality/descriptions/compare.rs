//! Whether one description is clearly better than another: a paired comparison over blocks of time.

use super::fitting::Evaluation;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Probability with which a search accuses right logs, over all descriptions that it tries.
pub(super) const ALPHA: f64 = 0.01;

/// The held-out residual of at least one torque must fall by this factor. A wrong description costs more; smaller gains are
/// those of friction, elasticity or a payload that the models do not hold.
const FALLS: f64 = 1.3;

/// By this factor the residual of one torque must fall, and the product of the factors of all torques for each change of a set. Right
/// logs of an arm with much play reach 1.3 with free parameters; a wrong sign, exchange or mounting of public logs has 8 and more.
const LARGE: f64 = 2.0;

/// No explained torque's held-out residual may grow by more than this factor: what makes one joint better at the cost of another
/// explains nothing. A torque of which a model without the change explains little is no evidence on the change.
const GROWS: f64 = 1.2;

/// A description is clearly worse than another where all torques together (product of the factors) gain this.
pub(super) const DISTINCT: f64 = 1.3;

/// An explained torque has less than this share unexplained: of an arm whose geometry is known, and of joints by themselves, whose
/// models lack the pull of the others.
pub(super) const EXPLAINED: f64 = 0.2;
pub(super) const EXPLAINED_ALONE: f64 = 0.5;

/// Fewer blocks allow no comparison.
const LEAST_BLOCKS: usize = 4;

/// The gain of a description over another, in logarithms of the mean square.
pub(super) struct Comparison {
    /// Mean over the blocks of the sum over the torques.
    pub gain: f64,
    /// One-sided p-value of the torque that gains most, or of all together, times the number of both; the blocks are the
    /// independent observations.
    pub p: f64,
    /// Mean gain of every torque channel.
    pub channels: Vec<Option<f64>>,
    /// Share of every torque that the reference leaves unexplained.
    pub before: Vec<Option<f64>>,
    /// Least mean gain of a log.
    pub least_of_logs: f64,
}

/// Compares the residuals of `reference` with those of `candidate`. `log` is the log of every block.
pub(super) fn compare(reference: &Evaluation, candidate: &Evaluation, log: &[usize]) -> Option<Comparison> {
    let channels = reference.held_out.len();
    let mut each = vec![Vec::new(); channels];
    let mut blocks: Vec<(usize, f64)> = Vec::new();
    for (block, &own_log) in log.iter().enumerate() {
        let mut gain = None;
        for (channel, of_channel) in each.iter_mut().enumerate() {
            if let (Some(before), Some(after)) =
                (reference.held_out[channel][block], candidate.held_out[channel][block])
            {
                of_channel.push(before - after);
                *gain.get_or_insert(0.0) += before - after;
            }
        }
        blocks.extend(gain.map(|gain| (own_log, gain)));
    }
    if blocks.len() < LEAST_BLOCKS {
        return None;
    }
    let gains: Vec<f64> = blocks.iter().map(|(_, gain)| *gain).collect();
    let gain = mean(&gains);
    // A joint that rests in some blocks has no gain there; the torque that gains most is compared on its own blocks. Where joints move in
    // turns, each has few, and only all together show what changes all.
    let p = each.iter().chain([&gains]).map(|gains| one_sided(gains)).fold(1.0, f64::min) * (channels + 1) as f64;
    let of_log = |wanted: usize| {
        let own: Vec<f64> = blocks.iter().filter(|(log, _)| *log == wanted).map(|(_, gain)| *gain).collect();
        if own.is_empty() { f64::INFINITY } else { mean(&own) }
    };
    let least_of_logs = log.iter().map(|&wanted| of_log(wanted)).fold(f64::INFINITY, f64::min);
    let channels = each.iter().map(|gains| (!gains.is_empty()).then(|| mean(gains))).collect();
    Some(Comparison { gain, p, channels, before: reference.unexplained.clone(), least_of_logs })
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// One-sided p-value of a positive mean, by Student's t over the blocks.
fn one_sided(gains: &[f64]) -> f64 {
    if gains.len() < LEAST_BLOCKS {
        return 1.0;
    }
    let (count, mean) = (gains.len() as f64, mean(gains));
    let error = (gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0) / count).sqrt();
    // Gains without any scatter are those of logs without noise.
    let t = if mean == 0.0 { 0.0 } else { mean / error.max(1e-12 * mean.abs()) };
    StudentsT::new(0.0, 1.0, count - 1.0).map_or(1.0, |law| law.sf(t))
}

impl Comparison {
    /// Whether the candidate explains the torques clearly better, among so many that were tried. Torques of which the reference
    /// leaves less than the share `explained` must stay so.
    pub(super) fn is_better(&self, tried: usize, explained: f64) -> bool {
        let of_rms = |factor: f64| 2.0 * factor.ln();
        let kept = |(gain, before): (&Option<f64>, &Option<f64>)| {
            gain.is_none_or(|gain| gain > -of_rms(GROWS)) || before.is_some_and(|share| share > explained)
        };
        self.p * (tried as f64) < ALPHA
            && self.channels.iter().flatten().any(|gain| *gain > of_rms(FALLS))
            && self.channels.iter().zip(&self.before).all(kept)
            && self.least_of_logs > -of_rms(GROWS)
    }

    /// Whether the residual of a torque falls clearly.
    pub(super) fn falls(&self, channel: usize) -> bool {
        self.channels[channel].is_some_and(|gain| gain > 2.0 * FALLS.ln())
    }

    /// Whether the residual of a torque of which the reference leaves more than a share falls much.
    pub(super) fn is_large_beyond(&self, share: f64) -> bool {
        let each = self.channels.iter().zip(&self.before);
        each.filter_map(|(gain, before)| Some((gain.as_ref()?, before.as_ref()?)))
            .any(|(gain, before)| *gain > 2.0 * LARGE.ln() && *before > share)
    }

    /// Whether the gain is larger than what a model that lacks something allows, for so many changes.
    pub(super) fn is_large(&self, changes: usize) -> bool {
        let most = self.channels.iter().flatten().fold(f64::NEG_INFINITY, |most, gain| most.max(*gain));
        most > 2.0 * LARGE.ln() && self.gain > 2.0 * changes as f64 * LARGE.ln()
    }

    /// The same with the mean gain of every torque over its own blocks, where joints move in turns.
    pub(super) fn is_large_in_all(&self, changes: usize) -> bool {
        let gain = self.channels.iter().flatten().sum();
        Comparison { gain, channels: self.channels.clone(), before: Vec::new(), ..*self }.is_large(changes)
    }

    /// Whether the reference is clearly worse than the candidate, from which it must be separable.
    pub(super) fn is_distinct(&self) -> bool {
        self.p < ALPHA && self.gain > 2.0 * DISTINCT.ln()
    }

    /// Whether the candidate gains something to speak of, be it by chance, on all torques together or on one, which may move in few blocks:
    /// of a short log little is certain.
    pub(super) fn is_noticeable(&self) -> bool {
        self.gain > 2.0 * DISTINCT.ln() || (0..self.channels.len()).any(|channel| self.falls(channel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_is_large_from_a_factor_of_two_for_each_change() {
        let large = |factors: &[f64], changes: usize| {
            let gains: Vec<f64> = factors.iter().map(|factor| 2.0 * factor.ln()).collect();
            let channels = gains.iter().copied().map(Some).collect();
            let before = vec![Some(1.0); gains.len()];
            Comparison { gain: gains.iter().sum(), p: 0.0, channels, before, least_of_logs: 1.0 }.is_large(changes)
        };
        assert!(large(&[2.1, 1.0], 1) && !large(&[1.9, 1.0], 1));
        // Two torques of which each gains little; one that gains at the cost of another.
        assert!(!large(&[1.6, 1.6, 1.6], 1) && !large(&[2.1, 0.9], 1));
        assert!(large(&[4.1, 1.0], 2) && large(&[2.1, 2.1], 2) && !large(&[3.9, 1.0], 2));
    }

    #[test]
    fn joints_that_move_in_turns_show_together_what_changes_all() {
        // Each joint moves in two of eight blocks.
        let of = |residual: &dyn Fn(usize) -> f64| Evaluation {
            held_out: (0..4).map(|j| (0..8).map(|b| (b % 4 == j).then(|| residual(b))).collect()).collect(),
            unexplained: vec![Some(0.5); 4],
        };
        let compared =
            |gain: &dyn Fn(usize) -> f64| compare(&of(&|_| 0.0), &of(&|block| -gain(block)), &[0; 8]).unwrap();
        assert!(compared(&|block| 3.0 + 0.1 * block as f64).p < 1e-4);
        assert!(compared(&|block| if block % 2 == 0 { 3.0 } else { -2.5 }).p > 0.5);
    }

    #[test]
    fn what_may_be_chance_is_noticed_and_not_distinct() {
        let of = |factor: f64, p: f64| Comparison {
            gain: 2.0 * factor.ln(),
            p,
            channels: vec![None, Some(0.0)],
            before: Vec::new(),
            least_of_logs: 0.0,
        };
        assert!(of(1.31, 0.5).is_noticeable() && !of(1.29, 0.5).is_noticeable());
        // One torque in few blocks.
        let of_one = |factor: f64| Comparison { channels: vec![Some(2.0 * factor.ln())], ..of(1.01, 0.5) };
        assert!(of_one(1.31).is_noticeable() && !of_one(1.29).is_noticeable());
        assert!(of(1.31, 0.009).is_distinct() && !of(1.31, 0.011).is_distinct() && !of(1.29, 0.009).is_distinct());
    }

    #[test]
    fn a_torque_that_was_explained_stays_so() {
        let better = |before: f64, factor: f64| {
            let channels = vec![Some(2.0 * 15f64.ln()), Some(-2.0 * factor.ln())];
            let before = vec![Some(1.0), Some(before)];
            Comparison { gain: 4.0, p: 0.0, channels, before, least_of_logs: 4.0 }.is_better(40, 0.2)
        };
        assert!(better(0.19, 1.19) && !better(0.19, 1.21));
        // The second of two public wrists, whose torque friction that is not modelled makes: it decides nothing.
        assert!(better(0.46, 1.34) && better(0.21, 1.21));
    }
}
