//! The factor by which a clock runs wrong, in logs without velocities: from the torques of gravity and inertia.
//!
//! Masses and their places act in gravity and in inertia, so that the torque of gravity gives the size of that of inertia, and with it the
//! square of time. Free bodies show it by themselves where the clock is wrong by much: wrong masses, and inertias that are placeholders,
//! change nothing about it. A smaller factor shows where the described bodies, whatever they weigh, show the same factor as free ones.

use super::super::change::{Change, Description};
use super::super::compare::{Comparison, DISTINCT, EXPLAINED, compare};
use super::super::findings::apart;
use super::super::fitting::{Physics, Rows};
use super::super::judgement::judge;
use super::super::shares::WRONG_MASSES;
use super::super::tried::Tried;
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::error::Result;
use crate::quality::velocity::in_true_time;
use crate::quality::view::View;
use crate::recording::Recording;
use crate::robot::Robot;
use std::cell::RefCell;
use std::rc::Rc;

/// True seconds per second of the clock that are tried first; neighbours differ by half of a factor of ten.
const TRIED: [f64; 7] = [0.031_62, 0.1, 0.316_2, 1.0, 3.162, 10.0, 31.62];

/// Halvings of the ratio of neighbours behind that: to within two per cent.
const HALVINGS: usize = 5;

/// A factor nearer to one is not reported where free bodies show it alone, and where those described show it with them: what a model lacks
/// may look like it. Right logs of bodies whose masses are wrong by 30 % are explained best by 0.8 to 1.1.
const REPORTED: f64 = 1.7;
const REPORTED_BY_BOTH: f64 = 1.15;

/// A factor this near to a power of ten is that: a wrong unit or a point that was lost.
const OF_TEN: f64 = 0.12;

/// Samples that are looked at, from the middles of the logs.
const MOST_SAMPLES: usize = 20_000;

/// A controller whose masses are wrong by half takes off so much of gravity that inertia is three times as large against the rest: as
/// under a clock with this factor, the square root of a third. Larger factors are none of gravity.
const OF_GRAVITY: f64 = 0.577;

/// An arm whose lengths are all this many times those of its file, or its inverse, may be a sister model: those of one family have reaches
/// between 0.5 and 1.3 m. Inertia grows by the square of length and gravity by length, so that it moves as the described arm does by another
/// clock: no torque separates the two.
const SIZES: f64 = 3.0;

/// Motion this many times slower has no torque of inertia to speak of.
const SLOW: f64 = 1e-3;

/// A time in which fewer blocks are left compares nothing.
const FEWEST_BLOCKS: usize = 8;

/// A factor of a clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ClockFactor {
    /// True seconds per second of the clock.
    pub factor: f64,
    /// Whether nothing else explains the torques as well.
    pub is_sure: bool,
    /// Whether free bodies show it too, so that the arm may be of another size.
    pub may_be_size: bool,
    /// Share of the torques that stays unexplained, held out, in the time of the clock and in that by the factor.
    pub unexplained: [f64; 2],
}

impl ClockFactor {
    /// By how much the residual falls, in words.
    pub(crate) fn fall(&self) -> String {
        let [before, after] = self.unexplained;
        if !before.is_finite() {
            return format!("with that {:.0} % of the torque stays unexplained on parts held out", 100.0 * after);
        }
        let [after, before] = apart(after, before);
        format!("with that {after} of the torque stays unexplained on parts held out instead of {before}")
    }
}

