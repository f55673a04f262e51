//! A free direction of gravity: the mounting of an arm on a slope or a rail.
//!
//! Not every mechanism determines it. Parallel axes do not feel on which side of their common plane gravity points, a joint that slides
//! holds its part of it by a constant of the drive, and a single joint feels a projection. So the search starts all over the sphere and
//! returns every valley, and a direction that was found is asked whether a valley goes on from it.

use super::super::change::{Change, Description};
use super::super::fitting::{Physics, Rows};
use super::super::tried::Tried;
use super::golden::golden;
use super::scale::merit as merit_of;
use nalgebra::{Matrix2, Vector2, Vector3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Directions from which the search starts, about 25 degrees apart.
const STARTS: usize = 64;

/// Starts within this angle belong to one valley, degrees.
const VALLEY: f64 = 40.0;

/// Valleys that are looked into, the deepest first.
const VALLEYS: usize = 4;

/// Rows of the search over the sphere: it places valleys, which all rows compare.
const ROWS: usize = 400;

/// Radii of the circles on which the shape of a valley is measured, degrees: the first ones with few rows, the last ones with all.
const FIRST_CIRCLES: [f64; 5] = [20.0, 20.0, 10.0, 10.0, 5.0];
const LAST_CIRCLES: [f64; 4] = [5.0, 2.5, 1.25, 0.6];

/// Directions on such a circle, and how many radii a step goes at most.
const SIDES: usize = 8;
const FARTHEST: f64 = 2.0;

/// Directions nearer than this to one that is tried anyway, degrees, are that one: smaller tilts of a base are asked of the
/// physics, not of the description.
const NEAR: f64 = 15.0;

/// A smaller tilt of the base is tried where it fits all rows better than none by so much, in the sum of the logarithms of the mean
/// squares: what it explains is no other change.
const TILTS: f64 = 0.5;

/// Two directions nearer than this are one, degrees.
const SAME: f64 = 7.5;

/// A valley goes on where on a circle of this radius around what was found, degrees, a direction fits about as well: by no more than this
/// in the sum of the logarithms of the mean squares. Held-out blocks decide between them.
const CIRCLES: [f64; 2] = [25.0, 60.0];
const ABOUT_AS_WELL: f64 = 1.0;

/// Directions on a circle that are tried first, and golden sections between them.
const ON_CIRCLE: usize = 24;
const SECTIONS: usize = 8;

/// How well rows are fitted by the direction of gravity, the rest as described.
struct Merit<'a> {
    physics: &'a Physics,
    rows: &'a Rows,
    from: &'a Description,
    size: f64,
}

impl Merit<'_> {
    fn of(&self, direction: &Vector3<f64>) -> f64 {
        let description = self.from.with_gravity(direction * self.size);
        let tables = self.physics.tables(self.rows, &description);
        merit_of(&tables, self.rows, &description)
    }

    /// The lowest place of a valley from a place in it, by steps of Newton's method with the slope and the curvature on circles: valleys
    /// are narrow, and run in any direction.
    fn lowest_from(&self, start: Vector3<f64>, circles: &[f64]) -> (f64, Vector3<f64>) {
        let (mut least, mut best) = (self.of(&start), start);
        for radius in circles.iter().map(|radius| radius.to_radians()) {
            let side = |place: usize| TAU * place as f64 / SIDES as f64;
            let around: [f64; SIDES] = std::array::from_fn(|place| self.of(&turned(&best, radius, side(place))));
            let on_circle = (0..SIDES).map(|place| (around[place], turned(&best, radius, side(place))));
            let step = newton_step(least, around).map(|step| {
                let direction = turned(&best, radius * step.norm().min(FARTHEST), step.y.atan2(step.x));
                (self.of(&direction), direction)
            });
            match on_circle.chain(step).min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((merit, direction)) if merit < least => (least, best) = (merit, direction),
                _ => {}
            }
        }
        (least, best)
    }
}

/// The description with directions of gravity that fit the rows best, each the lowest of its valley, the best first: those that are not
/// the described one, and along no axis that fits about as well.
pub(crate) fn free_directions(physics: &Physics, rows: &Rows, from: &Description) -> Vec<Description> {
    let size = from.gravity.norm();
    let merit = Merit { physics, rows, from, size };
    let is_known = |found: &Description| {
        let direction = found.gravity / size;
        let near = |other: &Vector3<f64>| within(other, &direction, NEAR);
        let as_good = |axis: Vector3<f64>| near(&axis) && merit.of(&axis) < merit.of(&direction) + ABOUT_AS_WELL;
        near(&(from.gravity / size)) || axes().any(as_good)
    };
    lowest(physics, rows, from).into_iter().filter(|found| !is_known(found)).collect()
}

