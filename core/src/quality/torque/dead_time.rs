//! The time by which torques come behind the motion: a search over lags, joint by joint, and what the joints agree on.

use super::joint_fit::JointFit;
use crate::quality::finding::{Finding, Kind, Severity};
use crate::quality::velocity::vertex;
use crate::quality::view::View;
use std::ops::RangeInclusive;

/// Shortest dead time that is reported, s.
const SHORTEST_S: f64 = 0.0015;

/// Mean square of the residual without a dead time over that with it, on half of the joints: what halves it is most of what is wrong.
/// Less has other causes, as slow noise, elastic gears and friction after reversals, for which some lag is always the best.
const COSTS: f64 = 2.0;

/// The same, of a joint, from which its lag is shown: on right logs some lag takes a tenth off.
const SHOWN: f64 = 1.25;

/// Lags of the same dead time differ by less than this share of it, and a sample: filters and friction delay each torque a little otherwise.
const ALIKE: f64 = 0.3;

/// A torque that alone comes late is named from so many seconds on, where that takes this factor off its mean squared residual.
const ALONE_S: f64 = 0.015;
const ALONE_COSTS: f64 = 4.0;

/// Dead times of signals that two programs log are no longer than this, s. Those are looked for in steps first, which a motion of three
/// turns per second cannot hide, and at every sample around the best.
const FAR_S: f64 = 0.5;
const STEP_S: f64 = 0.02;

/// Part of a log that may be lost at either end for that.
const LOST: usize = 8;

/// The lag of a joint's torque behind its motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lag {
    pub samples: f64,
    /// Mean squared residual without a lag over that with it.
    cost: f64,
}

impl Lag {
    /// The lag, s, where it is more than what fits best by chance.
    pub(super) fn shown_s(&self, period: f64) -> Option<f64> {
        (self.cost > SHOWN).then_some(self.samples * period)
    }
}

/// Which lags are tried, in samples to either side.
#[derive(Debug, Clone, Copy)]
pub(super) enum Search {
    /// Each up to this one.
    Near(usize),
    /// Those so many steps of so many samples away, and then each around the best.
    Far { steps: usize, step: usize },
}

impl Search {
    /// Far lags of a log.
    pub(super) fn far(view: &View) -> Search {
        let step = ((STEP_S / view.period) as usize).max(1);
        let reach = ((FAR_S / view.period) as usize).min(view.log.samples() / LOST);
        Search::Far { steps: reach / step, step }
    }

    fn reach(self) -> usize {
        match self {
            Search::Near(reach) => reach,
            Search::Far { steps, step } => steps * step,
        }
    }

    /// Whether all lags of a row are within so many samples.
    pub(super) fn is_within(self, row: usize, samples: usize) -> bool {
        row >= self.reach() && row + self.reach() < samples
    }

    /// By how much a torque comes behind the motion; None where the residual does not depend on it.
    pub(super) fn lag(self, fit: &JointFit, tau: &[f64]) -> Option<Lag> {
        let left = |lag: isize| fit.unexplained(tau, lag).powi(2);
        match self {
            Search::Near(reach) => valley(reach as isize, 1, left),
            Search::Far { steps, step } => {
                let step = step as isize;
                let coarse = valley(steps as isize, step, left)?;
                let about = around(coarse.samples.round() as isize, step, self.reach() as isize);
                let first = *about.start();
                let fine: Vec<f64> = about.map(left).collect();
                let best = (0..fine.len()).min_by(|&a, &b| fine[a].total_cmp(&fine[b]))?;
                let samples = first as f64 + best as f64 + vertex(&fine, best);
                Some(Lag { samples, cost: left(0) / fine[best].max(f64::MIN_POSITIVE) })
            }
        }
    }
}

/// The lags within a step of one, and within what the rows have on both sides: the lowest may lie between the last two steps.
fn around(lag: isize, step: isize, reach: isize) -> RangeInclusive<isize> {
    (lag - step).max(-reach)..=(lag + step).min(reach)
}

/// The lowest of residuals, so many steps to either side, where they depend on the lag and the lowest explains most of the torque.
fn valley(steps: isize, step: isize, left: impl Fn(isize) -> f64) -> Option<Lag> {
    let each: Vec<f64> = (-steps..=steps).map(|place| left(place * step)).collect();
    let best = (0..each.len()).min_by(|&a, &b| each[a].total_cmp(&each[b]))?;
    let worst = each[0].max(each[each.len() - 1]);
    let inside = best > 0 && best + 1 < each.len();
    (inside && each[best] < 0.5 * worst && each[best] < 0.25).then(|| Lag {
        samples: (best as f64 - steps as f64 + vertex(&each, best)) * step as f64,
        cost: each[steps as usize] / each[best].max(f64::MIN_POSITIVE),
    })
}

/// The lags of the joints that have one.
#[derive(Default)]
pub(super) struct Lags(Vec<(usize, Lag)>);

