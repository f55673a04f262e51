//! Logged velocity against the derivative of logged position: sign, unit, order of the columns, delay, and the clock.

use super::finding::{Finding, Kind, Severity};
use super::places::places;
use super::statistics::correlation;
use super::view::View;
use crate::channels::Channels;
use crate::linear::root_mean_square;
use crate::robot::Robot;
use crate::signal::size_quantile;
use std::f64::consts::{PI, TAU};

/// Which signal is in another unit where velocity and change of position per second differ by a factor.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Other {
    Position,
    Velocity,
}

/// Known factors between velocities and the change of position per second, with what is in another unit and the advice.
const FACTORS: [(f64, Other, &str); 10] = [
    (180.0 / PI, Other::Velocity, "it is in deg/s where the position is in rad: convert one of them"),
    (PI / 180.0, Other::Position, "the position is in deg where the velocity is in rad/s: convert the position"),
    (30.0 / PI, Other::Velocity, "it is in rpm: convert it to rad/s"),
    (
        PI / 30.0,
        Other::Velocity,
        "it was taken for rpm, and is in rad/s: undo the conversion, or take the velocity from the position",
    ),
    (1e3, Other::Velocity, "it is in mrad/s or mm/s: convert it to rad/s or m/s"),
    (
        1e-3,
        Other::Position,
        "the position is in mrad or mm where the velocity is in rad/s or m/s: convert the position",
    ),
    (1e-6, Other::Position, "the position is in um where the velocity is in m/s: convert the position"),
    (TAU, Other::Position, "the position is in turns where the velocity is in rad/s: convert the position"),
    (1.0 / TAU, Other::Velocity, "it is in turns per second: convert it to rad/s"),
    (
        60.0,
        Other::Velocity,
        "it is in rpm where the position is in turns, or at the motor side of a gear of 60: convert it",
    ),
];

/// Advice on a velocity that is larger or smaller than the change of position by a factor of no unit.
const AT_MOTOR: &str = "is it at the motor side of the gear? Convert it to the joint side";
const POSITION_AT_MOTOR: &str = "is the position at the motor side of the gear, or the clock wrong? Convert it to the joint side, or set \
                                 [units] time_factor in a dataset";

/// Relative deviation from a known factor.
const TOLERANCE: f64 = 0.1;

/// Drives of arms have larger gear ratios than this: a factor below it is that of the clock.
const SLOWEST_GEAR: f64 = 5.0;

/// Rates at which arms are logged, Hz. A larger factor is that of the clock where true time gives such a rate.
const LOGGED_HZ: [f64; 2] = [10.0, 10_000.0];

/// Speed of a joint without a limit, rad/s or m/s, and how many times a joint may exceed its own: velocities at the motors are faster.
const FASTEST: f64 = 10.0;
const NOT_FASTER: f64 = 1.5;

/// Relative deviation up to which a factor that all joints share is that of a unit.
const OF_UNIT: f64 = 0.03;

/// Units of time, in seconds, for one of which another was taken, and relative deviation of a factor from one of them.
const TIMES: [f64; 6] = [1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9];
const OF_TIME: f64 = 0.02;

/// Relative deviation up to which the factors of several velocities are one.
const SHARED: f64 = 0.02;

/// A delay leaves less than this part of the mean square that the velocity without one leaves.
const DELAY_EXPLAINS: f64 = 0.5;

/// Part of the velocity that the derivative of position may leave unexplained.
const UNEXPLAINED: f64 = 0.4;

/// Advice on velocities of a factor of no unit, where the torques show that the clock is right.
const VELOCITY_WRONG: &str = "the torques belong to the positions by this clock, so that the velocity is what is wrong: convert it, or leave \
                              it out (it is then the derivative of the position)";

/// What velocities and torques show of the clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Clock {
    /// Nothing shows that it is wrong.
    Right,
    /// True seconds per second of the clock, by the velocities.
    Wrong(f64),
    /// Velocities show a factor, which the torques deny.
    RightByTorques,
}

impl Clock {
    /// What velocities alone show of it.
    pub(super) fn of(view: &View, robot: Option<&Robot>) -> Clock {
        clock_factor(view, robot).map_or(Clock::Right, Clock::Wrong)
    }

    /// True seconds per second, where that is not one.
    pub(super) fn factor(self) -> Option<f64> {
        match self {
            Clock::Wrong(factor) => Some(factor),
            Clock::Right | Clock::RightByTorques => None,
        }
    }
}

