//! Columns of several joints, for findings that they share.

use super::view::View;

/// The joints that share a property, by the property.
pub(super) fn grouped<T: PartialEq>(dof: usize, of: impl Fn(usize) -> Option<T>) -> Vec<(T, Vec<usize>)> {
    let mut out: Vec<(T, Vec<usize>)> = Vec::new();
    for joint in 0..dof {
        let Some(own) = of(joint) else { continue };
        match out.iter_mut().find(|(known, _)| *known == own) {
            Some((_, joints)) => joints.push(joint),
            None => out.push((own, vec![joint])),
        }
    }
    out
}

/// The columns of a quantity of some joints, or of all.
pub(super) fn places(view: &View, quantity: &str, joints: &[usize]) -> String {
    if joints.len() == view.dof() && joints.len() > 1 {
        return format!("{quantity}1 .. {quantity}{}", view.dof());
    }
    joints.iter().map(|&joint| view.place(quantity, joint)).collect::<Vec<_>>().join(", ")
}
