//! The judgement of a description: without the bodies of the arm first, then with them; then the scale of the torques.

use super::bodies::{at_rest, compensation, currents};
use super::change::{Change, Description};
use super::compare::compare;
use super::fitting::{Fit, Friction, Physics, Rows};
use super::jumps;
use super::known::Known;
use super::scales::{OtherScales, Scales};
use super::search::{Found, Outcome, are_of_bodies, is_beyond_position, opposite_zeros, search, settled};
use super::shares::ALIKE;
use super::sizes::{bounds, effort, spread};
use super::tried::Tried;
use super::verdict::{Shown, Spread, Verdict};
use super::weights::{self, Weighed};
use crate::quality::view::View;
use crate::robot::Robot;
use nalgebra::Vector3;

/// A log by itself allows to go on with a changed description where it lasts so long, s; a shorter one needs a second log:
/// one short motion is one observation, whatever its blocks show.
const LONG_ENOUGH_S: f64 = 30.0;

/// Torques of a rigid-body model are explained by one to this share on half of the joints: the noise of encoders makes accelerations,
/// and so the model's torque, uncertain by some per cent. Torques of the others may be as small as their noise.
const RIGID: f64 = 0.15;

/// Friction below this share of a torque is none, where it is certain to be below the second: drives have ten times as much.
const FRICTIONLESS: f64 = 0.005;
const CERTAIN: f64 = 0.02;

/// Standard errors within which friction is none on each of several joints, and those that make a bound certain on one.
const WITHIN: f64 = 3.0;
const ERRORS: f64 = 2.0;

/// Whether all torques are those of a rigid-body model without any friction, under the description that holds.
pub(crate) fn is_modelled(views: &[&View], robot: Option<&Robot>, description: Option<&Description>) -> bool {
    let friction = || {
        let robot = robot?;
        let rows = Rows::new(views, Some(robot))?;
        let as_given = Description::as_given(robot.dof(), robot.gravity);
        let description = description.unwrap_or(&as_given);
        let tables = Physics::free(robot).tables(&rows, description);
        let fit = Fit::new(&tables, &rows, description);
        // Standard errors take many fits.
        let residuals = fit.residuals()?;
        if is_rigid(&residuals) { fit.friction() } else { None }
    };
    friction().is_some_and(|friction| is_frictionless(&friction))
}

/// Whether a rigid-body model explains torques, of which these shares remain.
fn is_rigid(residuals: &[f64]) -> bool {
    let explained = residuals.iter().filter(|left| **left < RIGID).count();
    2 * explained >= residuals.len().max(1)
}

/// Whether no joint has friction, and half of them would show it.
fn is_frictionless(friction: &[Friction]) -> bool {
    let none = |f: &Friction| f.share.abs() < (WITHIN * f.error).max(FRICTIONLESS);
    let certain = |f: &&Friction| f.share.abs() + ERRORS * f.error < CERTAIN;
    friction.iter().all(none) && 2 * friction.iter().filter(certain).count() >= friction.len().max(1)
}

/// Standard errors that make it certain that friction would drive a joint.
const ERRORS_OF_SIGN: f64 = 5.0;

/// Seconds of a log, to within half a step: each row stands for one, so that 3750 rows at 125 Hz are 30 s.
fn lasts(rows: usize, period: f64) -> f64 {
    (rows as f64 + 0.5) * period
}

/// What is wrong with the description of some logs of one arm.
pub(crate) struct Judged {
    /// What explains the logs clearly better.
    pub verdict: Option<Verdict>,
    /// Gravity of a base that is tilted a little, in base coordinates, m/s2, where nothing else is found.
    pub tilt: Option<Vector3<f64>>,
    /// Shares of the torques that stay unexplained along the motion and at rest, where they are those of gravity alone. Nothing else is looked
    /// for then.
    pub gravity_alone: Option<[f64; 2]>,
}

/// Judges the description of some logs of one arm.
pub(crate) fn judge(views: &[&View], robot: Option<&Robot>) -> Judged {
    if let Some(shares) = robot.and_then(|robot| at_rest::judged(views, robot)) {
        return Judged { verdict: None, tilt: None, gravity_alone: Some(shares) };
    }
    let mut tilt = None;
    let of_currents =
        robot.filter(|_| views.iter().any(|view| view.is_current)).and_then(|robot| of_currents(views, robot));
    let mut verdict = of_currents.or_else(|| changed(views, robot, &mut tilt));
    if let (Some(verdict), Some(robot)) = (&mut verdict, robot)
        && !verdict.factors.is_empty()
        && let Some(rows) = Rows::new(views, Some(robot))
    {
        verdict.factor_bounds = bounds::of_factors(robot, &rows, &verdict.description, &verdict.factors);
    }
    Judged { tilt: tilt.filter(|_| verdict.is_none()), verdict, gravity_alone: None }
}

