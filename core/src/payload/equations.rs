//! The equations of the two estimators: differences of torque at equal states, and all rows of all logs.

use super::rows::LogRows;
use super::sums::{JointRows, Key, inverse, of_joints, selection, total, weights};
use crate::identification::equal_states::EqualState;
use crate::identification::model::Model;
use crate::robot::PARAMETERS;
use nalgebra::DVector;

/// What may change at a joint besides the load.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::payload::Change;
///
/// // What may change at a joint in addition to the load; results name it in snake case.
/// assert_eq!(serde_json::to_value([Change::Offset, Change::Viscous, Change::Coulomb]).unwrap()[0], "offset");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// Offset of the torque.
    Offset,
    /// Viscous friction.
    Viscous,
    /// Coulomb friction.
    Coulomb,
}

/// The kinds of [`Change`], in the order of their parameters.
pub(super) const CHANGES: [Change; 3] = [Change::Offset, Change::Viscous, Change::Coulomb];

/// Where the parameters stand: those of the arm, those of the load, and the changes of every joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// Parameters of the arm, which the differences do not have.
    pub arm: usize,
    /// Joints.
    pub dof: usize,
}

impl Layout {
    /// All parameters.
    pub(super) fn size(&self) -> usize {
        self.arm + PARAMETERS + CHANGES.len() * self.dof
    }

    /// Place of a change.
    pub(super) fn change(&self, joint: usize, kind: usize) -> usize {
        self.arm + PARAMETERS + CHANGES.len() * joint + kind
    }
}

/// Equations in rows by joint. Joints without an equation have no rows.
#[derive(Debug)]
pub(super) struct Equations {
    pub layout: Layout,
    pub joints: Vec<JointRows>,
}

/// The arm without the load, from the logs before: base parameters, then an offset of every joint.
pub(super) fn baseline(model: &Model, before: &[LogRows], block_s: f64) -> DVector<f64> {
    let size = arm_size(model);
    let joints: Vec<JointRows> = (0..model.dof())
        .map(|joint| {
            let mut rows = empty(model, joint, Layout { arm: size, dof: model.dof() });
            for (log, own) in before.iter().enumerate() {
                append_arm(&mut rows, model, own, joint, |row| {
                    Key::new((log, own.block(row, block_s)), Some(log), None)
                });
            }
            rows
        })
        .collect();
    let sums = of_joints(&joints, Layout { arm: size, dof: model.dof() }.size());
    let free: Vec<usize> = (0..size).collect();
    let weights = weights(&sums, &free);
    let map = selection(sums[0].rhs.len(), &free);
    let weighted: Vec<_> = sums.iter().zip(&weights).map(|(sums, &weight)| sums.times(weight).mapped(&map)).collect();
    let all = total(&weighted, size);
    inverse(&all.gram) * &all.rhs
}

/// Parameters of the arm: base parameters, then an offset of every joint.
fn arm_size(model: &Model) -> usize {
    model.base().len() + model.dof()
}

/// Rows of all logs: those after have the load and what changed.
pub(super) fn all_rows(model: &Model, before: &[LogRows], after: &[LogRows], block_s: f64) -> Equations {
    let layout = Layout { arm: arm_size(model), dof: model.dof() };
    let joints = (0..model.dof()).map(|joint| {
        let mut rows = empty(model, joint, layout);
        for (log, own) in before.iter().enumerate() {
            append_arm(&mut rows, model, own, joint, |row| Key::new((log, own.block(row, block_s)), Some(log), None));
        }
        for (log, own) in after.iter().enumerate() {
            let start = rows.y.len();
            let number = before.len() + log;
            append_arm(&mut rows, model, own, joint, |row| {
                Key::new((number, own.block(row, block_s)), None, Some(log))
            });
            for (place, row) in (start..).zip(valid(own, joint)) {
                set_change(&mut rows, model, own, joint, (row, place));
            }
        }
        rows
    });
    Equations { layout, joints: joints.collect() }
}

