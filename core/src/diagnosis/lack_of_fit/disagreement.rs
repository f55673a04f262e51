//! Held-out logs that do not go with the training logs: of another arm, under another load, after something happened. Whatever is named
//! from the training logs, they do not judge it.

use super::structure::Unexplained;
use crate::diagnosis::criteria::StructureCriteria;
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::{Column, rms};

/// What is said of such a joint.
pub const LOGS_DISAGREE: &str = "is in the held-out logs alone";

/// Rows over which the residual is averaged: half a second. What smooth positions do to steps of the motion turns over within less, and
/// a load or another arm is there for longer.
const AVERAGED: usize = 25;

/// What a model leaves of one kind of rows.
type Left<'a> = (&'a Rows, &'a Column);

/// The joints on which the model leaves far more of the held-out rows than of the training rows, of its noise and of what it is unsure of
/// (root mean square, `[joint]`, N m), and not much less than the `baseline` leaves of the held-out rows.
pub(crate) fn disagreement(
    [train, test]: [Left; 2],
    baseline: &Column,
    noise: &[f64],
    prediction_std: &[f64],
    criteria: &StructureCriteria,
) -> Vec<Unexplained> {
    let on_joint = |joint: usize| {
        let [trained, held_out] = [train, test].map(|(rows, left)| averages(rows, left, joint));
        let expected = (criteria.foreign * trained)
            .max(criteria.above_noise * noise[joint])
            .max(criteria.foreign * prediction_std[joint]);
        let expected = expected.max(criteria.carried_on * averages(test.0, baseline, joint));
        tracing::debug!(joint, trained, held_out, expected, "held-out against training rows");
        (held_out > expected).then(|| Unexplained {
            joint,
            share: (held_out / rms(&test.0.valid, test.1)[joint]).powi(2).min(1.0),
            structure: LOGS_DISAGREE,
            family_wise_p: None,
            certain: true,
            instead_of: Vec::new(),
        })
    };
    (0..train.0.dof()).filter_map(on_joint).collect()
}

/// Root mean square of the residual of a joint, averaged over the valid rows of each half second.
fn averages(rows: &Rows, left: &Column, joint: usize) -> f64 {
    let Some(values) = left.part(joint) else { return 0.0 };
    let (mut sum, mut count) = (0.0, 0usize);
    for ends in rows.starts.windows(2) {
        let log: Vec<(f64, bool)> = (ends[0]..ends[1]).map(|row| (values[row], rows.valid[joint][row])).collect();
        for part in log.chunks(AVERAGED) {
            let counting: Vec<f64> = part.iter().filter(|(_, ok)| *ok).map(|(value, _)| *value).collect();
            if 2 * counting.len() >= AVERAGED {
                sum += (counting.iter().sum::<f64>() / counting.len() as f64).powi(2);
                count += 1;
            }
        }
    }
    (sum / count.max(1) as f64).sqrt()
}
