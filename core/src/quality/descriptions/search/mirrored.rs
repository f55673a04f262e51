//! Mirror images of a set of reversed axes.
//!
//! An arm that is nearly symmetric to a plane moves nearly as its mirror image in that plane, in which those joints turn the other way whose
//! axes lie in the plane. So a set of reversed axes looks nearly like its image, with other zeros. A search that grows sets by one change at a
//! time comes to one of them, and another may be the smaller set, or the one that the described bodies explain.

use super::found::Found;
use super::needed::{reduced, without_each};
use crate::quality::descriptions::change::{Change, Description};
use crate::quality::descriptions::compare::compare;
use crate::quality::descriptions::fitting::{Physics, Rows};
use crate::quality::descriptions::known::Known;
use crate::quality::descriptions::shares::ALIKE;
use crate::quality::descriptions::sizes::zeros;
use crate::quality::descriptions::tried::Tried;
use crate::robot::{JointKind, Robot};
use nalgebra::Vector3;

/// Zeros that an image may need beyond those of the set that was found.
const MORE_ZEROS: usize = 1;

/// Axes are parallel or at right angles to within this cosine (3 degrees): a plane of a skewed arm mirrors nothing.
const SKEW: f64 = 0.05;

/// What was found or one of its mirror images: that which the described bodies explain clearly better, else the smaller set, else that which
/// leaves less. Where nothing separates two of one size, each is a rival of the other. The rows are those in blocks, and whole.
pub(super) fn or_mirrored(known: &Known, rows: [&Rows; 2], start: &Tried, found: Found) -> Found {
    let images = images(known.physics, rows, start, &found);
    images.into_iter().fold(found, |found, image| better_of(known, rows[0], start, found, image))
}

fn better_of(known: &Known, rows: &Rows, start: &Tried, mut found: Found, image: Tried) -> Found {
    let Some(gain) = compare(&start.evaluation, &image.evaluation, &rows.log) else { return found };
    let is_clear = |worse: &Tried, better: &Tried| {
        compare(&worse.evaluation, &better.evaluation, &rows.log).is_some_and(|gain| gain.is_distinct())
    };
    if is_clear(&image, &found.best) || !known.supports(start, &image, &gain, rows) {
        return found;
    }
    // Free bodies are nearly symmetric wherever the arm is; those described are not.
    let described = known.other.filter(|_| matches!(known.physics, Physics::Free(_)));
    let under = |tried: &Tried| Tried::new(described?, rows, tried.description.clone());
    let [better, worse] = match [under(&found.best), under(&image)] {
        [Some(own), Some(image)] => {
            let clearly = |other: &Tried, better: &Tried| better.share() < ALIKE && is_clear(other, better);
            [clearly(&own, &image), clearly(&image, &own)]
        }
        _ => [false, false],
    };
    let size = image.description.changes.len().cmp(&found.best.description.changes.len());
    let smaller = size.is_lt() || (size.is_eq() && is_clear(&found.best, &image));
    if better || (smaller && !worse) {
        let next = Some(std::mem::replace(&mut found.best, image));
        return Found { rivals: Vec::new(), next, gain, ..found };
    }
    let mut all = std::iter::once(&found.best).chain(&found.rivals);
    let is_known = all.any(|own| own.description.same_but_for_sizes(&image.description));
    found.rivals.extend((size.is_eq() && !worse && !is_known).then_some(image));
    found
}

/// The mirror images of the best of what was found, each with zeros of its own and without what it does not need; none where no axis is
/// reversed.
fn images(physics: &Physics, rows: [&Rows; 2], start: &Tried, found: &Found) -> Vec<Tried> {
    let best = &found.best.description;
    let is_zero = |change: &&Change| matches!(change, Change::ZeroOffset(..));
    let zeros = best.changes.iter().filter(is_zero).count() + MORE_ZEROS;
    let planes = physics.robot().map(mirrors).unwrap_or_default();
    let images = planes.iter().filter_map(|turned| image(&start.description, best, turned));
    // Half a turn of a joint reverses those behind it that lie across: a sign of the image may stand for a zero that the set has not.
    let images = images.flat_map(|image| {
        let shorter = without_each(&start.description, &image);
        std::iter::once(image).chain(shorter)
    });
    let with_zeros = |image: Description| {
        let mut own = Tried::new(physics, rows[0], image)?;
        for _ in 0..zeros {
            let others = zeros::of_single_joints(physics, rows[1], &own.description);
            let tried = others.into_iter().filter_map(|other| Tried::new(physics, rows[0], other));
            let gain = |other: &Tried| compare(&own.evaluation, &other.evaluation, &rows[0].log);
            let noticeable = tried.filter_map(|other| {
                let gain = gain(&other).filter(|gain| gain.is_noticeable())?;
                Some((gain.gain, other))
            });
            let Some((_, next)) = noticeable.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            own = next;
        }
        Some(reduced(physics, rows, start, &own).unwrap_or(own))
    };
    images.filter_map(with_zeros).collect()
}

