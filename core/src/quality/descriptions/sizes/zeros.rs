//! Zeros of joints: an encoder reads zero where the description of the arm does not, as after another convention of angles or a motor
//! that was changed without calibration.
//!
//! A wrong zero turns all that a joint carries against all that it stands on: the pull of gravity and the coupling of the joints
//! come out otherwise. Free bodies take up the zero of the last joint, and that of a joint around which gravity is symmetric and which
//! stands on nothing that moves. Those described are not asked about the last joint either: a load that they lack turns with it.

use super::super::change::Description;
use super::super::fitting::{Physics, Rows};
use super::golden::golden;
use super::scale::merit as merit_of;
use crate::dynamics::Chain;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Offsets that are tried first, so many degrees apart. Torques hold the second harmonic of an offset, whose valleys are wider.
const STEP_DEG: f64 = 30.0;

/// Rows of the scan: a few for each parameter of an arm. What it finds is judged on all.
const SCANNED: usize = 400;

/// Golden sections of an interval between two of them: to within a degree.
const SECTIONS: usize = 8;

/// Smaller offsets are not reported, degrees: a calibration is off by those, which the diagnosis estimates with its standard error.
const REPORTED_DEG: f64 = 15.0;

/// Offsets within this of a multiple of the second are that one, degrees: conventions differ by such.
const NEAR_DEG: f64 = 2.5;
const CONVENTION_DEG: f64 = 45.0;

/// An offset fits all rows better than none by so much, in the logarithm of the mean squares.
const GAINS: f64 = 0.5;

/// Offsets of different joints that are handed on, the best first.
const KEPT: usize = 4;

/// Rounds over several offsets, each of which changes the best of the others by at most the second, degrees.
const ROUNDS: usize = 2;
const CHANGES_DEG: f64 = 20.0;

/// After each round, the way that it went is gone on by so many times its length at most.
const FURTHER: f64 = 5.0;

/// What an offset takes from that of another joint: all of it, in this sense; or nothing.
type Taken = Option<(usize, f64)>;

/// The description with an offset of one more zero, for joints that have none yet and to which all rows give one beyond what is reported.
pub(crate) fn of_single_joints(physics: &Physics, rows: &Rows, from: &Description) -> Vec<Description> {
    // Axes that are parallel take from each other what one of them has.
    let earlier = (0..from.dof()).filter(|&joint| from.position_offset[joint] != 0.0);
    let taken: Vec<Taken> =
        std::iter::once(None).chain(earlier.flat_map(|joint| [-1.0, 1.0].map(|sign| Some((joint, sign))))).collect();
    with_more(physics, rows, from, |_| taken.clone())
}

/// The description with offsets of two neighbours that make up for each other: the joints beyond parallel axes stay where they are, which
/// no single offset explains.
pub(crate) fn of_neighbours(physics: &Physics, rows: &Rows, from: &Description) -> Vec<Description> {
    let next = |joint: usize| (joint + 1 < from.dof() && rows.turns[joint + 1]).then_some(joint + 1);
    with_more(physics, rows, from, |joint| {
        next(joint).into_iter().flat_map(|next| [-1.0, 1.0].map(|sign| Some((next, sign)))).collect()
    })
}

/// The description with its offsets fitted again: those that were fitted before another change was added are not the best with it. None where it
/// has none, or one is then too small to be reported.
pub(crate) fn refined(physics: &Physics, rows: &Rows, from: &Description) -> Option<Description> {
    let (_, few) = prepared(physics, rows, from)?;
    if from.position_offset.iter().all(|offset| *offset == 0.0) {
        return None;
    }
    let merit = |offsets: &[f64]| merit_of_zeros(physics, &few, from, offsets);
    reported(&together(from.position_offset.clone(), merit))
        .map(|offsets| from.with_zeros(&in_limits(rows, from, offsets, merit)))
}

/// The geometry of the arm and the rows of a scan; none where zeros are not asked for.
fn prepared(physics: &Physics, rows: &Rows, from: &Description) -> Option<(Chain, Rows)> {
    let chain = match physics {
        Physics::Free(model) => model.chain().clone(),
        Physics::Bodies(robot) | Physics::Sprung(robot, _) | Physics::Masses(robot) => Chain::new(robot),
        Physics::Multiples(_) | Physics::Alone => return None,
    };
    from.scaled().next().is_none().then(|| (chain, rows.thinned(SCANNED)))
}

fn merit_of_zeros(physics: &Physics, rows: &Rows, from: &Description, offsets: &[f64]) -> f64 {
    let description = from.with_zeros(offsets);
    let tables = physics.tables(rows, &description);
    merit_of(&tables, rows, &description)
}