/// The verdict on motor currents: the torque constants of the described bodies, and what is wrong besides.
fn of_currents(views: &[&View], robot: &Robot) -> Option<Verdict> {
    let rows = Rows::new(views, Some(robot))?;
    let start = Description::as_given(robot.dof(), robot.gravity);
    let currents::Currents { before, after, factors } =
        currents::constants(robot, &rows, &jumps::with_motion(views), &start)?;
    Some(Verdict { currents: true, ..untraced_verdict(&before, after, factors) })
}

/// What explains the logs clearly better; `tilt` is set where a search finds a base that is tilted a little.
fn changed(views: &[&View], robot: Option<&Robot>, tilt: &mut Option<Vector3<f64>>) -> Option<Verdict> {
    let rows = Rows::new(views, robot)?;
    let dof = rows.measured.len();
    let gravity = robot.map_or(Vector3::zeros(), |robot| robot.gravity);
    let start = Description::as_given(dof, gravity);
    let seconds: f64 = views.iter().map(|view| lasts(view.log.samples(), view.period)).sum();
    let bodies = robot.and_then(Physics::described);
    // Another arm is described by other motions, as other joints or zeros: the described bodies must be those of the torques then.
    let alike = |found: &Found| {
        let under = |bodies: &Physics| Tried::new(bodies, &rows, found.best.description.clone());
        bodies.as_ref().map(|bodies| under(bodies).is_some_and(|tried| tried.share() < ALIKE))
    };
    let separate = |found: &Found| {
        let gain = |next: &Tried| compare(&next.evaluation, &found.best.evaluation, &rows.log);
        found.next.as_ref().is_none_or(|next| gain(next).is_some_and(|gain| gain.is_large(1)))
    };
    // Joints that nobody placed turn gravity against the arm that they carry, as another mounting does.
    let assumed = |found: &Found| -> Vec<String> {
        let turned = |tried: &Tried| tried.description.gravity != gravity && tried.description.gravity.norm() > 0.0;
        let turns = std::iter::once(&found.best).chain(&found.rivals).any(turned);
        robot.filter(|_| turns).map_or(Vec::new(), |robot| robot.assumed.clone())
    };
    let confirmed = |found: &Found| {
        let description = &found.best.description;
        let moved = (0..dof).any(|joint| description.changes_position_of(joint));
        let asked = moved || description.gravity != gravity;
        let alike = asked.then(|| alike(found)).flatten();
        let agree = match views.len() {
            1 => seconds >= LONG_ENOUGH_S,
            _ => found.gain.least_of_logs > 0.0,
        };
        let replicated = agree && found.is_determined && (!moved || (alike == Some(true) && separate(found)));
        let without_bodies = moved && bodies.is_none();
        Confirmed { replicated, unlike_bodies: alike == Some(false), without_bodies, assumed: assumed(found) }
    };
    let with_motion = jumps::with_motion(views);
    let Some(robot) = robot else {
        let outcome = search(Known::alone(&Physics::Alone), &rows, &with_motion, start)?;
        return verdict(outcome, None, |_| Confirmed::default());
    };
    let judged = |known: Known, bodies: Option<&Physics>, outcome: Outcome| {
        let outcome = settled(known, bodies, &rows, outcome);
        let best = outcome.found.as_ref().map(|found| &found.best);
        let spread = best.and_then(|best| spread::around(known.physics, &rows, best, gravity));
        verdict(outcome, spread, confirmed)
    };
    let free = Physics::free(robot);
    let known = Known { physics: &free, other: bodies.as_ref() };
    let outcome = search(known, &rows, &with_motion, start.clone())?;
    *tilt = outcome.tilt;
    if outcome.found.is_none()
        && let Some(bodies) = &bodies
        && let Some([before, after]) = compensation::judged(robot, bodies, &rows, &start)
    {
        return Some(untraced_verdict(&before, after, Vec::new()));
    }
    let found = outcome.found.as_ref().map(|found| &found.best);
    let of_bodies = |bodies| Scales { robot, free: &free, bodies, rows: &rows, with_motion: &with_motion };
    let scales = bodies.as_ref().map(of_bodies);
    let scaled = scales.as_ref().and_then(|scales| scales.judge(&outcome.start, found));
    // With a factor free bodies looked for nothing else; and what they take up, those described may show.
    let with_more = |first: Verdict| {
        let (Some(bodies), true) = (bodies.as_ref(), first.alternatives.is_empty() && !first.unlike_bodies) else {
            return first;
        };
        let by_bodies = Known { physics: bodies, other: Some(&free) };
        let by_free = first.description.scaled().next().map(|_| known);
        let more = by_free.into_iter().chain([by_bodies]).find_map(|known| {
            let outcome = search(known, &rows, &with_motion, first.description.clone())?;
            let found = outcome.found.as_ref()?;
            let of_described = std::ptr::eq(known.physics, bodies);
            let is_sure = !of_described || are_of_bodies((robot, bodies, &free), &rows, &start, &found.best);
            is_sure.then(|| judged(known, Some(bodies), outcome))?
        });
        let Some(more) = more else { return first };
        let found = together(first, more);
        // What hid a factor is known now.
        match scales.as_ref().and_then(|scales| scales.again(&start, &found.description)) {
            Some(scales) => rescaled(found, scales),
            None => found,
        }
    };
    if let Some(OtherScales { before, after, factors, alternatives }) = scaled {
        return Some(with_more(Verdict { alternatives, ..untraced_verdict(&before, after, factors) }));
    }
    let described = || bodies.as_ref().and_then(|bodies| Tried::new(bodies, &rows, start.clone()));
    tracing::debug!(free = ?outcome.start.evaluation.unexplained, share = outcome.start.share(), described = ?described().map(|d| (d.share(), d.evaluation.unexplained)), "shares");
    if outcome.found.is_some() {
        return judged(known, bodies.as_ref(), outcome).map(with_more);
    }
    if let Some(bodies) = &bodies {
        let known = Known { physics: bodies, other: Some(&free) };
        let outcome = search(known, &rows, &with_motion, start.clone())?;
        *tilt = tilt.or(outcome.tilt);
        let trusted = |found: &Found| {
            are_of_bodies((robot, bodies, &free), &rows, &start, &found.best)
                && is_beyond_position(robot, &rows, &found.best)
        };
        if outcome.found.as_ref().is_some_and(trusted) {
            let first = judged(known, Some(bodies), outcome);
            let has_factors = |verdict: &Verdict| verdict.description.scaled().next().is_some();
            return first.map(|first| if has_factors(&first) { with_more(first) } else { first });
        }
        if let Some(found) = opposite_zeros(bodies, &free, &rows, &outcome.start).filter(trusted) {
            return judged(known, Some(bodies), Outcome { found: Some(found), ..outcome });
        }
        if let Some(verdict) = of_drives(bodies, &rows, &start) {
            return Some(verdict);
        }
    }
    of_friction(&free, &rows, &start, &jumps::against_motion(views))
}

