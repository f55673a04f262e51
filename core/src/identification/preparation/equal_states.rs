//! Rows of logs after and before a change at nearly equal states: the same reference motion, whenever it began.

use crate::channels::Channels;
use crate::linear::root_mean_square;

/// Largest difference of a position, as a share of how far the joint moves. What the state differs by is taken off by the
/// model of the arm, so that a tenth of its error is left at most.
const NEAR_POSITION: f64 = 0.1;

/// The same of a velocity, as a share of its root mean square: friction hardly changes over it.
const NEAR_VELOCITY: f64 = 0.2;

/// Positions nearer than this are equal, rad or m: gravity's torque changes by a hundredth of itself at most.
const SAME_POSITION: f64 = 0.01;

/// Velocities nearer than this are equal, rad/s or m/s: sensors resolve no less.
const SAME_VELOCITY: f64 = 0.02;

/// States of one log.
#[derive(Debug, Clone, Default)]
pub struct States {
    /// Smoothed positions, `[joint][row]`, rad or m.
    pub q: Channels,
    /// Their velocities.
    pub qd: Channels,
}

/// The log and the row before a change at which the state is that of a row after it; none where there is no such row.
pub(crate) type EqualState = Option<(usize, usize)>;

/// How near two states are.
struct Nearness {
    position: Vec<f64>,
    velocity: Vec<f64>,
}

impl Nearness {
    fn new(logs: &[&States], dof: usize) -> Self {
        let over = |joint: usize, signal: fn(&States, usize) -> Vec<f64>| -> Vec<f64> {
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
    fn distance(&self, (a, at): (&States, usize), (b, there): (&States, usize)) -> Option<f64> {
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
pub(crate) fn matched(before: &[&States], after: &[&States]) -> Vec<Vec<EqualState>> {
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
    let nearest = |log: &States, row: usize| {
        let q = log.q.channel(first)[row];
        let start = sorted.partition_point(|entry| entry.0 < q - near.position[first]);
        let end = sorted.partition_point(|entry| entry.0 <= q + near.position[first]);
        let candidates = sorted[start..end].iter();
        let distances = candidates
            .filter_map(|&(_, other, there)| Some((near.distance((log, row), (before[other], there))?, other, there)));
        distances.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, other, there)| (other, there))
    };
    after.iter().map(|log| (0..log.q.samples()).map(|row| nearest(log, row)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A joint that swings over 1 rad with an angular frequency of 1 rad/s, at steps of 0.01 s from a phase on.
    fn swing(from: f64, rows: usize) -> States {
        let phase = |row: usize| from + 0.01 * row as f64;
        let of = |signal: fn(f64) -> f64| Channels::from_vectors(&[(0..rows).map(|row| signal(phase(row))).collect()]);
        States { q: of(f64::sin), qd: of(f64::cos) }
    }

    #[test]
    fn equal_states_are_found_whenever_the_motion_began() {
        let (before, after) = (swing(0.0, 400), swing(1.0, 400));
        let matched = matched(&[&before], &[&after]);
        for (row, state) in matched[0].iter().enumerate().take(300) {
            assert_eq!(*state, Some((0, row + 100)));
        }
        // What the motion before does not reach: a tenth of its spread of 0.71 rad beyond its end.
        assert!(matched[0][320..].iter().all(Option::is_none));
    }

    #[test]
    fn a_state_of_the_other_direction_is_no_equal_one() {
        let back = States { qd: swing(0.0, 100).qd.map(|_, qd| qd.iter().map(|v| -v).collect()), ..swing(0.0, 100) };
        assert!(matched(&[&swing(0.0, 100)], &[&back])[0].iter().all(Option::is_none));
    }
}