/// The planes that mirror all axes of an arm at its zero, each as the joints that turn (or slide) the other way in it.
fn mirrors(robot: &Robot) -> Vec<Vec<bool>> {
    let frames = robot.frames(&vec![0.0; robot.dof()]);
    let axis = |joint: usize| frames[joint].rotation * robot.joints[joint].axis;
    let axes: Vec<Vector3<f64>> = (0..robot.dof()).map(axis).collect();
    let across =
        axes.iter().flat_map(|a| axes.iter().map(|b| a.cross(b))).filter_map(|normal| normal.try_normalize(0.5));
    let mut out: Vec<Vec<bool>> = Vec::new();
    for normal in axes.iter().copied().chain(across) {
        let along: Vec<f64> = axes.iter().map(|axis| axis.dot(&normal).abs()).collect();
        if along.iter().any(|along| (SKEW..1.0 - SKEW).contains(along)) {
            continue;
        }
        // A turn is seen from the other side in a plane that holds its axis, a slide goes the other way across the plane.
        let turned = |joint: usize| (along[joint] > SKEW) == (robot.joints[joint].kind == JointKind::Prismatic);
        let turned: Vec<bool> = (0..robot.dof()).map(turned).collect();
        if turned.contains(&true) && !out.contains(&turned) {
            out.push(turned);
        }
    }
    out
}

/// A description whose `turned` joints go the other way than in another one, torque included; none of one that changes more than signs and
/// zeros, or no axis.
fn image(start: &Description, other: &Description, turned: &[bool]) -> Option<Description> {
    let is_plain = start.position_of == other.position_of
        && start.torque_of == other.torque_of
        && start.torque_scale == other.torque_scale
        && start.gravity == other.gravity;
    if !is_plain || start.position_sign == other.position_sign {
        return None;
    }
    let change = |joint: usize| {
        let position = (start.position_sign[joint] != other.position_sign[joint]) != turned[joint];
        let torque = (start.torque_sign[joint] != other.torque_sign[joint]) != turned[joint];
        match (position, torque) {
            (true, true) => Some(Change::AxisSign(joint)),
            (true, false) => Some(Change::PositionSign(joint)),
            (false, true) => Some(Change::TorqueSign(joint)),
            (false, false) => None,
        }
    };
    Some((0..start.dof()).filter_map(change).fold(start.clone(), |description, change| description.with(change)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{self, InertiaCheck};

    #[test]
    fn turned_joints_go_the_other_way() {
        let start = Description::as_given(4, Vector3::z());
        let of = |changes: &[Change]| changes.iter().fold(start.clone(), |own, change| own.with(*change));
        let own =
            of(&[Change::AxisSign(0), Change::TorqueSign(1), Change::PositionSign(2), Change::ZeroOffset(3, 1.0)]);
        let image_of = |turned: [bool; 4]| image(&start, &own, &turned).unwrap().changes;
        assert_eq!(image_of([true; 4]), [Change::PositionSign(1), Change::TorqueSign(2), Change::AxisSign(3)]);
        let kept = [Change::TorqueSign(1), Change::PositionSign(2), Change::AxisSign(3)];
        assert_eq!(image_of([true, false, false, true]), kept);
        for other in [Change::TorqueSign(0), Change::ZeroOffset(1, 1.0), Change::JointExchange(0, 1)] {
            assert_eq!(image(&start, &of(&[other]), &[true; 4]), None);
        }
    }

    #[test]
    fn planes_of_an_arm() {
        let arm = |file: &str| {
            let file = format!("{}/../{file}", env!("CARGO_MANIFEST_DIR"));
            mirrors(&robot::load(file, InertiaCheck::Ignored).unwrap())
        };
        let turned = |set: &[bool]| (1..=set.len()).filter(|joint| set[joint - 1]).collect::<Vec<usize>>();
        // Axes z, y, y, x, y, x: the vertical plane of the arm, that across it, and the floor.
        let mut sets: Vec<Vec<usize>> = arm("urdf/irb1600_6_120.urdf").iter().map(|set| turned(set)).collect();
        sets.sort();
        assert_eq!(sets, [vec![1, 2, 3, 5], vec![1, 4, 6], vec![2, 3, 4, 5, 6]]);
        assert_eq!(arm("tests/reference/skew7.urdf"), Vec::<Vec<bool>>::new());
    }
}
