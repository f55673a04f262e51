//! Kinds of generic functions that a residual may follow.

use crate::diagnosis::evidence::DELAYS_S;
use crate::diagnosis::logs::{Log, Rows};
use crate::signal::{first_order_lag, hat};
use serde::Serialize;
use std::f64::consts::PI;

/// Hats over the range of positions, over that of speeds in each direction, and over that of loads.
const PLACES: usize = 12;
const SPEEDS: usize = 7;
const LOADS: usize = 7;

/// Share of a joint's range, or of its fastest speed, that hats of reversals and of direction refer to.
const REVERSAL_REACH: [f64; 5] = [0.003, 0.01, 0.03, 0.1, 0.3];

/// Speed over a joint's fastest at which its direction counts as reversed: below, noise decides the sign.
const REVERSED: f64 = 0.01;

/// Cosines over each log: half a period of the first is the log.
const SLOW: usize = 6;

/// A kind of generic functions.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Kind;
///
/// // What a residual may follow, as the heading of a table and as the end of a sentence.
/// assert_eq!(Kind::ALL.len(), 12);
/// let friction = Kind::PositionByDirection;
/// assert_eq!(friction.title(), "position x direction");
/// assert_eq!(friction.meaning(), "is friction that depends on the joint's position");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A constant torque. The other kinds are kept orthogonal to it.
    Offset,
    /// Hats over the joint's position.
    Position,
    /// The same with the sign of the velocity: friction that depends on position.
    PositionByDirection,
    /// Hats over the speed, for each direction.
    Speed,
    /// Hats over the joint's torque, nonlinear in it.
    Load,
    /// Hats over the size of the joint's torque with the sign of the velocity: friction that depends on load.
    LoadByDirection,
    /// Exponentials of the distance travelled since the last reversal, with the sign of the velocity.
    Reversal,
    /// The rate of change of the joint's torque, and its speed behind first-order lags.
    Lag,
    /// Positions, velocities, accelerations and torques of other joints.
    OtherJoints,
    /// Slow cosines over each log.
    SlowTime,
    /// The same times the sign of the velocity: friction that changes over time.
    FrictionOverTime,
    /// The same times the joint's torque: a scale that changes over time.
    LoadOverTime,
}

impl Kind {
    /// All kinds, in the order of the map.
    pub const ALL: [Kind; 12] = [
        Kind::Offset,
        Kind::Position,
        Kind::PositionByDirection,
        Kind::Speed,
        Kind::Load,
        Kind::LoadByDirection,
        Kind::Reversal,
        Kind::Lag,
        Kind::OtherJoints,
        Kind::SlowTime,
        Kind::FrictionOverTime,
        Kind::LoadOverTime,
    ];

    /// Whether it is of the joint's own state, so that it is the same each time the joint comes by. What goes with time, a lag or other joints
    /// differs from block to block of a log.
    pub(super) fn repeats(self) -> bool {
        match self {
            Kind::Offset
            | Kind::Position
            | Kind::PositionByDirection
            | Kind::Speed
            | Kind::Load
            | Kind::LoadByDirection
            | Kind::Reversal => true,
            Kind::Lag | Kind::OtherJoints | Kind::SlowTime | Kind::FrictionOverTime | Kind::LoadOverTime => false,
        }
    }

    /// What the residual follows, as the heading of a table.
    pub fn title(self) -> &'static str {
        match self {
            Kind::Offset => "offset",
            Kind::Position => "position",
            Kind::PositionByDirection => "position x direction",
            Kind::Speed => "speed",
            Kind::Load => "load",
            Kind::LoadByDirection => "load x direction",
            Kind::Reversal => "since reversal",
            Kind::Lag => "lag",
            Kind::OtherJoints => "other joints",
            Kind::SlowTime => "slow time",
            Kind::FrictionOverTime => "friction over time",
            Kind::LoadOverTime => "load over time",
        }
    }

    /// What it means, as the end of a sentence that begins with the residual.
    pub fn meaning(self) -> &'static str {
        match self {
            Kind::Offset => "is a constant torque",
            Kind::Position => "follows the joint's position",
            Kind::PositionByDirection => "is friction that depends on the joint's position",
            Kind::Speed => "follows the joint's speed",
            Kind::Load => "follows the joint's torque other than in proportion",
            Kind::LoadByDirection => "is friction that depends on the joint's torque",
            Kind::Reversal => "follows the distance since the joint's last reversal",
            Kind::Lag => "follows the joint's motion with a lag",
            Kind::OtherJoints => "follows the motion or the torques of other joints",
            Kind::SlowTime => "changes slowly over time",
            Kind::FrictionOverTime => "is friction that changes over time",
            Kind::LoadOverTime => "is in proportion to the torque, more or less so over time",
        }
    }
}

