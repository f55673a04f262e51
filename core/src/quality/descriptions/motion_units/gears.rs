//! Whether positions are those of motors behind gears of one ratio, from the torques of gravity: such positions look like degrees or mrad.

use super::super::change::{Change, Description};
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Fit, Physics, Rows};
use super::super::sizes::golden::golden;
use super::super::tried::Tried;
use super::scaled::{scaled, scaled_motion};
use crate::error::Result;
use crate::quality::motion::{Gears, OtherUnit};
use crate::quality::view::View;
use crate::recording::Recording;
use crate::robot::{JointKind, Robot};

/// Positions exceed the limits by no more than this factor.
const WITHIN: f64 = 1.05;

/// No gear of an arm is higher.
const HIGHEST: f64 = 500.0;

/// Ratios that are tried first are so many times each other. A motion of one radian that is wrong by half of that is wrong by four degrees,
/// which the torque of gravity still nearly follows.
const STEP: f64 = 1.15;

/// Golden sections behind that: to within a thousandth.
const SECTIONS: usize = 12;

/// A ratio this near to a unit's is that of the unit.
const OF_UNIT: f64 = 0.05;

/// Rows that are looked at for the ratio.
const ROWS: usize = 500;

/// Passes over the joints for the ways in which their motors turn: the sign of one shows only where those of its neighbours are right.
const PASSES: usize = 3;

/// The gears behind which positions explain the torques clearly better than those in any unit do, and than the `units` that the positions
/// of each joint seem to be in. Motors may turn the other way than their joints: where no unit explains the torques, so do those that then
/// explain them better, in the units that they are compared with too.
///
/// # Errors
/// Those of the filters.
pub(crate) fn ratio(log: &Recording, robot: &Robot, units: &[Option<OtherUnit>]) -> Result<Option<Gears>> {
    let turns: Vec<usize> = (0..robot.dof()).filter(|&joint| robot.joints[joint].kind == JointKind::Revolute).collect();
    let lowest = turns.iter().map(|&joint| {
        let limits = robot.joints[joint].limits;
        let largest = log.q.channel(joint).iter().fold(0.0f64, |most, q| most.max(q.abs()));
        largest / (WITHIN * limits.lower.abs().max(limits.upper.abs()))
    });
    let lowest = lowest.fold(1.0, f64::max);
    // One joint alone may be in any unit.
    if turns.len() < 2 || lowest > HIGHEST {
        return Ok(None);
    }
    // The same rows serve all ratios: those of joints that are as fast as behind the lowest.
    let behind = Recording { q: scaled(&log.q, &of_all(robot, &turns, lowest)), ..log.clone() };
    let Some(rows) = Rows::new(&[&View::new(&behind, Some(robot))?], Some(robot)) else { return Ok(None) };
    let few = rows.thinned(ROWS);
    let search = Search { physics: Physics::free(robot), robot, turns: &turns, rows: &rows, few: &few, lowest };
    let as_given = Description::as_given(robot.dof(), robot.gravity);
    if let Some(ratio) = search.judged(&as_given, units) {
        return Ok(Some(Gears { ratio, some_reversed: false }));
    }
    let mut in_units = search.in_units(units).into_iter().filter_map(|factors| search.tried(&factors, &as_given));
    if in_units.any(|tried| tried.share() < EXPLAINED) {
        return Ok(None);
    }
    let reversed = search.with_signs(&as_given);
    tracing::debug!(changes = ?reversed.changes, "motors that turn the other way");
    let found = if reversed.same_as(&as_given) { None } else { search.judged(&reversed, units) };
    Ok(found.map(|ratio| Gears { ratio, some_reversed: true }))
}

/// Factors of all joints, where those that turn are behind a ratio.
fn of_all(robot: &Robot, turns: &[usize], ratio: f64) -> Vec<f64> {
    let mut factors = vec![1.0; robot.dof()];
    turns.iter().for_each(|&joint| factors[joint] = 1.0 / ratio);
    factors
}

/// What the search for the ratio asks.
struct Search<'a> {
    physics: Physics,
    robot: &'a Robot,
    /// Joints that turn.
    turns: &'a [usize],
    /// Rows behind the lowest ratio.
    rows: &'a Rows,
    few: &'a Rows,
    lowest: f64,
}

