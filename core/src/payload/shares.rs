//! What each joint shows of the load: a check of the torque constants of the joints against each other.

use super::answer::{JointShare, Payload, Quantity};
use super::equations::Equations;
use super::estimate::Estimate;
use super::sums::JointRows;
use crate::linear::root_mean_square;
use crate::robot::{PARAMETERS, Robot};
use std::collections::BTreeMap;

/// Largest standard error of a share that says anything of a torque constant.
const LARGEST_ERROR: f64 = 0.1;

/// Standard errors by which a share must differ from one, and by how much, so that torque constants disagree.
const SIGNIFICANT: f64 = 4.0;
const LEAST: f64 = 0.1;

/// The load's torque and the residual in every row of a joint.
fn parts(equations: &Equations, estimate: &Estimate, joint: &JointRows) -> [Vec<f64>; 2] {
    let (mut load, mut residual) = (vec![0.0; joint.y.len()], joint.y.clone());
    let places = equations.layout.arm..equations.layout.arm + PARAMETERS;
    for (column, &parameter) in joint.columns.iter().zip(&joint.parameters) {
        let value = estimate.beta[parameter];
        if value == 0.0 {
            continue;
        }
        residual.iter_mut().zip(column).for_each(|(rest, x)| *rest -= value * x);
        if places.contains(&parameter) {
            load.iter_mut().zip(column).for_each(|(sum, x)| *sum += value * x);
        }
    }
    [load, residual]
}

/// Rows in which the load acts: those after.
fn rows_after<'a>(joint: &'a JointRows, values: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    joint.keys.iter().zip(values).filter(|(key, _)| key.after.is_some()).map(|(_, value)| *value)
}

/// Root mean square of the load's torque on every joint.
pub(super) fn sized(equations: &Equations, estimate: &Estimate) -> Vec<f64> {
    let of = |joint: &JointRows| {
        let [load, _] = parts(equations, estimate, joint);
        root_mean_square(&rows_after(joint, &load).collect::<Vec<_>>())
    };
    equations.joints.iter().map(of).collect()
}

/// What every joint shows.
pub(super) fn shares(robot: &Robot, equations: &Equations, estimate: &Estimate) -> Vec<JointShare> {
    let of = |(joint, rows): (usize, &JointRows)| {
        let [load, residual] = parts(equations, estimate, rows);
        let square: f64 = load.iter().map(|x| x * x).sum();
        let mut slopes: BTreeMap<usize, f64> = BTreeMap::new();
        for ((key, load), rest) in rows.keys.iter().zip(&load).zip(&residual) {
            *slopes.entry(key.cluster).or_default() += load * rest;
        }
        let slope: f64 = slopes.values().sum();
        let error = slopes.values().map(|s| s * s).sum::<f64>().sqrt();
        let share = Quantity { value: 1.0 + slope / square, standard_error: error / square };
        let spec = &robot.joints[joint];
        JointShare {
            joint: spec.name.clone(),
            unit: spec.effort_unit(),
            load: root_mean_square(&rows_after(rows, &load).collect::<Vec<_>>()),
            residual: root_mean_square(&rows_after(rows, &residual).collect::<Vec<_>>()),
            share: (square > 0.0 && share.standard_error <= LARGEST_ERROR).then_some(share),
        }
    };
    equations.joints.iter().enumerate().map(of).collect()
}

impl Payload {
    /// A sentence where joints disagree about the load.
    #[doc(hidden)]
    pub fn disagreement(&self) -> Option<String> {
        disagreement(&self.joints)
    }
}

/// A sentence where joints disagree about the load.
pub(super) fn disagreement(joints: &[JointShare]) -> Option<String> {
    let differs = |share: &Quantity| {
        let off = (share.value - 1.0).abs();
        off > LEAST && off > SIGNIFICANT * share.standard_error
    };
    let shown: Vec<String> = joints
        .iter()
        .filter_map(|joint| Some((joint, joint.share.filter(differs)?)))
        .map(|(joint, share)| format!("{} {:.2} +- {:.2}", joint.joint, share.value, share.standard_error))
        .collect();
    (!shown.is_empty()).then(|| {
        format!(
            "joints disagree about the load (share of its torque that each shows: {}): their torque constants differ by as much, and \
             the standard errors do not hold that",
            shown.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share(value: f64, standard_error: f64) -> JointShare {
        let share = Some(Quantity { value, standard_error });
        JointShare { joint: "a".into(), unit: "N m", load: 1.0, residual: 0.1, share }
    }

    #[test]
    fn joints_disagree_where_the_difference_is_large_and_beyond_chance() {
        for (value, error, said) in
            [(1.11, 0.02, true), (1.09, 0.02, false), (0.85, 0.0374, true), (0.85, 0.0376, false), (1.0, 0.01, false)]
        {
            assert_eq!(disagreement(&[share(value, error)]).is_some(), said, "{value} {error}");
        }
    }
}
