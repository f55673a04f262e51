//! The play of a gear by the time of flight through it: from the change of sign of the load to the meeting of the teeth.

use super::impacts::{APART_S, Trace, Traces};
use super::play::Play;
use crate::diagnosis::logs::Rows;
use crate::identification::effect_model::Arm;

/// Share of the moments that hold an impact at most: the flight through the play is timed with those.
const STRONGEST: f64 = 0.1;

/// Longest flight through the play that is timed, s.
const LONGEST_S: f64 = 0.15;

/// Share of the largest jump at which the teeth have met, how much earlier they touched than that shows, and how uncertain
/// that is, s; in addition to half a sample.
const MET: f64 = 0.1;
const EARLIER_S: f64 = 1.5e-3;
const UNCERTAIN_S: f64 = 1.5e-3;

impl Traces {
    /// The play from the time in which it is crossed, between the change of sign and the meeting of the teeth. None where no
    /// jump is strong enough to be timed, of `jump` times the noise in squares.
    pub(crate) fn play(&self, joint: usize, arm: &Arm, rows: &Rows, jump: f64) -> Option<Play> {
        let mut gaps = Vec::new();
        let (mut changes, mut impacts) = (0, 0);
        for trace in &self.0 {
            let motion = &rows.logs[trace.log].motion;
            for change in trace.changes(joint) {
                let Some(rank) = trace.rank(change) else { continue };
                changes += 1;
                if rank > STRONGEST {
                    continue;
                }
                impacts += 1;
                let inertia = Some(arm.inertia_along(joint, motion, change)).filter(|inertia| *inertia > 0.0);
                gaps.extend(inertia.and_then(|inertia| trace.flight(joint, change, inertia, arm.rotor(joint), jump)));
            }
        }
        gaps.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let middle = *gaps.get(gaps.len() / 2)?;
        let mut apart: Vec<f64> = gaps.iter().map(|gap| (gap[0] - middle[0]).abs()).collect();
        apart.sort_by(f64::total_cmp);
        // Standard deviation of the median, with the scatter from the median absolute deviation.
        let scatter = 1.2533 * 1.4826 * apart[apart.len() / 2] / (gaps.len() as f64).sqrt();
        Some(Play { half_gap: middle[0], std: scatter.hypot(middle[1]), changes, impacts })
    }
}

impl Trace {
    /// Half the play that link and motor cross in the time to the meeting of the teeth, and what that time leaves uncertain,
    /// rad. Meanwhile the load moves the link alone, and the motor has no more to carry: what torque it still has moves the
    /// `rotor`, as far as it is known. A `jump` over the noise, in squares, ends the flight.
    fn flight(&self, joint: usize, window: usize, inertia: f64, rotor: Option<f64>, jump: f64) -> Option<[f64; 2]> {
        let load = self.load.channel(joint);
        let start = (window + 1..load.len()).find(|&k| load[k - 1] * load[k] < 0.0)?;
        let end = (start + self.samples(LONGEST_S)).min(self.new.len());
        let highest = (start..end).max_by(|a, b| self.new[*a].total_cmp(&self.new[*b]))?;
        let peak = self.new[highest];
        if peak < jump {
            return None;
        }
        // Noise comes near a faint jump long before it: what counts is the rise to the jump itself.
        let before = (start..highest).rev().find(|&k| self.new[k] <= MET * peak);
        let met = before.map_or(0, |k| k + 1 - start);
        let uncertain = UNCERTAIN_S + 0.5 * self.period;
        // Of a flight too short to be timed only so much is known.
        let time = (met as f64 * self.period - EARLIER_S - 0.5 * self.period).max(uncertain);
        let (mut speed, mut way) = (0.0, 0.0);
        let side = load[start].signum();
        let left = self.left.channel(joint);
        let before = &left[start - self.samples(APART_S).min(start)..start];
        let usual = before.iter().sum::<f64>() / before.len().max(1) as f64;
        for k in start..(start + (time / self.period).round() as usize).min(end) {
            let of_motor = rotor.map_or(0.0, |rotor| (load[k] + left[k] - usual) / rotor);
            speed += side * (load[k] / inertia + of_motor) * self.period;
            way += speed * self.period;
        }
        // The way grows with the third power of the time.
        (way > 0.0).then(|| [0.5 * way, 0.5 * way * ((1.0 + uncertain / time).powi(3) - 1.0)])
    }
}

#[cfg(test)]
mod tests {
    use super::super::impacts::tests::hit;
    use super::*;

    #[test]
    fn the_play_is_what_the_link_falls_through() {
        // A load of 2 pi 0.31 t behind 0.5 kg m2 takes t^3 2 pi 0.31 / (6 * 0.5) to either side in t = 20 ms.
        let traces = hit(2, 1e4);
        let change = traces.0[0].changes(0)[3];
        let [gap, std] = traces.0[0].flight(0, change, 0.5, None, 10.0).unwrap();
        let time: f64 = 0.02 - EARLIER_S;
        let expected = 0.5 * time.powi(3) * std::f64::consts::TAU * 0.31 / (6.0 * 0.5);
        assert!((gap - expected).abs() < 2.0 * std && std < 0.5 * gap, "{gap} +- {std}, {expected}");
        // A motor that keeps its torque is thrown the other way: with a rotor as heavy as the link twice the play is crossed.
        let [both, _] = traces.0[0].flight(0, change, 0.5, Some(0.5), 10.0).unwrap();
        assert!((both / gap - 2.0).abs() < 1e-9, "{both} {gap}");
    }
}