/// The description with an offset of one more zero, which takes one of those that `taken` gives for a joint.
fn with_more(
    physics: &Physics,
    rows: &Rows,
    from: &Description,
    taken: impl Fn(usize) -> Vec<Taken> + Sync,
) -> Vec<Description> {
    let Some((chain, few)) = prepared(physics, rows, from) else { return Vec::new() };
    let merit = |offsets: &[f64]| merit_of_zeros(physics, &few, from, offsets);
    // What another offset takes from those that are there gains nothing that they gain by themselves.
    let given = &together(from.position_offset.clone(), merit);
    let at = |joint: usize, offset: f64, taken: Taken| -> Vec<f64> {
        let mut offsets = given.clone();
        offsets[joint] = offset;
        taken.iter().for_each(|&(other, sign)| offsets[other] += sign * offset);
        offsets
    };
    let without = merit(given);
    let steps = (360.0 / STEP_DEG) as usize;
    let grid = |place: usize| (place as f64 * STEP_DEG).to_radians();
    let joints: Vec<usize> =
        (0..from.dof()).filter(|&joint| rows.turns[joint] && given[joint] == 0.0 && !is_last(&chain, joint)).collect();
    let at_places = |tried: Vec<(usize, Taken)>| -> Vec<Tried> {
        let each: Vec<_> =
            tried.iter().flat_map(|&(joint, taken)| (1..steps).map(move |place| (joint, place, taken))).collect();
        let tried = |&(joint, place, taken): &(usize, usize, Taken)| {
            let merit = merit(&at(joint, grid(place), taken));
            Tried { joint, place, taken, merit }
        };
        each.par_iter().map(tried).collect()
    };
    let alone = at_places(joints.iter().map(|&joint| (joint, None)).collect());
    // A joint whose zero changes nothing about the torques, as one whose axis is vertical and stands on nothing that moves, has none.
    let joints: Vec<usize> = joints.into_iter().filter(|&joint| shows(&alone, joint, without)).collect();
    let with_another =
        at_places(joints.iter().flat_map(|&joint| taken(joint).into_iter().map(move |t| (joint, t))).collect());
    let refined = |&joint: &usize| {
        let alone = if taken(joint).contains(&None) { alone.as_slice() } else { &[] };
        let each = alone
            .iter()
            .chain(&with_another)
            .filter(|tried| tried.joint == joint)
            .map(|tried| (tried.place, tried.taken, tried.merit));
        let (least, taken, _) = each.chain([(0, None, without)]).min_by(|a, b| a.2.total_cmp(&b.2))?;
        let step = STEP_DEG.to_radians();
        let offset =
            golden(grid(least) - step, grid(least) + step, SECTIONS, |offset| merit(&at(joint, offset, taken)));
        let offsets = at(joint, offset, taken);
        let merit = merit(&offsets);
        (merit < without - GAINS).then_some((merit, offsets))
    };
    let mut found: Vec<(f64, Vec<f64>)> = joints.par_iter().filter_map(refined).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(KEPT);
    let finished = |(_, offsets): (f64, Vec<f64>)| {
        let several = offsets.iter().filter(|offset| **offset != 0.0).count() > 1;
        let offsets = if several { together(offsets, merit) } else { offsets };
        reported(&offsets).map(|offsets| from.with_zeros(&in_limits(rows, from, offsets, merit)))
    };
    found.into_par_iter().filter_map(finished).collect()
}

/// An offset of the scan, with what it takes from another.
struct Tried {
    joint: usize,
    place: usize,
    taken: Taken,
    merit: f64,
}

/// Whether the zero of a joint shows in the torques, somewhere on the circle.
fn shows(tried: &[Tried], joint: usize, without: f64) -> bool {
    let own = tried.iter().filter(|tried| tried.joint == joint).map(|tried| tried.merit);
    let [least, most] = own.fold([without; 2], |[least, most], merit| [merit.min(least), merit.max(most)]);
    most - least > GAINS
}

/// Offsets fitted one after the other, in rounds.
fn together(mut offsets: Vec<f64>, merit: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let change = CHANGES_DEG.to_radians();
    let changed: Vec<usize> = (0..offsets.len()).filter(|&joint| offsets[joint] != 0.0).collect();
    if changed.is_empty() {
        return offsets;
    }
    for _ in 0..ROUNDS {
        let before = offsets.clone();
        for &joint in &changed {
            let with = |offset: f64| {
                let mut offsets = offsets.clone();
                offsets[joint] = offset;
                merit(&offsets)
            };
            offsets[joint] = golden(offsets[joint] - change, offsets[joint] + change, SECTIONS, with);
        }
        // Offsets of parallel axes make up for each other: further along the way that the round went.
        let along = |factor: f64| -> Vec<f64> {
            offsets.iter().zip(&before).map(|(now, before)| now + factor * (now - before)).collect()
        };
        offsets = along(golden(0.0, FURTHER, SECTIONS, |factor| merit(&along(factor))));
    }
    offsets
}