/// Differences at equal states. What states differ by is taken off by the model `arm` of the arm without the load.
pub(super) fn differences(
    model: &Model,
    (before, after): (&[LogRows], &[LogRows]),
    matched: &[Vec<EqualState>],
    arm: &DVector<f64>,
    block_s: f64,
) -> Equations {
    let layout = Layout { arm: 0, dof: model.dof() };
    // A row of the side with fewer logs is in several differences: its noise stays in one cluster.
    let by_before = before.len() < after.len();
    let joints = (0..model.dof()).map(|joint| {
        let mut rows = empty(model, joint, layout);
        for (log, (own, matched)) in after.iter().zip(matched).enumerate() {
            for row in valid(own, joint) {
                let Some((other, there)) = matched[row] else { continue };
                if !before[other].arm[joint].valid[there] {
                    continue;
                }
                let (now, then) = (&own.arm[joint], &before[other].arm[joint]);
                let expected: f64 = now
                    .parameters
                    .iter()
                    .enumerate()
                    .map(|(k, &b)| (now.columns.channel(k)[row] - then.columns.channel(k)[there]) * arm[b])
                    .sum();
                rows.y.push(now.torque[row] - then.torque[there] - expected);
                let place = match by_before {
                    true => (other, before[other].block(there, block_s)),
                    false => (log, own.block(row, block_s)),
                };
                rows.keys.push(Key::new(place, Some(other), Some(log)));
                rows.columns.iter_mut().for_each(|column| column.push(0.0));
                let place = rows.y.len() - 1;
                set_change(&mut rows, model, own, joint, (row, place));
            }
        }
        rows
    });
    Equations { layout, joints: joints.collect() }
}

/// Valid rows.
fn valid(log: &LogRows, joint: usize) -> impl Iterator<Item = usize> + '_ {
    log.arm[joint].valid.iter().enumerate().filter_map(|(row, &ok)| ok.then_some(row))
}

/// A joint's columns without rows: those of the arm where the layout has any, its offset, those of the load, three changes.
fn empty(model: &Model, joint: usize, layout: Layout) -> JointRows {
    let mut parameters = if layout.arm > 0 { model.active(joint) } else { Vec::new() };
    if layout.arm > 0 {
        parameters.push(model.base().len() + joint);
    }
    parameters.extend(layout.arm..layout.arm + PARAMETERS);
    parameters.extend((0..CHANGES.len()).map(|kind| layout.change(joint, kind)));
    let columns = vec![Vec::new(); parameters.len()];
    JointRows { parameters, columns, y: Vec::new(), keys: Vec::new() }
}

fn append_arm(rows: &mut JointRows, model: &Model, log: &LogRows, joint: usize, key: impl Fn(usize) -> Key) {
    if !model.has_equation(joint) {
        return;
    }
    let own = &log.arm[joint];
    for row in valid(log, joint) {
        rows.y.push(own.torque[row]);
        rows.keys.push(key(row));
        for (k, column) in rows.columns.iter_mut().enumerate() {
            column.push(match k.cmp(&own.parameters.len()) {
                std::cmp::Ordering::Less => own.columns.channel(k)[row],
                std::cmp::Ordering::Equal => 1.0,
                std::cmp::Ordering::Greater => 0.0,
            });
        }
    }
}

/// Fills the columns of the load and of the changes in one row, which is the last thirteen.
fn set_change(rows: &mut JointRows, model: &Model, log: &LogRows, joint: usize, (row, place): (usize, usize)) {
    let first = rows.columns.len() - PARAMETERS - CHANGES.len();
    let load = &log.load[joint];
    for k in 0..load.channels() {
        rows.columns[first + k][place] = load.channel(k)[row];
    }
    let own = &log.arm[joint];
    let drive = |which: usize| {
        let column = own.parameters.iter().position(|&b| model.drive_of(b) == Some((joint, which)));
        column.map_or(0.0, |k| own.columns.channel(k)[row])
    };
    let changes = [1.0, drive(1), drive(2)];
    for (kind, value) in changes.into_iter().enumerate() {
        rows.columns[first + PARAMETERS + kind][place] = value;
    }
}
