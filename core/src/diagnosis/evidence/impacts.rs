//! Impacts in gears with backlash: torque that jumps right after the load of a gear has changed sign.
//!
//! Teeth meet within milliseconds, which means over 20 ms and columns of smooth positions do not hold, and no model predicts
//! the phase of their ringing. *Where* the jumps are shows their cause all the same: the innovations of the torque from sample
//! to sample are ranked among all moments of the motion, and the ranks of those at which the load of one gear changes its
//! sign are combined (Fisher 1925). Ranks need no noise model. Moments near reversals and standstill are excluded: dry
//! friction jumps there. How wide the play is follows from the time of flight through it (`flight`).

use crate::channels::Channels;
use crate::diagnosis::logs::{Log, Rows};
use crate::diagnosis::regression::fisher;
use crate::identification::effect_model::Arm;
use crate::identification::noise::{AutoregressiveNoise, autocovariance};

/// Order of the noise from sample to sample, and standard deviations at which samples are cut for it: impacts are none of it.
const ORDER: usize = 12;
const CUT: f64 = 4.0;

/// Time after a change of sign in which the teeth meet, and before it for what the smoothing shifts, s.
const AFTER_S: f64 = 0.1;
const BEFORE_S: f64 = 0.01;

/// Length over which innovations are summed, s.
const IMPACT_S: f64 = 0.01;

/// Changes of sign closer than this are one, s.
pub(super) const APART_S: f64 = 0.05;

/// Time around a reversal of any joint, a standstill of the arm, and at the ends of a log that plays no part, s.
const REVERSAL_S: f64 = 0.06;
const STANDSTILL_S: f64 = 0.1;
const END_S: f64 = 0.3;

/// Share of a joint's usual speed under which it stands still, and which it exceeds around a true reversal.
const STILL: f64 = 0.05;
const TURNS: f64 = 0.01;

/// Fewest moments to rank among.
const FEWEST: usize = 200;

/// Share of the moments among which those are in which the loads change as much, to rank among.
const ALIKE: f64 = 0.2;

/// Rows that impacts disturb: before and after a change of sign, s.
const DISTURBED_S: [f64; 2] = [0.02, 0.15];

/// One log as impacts show in it.
#[derive(Debug)]
pub(super) struct Trace {
    /// Number of the log among its kind.
    pub(super) log: usize,
    /// Time between samples, s.
    pub(super) period: f64,
    /// Squared innovations of the torque in units of the noise, mean over the joints.
    pub(super) new: Vec<f64>,
    /// The largest of their sums over an impact's length, in the time after each sample.
    largest: Vec<f64>,
    /// Samples that are used.
    permitted: Vec<bool>,
    /// The values of `largest` where permitted, sorted.
    sorted: Vec<f64>,
    /// How much the loads change in the time after each sample.
    slew: Vec<f64>,
    /// Torque that each gear carries, `[joint][time]`, N m.
    pub(super) load: Channels,
    /// Residual of the torque, `[joint][time]`, N m.
    pub(super) left: Channels,
}

/// All logs of one kind as impacts show in them.
#[derive(Debug)]
pub(crate) struct Traces(pub(super) Vec<Trace>);

impl Traces {
    /// From the arm as found along logs; those from before a change are excluded.
    pub(crate) fn new(arm: &Arm, rows: &Rows) -> Self {
        Traces((rows.before..rows.logs.len()).filter_map(|log| Trace::new(arm, rows, log)).collect())
    }

    /// Logarithm of the probability of jumps as large after the changes of sign of a gear's load, were they anywhere. Windows
    /// of the gears `without` are excluded.
    pub(crate) fn log_p(&self, joint: usize, without: &[usize]) -> f64 {
        let mut ranks = Vec::new();
        for trace in &self.0 {
            let others: Vec<usize> = without.iter().flat_map(|&other| trace.changes(other)).collect();
            for change in trace.changes(joint) {
                let apart = others.iter().all(|&other| other.abs_diff(change) > trace.samples(AFTER_S + BEFORE_S));
                if let Some(rank) = trace.rank(change).filter(|_| apart) {
                    ranks.push(rank.ln());
                }
            }
        }
        fisher(ranks)
    }

    /// The same with each jump ranked only among moments without a change of sign in which the loads change as much: a model that follows
    /// steps of the torque late leaves jumps wherever such steps are, and on an arm that starts and stops these are where a load changes
    /// its sign.
    pub(crate) fn log_p_among_alike(&self, joint: usize) -> f64 {
        fisher(self.0.iter().flat_map(|trace| trace.ranks_among_alike(joint)).map(f64::ln))
    }

