//! The factor by which a clock runs wrong, in a log without velocities: from the torques of gravity and inertia.
//!
//! Masses and their places act in gravity and in inertia, so that the torque of gravity gives the size of that of inertia, and with it the
//! square of time. Bodies are free here: wrong masses, and inertias that are placeholders, change nothing about it.

use super::super::change::Description;
use super::super::compare::{DISTINCT, EXPLAINED, compare};
use super::super::fitting::{Physics, Rows};
use super::super::judgement::judge;
use super::super::tried::Tried;
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::error::Result;
use crate::quality::velocity::in_true_time;
use crate::quality::view::View;
use crate::recording::Recording;
use crate::robot::Robot;

/// True seconds per second of the clock that are tried first; neighbours differ by half of a factor of ten.
const TRIED: [f64; 7] = [0.031_62, 0.1, 0.316_2, 1.0, 3.162, 10.0, 31.62];

/// Halvings of the ratio of neighbours behind that: to within two per cent.
const HALVINGS: usize = 5;

/// A factor nearer to one is not reported: what a model lacks may look like it.
const REPORTED: f64 = 1.7;

/// A factor this near to a power of ten is that: a wrong unit or a point that was lost.
const OF_TEN: f64 = 0.12;

/// Samples that are looked at, from the middle of the log.
const MOST_SAMPLES: usize = 20_000;

/// Motion this many times slower has no torque of inertia to speak of.
const SLOW: f64 = 1e-3;

/// True seconds per second of the clock, where free bodies explain the torques clearly better by it than by the clock, and than without
/// inertia: a factor that only makes noisy accelerations small is none of the clock. No other change of the description explains them as well
/// in the time of the clock.
///
/// # Errors
/// Those of the filters.
pub(crate) fn clock_factor(log: &Recording, robot: &Robot) -> Result<Option<f64>> {
    let middle = log.samples().saturating_sub(MOST_SAMPLES) / 2;
    let log = log.slice(middle..(middle + MOST_SAMPLES).min(log.samples()));
    let physics = Physics::free(robot);
    let given = Description::as_given(robot.dof(), robot.gravity);
    let rows = |factor: f64| -> Result<Option<Rows>> {
        let mut log = log.clone();
        in_true_time(&mut log.time, factor);
        Ok(Rows::new(&[&View::new(&log, Some(robot))?], Some(robot)))
    };
    let tried = |rows: &Rows| Tried::new(&physics, rows, given.clone());
    // Held out, in the rows that belong to each factor.
    let share = |factor: f64| -> Result<f64> {
        Ok(rows(factor)?.and_then(|rows| tried(&rows)).map_or(f64::INFINITY, |tried| tried.share()))
    };
    let shares = TRIED.iter().map(|&factor| share(factor)).collect::<Result<Vec<f64>>>()?;
    let Some(least) = (0..TRIED.len()).min_by(|&a, &b| shares[a].total_cmp(&shares[b])) else { return Ok(None) };
    let mut best = (TRIED[least], shares[least]);
    let mut step = (TRIED[1] / TRIED[0]).sqrt();
    for _ in 0..HALVINGS {
        for factor in [best.0 / step, best.0 * step] {
            let share = share(factor)?;
            if share < best.1 {
                best = (factor, share);
            }
        }
        step = step.sqrt();
    }
    let power = 10f64.powf(best.0.log10().round());
    let factor = if (best.0 / power).ln().abs() < OF_TEN { power } else { best.0 };
    if factor.ln().abs() < REPORTED.ln() {
        return Ok(None);
    }
    let Some(mut rows) = rows(factor)? else { return Ok(None) };
    let Some(with) = tried(&rows) else { return Ok(None) };
    let explained = with.explains_half();
    let motion = rows.motion.clone();
    let mut is_clearly_better = |than: f64| {
        rows.motion = faster(&motion, than);
        let gain = tried(&rows).and_then(|other| compare(&other.evaluation, &with.evaluation, &rows.log));
        gain.is_some_and(|gain| gain.is_better(TRIED.len(), EXPLAINED) && gain.is_large(1))
    };
    if !explained || !is_clearly_better(factor) || !is_clearly_better(SLOW) {
        return Ok(None);
    }
    // Torques without gravity, or under another, change the ratio of gravity to inertia too.
    let other = judge(&[&View::new(&log, Some(robot))?], Some(robot));
    let explains = other.is_some_and(|verdict| verdict.after < DISTINCT * with.share());
    Ok((!explains).then_some(factor))
}

/// A motion that takes its path so many times faster.
fn faster(motion: &Motion, factor: f64) -> Motion {
    let times = |signals: &Channels, factor: f64| signals.map(|_, signal| signal.iter().map(|v| factor * v).collect());
    Motion { q: motion.q.clone(), qd: times(&motion.qd, factor), qdd: times(&motion.qdd, factor * factor) }
}

/// What is said of it.
pub(crate) fn clock_text(factor: f64) -> String {
    let digits = crate::quality::velocity::digits(factor);
    format!(
        "inertia and gravity in the torques belong together only if true time is about {digits} times that of the clock: the clock is wrong \
         by this factor. Set [units] time_factor = {digits} in a dataset, or log true time stamps (or velocities, which show it too)"
    )
}