/// True seconds per second of the clock that made these logs, where bodies explain their torques clearly better by it than by the clock, and
/// than without inertia: a factor that only makes noisy accelerations small is none of the clock. No other change of the description
/// explains them as well in the time of the clock. It is not sure where only the described bodies show it.
///
/// # Errors
/// Those of the filters.
pub(crate) fn clock_factor(logs: &[&Recording], robot: &Robot) -> Result<Option<ClockFactor>> {
    let most = MOST_SAMPLES / logs.len().max(1);
    let logs: Vec<Recording> = logs.iter().map(|log| middle(log, most)).collect();
    let times = Times { logs: &logs, robot, rows: RefCell::default() };
    let masses = Physics::masses(robot);
    let masses = masses.as_ref().map(|masses| Timing::new(&times, masses)).transpose()?;
    let by_masses = masses.as_ref().map(Timing::factor).transpose()?;
    tracing::debug!(by_masses, "the clock by described bodies");
    let shown = by_masses.filter(|factor| factor.ln().abs() >= REPORTED_BY_BOTH.ln());
    // Free bodies are not asked about a clock in whose time, and best in that, the described ones explain the torques.
    if let (Some(masses), Some(factor), None) = (&masses, by_masses, shown)
        && masses.share(factor)? < WRONG_MASSES
    {
        return Ok(None);
    }
    let free = Physics::free(robot);
    let free = Timing::new(&times, &free)?;
    let of_masses = match (&masses, shown) {
        (Some(masses), Some(factor)) => by_described_bodies(masses, factor, &free)?,
        _ => None,
    };
    let found = match of_masses {
        Some((found, share)) if found.is_sure => Some((found, share)),
        unsure => by_free_bodies(&free)?.or(unsure),
    };
    let Some((found, share)) = found else { return Ok(None) };
    // Torques without gravity, or under another, change the ratio of gravity to inertia too.
    let views: Vec<View> = logs.iter().map(|log| View::new(log, Some(robot))).collect::<Result<_>>()?;
    let other = judge(&views.iter().collect::<Vec<_>>(), Some(robot));
    let explains = other.verdict.is_some_and(|verdict| verdict.after < DISTINCT * share);
    let may_be_size = found.is_sure && size(found.factor).ln().abs() < SIZES.ln();
    let found = ClockFactor { is_sure: found.is_sure && !may_be_size, may_be_size, ..found };
    Ok((!explains).then_some(found))
}

/// How many times as long as described an arm is that moves by a right clock as the described one does by a clock with this factor.
fn size(factor: f64) -> f64 {
    factor.powi(-2)
}

/// Whether the torques deny a factor that velocities show: bodies explain them clearly better in the time of the clock than in a time that
/// is longer by the factor. The velocities are then wrong, not the clock.
///
/// # Errors
/// Those of the filters.
pub(crate) fn torques_deny_clock(log: &Recording, robot: &Robot, factor: f64) -> Result<bool> {
    let log = [middle(log, MOST_SAMPLES)];
    let times = Times { logs: &log, robot, rows: RefCell::default() };
    let Some(rows) = times.rows(1.0)?.filter(|rows| rows.log.len() >= FEWEST_BLOCKS) else { return Ok(false) };
    let denied = |physics: Physics| -> Result<bool> {
        let timing = Timing::new(&times, &physics)?;
        let Some(with) = timing.tried(&rows).filter(Tried::explains_half) else { return Ok(false) };
        Ok(timing.gain(&rows, &with, 1.0 / factor).is_some_and(|gain| is_clear(&gain)))
    };
    Ok(Physics::masses(robot).map(denied).transpose()? == Some(true) || denied(Physics::free(robot))?)
}

/// Whether a factor of the clock is better than another by more than what a model that lacks something allows.
fn is_clear(gain: &Comparison) -> bool {
    gain.is_better(TRIED.len(), EXPLAINED) && gain.is_large(1)
}

/// The middle of a log, of so many samples at most.
fn middle(log: &Recording, most: usize) -> Recording {
    let start = log.samples().saturating_sub(most) / 2;
    log.slice(start..(start + most).min(log.samples()))
}

/// A factor that the described bodies show, whatever they weigh, with the share of the torques that free bodies leave then. It is sure where
/// these confirm it. Where they explain the torques as well by the clock, moments of inertia that are described wrongly are as good a cause;
/// where they deny the factor, these are the cause.
fn by_described_bodies(masses: &Timing, factor: f64, free: &Timing) -> Result<Option<(ClockFactor, f64)>> {
    let Some(rows) = masses.times.rows(factor)? else { return Ok(None) };
    let (Some(own), Some(of_free)) = (masses.tried(&rows), free.tried(&rows)) else { return Ok(None) };
    if own.share() >= WRONG_MASSES || !masses.is_shown(&rows, &own, factor) {
        return Ok(None);
    }
    let is_sure = free.gain(&rows, &of_free, factor).is_some_and(|gain| gain.is_distinct());
    let denies = || free.loss(&rows, &of_free, factor).is_none_or(|loss| loss.is_distinct());
    let is_possible = is_sure || !denies();
    let unexplained = [masses.share(1.0)?, own.share()];
    Ok(is_possible.then(|| (ClockFactor { factor, is_sure, may_be_size: false, unexplained }, of_free.share())))
}

