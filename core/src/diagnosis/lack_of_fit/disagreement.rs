//! Held-out logs that do not go with the training logs: of another arm, under another load, after something happened. Whatever is named
//! from the training logs, they do not judge it.

use super::reported::{RejectedStructure, Structure, Unexplained};
use crate::diagnosis::criteria::{Criteria, Gate, Judgement};
use crate::diagnosis::logs::Rows;
use crate::diagnosis::model::{Member, Session};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, rms};
use crate::error::Result;
use std::ops::Range;

/// How such a joint is reported.
pub const LOGS_DISAGREE: &str = "is in the held-out logs alone";

/// Rows over which the residual is averaged: half a second. What smoothing of the positions does to steps of the motion averages out within
/// less, and a load or another arm is there for longer.
const AVERAGED: usize = 25;

/// Parts of the training rows that are left out one after the other: each is about as long as what is held out of a log.
const PARTS: usize = 4;

/// The joints on which the held-out logs do not go with the training logs, by the residual of the model with `members` averaged over half a
/// second. It must be far above that of the training rows, above the noise, far above the standard deviation of the prediction
/// (`prediction_std`, N m, `[joint]`), and not much less than the residual of the `baseline`.
///
/// Two more gates follow. It must exceed the residual of each part of the training rows under a fit to the others: what errors of the
/// positions do to poorly excited parameters is in no standard deviation. And no one set of parameters may fit all logs: if one does, the
/// training logs determine some parameters poorly, and the held-out logs do not disagree. A joint that fails one of these is rejected.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn disagreement(
    session: &Session,
    (members, whitener): (&[Member], &Whitener),
    [trained, held_out]: [&Column; 2],
    baseline: &Column,
    prediction_std: &[f64],
) -> Result<Structure> {
    let Criteria { levels, structure, .. } = &session.criteria;
    let noise = whitener.noise_std();
    let [train, test] = [(&session.logs.train.rows, trained), (&session.logs.test.rows, held_out)];
    let on_joint = |joint: usize| {
        let [trained, held_out] = [train, test].map(|(rows, left)| averages(rows, 0..rows.logs.len(), left, joint));
        let expected =
            (levels.far * trained).max(structure.above_noise * noise[joint]).max(levels.far * prediction_std[joint]);
        let most = expected.max(levels.most * averages(test.0, 0..test.0.logs.len(), baseline, joint));
        tracing::debug!(joint, trained, held_out, expected, most, "held-out against training rows");
        let clear = Judgement::above(Gate::AboveExpected, held_out / most, 1.0);
        (clear.passed && held_out > 0.0).then_some((joint, held_out, expected, clear))
    };
    let apart: Vec<(usize, f64, f64, Judgement)> = (0..train.0.dof()).filter_map(on_joint).collect();
    if apart.is_empty() {
        return Ok(Structure::default());
    }
    let left_out = parts_left_out(session, members, whitener)?;
    let together = fitted_together(session, members, whitener)?;
    let mut found = Structure::default();
    for (joint, held_out, expected, clear) in apart {
        let unlike_parts = Judgement::above(Gate::AboveExpected, held_out / left_out[joint], 1.0);
        let apart = Judgement::above(Gate::AboveExpected, together[joint] / expected, 1.0);
        let (structure, passed) = (LOGS_DISAGREE, [clear, unlike_parts, apart]);
        match Judgement::first_failed(passed) {
            Some(failed) => found.rejected.push(RejectedStructure { joint, structure, failed }),
            None => found.unexplained.push(Unexplained {
                joint,
                share: (held_out / rms(&test.0.valid, test.1)[joint]).powi(2).min(1.0),
                structure,
                family_wise_p: None,
                certain: true,
                instead_of: Vec::new(),
                passed: passed.to_vec(),
            }),
        }
    }
    Ok(found)
}

/// The largest residual of a part of the training rows under a fit to the other parts, averaged likewise, `[joint]`, N m.
fn parts_left_out(session: &Session, members: &[Member], whitener: &Whitener) -> Result<Vec<f64>> {
    let data = &session.logs.train;
    let columns = session.model.columns(data, members)?;
    let mut most = vec![0.0f64; data.rows.dof()];
    let logs = 0..data.rows.logs.len();
    let [mut others, mut left_out] = [(); 2].map(|()| data.rows.clone());
    for part in 0..PARTS {
        let own = part * data.rows.len() / PARTS..(part + 1) * data.rows.len() / PARTS;
        for (joint, valid) in data.rows.valid.iter().enumerate() {
            let of =
                |inside: bool| valid.iter().enumerate().map(|(row, &ok)| ok && own.contains(&row) == inside).collect();
            (others.valid[joint], left_out.valid[joint]) = (of(false), of(true));
        }
        let whitener = whitener.on(&others);
        let solved = whitener.solve(&columns, &data.torque);
        let residual = data.residual(&columns, &solved.values);
        for (joint, most) in most.iter_mut().enumerate() {
            *most = most.max(averages(&left_out, logs.clone(), &residual, joint));
        }
    }
    tracing::debug!(?most, "parts of the training rows by fits without them");
    Ok(most)
}

/// Residual of the training or of the held-out rows, whichever is larger, under one set of parameters for all logs, averaged likewise,
/// `[joint]`, N m.
fn fitted_together(session: &Session, members: &[Member], whitener: &Whitener) -> Result<Vec<f64>> {
    let all = session.over_all_logs();
    let data = &all.logs.train;
    let columns = all.model.columns(data, members)?;
    let whitener = whitener.on(&data.rows);
    let solved = whitener.solve(&columns, &data.torque);
    let residual = data.residual(&columns, &solved.values);
    let training = session.logs.train.rows.logs.len();
    let kinds = [0..training, training..data.rows.logs.len()];
    let on_joint = |joint: usize| {
        let each = kinds.iter().map(|logs| averages(&data.rows, logs.clone(), &residual, joint));
        each.fold(0.0, f64::max)
    };
    let together = (0..data.rows.dof()).map(on_joint).collect();
    tracing::debug!(?together, "all rows by one set of parameters");
    Ok(together)
}

/// Root mean square of the residual of a joint in some of the logs, averaged over the valid rows of each half second.
fn averages(rows: &Rows, logs: Range<usize>, left: &Column, joint: usize) -> f64 {
    let Some(values) = left.part(joint) else { return 0.0 };
    let (mut sum, mut count) = (0.0, 0usize);
    for ends in rows.starts[logs.start..=logs.end].windows(2) {
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
