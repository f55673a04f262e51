//! Which joints stand still in logs, and where.

use crate::recording::Recording;
use crate::robot::{JointKind, Robot};
use crate::signal::white_noise;

/// A joint that swings by less stands still, rad: a tenth of a degree excites nothing, while the sag of a held joint under the
/// motion of the others is of this size.
const STILL_RAD: f64 = 2e-3;

/// The same for a sliding joint, as a share of the arm's length.
const STILL_SHARE: f64 = 1e-3;

/// Noise up to so many times its standard deviation is no swing; never more than [`NOISE_LIMIT`] times the swing above.
const NOISE: f64 = 10.0;
const NOISE_LIMIT: f64 = 10.0;

/// A joint whose logged speed would cross its still range this many times a second moves, whatever its position shows.
const CROSSINGS_HZ: f64 = 10.0;

/// Share of samples at either end of a signal that may be outliers.
const OUTLIERS: f64 = 0.005;

/// Swing up to which a joint stands still, rad or m.
pub(super) fn range(robot: &Robot, kind: JointKind) -> f64 {
    match kind {
        JointKind::Revolute => STILL_RAD,
        JointKind::Prismatic => {
            let links = (0..robot.bodies()).map(|body| robot.body(body).origin.translation.norm());
            STILL_SHARE * (links.sum::<f64>() + robot.flange.translation.norm()).max(0.1)
        }
    }
}

/// Where a joint stands in each log, rad or m, if it stands still in every one of them.
pub(super) fn places<'a>(logs: impl Iterator<Item = &'a Recording>, joint: usize, tolerance: f64) -> Option<Vec<f64>> {
    let mut places = Vec::new();
    let mut allowed = tolerance;
    for log in logs {
        let q = log.q.channel(joint);
        if let Some(qd) = log.qd.as_ref().filter(|_| log.has_velocity(joint)) {
            let mut speeds: Vec<f64> = qd.channel(joint).iter().map(|speed| speed.abs()).collect();
            speeds.sort_by(f64::total_cmp);
            let usual = speeds.get(speeds.len() * 95 / 100).copied().unwrap_or(0.0);
            if usual > CROSSINGS_HZ * tolerance {
                return None;
            }
        }
        let mut sorted = q.to_vec();
        sorted.sort_by(f64::total_cmp);
        let outliers = (OUTLIERS * sorted.len() as f64) as usize;
        let (low, high) = (*sorted.get(outliers)?, *sorted.get(sorted.len().checked_sub(outliers + 1)?)?);
        allowed = allowed.max((NOISE * white_noise(q)).min(NOISE_LIMIT * tolerance));
        // Written so that positions that are no numbers do not stand still.
        let stands_here = high - low <= allowed;
        if !stands_here {
            return None;
        }
        places.push(sorted[sorted.len() / 2]);
    }
    (!places.is_empty()).then_some(places)
}

/// The lowest and the highest of some places, with their index.
pub(super) fn ends(places: &[f64]) -> Option<[(usize, f64); 2]> {
    let each = || places.iter().copied().enumerate();
    let order = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1);
    Some([each().min_by(order)?, each().max_by(order)?])
}
