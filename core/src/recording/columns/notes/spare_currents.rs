//! Currents of joints that have no torque, in a log with the torques of others.

use crate::recording::columns::families::{Candidate, Place};
use crate::recording::columns::layout::ABSENT;

/// What a dataset needs to take the currents in `own`, columns of torque and current, for joints without a torque. Torques and currents
/// are in units of their own, so that they are not taken together without one.
pub(in crate::recording::columns) fn note(
    header: &[String],
    names: &[String],
    tau: &[usize],
    own: &[Candidate],
    base: Option<usize>,
) -> Option<String> {
    let number = |place: Place| match place {
        Place::Index(index) => Some(index),
        Place::Number(number) => (number + 1).checked_sub(base.unwrap_or(1)),
    };
    let current = |joint: usize| {
        let of_joint = |own: &&Candidate| own.meaning.current && number(own.joint) == Some(joint + 1);
        own.iter().find(of_joint).map(|own| own.column)
    };
    let columns: Vec<Option<usize>> = tau
        .iter()
        .enumerate()
        .map(|(joint, &column)| if column == ABSENT { current(joint) } else { Some(column) })
        .collect();
    let spare: Vec<usize> = (0..tau.len()).filter(|&joint| tau[joint] == ABSENT && columns[joint].is_some()).collect();
    let first = *columns.get(*spare.first()?)?.as_ref()?;
    let joint = |joint: usize| names.get(joint).cloned().unwrap_or_else(|| format!("joint_{}", joint + 1));
    let joints = spare.iter().map(|&own| joint(own)).collect::<Vec<_>>().join(", ");
    let columns: Option<Vec<String>> =
        columns.iter().map(|own| own.map(|own| format!("\"{}\"", header[own]))).collect();
    let cure = columns.map_or(String::new(), |columns| {
        let constants: Vec<&str> = tau.iter().map(|&column| if column == ABSENT { "K" } else { "1" }).collect();
        format!(
            "; a dataset takes both: [columns] tau = [{}], [units] torque = \"A\", [motors] torque_constant_nm_a = [{}], with 1 where the column is in \
             N m and K the N m at the joint per A",
            columns.join(", "),
            constants.join(", ")
        )
    });
    Some(format!("the log has motor currents ({}) of joints without a torque ({joints}){cure}", header[first]))
}