/// A factor that free bodies show, with the share of the torques that they leave then.
fn by_free_bodies(free: &Timing) -> Result<Option<(ClockFactor, f64)>> {
    let factor = free.factor()?;
    if factor.ln().abs() < REPORTED.ln() {
        return Ok(None);
    }
    let Some(rows) = free.times.rows(factor)? else { return Ok(None) };
    let Some(with) = free.tried(&rows) else { return Ok(None) };
    let unexplained = [free.share(1.0)?, with.share()];
    Ok(free
        .is_shown(&rows, &with, factor)
        .then(|| (ClockFactor { factor, is_sure: true, may_be_size: false, unexplained }, with.share())))
}

/// Logs in other times.
struct Times<'a> {
    logs: &'a [Recording],
    robot: &'a Robot,
    /// Their rows by factor, as far as they were asked for: free and described bodies are tried on the same.
    rows: RefCell<Vec<(f64, Option<Rc<Rows>>)>>,
}

impl Times<'_> {
    /// The rows of the logs where the clock has so many true seconds per second.
    fn rows(&self, factor: f64) -> Result<Option<Rc<Rows>>> {
        if let Some((_, known)) = self.rows.borrow().iter().find(|(own, _)| *own == factor) {
            return Ok(known.clone());
        }
        let in_time = |log: &Recording| {
            let mut log = log.clone();
            in_true_time(&mut log.time, factor);
            log
        };
        let logs: Vec<Recording> = self.logs.iter().map(in_time).collect();
        let views: Vec<View> = logs.iter().map(|log| View::new(log, Some(self.robot))).collect::<Result<_>>()?;
        let rows = Rows::new(&views.iter().collect::<Vec<_>>(), Some(self.robot)).map(Rc::new);
        self.rows.borrow_mut().push((factor, rows.clone()));
        Ok(rows)
    }
}

/// What logs look like in another time, under what is known of the arm.
struct Timing<'a> {
    times: &'a Times<'a>,
    physics: &'a Physics,
    /// Torques that take part in the time of the clock.
    torques: usize,
}

