//! Changes of a set that the others make needless.
//!
//! A set grows by one change at a time. A change that stood for a part of the truth, before another one came, explains nothing beside that.

use super::found::Found;
use crate::quality::descriptions::change::{Change, Description};
use crate::quality::descriptions::compare::compare;
use crate::quality::descriptions::fitting::{Physics, Rows};
use crate::quality::descriptions::sizes::zeros;
use crate::quality::descriptions::tried::Tried;

/// What was found, with the best and its rivals as far as their changes are needed, in the rows in blocks, and whole. Of these the smallest
/// sets are kept.
pub(super) fn only(physics: &Physics, rows: [&Rows; 2], start: &Tried, found: Found) -> Found {
    let Found { best, rivals, next, gain, is_determined } = found;
    let count = |tried: &Tried| tried.description.changes.len();
    let before = count(&best);
    let mut each: Vec<Tried> =
        std::iter::once(best).chain(rivals).map(|own| reduced(physics, rows, start, own)).collect();
    let fewest = each.iter().map(count).min().unwrap_or(before);
    each.retain(|tried| count(tried) == fewest);
    let mut smallest: Vec<Tried> = Vec::new();
    for tried in each {
        if !smallest.iter().any(|other| other.description.same_but_for_sizes(&tried.description)) {
            smallest.push(tried);
        }
    }
    let best = smallest.remove(0);
    let gain = compare(&start.evaluation, &best.evaluation, &rows[0].log).unwrap_or(gain);
    Found { best, rivals: smallest, next, gain, is_determined }
}

/// A description without the changes by which it is not clearly better, one after the other.
fn reduced(physics: &Physics, [rows, whole]: [&Rows; 2], start: &Tried, mut own: Tried) -> Tried {
    loop {
        let with = own.description.changes.len();
        let shorter = without_each(&start.description, &own.description);
        let tried = shorter.into_iter().filter(|other| other.changes.len() < with).filter_map(|other| {
            let other = zeros::refined(physics, whole, &other).unwrap_or(other);
            Tried::new(physics, rows, other)
        });
        let is_needless = |other: &Tried| {
            compare(&other.evaluation, &own.evaluation, &rows.log).is_some_and(|gain| !gain.is_distinct())
        };
        let needless = tried.filter(is_needless).min_by(|a, b| a.share().total_cmp(&b.share()));
        match needless {
            Some(other) if other.description.changes.len() > start.description.changes.len() => own = other,
            _ => return own,
        }
    }
}

/// The description without each of the changes that were added to the start.
fn without_each(start: &Description, own: &Description) -> Vec<Description> {
    let is_zero = |change: &Change| matches!(change, Change::ZeroOffset(..));
    let others: Vec<Change> =
        own.changes.iter().filter(|change| !is_zero(change) && !start.changes.contains(change)).copied().collect();
    let without = |left_out: &Change| {
        let kept = others.iter().filter(|change| *change != left_out);
        kept.fold(start.clone(), |description, change| description.with(*change)).with_zeros(&own.position_offset)
    };
    let added =
        (0..own.dof()).filter(|&joint| own.position_offset[joint] != 0.0 && start.position_offset[joint] == 0.0);
    let without_zero = |joint: usize| {
        let mut offsets = own.position_offset.clone();
        offsets[joint] = 0.0;
        own.with_zeros(&offsets)
    };
    others.iter().map(without).chain(added.map(without_zero)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_change_beyond_the_start_is_left_out_in_turn() {
        let start = Description::as_given(3, nalgebra::Vector3::z()).with(Change::TorqueSign(0));
        let own = start.with(Change::TorqueSign(2)).with(Change::ZeroOffset(0, 0.5)).with(Change::ZeroOffset(1, 1.5));
        let each: Vec<Vec<Change>> = without_each(&start, &own).into_iter().map(|own| own.changes).collect();
        let sign = [Change::TorqueSign(0), Change::TorqueSign(2)];
        let zeros = [Change::ZeroOffset(0, 0.5), Change::ZeroOffset(1, 1.5)];
        let wanted =
            [vec![sign[0], zeros[0], zeros[1]], vec![sign[0], sign[1], zeros[1]], vec![sign[0], sign[1], zeros[0]]];
        assert_eq!(each, wanted);
    }
}