impl Search<'_> {
    /// Rows of which each joint's motion is so many times larger.
    fn under(&self, rows: &Rows, factors: &[f64]) -> Rows {
        Rows { motion: scaled_motion(&rows.motion, factors), ..rows.clone() }
    }

    fn tried(&self, factors: &[f64], description: &Description) -> Option<Tried> {
        Tried::new(&self.physics, &self.under(self.rows, factors), description.clone())
    }

    fn behind(&self, ratio: f64) -> Vec<f64> {
        of_all(self.robot, self.turns, ratio / self.lowest)
    }

    /// How well few rows are fitted behind a ratio, given by its logarithm.
    fn merit(&self, logarithm: f64, description: &Description) -> f64 {
        let rows = self.under(self.few, &self.behind(logarithm.exp()));
        let fit = Fit::new(&self.physics.tables(&rows, description), &rows, description).merit();
        fit.unwrap_or(f64::INFINITY)
    }

    /// Logarithms of the ratios that are tried first.
    fn ratios(&self) -> Vec<f64> {
        let (low, high): (f64, f64) = (self.lowest.ln(), HIGHEST.ln());
        let steps = ((high - low) / STEP.ln()).ceil().max(1.0);
        (0..=steps as usize).map(|step| low + (high - low) * step as f64 / steps).collect()
    }

    /// Factors of all joints in the units that come into question: each of them for all, and those that the joints seem to be in.
    fn in_units(&self, units: &[Option<OtherUnit>]) -> Vec<Vec<f64>> {
        let seeming = |joint: usize| match units[joint].filter(|_| self.turns.contains(&joint)) {
            Some(unit) => self.lowest / unit.in_si(),
            None => 1.0,
        };
        let seeming: Vec<f64> = (0..self.robot.dof()).map(seeming).collect();
        OtherUnit::of(JointKind::Revolute).iter().map(|unit| self.behind(unit.in_si())).chain([seeming]).collect()
    }

    /// The best ratio under a description, where it is that of no unit and clearly better than any.
    fn judged(&self, description: &Description, units: &[Option<OtherUnit>]) -> Option<f64> {
        let merit = |logarithm: f64| self.merit(logarithm, description);
        let ratios = self.ratios();
        let (best, _) = ratios.iter().map(|&at| (at, merit(at))).min_by(|a, b| a.1.total_cmp(&b.1))?;
        let ratio = golden((best - STEP.ln()).max(ratios[0]), best + STEP.ln(), SECTIONS, merit).exp();
        let of_unit = |unit: &OtherUnit| (ratio / unit.in_si()).ln().abs() < OF_UNIT;
        if OtherUnit::of(JointKind::Revolute).iter().any(of_unit) {
            return None;
        }
        let with = self.tried(&self.behind(ratio), description)?;
        tracing::debug!(ratio, share = with.share(), "gears");
        if !with.explains_half() {
            return None;
        }
        let is_better = |factors: Vec<f64>| {
            let other = self.tried(&factors, description);
            let gain = other.and_then(|other| compare(&other.evaluation, &with.evaluation, &self.rows.log));
            gain.is_some_and(|gain| gain.is_better(ratios.len(), EXPLAINED) && gain.is_large(1))
        };
        self.in_units(units).into_iter().all(is_better).then_some(ratio)
    }

    /// The description with the axes of those joints reversed with which the torques are explained best behind some ratio.
    fn with_signs(&self, from: &Description) -> Description {
        let of_ratio = |at: f64| {
            let (mut own, mut least) = (from.clone(), self.merit(at, from));
            for &joint in self.turns.iter().cycle().take(PASSES * self.turns.len()) {
                let other = own.with(Change::AxisSign(joint));
                let merit = self.merit(at, &other);
                if merit < least {
                    (own, least) = (other, merit);
                }
            }
            (own, least)
        };
        let all = self.ratios().into_iter().map(of_ratio);
        all.min_by(|a, b| a.1.total_cmp(&b.1)).map_or_else(|| from.clone(), |(best, _)| best)
    }
}