impl<'a> Timing<'a> {
    fn new(times: &'a Times<'a>, physics: &'a Physics) -> Result<Timing<'a>> {
        let mut timing = Timing { times, physics, torques: 0 };
        let as_given = times.rows(1.0)?.and_then(|rows| timing.tried(&rows));
        timing.torques = as_given.map_or(0, |tried| taking_part(&tried));
        Ok(timing)
    }

    fn tried(&self, rows: &Rows) -> Option<Tried> {
        let robot = self.times.robot;
        Tried::new(self.physics, rows, Description::as_given(robot.dof(), robot.gravity))
    }

    /// Share of the torques that stays unexplained, held out, in the rows that belong to a factor; without bound where these are fewer
    /// torques, or hardly any rows.
    fn share(&self, factor: f64) -> Result<f64> {
        let rows = self.times.rows(factor)?.filter(|rows| rows.log.len() >= FEWEST_BLOCKS);
        let tried = rows.and_then(|rows| self.tried(&rows)).filter(|tried| taking_part(tried) >= self.torques);
        Ok(tried.map_or(f64::INFINITY, |tried| tried.share()))
    }

    /// The factor under which the least of the torques stays unexplained.
    fn factor(&self) -> Result<f64> {
        let mut best = (1.0, f64::INFINITY);
        for factor in TRIED {
            let share = self.share(factor)?;
            if share < best.1 {
                best = (factor, share);
            }
        }
        let mut step = (TRIED[1] / TRIED[0]).sqrt();
        for _ in 0..HALVINGS {
            for factor in [best.0 / step, best.0 * step] {
                let share = self.share(factor)?;
                if share < best.1 {
                    best = (factor, share);
                }
            }
            step = step.sqrt();
        }
        let power = 10f64.powf(best.0.log10().round());
        Ok(if (best.0 / power).ln().abs() < OF_TEN { power } else { best.0 })
    }

    /// What rows in true time, `with` which the torques are tried, gain over a motion that is so many times faster.
    fn gain(&self, rows: &Rows, with: &Tried, than: f64) -> Option<Comparison> {
        let other = self.tried(&Rows { motion: faster(&rows.motion, than), ..rows.clone() })?;
        compare(&other.evaluation, &with.evaluation, &rows.log)
    }

    /// What a motion that is so many times faster gains over rows in true time, `with` which the torques are tried.
    fn loss(&self, rows: &Rows, with: &Tried, than: f64) -> Option<Comparison> {
        let other = self.tried(&Rows { motion: faster(&rows.motion, than), ..rows.clone() })?;
        compare(&with.evaluation, &other.evaluation, &rows.log)
    }

    /// Whether a factor explains half of the torques, clearly better than the clock does, and than motion without inertia does, and torques
    /// without gravity.
    fn is_shown(&self, rows: &Rows, with: &Tried, factor: f64) -> bool {
        let better = |than: f64| self.gain(rows, with, than).is_some_and(|gain| is_clear(&gain));
        with.explains_half()
            && better(factor)
            && better(SLOW)
            && !(factor < OF_GRAVITY && self.lack_gravity(rows, with, factor))
    }

    /// Whether torques of which a controller takes the gravity off, in the time of the clock, are explained about as well as by a factor.
    /// What is left of gravity where it knows the masses wrongly is small against inertia, as under a fast clock.
    fn lack_gravity(&self, rows: &Rows, with: &Tried, factor: f64) -> bool {
        let as_logged = Rows { motion: faster(&rows.motion, factor), ..rows.clone() };
        let weightless = |physics: &Physics| {
            let given = Description::as_given(self.times.robot.dof(), self.times.robot.gravity);
            Tried::new(physics, &as_logged, given.with(Change::WithoutGravity))
        };
        let own = weightless(self.physics);
        let others = (!matches!(self.physics, Physics::Masses(_))).then(|| Physics::masses(self.times.robot)).flatten();
        let of_masses = others.and_then(|masses| weightless(&masses));
        let explains = |other: Tried| {
            let gain = compare(&other.evaluation, &with.evaluation, &rows.log);
            other.explains_half() && !gain.is_some_and(|gain| gain.is_better(1, EXPLAINED) && gain.is_large(1))
        };
        own.into_iter().chain(of_masses).any(explains)
    }
}

/// Torques that a description was judged on.
fn taking_part(tried: &Tried) -> usize {
    tried.evaluation.unexplained.iter().flatten().count()
}

/// A motion that takes its path so many times faster.
fn faster(motion: &Motion, factor: f64) -> Motion {
    let times = |signals: &Channels, factor: f64| signals.map(|_, signal| signal.iter().map(|v| factor * v).collect());
    Motion { q: motion.q.clone(), qd: times(&motion.qd, factor), qdd: times(&motion.qdd, factor * factor) }
}

/// What is said of a factor that is sure.
pub(crate) fn clock_text(factor: f64) -> String {
    let digits = crate::quality::velocity::digits(factor);
    format!(
        "inertia and gravity in the torques belong together only if true time is about {digits} times that of the clock: the clock is wrong \
         by this factor. Set [units] time_factor = {digits} in a dataset, or log true time stamps (or velocities, which show it too)"
    )
}

/// What is said of one that is not.
pub(crate) fn unsure_clock_text(clock: ClockFactor) -> String {
    let ClockFactor { factor, may_be_size, .. } = clock;
    let digits = crate::quality::velocity::digits(factor);
    if may_be_size {
        let size = size(factor);
        return format!(
            "inertia and gravity in the torques belong together only if true time is about {digits} times that of the clock, or if the arm is about \
             {size:.2} times as long as its file describes it, as a sister model is: no torque separates the two. Check the model and its lengths; \
             if they are right, set [units] time_factor = {digits} in a dataset. Log true time stamps or velocities, which show the clock"
        );
    }
    format!(
        "the robot's bodies, whatever they weigh, explain the torques only if true time is about {digits} times that of the clock; other bodies on \
         these joints explain them by the clock as well. Either the clock is wrong by this factor ([units] time_factor = {digits} in a dataset), or \
         the file's moments of inertia are. Log true time stamps or velocities, or give more logs"
    )
}
