//! Changes of a set that the others make needless.
//!
//! A set grows by one change at a time. A change that explained a part, before another was added, may explain nothing together with that.

use super::found::Found;
use crate::quality::descriptions::change::{Change, Description};
use crate::quality::descriptions::compare::compare;
use crate::quality::descriptions::fitting::{Physics, Rows};
use crate::quality::descriptions::sizes::zeros;
use crate::quality::descriptions::tried::Tried;

/// What was found without the changes of the best that its others make needless, in the rows in blocks, and whole; of the rivals those that
/// come to as few.
pub(super) fn only(physics: &Physics, rows: [&Rows; 2], start: &Tried, mut found: Found) -> Found {
    let count = |tried: &Tried| tried.description.changes.len();
    let Some(best) = reduced(physics, rows, start, &found.best) else { return found };
    let Some(gain) = compare(&start.evaluation, &best.evaluation, &rows[0].log) else { return found };
    let mut kept: Vec<Tried> = Vec::new();
    for rival in found.rivals {
        let rival = reduced(physics, rows, start, &rival).unwrap_or(rival);
        let is_known = |other: &Tried| other.description.same_but_for_sizes(&rival.description);
        if count(&rival) == count(&best) && !std::iter::once(&best).chain(&kept).any(is_known) {
            kept.push(rival);
        }
    }
    (found.best, found.rivals, found.gain) = (best, kept, gain);
    found
}

/// A description without changes that gain nothing to speak of, one after the other; none where each gains something. What is left is
/// compared with all of them, so that small losses do not add up.
pub(super) fn reduced(physics: &Physics, [rows, whole]: [&Rows; 2], start: &Tried, all: &Tried) -> Option<Tried> {
    let mut out: Option<Tried> = None;
    loop {
        let own = &out.as_ref().unwrap_or(all).description;
        let shorter = without_each(&start.description, own);
        let is_shorter = |other: &Description| {
            (start.description.changes.len() + 1..own.changes.len()).contains(&other.changes.len())
        };
        let tried = shorter
            .into_iter()
            .filter(is_shorter)
            .filter_map(|other| Tried::new(physics, rows, zeros::refined(physics, whole, &other).unwrap_or(other)));
        let is_as_good = |other: &Tried| {
            // A torque that drops out, as one that is given the motion of a joint at rest, is not explained.
            let both = other.evaluation.unexplained.iter().zip(&all.evaluation.unexplained);
            let explains_all = both.into_iter().all(|(other, all)| other.is_some() || all.is_none());
            let gain = compare(&other.evaluation, &all.evaluation, &rows.log);
            explains_all && gain.is_some_and(|gain| !gain.is_noticeable())
        };
        match tried.filter(is_as_good).min_by(|a, b| a.share().total_cmp(&b.share())) {
            Some(other) => out = Some(other),
            None => return out,
        }
    }
}

/// The description without each of the changes that were added to the start.
pub(super) fn without_each(start: &Description, own: &Description) -> Vec<Description> {
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
