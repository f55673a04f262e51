//! A free direction of gravity: the mounting of an arm on a slope or a rail.

use super::super::change::{Change, Description};
use super::super::fitting::{Physics, Rows};
use super::scale::merit as merit_of;
use nalgebra::Vector3;

/// First and last step of the search over directions, degrees.
const STEPS: [f64; 5] = [40.0, 20.0, 10.0, 5.0, 2.5];

/// Directions nearer than this to one that is tried anyway, degrees, are that one: smaller tilts of a base are asked of the
/// physics, not of the description.
const NEAR: f64 = 15.0;

/// The direction of gravity that fits all rows best, where it is neither along an axis nor the described one.
pub(crate) fn free_direction(physics: &Physics, rows: &Rows, from: &Description) -> Option<Change> {
    let size = from.gravity.norm();
    if size == 0.0 {
        return None;
    }
    let merit = |direction: &Vector3<f64>| {
        let description = from.with(Change::Gravity((direction * size).into()));
        let tables = physics.tables(rows, &description);
        merit_of(&tables, rows, &description)
    };
    let axes = (0..3).flat_map(|axis| [1.0, -1.0].map(|sign| sign * Vector3::ith(axis, 1.0)));
    let known: Vec<Vector3<f64>> = std::iter::once(from.gravity / size).chain(axes).collect();
    let start = known.iter().map(|direction| (merit(direction), *direction));
    let (mut least, mut best) = start.min_by(|a, b| a.0.total_cmp(&b.0))?;
    for step in STEPS.map(f64::to_radians) {
        // Each step is repeated while it helps, at most around the sphere.
        for _ in 0..4 {
            let across = if best.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
            let side = best.cross(&across).normalize();
            let other = best.cross(&side);
            let turned = [side, -side, other, -other].map(|toward| best * step.cos() + toward * step.sin());
            let tried = turned.into_iter().map(|direction| (merit(&direction), direction));
            match tried.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((merit, direction)) if merit < least => (least, best) = (merit, direction),
                _ => break,
            }
        }
    }
    let near = |direction: &Vector3<f64>| best.dot(direction) > NEAR.to_radians().cos();
    (!known.iter().any(near)).then(|| Change::Gravity((best * size).into()))
}
