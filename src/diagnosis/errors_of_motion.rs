//! What errors of the positions put into the torque of every joint: columns that stand beside what is tested.

use super::arm::Arm;
use super::column::Column;
use super::log::Log;
use super::roles::is_level;
use super::rows::Rows;
use crate::effects::{Nature, Placed};
use crate::error::Result;

/// Columns of the errors of one kind of logs, for the arm as found. None before anything was fitted.
#[derive(Debug, Clone, Default)]
pub struct ErrorsOfMotion {
    /// The error of the smoothing, on each joint: what smoothing once more does, as seen through the first ("twicing", Tukey 1977).
    pub smoothing: Vec<Column>,
    /// What the positions hold beyond what is smooth, on each joint; none where they are smoothed no more than their noise asks.
    pub beyond: Vec<Column>,
    /// The second derivative of the torque, on each joint: what shifts or spreads torque in time holds it, and the noise of the
    /// encoders is in it always the same way as in the torque (errors in variables: Fuller, Measurement Error Models, 1987).
    pub bend: Vec<Column>,
}

impl ErrorsOfMotion {
    /// Along the motion of `rows`.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn new(arm: &Arm, rows: &Rows) -> Result<Self> {
        let along = arm.along(rows);
        let is_smoother = rows.logs.iter().any(|log| log.whole.is_some());
        let whole = |_, log: &Log| Ok(log.whole.as_ref().unwrap_or(&log.motion).clone());
        Ok(ErrorsOfMotion {
            smoothing: of_joints(arm.departure(rows, &along, |_, log| log.smoothed_again())?),
            beyond: if is_smoother { of_joints(arm.departure(rows, &along, whole)?) } else { Vec::new() },
            bend: of_joints(arm.bend(rows)?),
        })
    }

    /// All of them.
    pub fn all(&self) -> Vec<Column> {
        self.smoothing.iter().chain(&self.beyond).chain(&self.bend).cloned().collect()
    }

    /// Those that stand beside an effect along `rows`: none where torque is cut off, since the smoothing errs there too; not the second
    /// derivative of the torque beside an elastic gear, whose column that is; beside friction that comes up after reversals what is the
    /// same at each of them, since friction that holds a joint for a moment looks like it through smooth positions.
    pub fn beside(&self, placed: &Placed, rows: &Rows) -> Vec<Column> {
        if is_level(placed.effect) {
            Vec::new()
        } else if placed.effect.gear(&placed.parameters).is_some() {
            self.smoothing.iter().chain(&self.beyond).cloned().collect()
        } else if placed.effect.about().nature == Nature::AfterReversals {
            self.all().into_iter().chain(at_reversals(rows, placed.joint)).collect()
        } else {
            self.all()
        }
    }
}

/// Of every row near a reversal, within the smear of the smoothing, a column that is one there after each reversal upwards and minus one
/// after each downwards.
fn at_reversals(rows: &Rows, joint: usize) -> Vec<Column> {
    let smear = rows.smear[joint];
    let mut columns = vec![vec![0.0; rows.len()]; 2 * smear + 1];
    for (log, ends) in rows.logs.iter().zip(rows.starts.windows(2)) {
        let speed = log.motion.qd.channel(joint);
        let turns = speed.windows(2).enumerate().filter(|(_, pair)| pair[0].signum() != pair[1].signum());
        for (sample, pair) in turns {
            let row = ends[0] + sample / log.block;
            for (lag, column) in columns.iter_mut().enumerate() {
                if let Some(at) = (row + lag).checked_sub(smear).filter(|at| (ends[0]..ends[1]).contains(at)) {
                    column[at] += pair[1].signum();
                }
            }
        }
    }
    columns.into_iter().map(|column| Column::on(joint, column)).collect()
}

fn of_joints(column: Column) -> Vec<Column> {
    column.parts.into_iter().map(|(joint, signal)| Column::on(joint, signal)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::diagnosis::rows::FEWEST_ROWS;
    use crate::recording::Recording;

    #[test]
    fn reversals_are_counted_by_their_direction() {
        let time: Vec<f64> = (0..10_000).map(|k| f64::from(k) / 500.0).collect();
        let swing = |t: &f64| (std::f64::consts::TAU * 0.4 * t).sin();
        let q = Channels::from_vectors(&[time.iter().map(swing).collect()]);
        let tau = Channels::zeros(1, time.len());
        let log = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        let rows = Rows::new(&[&log], 5.0, FEWEST_ROWS).unwrap();
        let columns = at_reversals(&rows, 0);
        // Half a period of 5 Hz is five rows of 20 ms to either side. It turns downwards at 0.625 s and upwards at 1.875 s.
        let at = |lag: usize, row: usize| columns[lag].part(0).unwrap()[row];
        assert_eq!(columns.len(), 11);
        assert_eq!([at(5, 31), at(0, 26), at(10, 36), at(5, 93), at(5, 60)], [-1.0, -1.0, -1.0, 1.0, 0.0]);
    }
}
