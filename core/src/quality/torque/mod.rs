//! Torque against motion: the residual of a joint's own model, dead time, excitation.
//!
//! A linear model of every joint is fitted to its torque alone, so that a fault of one joint does not hide behind
//! another. The lag with the smallest residual is the dead time, where the arm is known: a model of a joint alone
//! would take the pull of the other joints for one. What is wrong with signs, columns, gravity or units is asked of all
//! joints and logs together, in [`super::descriptions`].

use super::channels;
use super::finding::{Finding, Kind, Severity};
use super::motion::JointSummary;
use super::view::View;
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::identification::model::Model;
use crate::identification::tsqr::Triangle;
use crate::robot::Robot;
use rayon::prelude::*;

mod dead_time;
mod joint_fit;
mod of_joint;
mod since_reversal;

use dead_time::Lags;
use of_joint::{OfJoint, Rows};

/// Samples of the log that enter the models.
const ROWS: usize = 4000;

/// Dead times are looked for up to this at every sample, s.
const REACH_S: f64 = 0.05;

/// A condition number above this makes base parameters uncertain.
const POOR: f64 = 2000.0;

/// Up to this one all base parameters are known about as well as the noise allows (Gautier and Khalil, 1992).
const GOOD: f64 = 100.0;

/// What a condition number of the base parameters means.
pub fn excitation(condition: f64) -> &'static str {
    match condition {
        good if good <= GOOD => "the motion separates all parameters well",
        fair if fair <= POOR => "the motion separates some parameters poorly",
        _ => "the motion does not separate all parameters",
    }
}

/// Share of the longest column of the base parameters up to which one is rounding: nothing in the motion depends on its parameter.
const ROUNDING: f64 = 1e-9;

/// What the torques of a log show.
#[derive(Default)]
pub(super) struct Torques {
    /// Findings about them.
    pub findings: Vec<Finding>,
    /// Condition number of the base parameters, where the arm is known.
    pub condition_number: Option<f64>,
    /// Samples by which they come behind the motion where the joints agree on a time; zero where they do not.
    pub late: isize,
}

/// Examines the torques of a log, and fills in the estimates of the joints' models.
pub(super) fn examined(view: &View, summaries: &mut [JointSummary], robot: Option<&Robot>) -> Torques {
    let reach = ((REACH_S / view.period) as usize).clamp(2, 60);
    let Some(last) = view.log.samples().checked_sub(2 * reach + 1) else { return Torques::default() };
    let step = last.div_ceil(ROWS).max(1);
    let frozen = channels::frozen_rows(view);
    let rows: Vec<usize> = (reach..reach + last).step_by(step).filter(|&row| !frozen[row]).collect();
    let motion = picked(view, &rows);
    let model = robot.map(Model::new);
    let columns = match &model {
        Some(model) => model.columns(&motion, 0.0),
        None => (0..view.dof()).map(|joint| joint_alone(&motion, joint)).collect(),
    };
    let along = Rows { view, rows: &rows, motion: &motion, reach, asks_lags: robot.is_some() };
    let of_joint = |joint: usize| OfJoint::new(&along, joint, &columns[joint]);
    let joints: Vec<Option<OfJoint>> = (0..view.dof()).into_par_iter().map(of_joint).collect();
    let mut out = Vec::new();
    // By all rows, and by those away from reversals.
    let [mut near, mut far, mut near_away, mut far_away] = [(); 4].map(|()| Lags::default());
    for (joint, own) in joints.into_iter().enumerate() {
        let Some(OfJoint { unexplained, constant, lags }) = own else { continue };
        summaries[joint].unexplained = Some(unexplained);
        summaries[joint].constant = constant;
        let Some(lags) = lags else { continue };
        summaries[joint].dead_time_s = lags.near.and_then(|lag| lag.shown_s(view.period));
        tracing::debug!(joint, lag = ?lags.near, "lag");
        near.add(joint, lags.near);
        far.add(joint, lags.far);
        near_away.add(joint, lags.near_away);
        far_away.add(joint, lags.far_away);
    }
    out.extend(near.finding(view, &near_away).or_else(|| {
        let finding = far.finding(view, &far_away)?;
        far.each().for_each(|(joint, lag)| summaries[joint].dead_time_s = lag.shown_s(view.period));
        Some(finding)
    }));
    let condition = model.map(|model| condition_number(&model, &columns, rows.len()));
    if let Some(condition) = condition.filter(|c| *c > POOR) {
        let text = format!(
            "the condition number of the base parameters is {condition:.3e}: some of them are not separable on this \
             motion; move several joints at the same time, faster and further"
        );
        out.push(Finding::new(Kind::PoorExcitation, Severity::Note, "motion", text));
    }
    let late = near.shown_away_too(view, &near_away).map_or(0, |seconds| (seconds / view.period).round() as isize);
    Torques { findings: out, condition_number: condition, late }
}

/// The smoothed motion at some samples.
fn picked(view: &View, rows: &[usize]) -> Motion {
    let pick = |signals: &Channels| signals.map(|_, signal| rows.iter().map(|&row| signal[row]).collect());
    Motion { q: pick(&view.q), qd: pick(&view.qd), qdd: pick(&view.qdd) }
}

/// Columns of a joint of which nothing is known: offset, gravity on a level axis, rotor, friction.
fn joint_alone(motion: &Motion, joint: usize) -> Channels {
    let (q, qd) = (motion.q.channel(joint), motion.qd.channel(joint));
    let of = |law: fn(f64) -> f64, signal: &[f64]| signal.iter().map(|&x| law(x)).collect::<Vec<f64>>();
    Channels::from_vectors(&[
        vec![1.0; q.len()],
        of(f64::sin, q),
        of(f64::cos, q),
        motion.qdd.channel(joint).to_vec(),
        qd.to_vec(),
        of(f64::signum, qd),
    ])
}

/// Condition number of the base columns on which the motion depends, each of unit length: joints that stand still have others.
fn condition_number(model: &Model, columns: &[Channels], rows: usize) -> f64 {
    let mut triangle = Triangle::new(model.base().len());
    for (joint, table) in columns.iter().enumerate() {
        let mut all = vec![0.0; model.base().len() * rows];
        for (c, parameter) in model.active(joint).into_iter().enumerate() {
            all[parameter * rows..][..rows].copy_from_slice(table.channel(c));
        }
        triangle.add(&all, rows);
    }
    let factor = triangle.factor();
    let norms: Vec<f64> = factor.column_iter().map(|column| column.norm()).collect();
    let longest = norms.iter().fold(0.0f64, |most, norm| most.max(*norm));
    let moved: Vec<usize> = (0..norms.len()).filter(|&column| norms[column] > ROUNDING * longest).collect();
    let mut unit = factor.select_columns(&moved);
    unit.column_iter_mut().zip(&moved).for_each(|(mut column, &from)| column.unscale_mut(norms[from]));
    let singular = unit.singular_values();
    singular.max() / singular.min().max(f64::EPSILON * singular.max())
}

#[cfg(test)]
mod tests {
    use super::{GOOD, POOR, excitation};

    #[test]
    fn a_condition_number_is_said_in_words() {
        let said = [1.0, GOOD, GOOD + 1.0, POOR, POOR + 1.0, f64::INFINITY].map(excitation);
        assert!(said[0].contains("well") && said[1] == said[0]);
        assert!(said[2].contains("poorly") && said[3] == said[2]);
        assert!(said[4].contains("does not separate") && said[5] == said[4]);
    }
}
