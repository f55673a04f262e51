//! Whether evidence is spread over the motion and over the joints: what rests on a moment or two, or on one joint, may be anything that
//! went wrong there.

use super::judging::Judged;
use crate::diagnosis::criteria::Levels;
use crate::diagnosis::model::{Member, Session, is_event};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection};
use crate::error::Result;
use std::ops::Range;

/// Rows in a block (one second): longer than the memory of noise and filters.
pub(super) const BLOCK: usize = 50;

/// The same for an event, which may last no longer than that: a tenth of a second.
const MOMENT: usize = 5;

/// The block of so many rows with the largest sum.
pub(super) fn most_influential_block(of_rows: &[f64], width: usize) -> Range<usize> {
    let width = width.min(of_rows.len());
    let mut sum: f64 = of_rows[..width].iter().sum();
    let mut best = (sum, 0);
    for end in width..of_rows.len() {
        sum += of_rows[end] - of_rows[end - width];
        if sum > best.0 {
            best = (sum, end + 1 - width);
        }
    }
    best.1..best.1 + width
}

/// Row of the logs and whitened residual before and after, of every valid row on every joint of both.
pub(super) fn row_by_row<'a>(
    whitener: &'a Whitener,
    before: &'a Column,
    after: &'a Column,
) -> impl Iterator<Item = (usize, f64, f64)> + 'a {
    before.parts.iter().flat_map(|(joint, values)| {
        let others = after.part(*joint).unwrap_or_default();
        whitener.places(*joint).iter().zip(values).zip(others).map(|((place, b), a)| (*place, *b, *a))
    })
}

/// Logarithm of the probability of what a candidate takes beyond the model with `members` outside the blocks in which it
/// takes most.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn without_influential_blocks(
    session: &Session,
    members: &[Member],
    whitener: &Whitener,
    winner: &Judged,
) -> Result<f64> {
    let present = session.model.columns(&session.logs.train, members)?;
    let mut rows = session.logs.train.rows.clone();
    let mut whitener = whitener.clone();
    let width = if is_event(winner.candidate.placed.effect) { MOMENT } else { BLOCK };
    for _ in 0..session.criteria.levels.few {
        let fit = whitener.fit(&present, &session.logs.train.torque);
        let with = fit.with(&whitener.apply_all(&winner.candidate.columns));
        let mut gains = vec![0.0; rows.len()];
        for (place, before, after) in row_by_row(&whitener, &fit.residual, &with.residual) {
            gains[place] += before * before - after * after;
        }
        let best = most_influential_block(&gains, width);
        rows.valid.iter_mut().for_each(|valid| valid[best.clone()].fill(false));
        whitener = whitener.on(&rows);
    }
    let fit = whitener.fit(&present, &session.logs.train.torque);
    let log_p = session.judge(&winner.candidate, &whitener, &fit).map_or(0.0, |judged| judged.test.log_p());
    tracing::debug!(log_p, "without the best blocks");
    Ok(log_p)
}

/// By how much the value of a law of one parameter, the same on all joints, differs without the joint on which it explains most: over half of
/// the value or three standard deviations ([`Levels::most`], [`Levels::far`]), whichever is more. Zero where the other joints determine
/// nothing.
pub(crate) fn apart_without_influential_joint(fit: &Projection, winner: &Judged, levels: &Levels) -> f64 {
    let ([column], [value]) = (&winner.whitened[..], &winner.test.values[..]) else { return 0.0 };
    let gain = |joint: usize| {
        let own = column.only(&[joint]);
        2.0 * value * own.dot(&fit.residual) - value * value * own.dot(&own)
    };
    let joints: Vec<usize> = column.parts.iter().map(|(joint, _)| *joint).collect();
    let best = joints.iter().copied().max_by(|a, b| gain(*a).total_cmp(&gain(*b)));
    let others: Vec<usize> = joints.into_iter().filter(|joint| Some(*joint) != best).collect();
    let Some(test) = fit.test(&[column.only(&others)]).filter(|_| !others.is_empty()) else { return 0.0 };
    let apart = (test.values[0] - value).abs() / (levels.most * value.abs()).max(levels.far * test.std[0]);
    tracing::debug!(value, without = test.values[0], std = test.std[0], apart, "without the best joint");
    apart
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::model::Candidate;
    use crate::effects::{self, Placed};

    #[test]
    fn a_delay_of_all_torques_is_none_of_one_joint() {
        let wave = |joint: usize, size: f64| (0..400).map(move |t| size * (0.1 * (joint + 1) as f64 * t as f64).sin());
        let apart = |sizes: &[f64]| {
            let on_each = |sizes: &[f64]| {
                Column::new(sizes.iter().enumerate().map(|(joint, &size)| wave(joint, size).collect::<Vec<f64>>()))
            };
            let (column, torque) = (on_each(&vec![1.0; sizes.len()]), on_each(sizes));
            let fit = Projection::new(&[Column::on(0, vec![1.0; 400])], &torque);
            let placed = Placed { effect: effects::delay(), joint: 0, parameters: vec![1e-3] };
            let test = fit.test(std::slice::from_ref(&column)).unwrap();
            let candidate = Candidate { placed, log: None, columns: vec![column.clone()].into() };
            apart_without_influential_joint(
                &fit,
                &Judged { candidate, whitened: vec![column], test },
                &Levels::default(),
            )
        };
        assert!(apart(&[3.0, 3.0, 3.0]) < 0.01 && apart(&[9.0]) == 0.0);
        // With four times as much on one of three joints, twice the value of the others: off by half.
        assert!(apart(&[11.4, 3.0, 3.0]) < 1.0 && apart(&[12.7, 3.0, 3.0]) > 1.0);
        // Three standard deviations, of 1/20 each, are more than half of a value that is small.
        assert!(apart(&[0.3, 0.0, 0.0]) < 1.0 && apart(&[0.6, 0.0, 0.0]) > 1.0);
    }

    #[test]
    fn the_most_influential_block_is_where_most_is_gained() {
        let mut rows = vec![0.1; 400];
        rows[120] = 30.0;
        rows[165] = 20.0;
        let best = most_influential_block(&rows, BLOCK);
        assert_eq!(best.len(), BLOCK);
        assert!(best.contains(&120) && best.contains(&165));
        assert_eq!(most_influential_block(&rows, MOMENT), 116..121);
        assert_eq!(most_influential_block(&[1.0, 2.0], BLOCK), 0..2);
    }
}