/// Signals over the rows from which the functions of one joint are made.
pub(super) struct Signals<'a> {
    /// The rows.
    pub rows: &'a Rows,
    /// Torque of the arm as identified, `[joint][row]`, N m.
    pub torque: &'a [Vec<f64>],
    /// The joint.
    pub joint: usize,
}

impl Signals<'_> {
    /// The functions of a kind over the rows.
    pub(super) fn functions(&self, kind: Kind) -> Vec<Vec<f64>> {
        let joint = self.joint;
        match kind {
            Kind::Offset => vec![vec![1.0; self.rows.len()]],
            Kind::Position => self.hats(&self.position(), PLACES),
            Kind::PositionByDirection => times(&self.hats(&self.position(), PLACES), &self.direction()),
            Kind::Speed => self.speeds(),
            Kind::Load => self.hats(&self.torque[joint], LOADS),
            Kind::LoadByDirection => {
                let size: Vec<f64> = self.torque[joint].iter().map(|x| x.abs()).collect();
                times(&self.hats(&size, LOADS), &self.direction())
            }
            Kind::Reversal => self.reversals(),
            Kind::Lag => self.lags(),
            Kind::OtherJoints => self.others(),
            Kind::SlowTime => self.slow(),
            Kind::FrictionOverTime => times(&self.slow(), &self.direction()),
            Kind::LoadOverTime => times(&self.slow(), &self.torque[joint]),
        }
    }

    fn of(&self, joint: usize, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        self.rows.signal(|log| {
            let (q, v) = (log.motion.q.channel(joint), log.motion.qd.channel(joint));
            q.iter().zip(v).map(|(&q, &v)| f(q, v)).collect()
        })
    }

    fn position(&self) -> Vec<f64> {
        self.of(self.joint, |q, _| q)
    }

    fn direction(&self) -> Vec<f64> {
        self.of(self.joint, |_, v| v.signum())
    }

    /// Hats over the quantiles of `signal` on the rows that are valid: each has rows to be judged by.
    fn hats(&self, signal: &[f64], count: usize) -> Vec<Vec<f64>> {
        let valid = &self.rows.valid[self.joint];
        let mut sorted: Vec<f64> = signal.iter().zip(valid).filter(|(_, ok)| **ok).map(|(x, _)| *x).collect();
        sorted.sort_by(f64::total_cmp);
        let Some(&highest) = sorted.last() else { return Vec::new() };
        let lowest = sorted[0];
        // Half way between even spacing and even counts: neither empty hats nor ones without resolution.
        let knot = |k: usize| {
            let share = k as f64 / (count - 1) as f64;
            let even = lowest + share * (highest - lowest);
            0.5 * (even + sorted[(share * (sorted.len() - 1) as f64) as usize])
        };
        let mut knots: Vec<f64> = (0..count).map(knot).collect();
        knots.dedup_by(|b, a| *b - *a <= 1e-9 * (highest - lowest));
        (0..knots.len()).map(|k| signal.iter().map(|&x| hat(&knots, k, x)).collect()).collect()
    }

    /// Hats over the square root of the speed, for each direction: friction bends most at low speed.
    fn speeds(&self) -> Vec<Vec<f64>> {
        let root = self.of(self.joint, |_, v| v.abs().sqrt());
        let (direction, hats) = (self.direction(), self.hats(&root, SPEEDS));
        let side = |sign: f64| direction.iter().map(|d| if *d == sign { sign } else { 0.0 }).collect::<Vec<f64>>();
        [side(1.0), side(-1.0)].iter().flat_map(|side| times(&hats, side)).collect()
    }

    fn reversals(&self) -> Vec<Vec<f64>> {
        let q = self.position();
        let (lowest, highest) = q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
        let since = |log: &Log| since_reversal(log.motion.q.channel(self.joint), log.motion.qd.channel(self.joint));
        REVERSAL_REACH
            .iter()
            .map(|share| {
                let reach = share * (highest - lowest);
                self.rows.signal(|log| since(log).iter().map(|d| d.signum() * (-d.abs() / reach).exp()).collect())
            })
            .collect()
    }

    fn lags(&self) -> Vec<Vec<f64>> {
        let joint = self.joint;
        let mut all = vec![rate_of_change(&self.torque[joint], &self.rows.starts)];
        for delay in DELAYS_S {
            for sign in [1.0, -1.0] {
                all.push(self.rows.signal(|log| {
                    let speed = log.motion.qd.channel(joint).iter().map(|&v| if v * sign > 0.0 { v } else { 0.0 });
                    first_order_lag(speed, log.period / delay)
                }));
            }
        }
        all
    }

    fn others(&self) -> Vec<Vec<f64>> {
        let others = (0..self.rows.dof()).filter(|&other| other != self.joint);
        let own = self.direction();
        others
            .flat_map(|other| {
                let dragged = self.of(other, |_, v| v.abs()).iter().zip(&own).map(|(v, d)| v * d).collect();
                [
                    self.of(other, |q, _| q.cos()),
                    self.of(other, |q, _| q.sin()),
                    self.of(other, |_, v| v),
                    self.of(other, |_, v| v.signum()),
                    self.rows.signal(|log| log.motion.qdd.channel(other).to_vec()),
                    self.torque[other].clone(),
                    dragged,
                ]
            })
            .collect()
    }

    /// Cosines over each log, and a constant for each log but the first.
    fn slow(&self) -> Vec<Vec<f64>> {
        let mut all = Vec::new();
        for log in 0..self.rows.logs.len() {
            let (start, end) = (self.rows.starts[log], self.rows.starts[log + 1]);
            let first = usize::from(log == 0);
            for order in first..=SLOW {
                let mut signal = vec![0.0; self.rows.len()];
                for (place, x) in signal[start..end].iter_mut().enumerate() {
                    *x = (PI * order as f64 * (place as f64 + 0.5) / (end - start) as f64).cos();
                }
                all.push(signal);
            }
        }
        all
    }
}