    /// Number of changes of sign of a gear's load that can be looked at.
    pub(crate) fn changes(&self, joint: usize) -> usize {
        self.0.iter().map(|trace| trace.changes(joint).iter().filter(|&&k| trace.rank(k).is_some()).count()).sum()
    }

    /// Share of the squared innovations that follows the changes of sign beyond the noise: lower bound (84 %).
    pub(crate) fn share(&self, joint: usize) -> f64 {
        let (mut beyond, mut all) = (Vec::new(), 0.0);
        for trace in &self.0 {
            all += trace.new.iter().sum::<f64>();
            let length = trace.samples(AFTER_S + BEFORE_S);
            let changes = trace.changes(joint).into_iter().filter(|&k| trace.rank(k).is_some());
            beyond.extend(changes.map(|k| {
                let own = &trace.new[k..(k + length).min(trace.new.len())];
                own.iter().map(|value| value - 1.0).sum::<f64>()
            }));
        }
        let sum: f64 = beyond.iter().sum();
        let mean = sum / beyond.len().max(1) as f64;
        let scatter = beyond.iter().map(|value| (value - mean).powi(2)).sum::<f64>().sqrt();
        (sum - scatter) / all.max(f64::MIN_POSITIVE)
    }

    /// Leaves out the rows that impacts in a gear disturb, on every joint.
    pub(crate) fn leave_out(&self, joint: usize, rows: &mut Rows) {
        for trace in &self.0 {
            let [before, after] = DISTURBED_S.map(|reach| trace.samples(reach));
            for window in trace.changes(joint) {
                let change = window + trace.samples(BEFORE_S);
                rows.leave_out_samples(trace.log, change.saturating_sub(before), change + after);
            }
        }
    }
}

impl Trace {
    /// None for a log too short or too still to rank moments in.
    fn new(arm: &Arm, rows: &Rows, index: usize) -> Option<Self> {
        let log = &rows.logs[index];
        let period = log.period;
        let torque = arm.torque(&log.motion, &log.motion);
        let (count, dof) = (log.time.len(), torque.channels());
        let left = log.torque.map(|joint, measured| {
            measured.iter().zip(torque.channel(joint)).map(|(measured, model)| measured - model).collect()
        });
        let mut new = vec![0.0; count];
        let mut known = vec![true; count];
        for joint in 0..dof {
            known.iter_mut().zip(left.channel(joint)).for_each(|(known, value)| *known &= value.is_finite());
            for (sum, value) in new.iter_mut().zip(innovations(left.channel(joint))) {
                *sum += value * value / dof as f64;
            }
        }
        let mut permitted = moving(log);
        permitted.iter_mut().zip(&known).for_each(|(ok, known)| *ok &= known);
        Self::ranked(index, period, new, &permitted, [arm.load(&log.motion), left])
    }

    /// From the innovations of a log, with the samples that are used; None where these are too few.
    fn ranked(log: usize, period: f64, new: Vec<f64>, permitted: &[bool], [load, left]: [Channels; 2]) -> Option<Self> {
        let samples = |seconds| samples_in(seconds, period);
        let (count, window, length) = (new.len(), samples(AFTER_S + BEFORE_S), samples(IMPACT_S));
        let permitted: Vec<bool> =
            (0..count).map(|k| k + window <= count && permitted[k..k + window].iter().all(|&ok| ok)).collect();
        let sums: Vec<f64> = (0..count).map(|k| new[k..(k + length).min(count)].iter().sum()).collect();
        let largest: Vec<f64> =
            (0..count).map(|k| sums[k..(k + window).min(count)].iter().fold(0.0, |m: f64, v| m.max(*v))).collect();
        let mut sorted: Vec<f64> = largest.iter().zip(&permitted).filter(|(_, ok)| **ok).map(|(v, _)| *v).collect();
        if sorted.len() < FEWEST {
            return None;
        }
        sorted.sort_by(f64::total_cmp);
        let slew = slew(&load, window);
        Some(Trace { log, period, new, largest, permitted, sorted, slew, load, left })
    }

    pub(super) fn samples(&self, seconds: f64) -> usize {
        samples_in(seconds, self.period)
    }

    /// First samples of the windows in which the load of a gear changes its sign.
    pub(super) fn changes(&self, joint: usize) -> Vec<usize> {
        let load = self.load.channel(joint);
        let (apart, lead) = (self.samples(APART_S), self.samples(BEFORE_S));
        let mut changes: Vec<usize> = Vec::new();
        for k in 1..load.len() {
            let turns = load[k - 1] * load[k] < 0.0;
            if turns && changes.last().is_none_or(|&last| k > last + lead + apart) {
                changes.push(k.saturating_sub(lead));
            }
        }
        changes
    }