/// The description with a base that is tilted a little, where that fits better than none.
pub(crate) fn tilted(physics: &Physics, rows: &Rows, from: &Description) -> Option<Description> {
    let size = from.gravity.norm();
    if size == 0.0 {
        return None;
    }
    let given = from.with(Change::Gravity(from.gravity.into()));
    let merit = Merit { physics, rows, from: &given, size };
    let start = from.gravity / size;
    let (least, direction) = merit.lowest_from(start, &LAST_CIRCLES);
    (least < merit.of(&start) - TILTS && within(&start, &direction, NEAR)).then(|| given.with_gravity(direction * size))
}

/// A description without a tilt of the base from `gravity` that is asked of the physics; none where it has no such tilt.
pub(crate) fn without_tilt(description: &Description, gravity: Vector3<f64>) -> Option<Description> {
    let is_tilt = |change: &Change| match change {
        Change::Gravity(own) => {
            let own = Vector3::from(*own);
            own != gravity && own.norm() > 0.0 && within(&own.normalize(), &gravity.normalize(), NEAR)
        }
        _ => false,
    };
    description.changes.iter().any(is_tilt).then(|| {
        let mut out = Description { gravity, ..description.clone() };
        out.changes.retain(|change| !is_tilt(change));
        out
    })
}

/// The same with all directions that are the lowest of a valley.
pub(crate) fn lowest(physics: &Physics, rows: &Rows, from: &Description) -> Vec<Description> {
    let size = from.gravity.norm();
    if size == 0.0 {
        return Vec::new();
    }
    let few = rows.thinned(ROWS);
    let is_changed = from.changes.iter().any(|change| matches!(change, Change::Gravity(_)));
    let from_gravity = if is_changed { from.clone() } else { from.with(Change::Gravity(from.gravity.into())) };
    let [quick, whole] = [&few, rows].map(|rows| Merit { physics, rows, from: &from_gravity, size });
    let own = std::iter::once(from.gravity / size).chain(axes());
    let starts: Vec<Vector3<f64>> = own.chain(over_the_sphere(STARTS)).collect();
    let merits: Vec<f64> = starts.par_iter().map(|direction| quick.of(direction)).collect();
    let is_lowest = |place: &usize| {
        let near = |other: usize| other != *place && within(&starts[other], &starts[*place], VALLEY);
        !(0..starts.len()).any(|other| near(other) && merits[other] < merits[*place])
    };
    let mut lowest: Vec<usize> = (0..starts.len()).filter(is_lowest).collect();
    lowest.sort_by(|&a, &b| merits[a].total_cmp(&merits[b]));
    lowest.truncate(VALLEYS);
    let refined = |&place: &usize| {
        let (_, direction) = quick.lowest_from(starts[place], &FIRST_CIRCLES);
        whole.lowest_from(direction, &LAST_CIRCLES)
    };
    let mut found: Vec<(f64, Vector3<f64>)> = lowest.par_iter().map(refined).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut kept: Vec<Vector3<f64>> = Vec::new();
    for (_, direction) in found {
        if !kept.iter().any(|other| within(other, &direction, SAME)) {
            kept.push(direction);
        }
    }
    kept.into_iter().map(|direction| from_gravity.with_gravity(direction * size)).collect()
}

/// The description with other directions of the gravity that it changes, to which the valley goes on from there; none where the mechanism
/// determines it.
pub(crate) fn along_the_valley(physics: &Physics, rows: &Rows, from: &Description) -> Vec<Description> {
    let size = from.gravity.norm();
    if size == 0.0 || !from.changes.iter().any(|change| matches!(change, Change::Gravity(_))) {
        return Vec::new();
    }
    let few = rows.thinned(ROWS);
    let merit = Merit { physics, rows: &few, from, size };
    let center = from.gravity / size;
    let least = merit.of(&center);
    // Slow motion shows the sense of gravity by inertia alone, which free bodies take up.
    let opposite = -center;
    let mut out: Vec<Vector3<f64>> = Vec::new();
    if merit.of(&opposite) < least + ABOUT_AS_WELL {
        out.push(opposite);
    }
    for radius in CIRCLES.map(f64::to_radians) {
        let step = TAU / ON_CIRCLE as f64;
        let at = |angle: f64| turned(&center, radius, angle);
        let merits: Vec<f64> = (0..ON_CIRCLE).into_par_iter().map(|place| merit.of(&at(step * place as f64))).collect();
        let is_lowest = |&place: &usize| {
            let neighbours = [place + 1, place + ON_CIRCLE - 1].map(|other| merits[other % ON_CIRCLE]);
            neighbours.iter().all(|other| merits[place] <= *other)
        };
        for place in (0..ON_CIRCLE).filter(is_lowest) {
            let angle = step * place as f64;
            let angle = golden(angle - step, angle + step, SECTIONS, |angle| merit.of(&at(angle)));
            let (own, direction) = (merit.of(&at(angle)), at(angle));
            if own < least + ABOUT_AS_WELL && !out.iter().any(|other| within(other, &direction, NEAR)) {
                out.push(direction);
            }
        }
    }
    out.into_iter().map(|direction| from.with_gravity(direction * size)).collect()
}

