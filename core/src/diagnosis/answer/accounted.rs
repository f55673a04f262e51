//! How much of what is hidden a diagnosis accounts for, where that is known: in studies.
//!
//! From logs alone, only the gap to an estimated noise floor can be estimated (`gap`), which at the size of the noise scatters as
//! much as the gap itself. With the hidden effects known, noise plays no part.

use crate::diagnosis::model::{Member, Session};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, combined, rms};
use crate::effects::Placed;
use crate::error::Result;

/// Share of what `hidden` adds to the held-out torque beyond what the baseline takes up that the extended model with `members` adds too:
/// 1 - (added - hidden)^2 / hidden^2 in sums of squares, the joints weighted by their `noise`; zero where it adds nothing. The baseline is
/// fitted in the noise under it (`first_whitener`), the extended model in its own.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn share_accounted_for(
    session: &Session,
    hidden: &[Placed],
    first_whitener: &Whitener,
    (members, whitener): (&[Member], &Whitener),
    noise: &[f64],
) -> Result<f64> {
    let added = |rows| Ok(combined(&session.model.arm.added(hidden, rows)?, &vec![1.0; hidden.len()]));
    let (train, mut wanted) = (added(&session.logs.train.rows)?, added(&session.logs.test.rows)?);
    let taken = first_whitener.solve(&session.logs.train.baseline, &train);
    for (column, value) in session.logs.test.baseline.iter().zip(taken.values) {
        wanted.add(-value, column);
    }
    let mut missed = wanted.clone();
    missed.add(-1.0, &session.residual_on(&session.logs.test, &[], first_whitener)?);
    missed.add(1.0, &session.held_out_residual(members, whitener)?);
    let valid = &session.logs.test.rows.valid;
    let square = |column: &Column| -> f64 {
        let joints = rms(valid, column).into_iter().zip(noise).zip(valid);
        joints.map(|((rms, noise), valid)| (rms / noise).powi(2) * valid.iter().filter(|ok| **ok).count() as f64).sum()
    };
    Ok(1.0 - square(&missed) / square(&wanted).max(f64::MIN_POSITIVE))
}