fn times(signals: &[Vec<f64>], factor: &[f64]) -> Vec<Vec<f64>> {
    signals.iter().map(|signal| signal.iter().zip(factor).map(|(x, f)| x * f).collect()).collect()
}

/// Distance travelled since the last reversal, with the sign of the direction.
fn since_reversal(q: &[f64], qd: &[f64]) -> Vec<f64> {
    let band = REVERSED * qd.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    let mut direction = qd.iter().find(|v| v.abs() > band).map_or(1.0, |v| v.signum());
    // Nothing is known of the motion before the log: it counts as far.
    let mut turned = f64::NEG_INFINITY;
    let mut farthest = f64::NEG_INFINITY;
    q.iter()
        .zip(qd)
        .map(|(&q, &v)| {
            farthest = farthest.max(direction * q);
            if v * direction < -band {
                direction = -direction;
                turned = -farthest;
                farthest = direction * q;
            }
            direction * (direction * q - turned).clamp(0.0, f64::MAX)
        })
        .collect()
}

/// Central differences of a signal over the rows within each log, per row.
fn rate_of_change(signal: &[f64], starts: &[usize]) -> Vec<f64> {
    let mut rate = vec![0.0; signal.len()];
    for log in starts.windows(2) {
        for row in log[0] + 1..log[1].max(1) - 1 {
            rate[row] = 0.5 * (signal[row + 1] - signal[row - 1]);
        }
    }
    rate
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_grows_from_the_place_of_the_reversal() {
        let q: Vec<f64> = [0.0, 1.0, 2.0, 3.0, 2.5, 1.0, 0.0, 0.5, 2.0].into();
        let qd: Vec<f64> = [1.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0, 1.0].into();
        let since = since_reversal(&q, &qd);
        assert!(since[..4].iter().all(|d| *d > 1e300));
        assert_eq!(since[4..], [-0.5, -2.0, -3.0, 0.5, 2.0]);
    }
}
