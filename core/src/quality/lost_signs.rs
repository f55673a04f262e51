//! Torques that come to zero and turn back there: their signs were lost.

use super::channels::{extremes, resolution, runs};
use super::descriptions;
use super::finding::{Finding, Kind, Severity};
use super::view::View;
use crate::channels::Channels;
use crate::error::Result;
use crate::recording::Recording;
use crate::robot::Robot;
use crate::signal::size_quantile;

/// Shares of a torque's size: up to the first it visits zero if it comes from beyond twice that and comes down to the second; up to
/// the last it meets zero, at which one that turns of its own stops by chance alone; visits of which one that does so is enough.
const NEAR: f64 = 0.03;
const VISITS: f64 = 0.02;
const MEETS: f64 = 0.004;
const MANY: usize = 5;

/// A torque that lost its sign has a kink where it meets zero: it is within a quarter of [`NEAR`] for a quarter of the time that it is
/// within all of it, where one that touches zero of its own is there for half of the time. Between the two, over all visits:
const KINK: f64 = 2.3;

/// So many visits need no kink, which noise hides: a torque that turns of its own does not meet zero as often by chance.
const OFTEN: usize = 4;

/// Visits of zero by a torque that comes down to it, meets it, and never goes below (or above).
struct Visits {
    /// Samples at which it meets zero.
    met: Vec<usize>,
    /// Samples at which it is nearest to zero in every visit, whether or not it meets it.
    all: Vec<usize>,
}

/// Findings about torques that lost their signs; `logged` is the log as it was, with the digits that even steps do not keep.
///
/// # Errors
/// Those of the filters.
pub(super) fn findings(view: &View, logged: &Recording, robot: Option<&Robot>) -> Result<Vec<Finding>> {
    let (mut out, mut turned_back) = (Vec::new(), 0);
    for joint in (0..view.dof()).filter(|&joint| logged.has_torque(joint)) {
        let own = logged.tau.channel(joint);
        if let Some(visits) = turns_back(own) {
            turned_back += 1;
            out.extend(unsigned(view, joint, own, &visits, robot)?);
        }
    }
    if let Some(all) = all_unsigned(view, &logged.tau, turned_back) {
        // One cause: the joints are not listed one by one.
        return Ok(vec![all]);
    }
    if out.len() == changing(&logged.tau).count() {
        // Nothing is left to identify from.
        out.iter_mut().for_each(|finding| finding.severity = Severity::Fatal);
    }
    Ok(out)
}

/// The visits of a torque that never crosses zero, where it seems to turn back there.
fn turns_back(tau: &[f64]) -> Option<Visits> {
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
    let nearest = |&(start, part): &(usize, &[f64])| {
        let at = (0..part.len()).min_by(|&a, &b| part[a].abs().total_cmp(&part[b].abs()));
        start + at.unwrap_or(0)
    };
    let all: Vec<usize> = visits.iter().map(nearest).collect();
    visits.retain(|(_, part)| lowest(part) < MEETS * size);
    let parts: Vec<&[f64]> = visits.iter().map(|(_, part)| *part).collect();
    let turns = visits.len() >= OFTEN || have_kinks(&parts, 2.0 * NEAR * size);
    let met: Vec<usize> = visits.iter().filter(|_| turns).map(nearest).collect();
    ((!met.is_empty() && all.len() >= MANY) || (met.len() >= 2 && 2 * met.len() >= all.len()))
        .then_some(Visits { met, all })
}

/// A torque that turns back at zero. A few visits are chance, unless a model explains the torque better with the sign that it would have
/// lost.
fn unsigned(view: &View, joint: usize, tau: &[f64], visits: &Visits, robot: Option<&Robot>) -> Result<Option<Finding>> {
    // The view is at even steps. Between two samples a torque may cross zero and meet it at none.
    let at = |samples: &[usize]| -> Vec<usize> {
        samples.iter().map(|sample| sample * view.log.samples() / tau.len()).collect()
    };
    let mut turns = vec![at(&visits.met), at(&visits.all)];
    turns.dedup();
    if visits.met.len() < OFTEN && !descriptions::is_explained_with_signs(view.log, robot, joint, &turns)? {
        return Ok(None);
    }
    let what = if extremes(tau).0 >= 0.0 { "never negative" } else { "never positive" };
    let text = format!(
        "the torque is {what} but comes to zero {} times and turns back: its sign was lost; log it with its sign",
        visits.all.len()
    );
    Ok(Some(Finding::new(Kind::UnsignedTorque, Severity::Warning, view.place("tau", joint), text)))
}

/// The finding on a torque that lost its sign, as the model shows, where it does not turn back at zero often enough to show it by itself.
pub(super) fn by_model(joint: usize, name: &str, tau: &[f64]) -> Finding {
    let what = if extremes(tau).0 >= 0.0 { "never negative" } else { "never positive" };
    let text = format!(
        "the torque is {what}, although that of the model changes its sign and explains it so: its sign was lost; log it with its sign"
    );
    Finding::new(Kind::UnsignedTorque, Severity::Warning, format!("tau{} ({name})", joint + 1), text)
}

/// Whether a torque comes to zero and leaves it on straight lines, from the parts in which it is within `near` of it.
fn have_kinks(parts: &[&[f64]], near: f64) -> bool {
    let inner = |part: &&[f64]| part.iter().filter(|value| value.abs() < 0.25 * near).count();
    let within: usize = parts.iter().map(|part| part.len()).sum();
    let closer: usize = parts.iter().map(inner).sum();
    closer <= parts.len() || within as f64 > KINK * closer as f64
}

/// Joints whose torque lost its sign, as found: such a torque gives no evidence on signs and gravity.
pub(super) fn without_sign(view: &View, found: &[Finding]) -> Vec<usize> {
    let unsigned = || found.iter().filter(|finding| finding.kind == Kind::UnsignedTorque);
    let of = |joint: &usize| unsigned().any(|f| f.place == view.place("tau", *joint) || f.place == all_torques(view));
    (0..view.dof()).filter(of).collect()
}

/// The place of a finding about the torques of all joints.
fn all_torques(view: &View) -> String {
    format!("tau1 .. tau{}", view.dof())
}

/// Torques none of which is ever negative (or positive), although two come to zero and turn back, or, of few digits, each comes to
/// zero again and again: one joint may be loaded so, all of them are not.
fn all_unsigned(view: &View, logged: &Channels, turned_back: usize) -> Option<Finding> {
    let changing: Vec<&[f64]> = changing(logged).collect();
    let visits = |tau: &[f64]| runs(tau).filter(|&(start, _)| tau[start] == 0.0).count();
    let one_sided = |tau: &&[f64]| {
        let (low, high) = extremes(tau);
        low >= 0.0 || high <= 0.0
    };
    let visited = || changing.iter().all(|tau| visits(tau) >= MANY);
    (changing.len() > 1 && changing.iter().all(one_sided) && (turned_back > 1 || visited())).then(|| {
        let text = "no torque ever changes its sign, although they come to zero again and again: the signs were lost (a load \
                    without direction, or an absolute value); log the torques with their signs";
        Finding::new(Kind::UnsignedTorque, Severity::Fatal, all_torques(view), text)
    })
}

/// Torques that change, which a log may lack of some joints.
fn changing(tau: &Channels) -> impl Iterator<Item = &[f64]> {
    tau.iter().filter(|tau| tau.iter().any(|v| *v != tau[0] && v.is_finite()))
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