/// Joints that move and have a velocity.
fn moving(view: &View) -> Vec<usize> {
    let moves = |joint: &usize| {
        let band = view.band[*joint];
        view.log.has_velocity(*joint) && root_mean_square(view.qd.channel(*joint)) > band
    };
    (0..view.dof()).filter(moves).collect()
}

/// Findings about the velocity columns of joints whose position can be compared, and about the clock that they show.
pub(super) fn findings(view: &View, clock: Clock, incomparable: &[usize]) -> Vec<Finding> {
    let Some(logged) = &view.log.qd else { return Vec::new() };
    let mut out = Vec::new();
    let moving = moving(view);
    out.extend(clock.factor().map(|factor| clock_finding(factor, moving.len())));
    let mut factors: Vec<(usize, f64, Other, &str)> = Vec::new();
    for joint in moving.into_iter().filter(|joint| !incomparable.contains(joint)) {
        let (own, column) = (view.qd.channel(joint), logged.channel(joint));
        let place = view.place("qd", joint);
        let like = correlation(own, column);
        if like.abs() < 0.7
            && let Some(other) = twin(view, column, joint)
        {
            let text = format!(
                "the velocity follows the position of {}: the columns are swapped; exchange them",
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
            let text = "the velocity has the opposite sign of the change of position; reverse the sign of one of them";
            out.push(Finding::new(Kind::VelocitySign, Severity::Warning, place.clone(), text));
        }
        let factor = slope.abs();
        if clock.factor().is_none() && (factor - 1.0).abs() > TOLERANCE {
            let off = |known: f64| (factor / known - 1.0).abs();
            let nearest = FACTORS.iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0)));
            let known = nearest.filter(|(known, _, _)| off(*known) < TOLERANCE);
            let gear = match clock {
                Clock::RightByTorques => VELOCITY_WRONG,
                _ if factor > 1.0 => AT_MOTOR,
                _ => POSITION_AT_MOTOR,
            };
            let advice = known.map_or(gear, |(_, _, advice)| advice);
            // A gear may be near the factor of a unit.
            let exact = known.filter(|(known, _, _)| off(*known) < OF_UNIT);
            factors.push((joint, factor, exact.map_or(Other::Velocity, |(_, other, _)| *other), advice));
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
    out.extend(of_factors(view, &factors));
    out
}

/// Findings about velocities that are some times the change of position per second, by joint: one where all share it.
fn of_factors(view: &View, factors: &[(usize, f64, Other, &str)]) -> Vec<Finding> {
    let finding = |joints: &[usize], factor: f64, other: Other, advice: &str| {
        let text = format!("the velocity is {factor:.4} times the change of position per second; {advice}");
        let (kind, column) = match other {
            Other::Position => (Kind::PositionUnit, "q"),
            Other::Velocity => (Kind::VelocityUnit, "qd"),
        };
        Finding::new(kind, Severity::Warning, places(view, column, joints), text)
    };
    match factors {
        [(_, factor, unit, advice), _, ..] if factors.iter().all(|other| (other.1 / factor - 1.0).abs() < SHARED) => {
            vec![finding(&factors.iter().map(|own| own.0).collect::<Vec<_>>(), *factor, *unit, advice)]
        }
        _ => factors.iter().map(|&(joint, factor, unit, advice)| finding(&[joint], factor, unit, advice)).collect(),
    }
}

/// Change of the position of a joint per second over its logged velocity, where they belong together.
pub(super) fn ratio(view: &View, joint: usize) -> Option<f64> {
    let logged = view.log.qd.as_ref().filter(|_| view.log.has_velocity(joint) && view.band[joint].is_finite())?;
    let (slope, unexplained) = slope(view.qd.channel(joint), logged.channel(joint));
    (unexplained < UNEXPLAINED && slope != 0.0).then(|| 1.0 / slope.abs())
}

