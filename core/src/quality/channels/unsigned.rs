//! A torque that comes to zero and turns back there: its sign was lost.

use super::digits::{extremes, resolution};
use crate::error::Result;
use crate::quality::descriptions;
use crate::quality::finding::{Finding, Kind, Severity};
use crate::quality::view::View;
use crate::robot::Robot;
use crate::signal::size_quantile;

/// Shares of a torque's size: up to the first it visits zero if it comes from beyond twice that and comes down to the second; up to
/// the last it meets zero, at which one that turns of its own stops by chance alone; visits of which one that does so is enough.
const NEAR: f64 = 0.03;
const VISITS: f64 = 0.02;
const MEETS: f64 = 0.004;
pub(super) const MANY: usize = 5;

/// A torque that lost its sign has a kink where it meets zero: it is within a quarter of [`NEAR`] for a quarter of the time that it is
/// within all of it, where one that touches zero of its own is there for half of the time. Between the two, over all visits:
const KINK: f64 = 2.3;

/// So many visits need no kink, which noise hides: a torque that turns of its own does not meet zero as often by chance.
const OFTEN: usize = 4;

/// Visits of zero by a torque that comes down to it, meets it, and never goes below (or above).
pub(super) struct Visits {
    /// Samples at which it meets zero.
    met: Vec<usize>,
    /// Visits, whether or not it meets zero.
    all: usize,
}

/// The visits of a torque that never crosses zero, where it seems to turn back there.
pub(super) fn turns_back(tau: &[f64]) -> Option<Visits> {
    let (low, high) = extremes(tau);
    let size = size_quantile(tau.iter().copied(), 0.95);
    // A torque with few digits meets zero wherever it comes near.
    if (low < 0.0 && high > 0.0) || size == 0.0 || resolution(tau) > MEETS * size {
        return None;
    }
    let lowest = |part: &[f64]| part.iter().fold(f64::INFINITY, |least, value| least.min(value.abs()));
    let mut start = 0;
    let mut visits: Vec<(usize, &[f64])> = Vec::new();
    for part in tau.split(|value: &f64| value.abs() > 2.0 * NEAR * size) {
        visits.push((start, part));
        start += part.len() + 1;
    }
    visits.retain(|(_, part)| lowest(part) < VISITS * size);
    let all = visits.len();
    visits.retain(|(_, part)| lowest(part) < MEETS * size);
    let parts: Vec<&[f64]> = visits.iter().map(|(_, part)| *part).collect();
    let turns = visits.len() >= OFTEN || have_kinks(&parts, 2.0 * NEAR * size);
    let nearest = |&(start, part): &(usize, &[f64])| {
        let at = (0..part.len()).min_by(|&a, &b| part[a].abs().total_cmp(&part[b].abs()));
        start + at.unwrap_or(0)
    };
    let met: Vec<usize> = visits.iter().filter(|_| turns).map(nearest).collect();
    ((!met.is_empty() && all >= MANY) || (met.len() >= 2 && 2 * met.len() >= all)).then_some(Visits { met, all })
}

/// A torque that turns back at zero. A few visits are chance, unless a model explains the torque better with the sign that it would have lost.
pub(super) fn unsigned(
    view: &View,
    joint: usize,
    tau: &[f64],
    visits: &Visits,
    robot: Option<&Robot>,
) -> Result<Option<Finding>> {
    let turns = || -> Vec<usize> {
        // The view is at even steps.
        let at = |&met: &usize| met * view.log.samples() / tau.len();
        visits.met.iter().map(at).collect()
    };
    if visits.met.len() < OFTEN && !descriptions::is_explained_with_signs(view.log, robot, joint, &turns())? {
        return Ok(None);
    }
    let what = if extremes(tau).0 >= 0.0 { "never negative" } else { "never positive" };
    let text = format!(
        "the torque is {what} but comes to zero {} times and turns back: its sign was lost; log it with its sign",
        visits.all
    );
    Ok(Some(Finding::new(Kind::UnsignedTorque, Severity::Warning, view.place("tau", joint), text)))
}

/// Whether a torque comes to zero and leaves it on straight lines, from the parts in which it is within `near` of it.
fn have_kinks(parts: &[&[f64]], near: f64) -> bool {
    let inner = |part: &&[f64]| part.iter().filter(|value| value.abs() < 0.25 * near).count();
    let within: usize = parts.iter().map(|part| part.len()).sum();
    let closer: usize = parts.iter().map(inner).sum();
    closer <= parts.len() || within as f64 > KINK * closer as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line through zero without its sign, and a parabola that touches zero.
    #[test]
    fn a_torque_without_its_sign_has_kinks_at_zero() {
        let part = |law: fn(f64) -> f64| -> Vec<f64> {
            (-400..=400).map(|k| law(f64::from(k) / 100.0)).filter(|value| value.abs() <= 1.0).collect()
        };
        let (line, touch) = (part(f64::abs), part(|x| 0.02 + x * x));
        assert!(have_kinks(&[&line, &line], 1.0) && !have_kinks(&[&touch, &touch], 1.0));
        // So fast that a sample or two are near.
        assert!(have_kinks(&[&[0.9, 0.1, 0.8]], 1.0));
    }
}
