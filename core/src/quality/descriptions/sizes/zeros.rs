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

/// So are offsets within this of one, degrees, where the torques contradict it no more than chance would: offsets of parallel axes make up
/// for each other.
const PERHAPS_DEG: f64 = 8.0;

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

/// The description with an offset of one more zero, which takes one of those that `taken` gives for a joint.
fn with_more(
    physics: &Physics,
    rows: &Rows,
    from: &Description,
    taken: impl Fn(usize) -> Vec<Taken>,
) -> Vec<Description> {
    let chain = match physics {
        Physics::Free(model) => model.chain().clone(),
        Physics::Bodies(robot) | Physics::Masses(robot) => Chain::new(robot),
        Physics::Multiples(_) | Physics::Alone => return Vec::new(),
    };
    if from.scaled().next().is_some() {
        return Vec::new();
    }
    let few = rows.thinned(SCANNED);
    let merit = |offsets: &[f64]| {
        let description = from.with_zeros(offsets);
        let tables = physics.tables(&few, &description);
        merit_of(&tables, &few, &description)
    };
    let given = &from.position_offset;
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
    let places = |joint: usize| {
        taken(joint).into_iter().flat_map(move |taken| (1..steps).map(move |place| (joint, place, taken)))
    };
    let tried: Vec<(usize, usize, Taken)> = joints.iter().flat_map(|&joint| places(joint)).collect();
    let merits: Vec<f64> =
        tried.par_iter().map(|&(joint, place, taken)| merit(&at(joint, grid(place), taken))).collect();
    let refined = |&joint: &usize| {
        let own = tried.iter().zip(&merits).filter(|((other, ..), _)| *other == joint);
        let each = own.map(|((_, place, taken), merit)| (*place, *taken, *merit)).chain([(0, None, without)]);
        let (least, taken, _) = each.min_by(|a, b| a.2.total_cmp(&b.2))?;
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
    let together = |(_, mut offsets): (f64, Vec<f64>)| {
        let change = CHANGES_DEG.to_radians();
        let several = offsets.iter().filter(|offset| **offset != 0.0).count() > 1;
        for _ in 0..if several { ROUNDS } else { 0 } {
            let before = offsets.clone();
            for joint in (0..offsets.len()).filter(|&joint| offsets[joint] != 0.0).collect::<Vec<_>>() {
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
        reported(&conventional(&offsets, merit)).map(|offsets| from.with_zeros(&in_limits(rows, from, offsets, merit)))
    };
    found.into_par_iter().filter_map(together).collect()
}

/// Whether a joint carries no other.
fn is_last(chain: &Chain, joint: usize) -> bool {
    let carries = |other: usize| (0..chain.bodies()).all(|body| !chain.moves(other, body) || chain.moves(joint, body));
    !(0..chain.dof()).any(|other| other != joint && carries(other))
}

/// The multiples of the angle of conventions in the place of offsets near them, all of them or one, where these fit about as well.
fn conventional(offsets: &[f64], merit: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let step = CONVENTION_DEG.to_radians();
    let usual = |offset: f64| match (offset / step).round() * step {
        near if near != 0.0 && (near - offset).abs() < PERHAPS_DEG.to_radians() => near,
        _ => offset,
    };
    let least = merit(offsets);
    let all: Vec<f64> = offsets.iter().map(|&offset| usual(offset)).collect();
    let one = |joint: usize| {
        let mut out = offsets.to_vec();
        out[joint] = usual(out[joint]);
        out
    };
    let tried = std::iter::once(all).chain((0..offsets.len()).map(one)).filter(|out| out != offsets);
    let mut fits = tried.filter(|out| merit(out) < least + GAINS);
    fits.next().unwrap_or_else(|| offsets.to_vec())
}

/// Offsets as they are reported, rad within half a turn; none where one is too small for that.
fn reported(offsets: &[f64]) -> Option<Vec<f64>> {
    let of = |offset: &f64| {
        if *offset == 0.0 {
            return Some(0.0);
        }
        let degrees = offset.to_degrees();
        let usual = (degrees / CONVENTION_DEG).round() * CONVENTION_DEG;
        let degrees = if (degrees - usual).abs() < NEAR_DEG { usual } else { degrees };
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
    use super::{conventional, reported};

    #[test]
    fn offsets_near_a_convention_are_that_where_it_fits_about_as_well() {
        let right = [0.0, 90f64.to_radians(), -90f64.to_radians()];
        let found = [0.0, 85f64.to_radians(), -85f64.to_radians()];
        // A narrow valley, and one in which both make up for each other.
        let narrow = |at: &[f64]| 300.0 * at.iter().zip(&found).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let sum = |at: &[f64]| 300.0 * (at[1] + at[2]).powi(2);
        assert_eq!(conventional(&found, narrow), found);
        assert_eq!(conventional(&found, sum), right);
        let far = [0.0, 81f64.to_radians(), 0.1];
        assert_eq!(conventional(&far, |_| 0.0), far);
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