    /// Share of all moments after which the torque jumps as much as after this sample; None where it plays no part.
    pub(super) fn rank(&self, sample: usize) -> Option<f64> {
        let least = self.largest[sample];
        let below = self.sorted.partition_point(|value| *value < least);
        let count = self.sorted.len() as f64;
        self.permitted[sample].then(|| (count - below as f64 + 1.0) / (count + 1.0))
    }

    /// Ranks of a gear's changes of sign among moments away from all of them in which the loads change as much.
    fn ranks_among_alike(&self, joint: usize) -> Vec<f64> {
        let (changes, window) = (self.changes(joint), self.samples(AFTER_S + BEFORE_S));
        let mut away = self.permitted.clone();
        for &change in &changes {
            away[change.saturating_sub(window)..(change + window).min(self.permitted.len())].fill(false);
        }
        let mut others: Vec<usize> = (0..away.len()).filter(|&k| away[k]).collect();
        others.sort_by(|&a, &b| self.slew[a].total_cmp(&self.slew[b]));
        let count = ((ALIKE * others.len() as f64) as usize).max(FEWEST).min(others.len());
        let rank = |change: usize| {
            let place = others.partition_point(|&other| self.slew[other] < self.slew[change]);
            let first = place.saturating_sub(count / 2).min(others.len() - count);
            let alike = &others[first..first + count];
            let above = alike.iter().filter(|&&other| self.largest[other] >= self.largest[change]).count();
            (above + 1) as f64 / (count + 1) as f64
        };
        changes.into_iter().filter(|&change| self.permitted[change]).map(rank).collect()
    }
}

/// Samples in a time, at least one.
fn samples_in(seconds: f64, period: f64) -> usize {
    ((seconds / period).round() as usize).max(1)
}

/// How much the loads change within so many samples after each: root mean square over the gears, each over its own.
fn slew(load: &Channels, window: usize) -> Vec<f64> {
    let mut sum = vec![0.0; load.samples()];
    for load in load.iter() {
        let all = load.iter().map(|value| value * value).sum::<f64>() / load.len().max(1) as f64;
        for (k, sum) in sum.iter_mut().enumerate() {
            let after = load[(k + window).min(load.len() - 1)];
            *sum += (after - load[k]).powi(2) / all.max(f64::MIN_POSITIVE);
        }
    }
    sum.into_iter().map(f64::sqrt).collect()
}

