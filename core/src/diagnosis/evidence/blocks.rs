//! Whether evidence is spread over the motion: what rests on a moment or two may be anything that went wrong there.

use super::judging::Judged;
use crate::diagnosis::model::{Member, Session, is_event};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::Column;
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

#[cfg(test)]
mod tests {
    use super::*;

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