/// Whether one direction of gravity is within the first of the circles around another.
pub(crate) fn is_next_to(a: &Description, b: &Description) -> bool {
    within(&a.gravity.normalize(), &b.gravity.normalize(), CIRCLES[0] + 1.0)
}

/// Whether two descriptions differ in nothing but the direction of gravity, and that by more than a little.
pub(crate) fn is_another_direction(a: &Tried, b: &Tried) -> bool {
    let [a, b] = [a, b].map(|tried| &tried.description);
    a.gravity.norm() > 0.0 && a.with_gravity(b.gravity).same_as(b) && !is_near(a, b)
}

/// Whether two descriptions differ in nothing but the direction of gravity, and that a little.
pub(crate) fn is_near(a: &Description, b: &Description) -> bool {
    has_direction_near(a, b) && a.with_gravity(b.gravity).same_as(b)
}

/// Whether gravity has nearly the same direction under two descriptions.
pub(crate) fn has_direction_near(a: &Description, b: &Description) -> bool {
    let both = [a, b].map(|description| description.gravity);
    let [of_a, of_b] = both.map(|gravity| gravity.normalize());
    both.iter().all(|gravity| gravity.norm() > 0.0) && within(&of_a, &of_b, NEAR)
}

/// The step from the center of a circle to the lowest place of the paraboloid through the values on it and in its center, in radii; none
/// where that has no lowest place.
fn newton_step(center: f64, around: [f64; SIDES]) -> Option<Vector2<f64>> {
    let sum = |weight: &dyn Fn(f64) -> f64| -> f64 {
        let of = |place: usize| around[place] * weight(TAU * place as f64 / SIDES as f64);
        (0..SIDES).map(of).sum::<f64>() / SIDES as f64
    };
    let slope = 2.0 * Vector2::new(sum(&f64::cos), sum(&f64::sin));
    // Half of the sum of both curvatures, half of their difference, and the mixed one.
    let [mean, difference, mixed] = [
        2.0 * (sum(&|_| 1.0) - center),
        4.0 * sum(&|angle| (2.0 * angle).cos()),
        4.0 * sum(&|angle| (2.0 * angle).sin()),
    ];
    let curvature = Matrix2::new(mean + difference, mixed, mixed, mean - difference);
    curvature.cholesky().map(|curvature| -curvature.solve(&slope))
}

/// A direction turned by an angle, toward a side given by another.
pub(super) fn turned(direction: &Vector3<f64>, by: f64, side: f64) -> Vector3<f64> {
    let across = if direction.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
    let first = direction.cross(&across).normalize();
    let second = direction.cross(&first);
    direction * by.cos() + (first * side.cos() + second * side.sin()) * by.sin()
}

/// Whether two directions are within so many degrees of each other.
pub(super) fn within(a: &Vector3<f64>, b: &Vector3<f64>, degrees: f64) -> bool {
    a.dot(b) > degrees.to_radians().cos()
}

pub(super) fn axes() -> impl Iterator<Item = Vector3<f64>> {
    (0..3).flat_map(|axis| [1.0, -1.0].map(|sign| sign * Vector3::ith(axis, 1.0)))
}

/// Directions spread evenly over the sphere, on a spiral of golden angles.
fn over_the_sphere(count: usize) -> impl Iterator<Item = Vector3<f64>> {
    let golden_angle = PI * (3.0 - 5f64.sqrt());
    (0..count).map(move |place| {
        let z = 1.0 - (2 * place + 1) as f64 / count as f64;
        let (sin, cos) = (golden_angle * place as f64).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        Vector3::new(radius * cos, radius * sin, z)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_direction_is_far_from_a_start() {
        let starts: Vec<Vector3<f64>> = over_the_sphere(STARTS).collect();
        for direction in over_the_sphere(1000) {
            assert!(starts.iter().any(|start| within(start, &direction, 20.0)), "{direction}");
        }
    }

    #[test]
    fn the_lowest_place_of_a_paraboloid_is_one_step_away() {
        let lowest = Vector2::new(0.7, -1.2);
        let curvature = Matrix2::new(9.0, 3.5, 3.5, 1.6);
        let value = |place: Vector2<f64>| 5.0 + (place - lowest).dot(&(curvature * (place - lowest)));
        let around = std::array::from_fn(|side| {
            let (sin, cos) = (TAU * side as f64 / SIDES as f64).sin_cos();
            value(Vector2::new(cos, sin))
        });
        let step = newton_step(value(Vector2::zeros()), around).unwrap();
        assert!((step - lowest).norm() < 1e-9, "{step}");
        assert_eq!(newton_step(5.0, [4.0; SIDES]), None, "a summit");
    }

    #[test]
    fn a_direction_is_turned_by_an_angle() {
        for direction in over_the_sphere(20) {
            let sides = [0.0, 1.0, 4.0].map(|side| turned(&direction, 0.3, side));
            assert!(sides.iter().all(|side| (side.dot(&direction) - 0.3f64.cos()).abs() < 1e-12));
        }
    }
}