/// Innovations from sample to sample, in units of their noise; zero where they are not known.
fn innovations(left: &[f64]) -> Vec<f64> {
    let known: Vec<bool> = left.iter().map(|value| value.is_finite()).collect();
    let middle = |mut values: Vec<f64>| -> f64 {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let finite = || left.iter().copied().filter(|value| value.is_finite());
    let center = middle(finite().collect());
    let spread = 1.4826 * middle(finite().map(|value| (value - center).abs()).collect());
    let cut: Vec<f64> = left
        .iter()
        .map(|value| if value.is_finite() { (value - center).clamp(-CUT * spread, CUT * spread) } else { 0.0 })
        .collect();
    let noise = AutoregressiveNoise::from_autocovariance(&autocovariance(&cut, &known, ORDER));
    let order = noise.coefficients.len();
    let mut new = vec![0.0; left.len()];
    for k in order..left.len() {
        if known[k - order..=k].iter().all(|&known| known) {
            let past = noise.coefficients.iter().enumerate();
            new[k] = left[k] - center - past.map(|(lag, a)| a * (left[k - 1 - lag] - center)).sum::<f64>();
        }
    }
    let scale = 1.4826 * middle(new[order..].iter().map(|value| value.abs()).collect());
    if scale > 0.0 {
        new.iter_mut().for_each(|value| *value /= scale);
    } else {
        new.fill(0.0);
    }
    new
}

/// Samples away from reversals of any joint, from standstill, and from the ends of a log.
fn moving(log: &Log) -> Vec<bool> {
    let samples = |seconds| samples_in(seconds, log.period);
    let count = log.time.len();
    let mut permitted = vec![true; count];
    let mut exclude = |middle: usize, reach: usize| {
        permitted[middle.saturating_sub(reach)..(middle + reach + 1).min(count)].fill(false);
    };
    let mut still = vec![true; count];
    for joint in 0..log.motion.joints() {
        let speed = log.motion.qd.channel(joint);
        let usual = (speed.iter().map(|v| v * v).sum::<f64>() / count as f64).sqrt();
        if usual == 0.0 {
            continue;
        }
        still.iter_mut().zip(speed).for_each(|(still, v)| *still &= v.abs() < STILL * usual);
        let reach = samples(REVERSAL_S);
        for k in 1..count {
            // The noise of a joint that stands still changes its sign all the time.
            let near = || &speed[k.saturating_sub(reach)..(k + reach).min(count)];
            if speed[k - 1] * speed[k] < 0.0 && near().iter().any(|v| v.abs() > TURNS * usual) {
                exclude(k, reach);
            }
        }
    }
    let reach = samples(STANDSTILL_S);
    still.iter().enumerate().filter(|(_, still)| **still).for_each(|(k, _)| exclude(k, reach));
    let end = samples(END_S);
    exclude(0, end);
    exclude(count - 1, end);
    permitted
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};

    const PERIOD: f64 = 0.002;

    /// Twenty seconds of noise in which the first of two gears, whose loads change signs at different times, hits its teeth
    /// this hard 20 ms after each change.
    pub(in crate::diagnosis::evidence) fn hit(seed: u64, hardness: f64) -> Traces {
        let mut source = random::stream(seed, "impacts", 0);
        let wave = |hz: f64, phase: f64| -> Vec<f64> {
            (0..10_000).map(|k| (std::f64::consts::TAU * hz * f64::from(k) * PERIOD + phase).sin()).collect()
        };
        let load = Channels::from_vectors(&[wave(0.31, 0.4), wave(0.23, 1.1)]);
        let left = Channels::zeros(2, 10_000);
        let mut new: Vec<f64> = (0..10_000)
            .map(|_| {
                let white: f64 = StandardNormal.sample(&mut source);
                white * white
            })
            .collect();
        for k in 1..9_900 {
            if load.channel(0)[k - 1] * load.channel(0)[k] < 0.0 {
                new[k + 10] += hardness;
            }
        }
        Traces(vec![Trace::ranked(0, PERIOD, new, &[true; 10_000], [load, left]).unwrap()])
    }

    #[test]
    fn impacts_tell_their_gear() {
        let traces = hit(1, 200.0);
        assert!(traces.log_p(0, &[]) < -15.0, "{}", traces.log_p(0, &[]));
        assert!(traces.log_p(1, &[]) > -5.0, "{}", traces.log_p(1, &[]));
        assert_eq!((traces.changes(0), traces.changes(1)), (12, 9));
        assert!(traces.share(0) > 0.1 && traces.share(1) < 0.02, "{} {}", traces.share(0), traces.share(1));
    }

    #[test]
    fn without_impacts_all_ranks_are_as_likely() {
        let runs = 400;
        let below = (0..runs).filter(|&seed| hit(seed, 0.0).log_p(0, &[]) < 0.05f64.ln()).count();
        assert!((5..=32).contains(&below), "{below} of {runs} below 5 %");
    }

    #[test]
    fn jumps_where_all_loads_step_are_no_impacts() {
        // Loads that step every half second, the first through zero, and a model that is late by 20 ms in all steps.
        let step = |k: usize, high: f64, low: f64| if (k / 250).is_multiple_of(2) { high } else { low };
        let load = Channels::from_vectors(&[
            (0..10_000).map(|k| if k < 5_000 { step(k, 2.0, -2.0) } else { step(k, 4.0, 0.5) }).collect(),
            (0..10_000).map(|k| step(k, 3.0, 1.0)).collect(),
        ]);
        let mut source = random::stream(6, "steps", 0);
        let mut new: Vec<f64> = (0..10_000)
            .map(|_| {
                let white: f64 = StandardNormal.sample(&mut source);
                white * white
            })
            .collect();
        (250..10_000).step_by(250).for_each(|k| new[k + 10] += 200.0);
        let left = Channels::zeros(2, 10_000);
        let traces = Traces(vec![Trace::ranked(0, PERIOD, new, &[true; 10_000], [load, left]).unwrap()]);
        assert!(traces.log_p(0, &[]) < -10.0 && traces.log_p_among_alike(0) > -5.0, "{traces:?}");
        let hit = hit(1, 200.0);
        assert!(hit.log_p_among_alike(0) < -10.0 && hit.log_p_among_alike(1) > -5.0);
    }

    #[test]
    fn what_is_new_in_coloured_noise_is_white_and_keeps_jumps() {
        let law = AutoregressiveNoise { coefficients: vec![1.6, -0.65], innovation_std: 0.3 };
        let mut left = law.simulate(20_000, &mut random::stream(4, "test", 0));
        left[5_000] += 9.0;
        left[700] = f64::NAN;
        let new = innovations(&left);
        assert!((new[5_000].abs() - 30.0).abs() < 6.0, "{}", new[5_000]);
        assert!(new[700..=712].iter().all(|&value| value == 0.0) && new[713] != 0.0);
        let quiet = &new[6_000..];
        let mean = |lag: usize| quiet.iter().zip(&quiet[lag..]).map(|(a, b)| a * b).sum::<f64>() / quiet.len() as f64;
        assert!((mean(0) - 1.0).abs() < 0.05 && mean(1).abs() < 0.03 && mean(2).abs() < 0.03);
    }
}
