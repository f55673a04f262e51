//! How far a joint goes in logs.

use crate::diagnosis::logs::Rows;
use crate::effects::Extent;

/// Distance that a joint moves at least, rad or m: one that stands still has no ripple to look for.
const LEAST_RANGE: f64 = 1e-6;

/// The extent of a joint, from its positions and speeds in all rows and its torque in the valid ones.
pub(crate) fn extent(rows: &Rows, joint: usize) -> Extent {
    let speeds = rows.logs.iter().flat_map(|log| log.motion.qd.channel(joint));
    let positions = rows.logs.iter().flat_map(|log| log.motion.q.channel(joint));
    let (low, high) = positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &q| (l.min(q), h.max(q)));
    let torque = rows.torque[joint].iter().zip(&rows.valid[joint]);
    let begin = rows.logs.iter().filter_map(|log| log.time.first().copied()).fold(f64::INFINITY, f64::min);
    let end = rows.logs.iter().filter_map(|log| log.time.last().copied()).fold(0.0, f64::max);
    Extent {
        speed: speeds.fold(0.0, |most, v| most.max(v.abs())),
        range: (high - low).max(LEAST_RANGE),
        torque: torque.fold(0.0f64, |most, (v, ok)| if *ok { most.max(v.abs()) } else { most }),
        time: [begin, end],
    }
}
