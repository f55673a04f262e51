//! What a model leaves of each log when it is fitted to the others.

use super::column::Column;
use super::session::{Member, Session};
use super::solution::solve;
use super::whitening::Whitener;
use crate::error::Result;

/// What the model with `members` leaves of every log that is identified from, fitted to all the others.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn left_by_others(session: &Session, members: &[Member], whitener: &Whitener) -> Result<Column> {
    let side = &session.train;
    let columns = session.all_columns(side, members)?;
    let mut others = side.rows.clone();
    let mut left = side.torque.clone();
    for log in side.rows.starts.windows(2) {
        let own = log[0]..log[1];
        others.valid.iter_mut().for_each(|valid| valid[own.clone()].fill(false));
        let of_others = whitener.on(&others);
        let values = solve(&of_others.apply_all(&columns), &of_others.apply(&side.torque)).values;
        for (joint, left) in &mut left.parts {
            for (column, value) in columns.iter().zip(&values) {
                let Some(signal) = column.part(*joint) else { continue };
                left[own.clone()].iter_mut().zip(&signal[own.clone()]).for_each(|(left, x)| *left -= value * x);
            }
        }
        others
            .valid
            .iter_mut()
            .zip(&side.rows.valid)
            .for_each(|(valid, of_rows)| valid[own.clone()].copy_from_slice(&of_rows[own.clone()]));
    }
    Ok(left)
}