/// Whether every logged velocity is in SI units, though the positions are in others, of which `in_si` make one of SI.
pub(super) fn is_si(view: &View, in_si: impl Fn(usize) -> Option<f64>) -> bool {
    let Some(logged) = &view.log.qd else { return false };
    let compared = |&joint: &usize| {
        let changes = root_mean_square(logged.channel(joint)) > 0.0;
        view.log.has_velocity(joint) && view.band[joint].is_finite() && changes && in_si(joint).is_some()
    };
    let joints: Vec<usize> = (0..view.dof()).filter(compared).collect();
    let si = |&joint: &usize| {
        let ratio = ratio(view, joint).zip(in_si(joint));
        ratio.is_some_and(|(ratio, in_si)| (ratio / in_si - 1.0).abs() < TOLERANCE)
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
pub(super) fn clock_factor(view: &View, robot: Option<&Robot>) -> Option<f64> {
    let logged = view.log.qd.as_ref()?;
    let moving = moving(view);
    let sound = |joint: &usize| {
        let (slope, rest) = slope(view.qd.channel(*joint), logged.channel(*joint));
        slope > 0.0 && rest < UNEXPLAINED
    };
    if moving.is_empty() || !moving.iter().all(sound) {
        return None;
    }
    let rms = |table: &Channels, joint: usize| root_mean_square(table.channel(joint));
    let mut factors: Vec<f64> = moving.iter().map(|&joint| rms(&view.qd, joint) / rms(logged, joint)).collect();
    factors.sort_by(f64::total_cmp);
    let median = factors[factors.len() / 2];
    let shared = factors.iter().all(|factor| (factor / median - 1.0).abs() < TOLERANCE);
    let fastest = |joint: usize| {
        let limit = robot.map_or(f64::INFINITY, |robot| robot.joints[joint].limits.velocity);
        NOT_FASTER * if limit.is_finite() && limit > 0.0 { limit } else { FASTEST }
    };
    let too_fast = |joint: &usize| size_quantile(logged.channel(*joint).iter().copied(), 0.99) > fastest(*joint);
    // Where positions change faster still, the velocities are the ones that a joint can rather have.
    let possible_speeds = || median > 1.0 || !moving.iter().any(too_fast);
    let possible =
        (median - 1.0).abs() > TOLERANCE && is_of_clock(median, 1.0 / view.period, moving.len(), possible_speeds);
    let time = TIMES.into_iter().find(|unit| (median / unit - 1.0).abs() < OF_TIME);
    (shared && possible).then(|| time.unwrap_or(median))
}

/// Whether true seconds per second of the clock, which so many joints share, are none of a unit or a gear. The log has so many rows per
/// second of the clock; `possible` are velocities that the joints can have.
fn is_of_clock(factor: f64, rate_hz: f64, joints: usize, possible: impl Fn() -> bool) -> bool {
    if (1.0 / SLOWEST_GEAR..SLOWEST_GEAR).contains(&factor) {
        return true;
    }
    let logged = |rate: f64| (LOGGED_HZ[0]..=LOGGED_HZ[1]).contains(&rate);
    let is_unit = FACTORS.iter().any(|(known, ..)| (1.0 / (factor * known) - 1.0).abs() < OF_UNIT);
    // Where a unit, or the gear of the only joint, is as good a reason, the clock must give a rate that no log has.
    let other_cause = is_unit || joints == 1;
    logged(rate_hz / factor) && !(other_cause && logged(rate_hz)) && possible()
}

/// Times of a clock that runs wrong by a factor as true ones.
pub(super) fn in_true_time(time: &mut [f64], factor: f64) {
    time.iter_mut().for_each(|t| *t *= factor);
}

/// A factor in its digits, as a number that a dataset may hold.
pub(super) fn digits(factor: f64) -> String {
    match factor {
        f if (0.01..1e3).contains(&f) => format!("{f:.3}"),
        f => format!("{f:.3e}"),
    }
}

fn clock_finding(factor: f64, joints: usize) -> Finding {
    let beyond = !(1.0 / SLOWEST_GEAR..SLOWEST_GEAR).contains(&factor);
    let others = match (joints, beyond) {
        (1, _) => "; a velocity in another unit is the other cause, which a log of one joint does not separate",
        (_, false) => "; neither a unit nor a gear gives one factor to all joints",
        (_, true) => {
            "; the other cause are gears of one ratio on all joints, with positions and velocities on both sides of them"
        }
    };
    let digits = digits(factor);
    let text = format!(
        "the change of position per second is {digits} times the logged velocity on {} that moves: the clock is wrong by \
         this factor{others}. Set [units] time_factor = {digits} in a dataset, or log true time stamps",
        if joints == 1 { "the one joint" } else { "every joint" },
    );
    Finding::new(Kind::ClockFactor, Severity::Warning, "t", text)
}

/// Another joint whose change of position the column follows.
fn twin(view: &View, column: &[f64], joint: usize) -> Option<usize> {
    (0..view.dof()).filter(|&k| k != joint).find(|&k| correlation(view.qd.channel(k), column).abs() > 0.95)
}

/// Longest delays that are looked for, at every sample and in one of several, s.
const REACH_S: [f64; 2] = [0.05, 0.25];

/// One of so many samples is taken for the longer delays.
const STEP: usize = 5;

/// By how much the column comes behind the derivative, s; None within a sample and a half.
fn delay(own: &[f64], column: &[f64], period: f64) -> Option<f64> {
    let thin = |signal: &[f64]| signal.iter().copied().step_by(STEP).collect::<Vec<f64>>();
    match delay_within(REACH_S[0], own, column, period) {
        Ok(delay) => delay,
        Err(Beyond) => delay_within(REACH_S[1], &thin(own), &thin(column), STEP as f64 * period).ok().flatten(),
    }
}

/// The best of all lags is the longest that is tried.
struct Beyond;

fn delay_within(reach_s: f64, own: &[f64], column: &[f64], period: f64) -> Result<Option<f64>, Beyond> {
    let reach = ((reach_s / period) as usize).clamp(3, 60).min(own.len() / 4);
    let table = Channels::from_vectors(&[own.to_vec(), column.to_vec()]);
    let inner = reach..own.len() - reach;
    let like: Vec<f64> = (0..=2 * reach)
        .map(|lag| {
            let shifted = &table.channel(1)[inner.start + lag - reach..inner.end + lag - reach];
            correlation(&table.channel(0)[inner.clone()], shifted).abs()
        })
        .collect();
    let Some(best) = (0..like.len()).max_by(|&a, &b| like[a].total_cmp(&like[b])) else { return Ok(None) };
    // Without a maximum inside, as at constant speed, no lag shows.
    if best == 0 || best == 2 * reach {
        return Err(Beyond);
    }
    let lag = best as f64 - reach as f64 + vertex(&like, best);
    let unlike = |place: usize| 1.0 - like[place].powi(2);
    // Noise and slow motion allow many lags.
    Ok((lag.abs() > 1.5 && unlike(best) < DELAY_EXPLAINS * unlike(reach)).then_some(lag * period))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delay_beyond_a_twentieth_of_a_second_is_found() {
        let wave = |late: f64| -> Vec<f64> {
            let at = |k: i32| 0.004 * f64::from(k) - late;
            (0..4000).map(|k| (1.3 * at(k)).sin() + 0.5 * (2.9 * at(k)).cos()).collect()
        };
        for late in [0.02, 0.1, 0.15] {
            let found = delay(&wave(0.0), &wave(late), 0.004);
            assert!(found.is_some_and(|found| (found - late).abs() < 1e-3), "{late}: {found:?}");
        }
        assert_eq!(delay(&wave(0.0), &wave(0.0), 0.004), None);
    }

    #[test]
    fn a_large_factor_is_that_of_the_clock_where_true_time_is_that_of_a_log() {
        let of = |factor: f64, rate: f64, joints: usize| is_of_clock(factor, rate, joints, || true);
        // Ten times too slow or too fast, at 250 Hz; rpm are 9.55 times as many.
        assert!(of(0.1, 250.0, 6) && of(10.0, 250.0, 6) && !of(1.0 / 9.55, 250.0, 6) && !of(1.0 / 9.8, 250.0, 6));
        assert!(!is_of_clock(0.1, 250.0, 6, || false));
        // Velocities that were taken for rpm, and are in rad/s.
        assert!(!of(9.549, 250.0, 6) && !of(9.549, 1e3, 6));
        // True rates of 9.9, 10.1, 9900 and 10100 Hz.
        assert_eq!([99.0, 101.0].map(|rate| of(10.0, rate, 6)), [false, true]);
        assert_eq!([990.0, 1010.0].map(|rate| of(0.1, rate, 6)), [true, false]);
        // Units, unless no log has the rate: ms for s, and s for ms.
        assert_eq!([of(1e-3, 50.0, 6), of(1e-3, 4.0, 6), of(PI / 180.0, 50.0, 6)], [false, true, false]);
        assert_eq!([of(1e3, 250e3, 6), of(1e3, 9e3, 6), of(1e-6, 1e-3, 6)], [true, false, true]);
        // A joint by itself may have a gear of ten; none has one of four.
        assert_eq!([of(0.1, 250.0, 1), of(0.25, 250.0, 1), of(0.19, 250.0, 1)], [false, true, false]);
    }

    #[test]
    fn factors_are_written_as_numbers() {
        assert_eq!([0.625, 10.0, 1e-3, 1e6].map(digits), ["0.625", "10.000", "1.000e-3", "1.000e6"]);
        assert!(digits(1e-9).parse::<f64>().is_ok_and(|value| value == 1e-9));
    }
}