/// The verdict on torques whose friction would drive the joint: those of last joints are little else, and a jog has few blocks in which one
/// moves. `against_motion` are the torques that jump against the motion at reversals.
fn of_friction(free: &Physics, rows: &Rows, start: &Description, against_motion: &[bool]) -> Option<Verdict> {
    // Standard errors take many fits.
    if !against_motion.contains(&true) {
        return None;
    }
    let friction = Fit::new(&free.tables(rows, start), rows, start).friction()?;
    let drives =
        |f: &&Friction| against_motion[f.joint] && f.share < -CERTAIN && f.share + ERRORS_OF_SIGN * f.error < 0.0;
    let joints: Vec<usize> = friction.iter().filter(drives).map(|f| f.joint).collect();
    if joints.is_empty() {
        return None;
    }
    let with = |change: fn(usize) -> Change| {
        let changed = joints.iter().fold(start.clone(), |description, &joint| description.with(change(joint)));
        Tried::new(free, rows, changed)
    };
    let [before, after] = [Tried::new(free, rows, start.clone())?, with(Change::TorqueSign)?];
    let left = |tried: &Tried, joint: usize| tried.evaluation.unexplained[joint].unwrap_or(f64::INFINITY);
    if joints.iter().any(|&joint| left(&after, joint) >= left(&before, joint)) {
        return None;
    }
    let other = with(Change::PositionSign).filter(|_| joints.len() == 1);
    let alternatives = other.map(Tried::alternative).into_iter().collect();
    Some(Verdict { alternatives, ..untraced_verdict(&before, after, Vec::new()) })
}

/// The verdict on a description under which a drive would do what none does, though it explains the torques.
fn of_drives(bodies: &Physics, rows: &Rows, start: &Description) -> Option<Verdict> {
    let of_all = |before: &Tried, after: Vec<Tried>, shown: Shown| {
        let mut after = after.into_iter();
        let best = after.next()?;
        let alternatives = after.map(Tried::alternative).collect();
        Some(Verdict { alternatives, shown: Some(shown), ..untraced_verdict(before, best, Vec::new()) })
    };
    if let Some(Weighed { before, after, shown }) = weights::weighed(bodies, rows, start) {
        return of_all(&before, after, shown);
    }
    let (description, shown) = effort::of_one_joint(bodies, rows, start)?;
    let [before, after] = [start.clone(), description].map(|own| Tried::new(bodies, rows, own));
    of_all(&before?, vec![after?], shown)
}