/// Whether a joint carries no other.
fn is_last(chain: &Chain, joint: usize) -> bool {
    let carries = |other: usize| (0..chain.bodies()).all(|body| !chain.moves(other, body) || chain.moves(joint, body));
    !(0..chain.dof()).any(|other| other != joint && carries(other))
}

/// The multiple of the angle of conventions nearest to an offset, rad, where it is within so many degrees of one other than zero.
pub(crate) fn convention_near(offset: f64, within_deg: f64) -> Option<f64> {
    let step = CONVENTION_DEG.to_radians();
    let near = (offset / step).round() * step;
    (near != 0.0 && (near - offset).abs() < within_deg.to_radians()).then_some(near)
}

/// Offsets as they are reported, rad within half a turn; none where one is too small for that.
fn reported(offsets: &[f64]) -> Option<Vec<f64>> {
    let of = |offset: &f64| {
        if *offset == 0.0 {
            return Some(0.0);
        }
        let degrees = convention_near(*offset, NEAR_DEG).unwrap_or(*offset).to_degrees();
        // Half a turn is written as a positive one.
        let degrees = 180.0 - (180.0 - degrees).rem_euclid(360.0);
        (degrees.abs() > REPORTED_DEG).then(|| degrees.to_radians())
    };
    offsets.iter().map(of).collect()
}

/// The same offsets, by turns more or less where the joint is then within its limits or nearer to them: by whole ones, and by half ones
/// where the torques contradict these no more than chance would, as where gravity is compensated.
fn in_limits(rows: &Rows, from: &Description, offsets: Vec<f64>, merit: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let logged = from.with_zeros(&vec![0.0; from.dof()]).positions(&rows.motion.q);
    let turned = |joint: usize| {
        let offset = offsets[joint];
        let at = |turns: f64| offset + turns * TAU;
        let beyond = |turns: f64| {
            let positions: Vec<f64> = logged.channel(joint).iter().map(|q| q + at(turns)).collect();
            rows.beyond_limits(joint, &positions).max(0.0)
        };
        // The first of those that are as near to the limits: the one that fits best.
        let nearest = |turns: &[f64]| turns.iter().copied().min_by(|a, b| beyond(*a).total_cmp(&beyond(*b)));
        let whole = nearest(&[0.0, -1.0, 1.0]).unwrap_or(0.0);
        match offset {
            0.0 => 0.0,
            _ if beyond(whole) <= 0.0 => at(whole),
            _ => {
                let least = merit(&offsets);
                let fits = |turns: &f64| {
                    let mut turned = offsets.clone();
                    turned[joint] = at(*turns);
                    merit(&turned) < least + GAINS
                };
                let halves: Vec<f64> = [-0.5, 0.5].into_iter().filter(fits).collect();
                at(nearest(&[&[whole], halves.as_slice()].concat()).unwrap_or(whole))
            }
        }
    };
    (0..offsets.len()).map(turned).collect()
}

#[cfg(test)]
mod tests {
    use super::{Tried, convention_near, reported, shows};

    #[test]
    fn a_zero_shows_where_some_angle_changes_the_torques() {
        let of = |most: f64| {
            let tried = |joint, place, merit| Tried { joint, place, taken: None, merit };
            shows(&[tried(1, 1, -4.0), tried(1, 2, -4.0 + most), tried(2, 1, 9.0)], 1, -4.0)
        };
        assert!(of(0.51) && !of(0.49) && of(-0.51) && !of(-0.49));
    }

    #[test]
    fn conventions_are_near_up_to_an_angle_and_none_is_zero() {
        let near = |degrees: f64| convention_near(f64::to_radians(degrees), 8.0).map(|near| near.to_degrees().round());
        assert_eq!([near(52.9), near(53.1), near(-97.9), near(1.0)], [Some(45.0), None, Some(-90.0), None]);
    }

    #[test]
    fn offsets_are_reported_beyond_a_calibration_and_are_those_of_a_convention_where_they_are_near() {
        let of = |degrees: f64| reported(&[0.0, degrees.to_radians()]).map(|offsets| offsets[1].to_degrees());
        let near =
            |found: Option<f64>, wanted: f64| assert!((found.unwrap() - wanted).abs() < 1e-9, "{found:?} {wanted}");
        near(of(15.1), 15.1);
        near(of(-15.1), -15.1);
        assert_eq!([of(14.9), of(-14.9), of(1.0), of(359.0)], [None; 4]);
        near(of(92.4), 90.0);
        near(of(92.6), 92.6);
        near(of(43.0), 45.0);
        near(of(-178.0), 180.0);
        near(of(181.0), 180.0);
        near(of(200.0), -160.0);
    }
}
