//! What the bodies weigh under another direction of gravity than that described.
//!
//! A first axis along gravity does not feel the first moments of what it carries, so that no base parameter holds them. An effect that
//! turns gravity makes them felt, in proportion to its size: with the described moments in their place, wrong ones would change the size
//! that is found.

use super::arm_columns::all_over_rows;
use super::member::Member;
use super::prepared::PreparedLogs;
use super::session::Session;
use crate::channels::Channels;
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::{Column, joints_of};
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::identification::effect_model::{Arm, Trust};
use crate::identification::model::Model;
use crate::linear::{OrthonormalBasis, length};
use nalgebra::Vector3;

/// Share of a column's size below which its residual over the others is rounding. A moment is rounding below this share of the weight of 1
/// kg m.
const ROUNDING: f64 = 1e-6;

/// Changes of the bodies that gravity as described does not show, with their places in the baseline.
#[derive(Debug, Default)]
pub(crate) struct Unseen {
    /// Changes of the standard parameters, one for each column.
    changes: Vec<Vec<f64>>,
    /// Place of the first column.
    first: usize,
    /// Columns along the training and the held-out logs.
    columns: [Vec<Column>; 2],
}

impl Unseen {
    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// The logs with the columns in their baselines.
    pub(crate) fn free_in(&self, logs: &PreparedLogs) -> PreparedLogs {
        logs.clone().with(self.first, &self.columns)
    }

    /// The standard parameters' change with these values of the baseline.
    pub(crate) fn change(&self, baseline: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.changes.first().map_or(0, Vec::len)];
        for (change, value) in self.changes.iter().zip(&baseline[self.first..]) {
            sum.iter_mut().zip(change).for_each(|(sum, part)| *sum += value * part);
        }
        sum
    }
}

impl Session<'_> {
    /// What the `members` make felt of the bodies by turning gravity.
    pub(crate) fn unseen(&self, members: &[Member]) -> Unseen {
        let arm = &self.model.arm;
        let turned = turned_gravity(arm, members);
        let described = arm.described().gravity;
        let differences = self.logs.train.rows.equal_states.is_some();
        if arm.trust() == Trust::Nominal || turned == described || differences {
            return Unseen::default();
        }
        let model = self.model.base;
        let more = turned - described;
        let mut changes = model.base().unseen();
        let columns = torques(arm, &self.logs.train.rows, more, &changes);
        let independent = independent(&columns, more.norm() * (self.logs.train.rows.len() as f64).sqrt());
        changes = independent.iter().map(|&place| changes[place].clone()).collect();
        let own = independent.into_iter().map(|place| columns[place].clone()).collect();
        let held_out = torques(arm, &self.logs.test.rows, more, &changes);
        Unseen { changes, first: self.blocks(&[]).known.start, columns: [own, held_out] }
    }
}

/// Gravity of the arm as found with the effects in the model, in base coordinates, m/s2.
fn turned_gravity(arm: &Arm, members: &[Member]) -> Vector3<f64> {
    let mut robot = arm.found().clone();
    for Member { placed, .. } in members.iter().filter(|member| !member.held) {
        placed.effect.alter(&placed.parameters, placed.joint, &mut robot);
    }
    robot.gravity
}

/// Torques of changes of the standard parameters at rest under a gravity, over the rows from after the change in question.
fn torques(arm: &Arm, rows: &Rows, gravity: Vector3<f64>, changes: &[Vec<f64>]) -> Vec<Column> {
    let chain = Chain::new(arm.described()).with_gravity(gravity.into());
    let at_rest: Vec<Motion> = rows.logs.iter().map(|log| Motion::at_rest(log.motion.q.clone())).collect();
    let of = |change: &Vec<f64>| {
        let inertial = Model::with_standard_values(arm.described(), change).inertial_parameters();
        let logs = at_rest.iter().enumerate().map(|(index, motion)| match index < rows.before {
            true => Channels::zeros(motion.q.channels(), motion.q.samples()),
            false => inverse_dynamics(&chain, &inertial, motion),
        });
        all_over_rows(rows, &logs.collect::<Vec<_>>())
    };
    changes.iter().map(of).collect()
}

/// Places of columns that no others before them make up, without those that are rounding against the size of `one`.
fn independent(columns: &[Column], one: f64) -> Vec<usize> {
    let rows = columns.iter().flat_map(|column| &column.parts).map(|(_, values)| values.len()).max().unwrap_or(0);
    let joints = joints_of(columns);
    let nothing = vec![0.0; rows];
    let dense =
        |column: &Column| joints.iter().flat_map(|joint| column.part(*joint).unwrap_or(&nothing)).copied().collect();
    let dense: Vec<(usize, Vec<f64>)> = columns.iter().map(dense).enumerate().collect();
    let large: Vec<&(usize, Vec<f64>)> = dense.iter().filter(|(_, values)| length(values) > ROUNDING * one).collect();
    let values: Vec<&[f64]> = large.iter().map(|(_, values)| values.as_slice()).collect();
    OrthonormalBasis::new(&values, ROUNDING).kept.into_iter().map(|k| large[k].0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_kept_that_are_no_rounding_and_no_sums_of_others() {
        let on = |values: [f64; 3]| Column::on(0, values.to_vec());
        let columns =
            [on([1e-9; 3]), on([1.0, 0.0, 1.0]), on([0.0, 2e-6, 0.0]), on([-2.0, 0.0, -2.0]), on([1.0, 1.0, 1.0])];
        assert_eq!(independent(&columns, 1.0), [1, 2]);
        assert_eq!(independent(&columns, 3.0), [1, 4]);
        assert!(independent(&columns, 1e7).is_empty());
    }

    #[test]
    fn a_first_axis_along_gravity_hides_two_moments_of_what_it_carries() {
        use crate::robot::{InertiaCheck, load};
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let robot = load(path, InertiaCheck::Required).unwrap();
        let felt = |gravity: Vector3<f64>, more: Vector3<f64>| {
            let robot = crate::robot::Robot { gravity, ..robot.clone() };
            let changes = Model::new(&robot).base().unseen();
            let chain = Chain::new(&robot).with_gravity(more.into());
            let q = Channels::from_vectors(
                &(0..6)
                    .map(|j| (0..9).map(|k| (1.3 * f64::from(k) + f64::from(j)).sin()).collect())
                    .collect::<Vec<_>>(),
            );
            let column = |change: &Vec<f64>| {
                let inertial = Model::with_standard_values(&robot, change).inertial_parameters();
                let torque = inverse_dynamics(&chain, &inertial, &Motion::at_rest(q.clone()));
                Column::new((0..6).map(|joint| torque.channel(joint).to_vec()))
            };
            independent(&changes.iter().map(column).collect::<Vec<_>>(), more.norm() * 3.0).len()
        };
        let upright = robot.gravity;
        assert_eq!(felt(upright, Vector3::new(0.5, -0.3, 0.0)), 2);
        // Gravity that is along no axis shows all that another shows.
        assert_eq!(felt(Vector3::new(6.0, 1.0, -7.6), Vector3::new(0.5, -0.3, 0.2)), 0);
    }
}