/// The verdict on a description to which described bodies add changes that free ones do not show.
fn together(first: Verdict, more: Verdict) -> Verdict {
    let [before, _] = first.each;
    let [_, after] = more.each;
    Verdict {
        before: first.before,
        each: [before, after],
        factors: first.factors,
        currents: first.currents,
        by_bodies: first.by_bodies || more.by_bodies,
        spread: more.spread.or(first.spread),
        assumed: if first.assumed.is_empty() { more.assumed } else { first.assumed },
        without_bodies: first.without_bodies,
        beyond_doubt: first.beyond_doubt && more.beyond_doubt,
        ..more
    }
}

/// The verdict on changes whose factors are others.
fn rescaled(found: Verdict, scales: OtherScales) -> Verdict {
    let [before, _] = found.each;
    Verdict {
        after: scales.after.share(),
        each: [before, scales.after.evaluation.unexplained],
        description: scales.after.description,
        factors: scales.factors,
        alternatives: Vec::new(),
        ..found
    }
}

/// The verdict on torques of another scale, and on others that the logs do not trace to a cause.
fn untraced_verdict(before: &Tried, after: Tried, factors: Vec<Option<f64>>) -> Verdict {
    Verdict {
        before: before.share(),
        after: after.share(),
        each: [before.evaluation.unexplained.clone(), after.evaluation.unexplained],
        alternatives: Vec::new(),
        next: None,
        shown: None,
        description: after.description,
        factors,
        currents: false,
        factor_bounds: Vec::new(),
        by_bodies: false,
        spread: None,
        assumed: Vec::new(),
        unlike_bodies: false,
        without_bodies: false,
        beyond_doubt: false,
    }
}

/// What confirms the best of a search beyond its gain.
#[derive(Default)]
struct Confirmed {
    /// The logs are long enough or agree, and the described bodies do where positions are changed.
    replicated: bool,
    /// The described bodies contradict it.
    unlike_bodies: bool,
    /// Motions are changed, and no bodies are described that could exclude another arm.
    without_bodies: bool,
    /// Joints whose assumed positions are as good a cause.
    assumed: Vec<String>,
}

fn verdict(outcome: Outcome, spread: Option<Spread>, confirmed: impl Fn(&Found) -> Confirmed) -> Option<Verdict> {
    let Outcome { start, found, .. } = outcome;
    let found = found?;
    // From what a factor comes the logs cannot show.
    let scaled = found.best.description.scaled().next();
    let Confirmed { replicated, unlike_bodies, without_bodies, assumed } = confirmed(&found);
    let is_known = spread.as_ref().is_none_or(Spread::is_narrow);
    let beyond_doubt = found.rivals.is_empty() && scaled.is_none() && replicated && assumed.is_empty() && is_known;
    Some(Verdict {
        before: start.share(),
        after: found.best.share(),
        each: [start.evaluation.unexplained, found.best.evaluation.unexplained.clone()],
        alternatives: found.rivals.into_iter().map(Tried::alternative).collect(),
        next: found.next.map(Tried::alternative),
        shown: None,
        description: found.best.description,
        factors: Vec::new(),
        currents: false,
        factor_bounds: Vec::new(),
        by_bodies: !found.is_determined,
        spread,
        assumed,
        unlike_bodies,
        without_bodies,
        beyond_doubt,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_a_log_lasts_a_step() {
        assert!(lasts(3750, 1.0 / 125.0) >= LONG_ENOUGH_S && lasts(3749, 1.0 / 125.0) < LONG_ENOUGH_S);
    }

    #[test]
    fn torques_are_modelled_where_no_joint_has_friction_and_half_would_show_it() {
        assert!(is_rigid(&[0.14, 1.0]) && !is_rigid(&[0.16, 1.0]) && !is_rigid(&[0.01, 0.2, 0.2]) && !is_rigid(&[]));
        let of = |each: &[(f64, f64)]| {
            let friction: Vec<Friction> =
                each.iter().map(|&(share, error)| Friction { joint: 0, share, error }).collect();
            is_frictionless(&friction)
        };
        assert!(of(&[(0.001, 0.009), (0.0, 0.05)]) && !of(&[(0.001, 0.01), (0.0, 0.05)]));
        // Friction beyond its error, or too small to be any.
        assert!(of(&[(0.0049, 1e-4), (-0.0049, 1e-4)]) && !of(&[(0.0051, 1e-4), (0.0, 1e-4)]));
        assert!(of(&[(0.0, 1e-4), (0.14, 0.05)]) && !of(&[(0.0, 1e-4), (0.16, 0.05)]) && !of(&[]));
    }
}
