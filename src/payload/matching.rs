//! Rows of logs after and before at nearly equal states: the same reference motion, whenever it began.

use super::rows::LogRows;
use crate::linear::root_mean_square;

/// Largest difference of a position, as a share of how far the joint moves. What the state differs by is taken off by the
/// model of the arm, so that a tenth of its error is left at most.
const NEAR_POSITION: f64 = 0.1;

/// The same of a velocity, as a share of its root mean square: friction hardly changes over it.
const NEAR_VELOCITY: f64 = 0.2;

/// Positions nearer than this are equal, rad or m: gravity's torque changes by a hundredth of itself at most.
const SAME_POSITION: f64 = 0.01;

/// Velocities nearer than this are equal, rad/s or m/s: sensors tell no less apart.
const SAME_VELOCITY: f64 = 0.02;

/// How near two states are.
struct Nearness {
    position: Vec<f64>,
    velocity: Vec<f64>,
}

impl Nearness {
    fn new(logs: &[LogRows], dof: usize) -> Self {
        let over = |joint: usize, signal: fn(&LogRows, usize) -> Vec<f64>| -> Vec<f64> {
            logs.iter().flat_map(|log| signal(log, joint)).collect()
        };
        let position = |joint| {
            let q = over(joint, |log, joint| log.q.channel(joint).to_vec());
            let mean = q.iter().sum::<f64>() / q.len().max(1) as f64;
            let moved: Vec<f64> = q.iter().map(|x| x - mean).collect();
            (NEAR_POSITION * root_mean_square(&moved)).max(SAME_POSITION)
        };
        let velocity = |joint| {
            let qd = over(joint, |log, joint| log.qd.channel(joint).to_vec());
            (NEAR_VELOCITY * root_mean_square(&qd)).max(SAME_VELOCITY)
        };
        Nearness { position: (0..dof).map(position).collect(), velocity: (0..dof).map(velocity).collect() }
    }

    /// Squared distance of two states in units of what counts as near; none where a joint is farther than that.
    fn distance(&self, (a, at): (&LogRows, usize), (b, there): (&LogRows, usize)) -> Option<f64> {
        let mut sum = 0.0;
        for (joint, (position, velocity)) in self.position.iter().zip(&self.velocity).enumerate() {
            let dq = (a.q.channel(joint)[at] - b.q.channel(joint)[there]) / position;
            let dv = (a.qd.channel(joint)[at] - b.qd.channel(joint)[there]) / velocity;
            if dq.abs() > 1.0 || dv.abs() > 1.0 {
                return None;
            }
            sum += dq * dq + dv * dv;
        }
        Some(sum)
    }
}

/// For every row of every log `after`, the log and row of `before` with the nearest state; none where no state is near.
pub(super) fn matched(before: &[LogRows], after: &[LogRows]) -> Vec<Vec<Option<(usize, usize)>>> {
    let dof = before.first().map_or(0, |log| log.q.channels());
    let near = Nearness::new(before, dof);
    // Sorted by the joint of which the fewest rows are near any other, so that few states are compared.
    let share = |joint: &usize| {
        let all: Vec<f64> = before.iter().flat_map(|log| log.q.channel(*joint).iter().copied()).collect();
        let [low, high] = all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], &x| [l.min(x), h.max(x)]);
        near.position[*joint] / (high - low).max(f64::MIN_POSITIVE)
    };
    let Some(first) = (0..dof).min_by(|a, b| share(a).total_cmp(&share(b))) else { return Vec::new() };
    let mut sorted: Vec<(f64, usize, usize)> = before
        .iter()
        .enumerate()
        .flat_map(|(log, rows)| rows.q.channel(first).iter().enumerate().map(move |(row, &q)| (q, log, row)))
        .collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let nearest = |log: &LogRows, row: usize| {
        let q = log.q.channel(first)[row];
        let start = sorted.partition_point(|entry| entry.0 < q - near.position[first]);
        let end = sorted.partition_point(|entry| entry.0 <= q + near.position[first]);
        let candidates = sorted[start..end].iter();
        let distances = candidates
            .filter_map(|&(_, other, there)| Some((near.distance((log, row), (&before[other], there))?, other, there)));
        distances.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, other, there)| (other, there))
    };
    after.iter().map(|log| (0..log.rows()).map(|row| nearest(log, row)).collect()).collect()
}
