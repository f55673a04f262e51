//! Which joints stand still in logs, and where.

use crate::recording::Recording;
use crate::robot::{JointKind, Robot, shortened};
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

/// What is said of joints that stand still in every log and not at one place, each with where it stands. None where there are no such
/// joints.
pub(super) fn keep_coordinates(joints: &[(String, String)]) -> Option<String> {
    Some(match joints {
        [] => return None,
        [(name, places)] => format!(
            "joint `{name}` stands still in every log, {places}: it keeps its coordinate, so that it stands right in each"
        ),
        [(first, places), ..] => format!(
            "joints {} stand still in every log and not at one place, as {first} {places}: each keeps its coordinate, so that it stands right \
             in each log",
            names(joints)
        ),
    })
}

/// What is said of joints not under study that stand at other places from log to log, each with where it stands.
pub(super) fn held_between(joints: &[(String, String)], cure: &str) -> Option<String> {
    Some(match joints {
        [] => return None,
        [(name, places)] => format!(
            "joint `{name}` is not under study and stands {places}: it is held between, which is wrong in each; {cure}"
        ),
        [(first, places), ..] => format!(
            "joints {} are not under study and stand at other places from log to log, as {first} {places}: they are held between, which is wrong \
             in each; {cure}",
            names(joints)
        ),
    })
}

fn names(joints: &[(String, String)]) -> String {
    shortened(&joints.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_that_stand_apart_are_one_note_with_those_that_move() {
        let of = |joints: &[&str]| -> Vec<(String, String)> {
            joints.iter().map(|name| (name.to_string(), "at 0 rad in a and at 1 rad in b".to_owned())).collect()
        };
        assert_eq!(keep_coordinates(&[]), None);
        let one = keep_coordinates(&of(&["j2"])).unwrap();
        assert!(one.starts_with("joint `j2` stands still in every log, at 0 rad"), "{one}");
        // To hold such a joint at one position would be wrong in some log: nothing advises it.
        assert!(one.ends_with("stands right in each"), "{one}");
        let many = keep_coordinates(&of(&["j1", "j2", "j3", "j4", "j5"])).unwrap();
        assert!(
            many.starts_with("joints j1, j2, j3 and 2 more stand still") && many.ends_with("right in each log"),
            "{many}"
        );
        let held = held_between(&of(&["j1", "j2", "j3", "j4", "j5"]), "do this").unwrap();
        assert!(held.contains("j3 and 2 more are not under study") && held.ends_with("do this"), "{held}");
    }
}