impl Lags {
    pub(super) fn add(&mut self, joint: usize, lag: Option<Lag>) {
        self.0.extend(lag.map(|lag| (joint, lag)));
    }

    pub(super) fn each(&self) -> impl Iterator<Item = (usize, Lag)> + '_ {
        self.0.iter().copied()
    }

    /// A dead time that the joints agree on, or that of a single torque; `away` are the lags by samples away from reversals.
    pub(super) fn finding(&self, view: &View, away: &Lags) -> Option<Finding> {
        self.of_all(view, away).or_else(|| self.of_one(view))
    }

    /// The dead time that the joints agree on, s, where samples away from reversals show it too: friction that builds up after reversals
    /// does not.
    pub(super) fn shown_away_too(&self, view: &View, away: &Lags) -> Option<f64> {
        let (all, away) = (self.in_common(view)?, away.in_common(view)?);
        ((all - away).abs() < ALIKE * all.abs() + view.period).then_some(all)
    }

    /// The dead time of the only torque that comes late.
    fn of_one(&self, view: &View) -> Option<Finding> {
        let late = |(_, lag): &&(usize, Lag)| {
            let seconds = lag.samples * view.period;
            seconds > ALONE_S.max(3.0 * view.period) && lag.cost > ALONE_COSTS
        };
        let late: Vec<&(usize, Lag)> = self.0.iter().filter(late).collect();
        let [(joint, lag)] = late[..] else { return None };
        if self.0.len() < 3 {
            return None;
        }
        let text = format!(
            "this torque comes {:.0} ms behind its motion, and the others do not: it is filtered or logged late, or its drive or gear lags; \
             `tauscope diagnose` separates a torque_lag from a time_delay and an elastic gear",
            1e3 * lag.samples * view.period
        );
        Some(Finding::new(Kind::DeadTime, Severity::Note, format!("tau{}", joint + 1), text))
    }

    /// The dead time that the joints agree on, s: positive where the torque comes behind the motion.
    fn in_common(&self, view: &View) -> Option<f64> {
        let lags = &self.0;
        let costly = lags.iter().filter(|(_, lag)| lag.cost > COSTS).count();
        if lags.len() * 2 < view.dof() || costly * 2 < lags.len() {
            return None;
        }
        let mut lags: Vec<f64> = lags.iter().map(|(_, lag)| lag.samples * view.period).collect();
        lags.sort_by(f64::total_cmp);
        let median = lags[lags.len() / 2];
        let agree = lags.iter().filter(|lag| (*lag - median).abs() < ALIKE * median.abs() + view.period).count();
        let is_common = median.abs() >= SHORTEST_S.max(1.5 * view.period) && agree * 3 >= lags.len() * 2;
        is_common.then_some(median)
    }

    /// The finding on it.
    fn of_all(&self, view: &View, away: &Lags) -> Option<Finding> {
        let median = self.in_common(view)?;
        let (ms, joints) = (1e3 * median.abs(), self.0.len());
        let comes = if median > 0.0 { "behind" } else { "ahead of" };
        if self.shown_away_too(view, away).is_none() {
            let text = format!(
                "the torque seems to come {comes} the motion by {ms:.1} ms (median of {joints} joints), and away from reversals it does not: a lag, or \
                 friction that builds up after reversals; `tauscope diagnose` separates a time_delay from a presliding_hysteresis"
            );
            return Some(Finding::new(Kind::DeadTime, Severity::Note, "tau", text));
        }
        let text = format!(
            "the torque comes {comes} the motion by {ms:.1} ms (median of {joints} joints): the signals are not taken at the same time, or one is \
             filtered; shift or filter the other"
        );
        Some(Finding::new(Kind::DeadTime, Severity::Warning, "tau", text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lag_is_shown_where_it_takes_something_off_the_residual() {
        let shown = |cost: f64| Lag { samples: 5.0, cost }.shown_s(0.002);
        assert!(shown(1.26).is_some_and(|lag| (lag - 0.01).abs() < 1e-12) && shown(1.24).is_none());
    }

    #[test]
    fn no_lag_is_beyond_the_rows() {
        assert_eq!(around(35, 10, 40), 25..=40);
        assert_eq!(around(-35, 10, 40), -40..=-25);
        assert_eq!(around(0, 10, 40), -10..=10);
    }

    #[test]
    fn a_valley_is_lower_than_its_ends_and_explains_most() {
        let parabola = |floor: f64| move |lag: isize| floor + 1e-3 * (lag as f64 - 3.4).powi(2);
        let found = valley(10, 2, parabola(0.01)).unwrap();
        assert!((found.samples - 3.4).abs() < 0.1, "{found:?}");
        assert!(found.cost > 2.0, "{found:?}");
        // Most is left; the ends are as low; the lowest is an end.
        assert!(valley(10, 2, parabola(0.26)).is_none() && valley(10, 1, parabola(0.24)).is_none());
        assert!(valley(3, 1, parabola(0.01)).is_none());
    }
}
