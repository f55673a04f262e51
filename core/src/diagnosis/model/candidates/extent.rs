//! How far a joint goes in logs.

use crate::diagnosis::logs::Rows;
use crate::effects::Extent;

/// Share of the highest speed from which a joint moves, and of the samples in which it moves those that hold the highest harmonic of a
/// ripple: the slowest quarter, which every start and stop passes.
const MOVES: f64 = 0.05;
const SLOWEST: f64 = 0.25;

/// The extent of a joint, from its positions and speeds in all rows and its torque in the valid ones.
pub(crate) fn extent(rows: &Rows, joint: usize) -> Extent {
    let speeds = rows.logs.iter().flat_map(|log| log.motion.qd.channel(joint));
    let positions = rows.logs.iter().flat_map(|log| log.motion.q.channel(joint));
    let (low, high) = positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &q| (l.min(q), h.max(q)));
    let torque = rows.torque[joint].iter().zip(&rows.valid[joint]);
    let ends: Vec<[f64; 2]> =
        rows.logs.iter().filter_map(|log| Some([*log.time.first()?, *log.time.last()?])).collect();
    let runs_on = runs_on(&ends);
    let begin = ends.iter().map(|ends| ends[0]).fold(f64::INFINITY, f64::min);
    let end = ends.iter().map(|ends| ends[1]).fold(0.0, f64::max);
    let longest = ends.iter().map(|[begin, end]| end - begin).fold(0.0, f64::max);
    Extent {
        speed: speeds.fold(0.0, |most, v| most.max(v.abs())),
        positions: [low, high],
        torque: torque.fold(0.0f64, |most, (v, ok)| if *ok { most.max(v.abs()) } else { most }),
        time: [begin, end],
        duration: if runs_on { end - begin } else { longest },
        runs_on,
    }
}

/// Whether the clocks of logs, each with its first and last instant, run on from one to the next: no two share an instant, and less time
/// passes between them than in them, so that what the logs warmed up stays so.
fn runs_on(ends: &[[f64; 2]]) -> bool {
    let mut ends = ends.to_vec();
    ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let gaps: Vec<f64> = ends.windows(2).map(|pair| pair[1][0] - pair[0][1]).collect();
    let logged: f64 = ends.iter().map(|[begin, end]| end - begin).sum();
    !gaps.is_empty() && gaps.iter().all(|gap| *gap > 0.0) && gaps.iter().sum::<f64>() < logged
}

/// Highest number of periods per turn of a joint that the rows hold where it moves slowly: half a period from row to row. Zero of one that
/// stands still.
pub(super) fn highest_harmonic(rows: &Rows, joint: usize) -> f64 {
    let speeds = rows.logs.iter().flat_map(|log| log.motion.qd.channel(joint));
    let mut speeds: Vec<f64> = speeds.map(|v| v.abs()).collect();
    let top = speeds.iter().copied().fold(0.0, f64::max);
    speeds.retain(|v| *v > MOVES * top);
    let slowest = (SLOWEST * speeds.len() as f64) as usize;
    let slow = if speeds.is_empty() { 0.0 } else { *speeds.select_nth_unstable_by(slowest, f64::total_cmp).1 };
    // A row is the mean of a block of samples.
    let row_s = rows.logs.iter().map(|log| log.block as f64 * log.period).fold(0.0, f64::max);
    if slow > 0.0 && row_s > 0.0 { std::f64::consts::PI / (row_s * slow) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clocks_run_on_where_logs_follow_each_other() {
        assert!(runs_on(&[[40.0, 70.0], [0.0, 30.0]]) && runs_on(&[[0.0, 30.0], [89.0, 119.0]]));
        // Each starts anew, there is one only, or the arm stood for longer than it moved.
        assert!(!runs_on(&[[0.0, 30.0], [0.0, 30.0]]) && !runs_on(&[[0.0, 30.0]]));
        assert!(!runs_on(&[[0.0, 30.0], [91.0, 121.0]]));
    }
}
