//! Logged velocity against the derivative of logged position: sign, unit, order of the columns, delay.

use super::finding::{Finding, Kind, Severity};
use super::statistics::correlation;
use super::view::View;
use crate::channels::Channels;
use crate::linear::root_mean_square;
use std::f64::consts::PI;

/// Known factors between velocities in other units, with the advice.
const FACTORS: [(f64, &str); 5] = [
    (180.0 / PI, "it is in deg/s where the position is in rad: convert one of them"),
    (PI / 180.0, "the position is in deg where the velocity is in rad/s: convert the position"),
    (30.0 / PI, "it is in rpm: convert it to rad/s"),
    (1e3, "it is in mrad/s or mm/s: convert it to rad/s or m/s"),
    (1e-3, "the position is in mm where the velocity is in m/s: convert the position"),
];

/// Relative deviation from a known factor.
const TOLERANCE: f64 = 0.1;

/// Drives of arms have larger gear ratios than this; a clock is not wrong by more.
const SLOWEST_GEAR: f64 = 5.0;

/// Part of the velocity that the derivative of position may leave unexplained.
const UNEXPLAINED: f64 = 0.4;

/// Findings about the velocity columns, and the factor by which the clock is wrong; none where there are none.
pub(super) fn findings(view: &View) -> (Vec<Finding>, Option<f64>) {
    let Some(logged) = &view.log.qd else { return (Vec::new(), None) };
    let mut out = Vec::new();
    let compared = |joint| view.log.has_velocity(joint) && root_mean_square(view.qd.channel(joint)) > view.band[joint];
    let moving: Vec<bool> = (0..view.dof()).map(compared).collect();
    let clock = clock_factor(view, logged, &moving);
    out.extend(clock.map(|factor| clock_finding(factor, moving.iter().filter(|moving| **moving).count())));
    for joint in (0..view.dof()).filter(|&joint| moving[joint]) {
        let (own, column) = (view.qd.channel(joint), logged.channel(joint));
        let place = view.place("qd", joint);
        let like = correlation(own, column);
        if like.abs() < 0.7
            && let Some(other) = twin(view, column, joint)
        {
            let text = format!(
                "the velocity follows the position of {}: the columns are swapped; put them in order",
                view.log.joints[other]
            );
            out.push(Finding::new(Kind::Swapped, Severity::Warning, place, text));
            continue;
        }
        let (slope, unexplained) = slope(own, column);
        if unexplained > UNEXPLAINED {
            let text = format!(
                "{:.0} % of the velocity is not the derivative of the position; check which sensors both come from",
                100.0 * unexplained
            );
            out.push(Finding::new(Kind::VelocityMismatch, Severity::Warning, place, text));
            continue;
        }
        if slope < 0.0 {
            let text = "the velocity has the opposite sign of the change of position; turn one of them round";
            out.push(Finding::new(Kind::VelocitySign, Severity::Warning, place.clone(), text));
        }
        let factor = slope.abs();
        if clock.is_none() && (factor - 1.0).abs() > TOLERANCE {
            let known = FACTORS.iter().find(|(known, _)| (factor / known - 1.0).abs() < TOLERANCE);
            let advice = known.map_or("is it at the motor side of the gear? Convert it to the joint side", |(_, a)| a);
            let text = format!("the velocity is {factor:.4} times the change of position per second; {advice}");
            out.push(Finding::new(Kind::VelocityUnit, Severity::Warning, place.clone(), text));
        }
        if let Some(lag) = delay(own, column, view.period) {
            let text = format!(
                "the velocity {} the change of position by {:.1} ms: it went through a filter; take the velocity from the \
                 position",
                if lag > 0.0 { "comes behind" } else { "comes ahead of" },
                1e3 * lag.abs()
            );
            out.push(Finding::new(Kind::VelocityDelay, Severity::Note, place, text));
        }
    }
    (out, clock)
}

/// Whether every logged velocity is a derivative in degrees or mm that is given in SI units.
pub(super) fn is_si(view: &View) -> bool {
    let Some(logged) = &view.log.qd else { return false };
    let moving = |&joint: &usize| view.log.has_velocity(joint) && view.band[joint].is_finite();
    let joints: Vec<usize> = (0..view.dof()).filter(moving).collect();
    let si = |&joint: &usize| {
        let (slope, unexplained) = slope(view.qd.channel(joint), logged.channel(joint));
        let known = [PI / 180.0, 1e-3].iter().any(|known| (slope.abs() / known - 1.0).abs() < TOLERANCE);
        known && unexplained < UNEXPLAINED
    };
    !joints.is_empty() && joints.iter().all(si)
}

