//! Shapes at a bound of their law: better there than inside, the data ask for another law.

use super::judging::Judged;
use crate::diagnosis::model::{Candidate, Moved, Session, extent, prior, shapes};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection};
use crate::effects::{Placed, Search, varies_by_factors};
use crate::error::Result;
use std::f64::consts::TAU;

/// Distance to a bound over the range of a shape, or over that of its logarithm, within which it lies there; and by which it is moved
/// inside.
const AT_BOUND: f64 = 1e-3;
const INSIDE: f64 = 0.1;

impl Session<'_> {
    /// What the statistic of the test loses where a shape that lies at a bound of its law is moved inside; the most that any shape does.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn lost_inside_bounds(&self, judged: &Judged, whitener: &Whitener, fit: &Projection) -> Result<f64> {
        let Candidate { placed, log, columns } = &judged.candidate;
        let extent = extent(&self.logs.train.rows, placed.joint);
        let at_bounds = shapes(placed.effect).into_iter();
        let bounds = |index: usize| extent.bounds_of_law(placed.effect, index);
        let inside: Vec<Placed> = at_bounds.filter_map(|index| moved_inside(placed, index, bounds(index))).collect();
        if inside.is_empty() {
            return Ok(0.0);
        }
        let statistic = |placed: &Placed, columns: &[Column]| {
            let spread = prior(placed, self.model.base.robot());
            fit.test_with_prior(&whitener.apply_all(columns), &spread).map_or(0.0, |test| test.statistic)
        };
        let here = statistic(placed, columns);
        let moved = self.logs.train.columns(&self.model.arm, *log, &inside, Moved::Tested)?;
        Ok(inside.iter().zip(&moved).map(|(placed, columns)| here - statistic(placed, columns)).fold(0.0, f64::max))
    }
}

/// The effect with a shape that lies at a bound of its law moved inside. A whole turn has no bound, nor has a time at which something
/// happens.
fn moved_inside(placed: &Placed, index: usize, (lower, upper): (f64, f64)) -> Option<Placed> {
    if placed.effect.search(index) == Search::Instant {
        return None;
    }
    if !(lower.is_finite() && upper.is_finite()) || upper - lower >= TAU * (1.0 - AT_BOUND) && lower == -upper {
        return None;
    }
    let by_factors = placed.effect.search(index) != Search::Position && varies_by_factors(lower, upper);
    let scale = |value: f64| if by_factors { value.ln() } else { value };
    let [low, high, at] = [lower, upper, placed.parameters[index]].map(scale);
    let range = high - low;
    let step = if at - low <= AT_BOUND * range {
        INSIDE * range
    } else if high - at <= AT_BOUND * range {
        -INSIDE * range
    } else {
        return None;
    };
    let mut moved = placed.clone();
    moved.parameters[index] = if by_factors { (at + step).exp() } else { at + step };
    Some(moved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Parameter, find};

    #[test]
    fn a_shape_at_a_bound_is_moved_inside() {
        let strut = |geometry: f64, angle: f64| {
            let mut placed = Placed::typical(find("gravity_balancer").unwrap(), 1);
            placed.parameters[2..4].copy_from_slice(&[geometry, angle]);
            placed
        };
        let Parameter { lower, upper, .. } = strut(0.5, 0.0).effect.parameters()[2];
        let inside = |placed: &Placed, index: usize| {
            let Parameter { lower, upper, .. } = placed.effect.parameters()[index];
            moved_inside(placed, index, (lower, upper))
        };
        let moved = |geometry: f64| inside(&strut(geometry, 0.0), 2).map(|placed| placed.parameters[2]);
        assert!(moved(lower).is_some_and(|geometry| geometry > lower && geometry < upper));
        assert!(moved(upper).is_some_and(|geometry| geometry > lower && geometry < upper));
        // On either side of the distance that counts as being there.
        let apart = |share: f64| {
            if varies_by_factors(lower, upper) {
                lower * (upper / lower).powf(share)
            } else {
                lower + share * (upper - lower)
            }
        };
        assert!(moved(apart(0.9 * AT_BOUND)).is_some() && moved(apart(1.1 * AT_BOUND)).is_none());
        // So is the beginning of a contact, at the first second of a log or later.
        let contact = Placed::typical(find("external_contact").unwrap(), 0);
        let instants = shapes(contact.effect);
        assert!(instants.len() == 2 && instants.into_iter().all(|index| inside(&contact, index).is_none()));
        // An angle of half a turn is one like any other.
        assert!(inside(&strut(0.5, std::f64::consts::PI), 3).is_none());
    }
}
