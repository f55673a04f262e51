//! What a controller makes of the noise of its encoders: closed-loop identification with errors in the measured output (Forssell and
//! Ljung, Closed-loop identification revisited, Automatica 35, 1999).
//!
//! A position controller answers to what its encoder reads, and takes the encoder's noise and rounding for errors of the position. The
//! torque that this makes goes with positions as measured, and therefore with all that is worked out from them. Above the frequency from
//! which positions are mostly noise it is seen in them: there the torque may go with the position and with its rate, by gains that are
//! free.

use crate::diagnosis::logs::{Log, Rows};
use crate::diagnosis::regression::Column;
use crate::error::Result;
use rayon::prelude::*;

/// Columns of each joint.
pub(super) const FEEDBACK: usize = 2;

/// For every joint what its encoder reads above the frequency from which the position is mostly noise, rad or m, and its rate, over
/// the rows: two columns a joint, which are empty where that frequency is above `seen_hz`, since the torque does not show it.
///
/// # Errors
/// If a log is too short for the filters.
pub(super) fn feedback(rows: &Rows, seen_hz: f64) -> Result<Vec<Column>> {
    let of_joint = |joint: usize| -> Result<Vec<Column>> {
        let noise = rows.logs.iter().map(|log| log.above_motion(joint, seen_hz)).collect::<Result<Vec<_>>>()?;
        let columns = [0, 1].map(|order| {
            let of_log = |(log, noise): (&Log, &[Vec<f64>; 2])| log.as_logged(&noise[order]);
            rows.logs.iter().zip(&noise).flat_map(of_log).collect::<Vec<f64>>()
        });
        let on_joint = |values: Vec<f64>| match values.iter().any(|value| *value != 0.0) {
            true => Column::on(joint, values),
            false => Column::default(),
        };
        Ok(columns.map(on_joint).into())
    };
    let each = (0..rows.dof()).into_par_iter().map(of_joint).collect::<Result<Vec<Vec<Column>>>>()?;
    Ok(each.concat())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::diagnosis::regression::solve;
    use crate::recording::Recording;

    const RATE: f64 = 500.0;
    const STIFFNESS: f64 = 200.0;

    /// Rows of a joint that swings, read in steps of `step`, rad, with the torque of a controller that answers to the error of reading.
    fn rows(step: f64) -> Rows {
        let time: Vec<f64> = (0..20_000).map(|k| f64::from(k) / RATE).collect();
        let motion = |t: &f64| 0.8 * (1.9 * t).sin() + 0.2 * (4.3 * t).cos();
        let read = |t: &f64| if step > 0.0 { (motion(t) / step).round() * step } else { motion(t) };
        let answer = |t: &f64| -STIFFNESS * (read(t) - motion(t));
        let q = Channels::from_vectors(&[time.iter().map(read).collect()]);
        let tau = Channels::from_vectors(&[time.iter().map(answer).collect()]);
        let log = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        Rows::new(&[&log], 20.0, 1).unwrap()
    }

    fn square(values: &[f64]) -> f64 {
        values.iter().map(|x| x * x).sum()
    }

    #[test]
    fn a_controllers_stiffness_is_found_in_what_it_makes_of_steps() {
        let rows = rows(2e-3);
        let columns = feedback(&rows, f64::INFINITY).unwrap();
        assert_eq!(columns.len(), 2);
        let torque = Column::new(rows.torque.iter().cloned());
        let solved = solve(&columns, &torque);
        assert!((solved.values[0] / -STIFFNESS - 1.0).abs() < 0.1, "{:?}", solved.values);
        let mut left = torque.clone();
        columns.iter().zip(&solved.values).for_each(|(column, value)| left.add(-value, column));
        let [all, left] = [&torque, &left].map(|column| square(column.part(0).unwrap()));
        assert!(left < 0.5 * all, "{left} of {all}");
    }

    #[test]
    fn what_the_torque_does_not_show_has_no_columns() {
        let rows = rows(2e-3);
        let hz = rows.logs[0].noise_from_hz().unwrap()[0];
        let is_empty = |seen_hz: f64| feedback(&rows, seen_hz).unwrap().iter().all(|column| column.parts.is_empty());
        assert!(is_empty(hz) && !is_empty(hz + 1e-9));
    }

    #[test]
    fn rare_jerks_are_motion_and_no_noise() {
        let mut log = rows(2e-3).logs.remove(0);
        let plain = log.above_motion(0, f64::INFINITY).unwrap();
        assert!(plain[0].iter().all(|x| x.abs() < 0.01));
        log.knock(0, 10_000, 0.05);
        let knocked = log.above_motion(0, f64::INFINITY).unwrap();
        assert_eq!(knocked[0][10_000], 0.0);
        assert!(knocked[0].iter().all(|x| x.abs() < 0.01));
    }
}