/// Slope and unexplained part of a logged velocity over the change of position.
fn slope(own: &[f64], column: &[f64]) -> (f64, f64) {
    let slope = own.iter().zip(column).map(|(v, x)| v * x).sum::<f64>() / own.iter().map(|v| v * v).sum::<f64>();
    let rest: Vec<f64> = own.iter().zip(column).map(|(v, x)| x - slope * v).collect();
    (slope, root_mean_square(&rest) / root_mean_square(column).max(f64::MIN_POSITIVE))
}

/// True seconds per second of the clock, where the change of position per second differs from the velocities by a factor
/// that all joints share and that neither a unit nor a gear explains.
fn clock_factor(view: &View, logged: &Channels, moving: &[bool]) -> Option<f64> {
    let each: Vec<(f64, f64)> = (0..view.dof())
        .filter(|&joint| moving[joint])
        .map(|joint| slope(view.qd.channel(joint), logged.channel(joint)))
        .collect();
    let sound = |(slope, rest): &(f64, f64)| *slope > 0.0 && *rest < UNEXPLAINED;
    if each.is_empty() || !each.iter().all(sound) {
        return None;
    }
    let mut factors: Vec<f64> = (0..view.dof())
        .filter(|&joint| moving[joint])
        .map(|joint| root_mean_square(view.qd.channel(joint)) / root_mean_square(logged.channel(joint)))
        .collect();
    factors.sort_by(f64::total_cmp);
    let median = factors[factors.len() / 2];
    let shared = factors.iter().all(|factor| (factor / median - 1.0).abs() < TOLERANCE);
    let possible = (1.0 / SLOWEST_GEAR..SLOWEST_GEAR).contains(&median) && (median - 1.0).abs() > TOLERANCE;
    (shared && possible).then_some(median)
}

/// Times of a clock that runs wrong by a factor as true ones.
pub(super) fn in_true_time(time: &mut [f64], factor: f64) {
    time.iter_mut().for_each(|t| *t *= factor);
}

fn clock_finding(factor: f64, joints: usize) -> Finding {
    let others = match joints {
        1 => "; a velocity in another unit is the other cause, which a log of one joint does not separate",
        _ => "; neither a unit nor a gear gives one factor to all joints",
    };
    let text = format!(
        "the change of position per second is {factor:.3} times the logged velocity on {} that moves: the clock is wrong by \
         this factor{others}. Set [units] time_factor = {factor:.3} in a dataset, or log true time stamps",
        if joints == 1 { "the one joint" } else { "every joint" },
    );
    Finding::new(Kind::ClockFactor, Severity::Warning, "t", text)
}

/// Another joint whose change of position the column follows.
fn twin(view: &View, column: &[f64], joint: usize) -> Option<usize> {
    (0..view.dof()).filter(|&k| k != joint).find(|&k| correlation(view.qd.channel(k), column).abs() > 0.95)
}

/// By how much the column comes behind the derivative, s; None within a sample and a half.
fn delay(own: &[f64], column: &[f64], period: f64) -> Option<f64> {
    let reach = ((0.05 / period) as usize).clamp(3, 60).min(own.len() / 4);
    let table = Channels::from_vectors(&[own.to_vec(), column.to_vec()]);
    let inner = reach..own.len() - reach;
    let like: Vec<f64> = (0..=2 * reach)
        .map(|lag| {
            let shifted = &table.channel(1)[inner.start + lag - reach..inner.end + lag - reach];
            correlation(&table.channel(0)[inner.clone()], shifted).abs()
        })
        .collect();
    let best = (0..like.len()).max_by(|&a, &b| like[a].total_cmp(&like[b]))?;
    let lag = best as f64 - reach as f64 + vertex(&like, best);
    (lag.abs() > 1.5).then_some(lag * period)
}

/// Place of the extremum of a parabola through a value and its neighbours, in steps from it.
pub(super) fn vertex(values: &[f64], at: usize) -> f64 {
    if at == 0 || at + 1 >= values.len() {
        return 0.0;
    }
    let (a, b, c) = (values[at - 1], values[at], values[at + 1]);
    let bend = a - 2.0 * b + c;
    if bend == 0.0 { 0.0 } else { (0.5 * (a - c) / bend).clamp(-0.5, 0.5) }
}
