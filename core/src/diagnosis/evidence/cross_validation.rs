//! Leave-one-log-out residuals: each log under the model as fitted to the others.

use crate::diagnosis::model::{Member, Session};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::Column;
use crate::error::Result;

/// Residual of every log that is identified from, under the model with `members` as fitted to all the others.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn cross_validated_residual(session: &Session, members: &[Member], whitener: &Whitener) -> Result<Column> {
    let data = &session.logs.train;
    let columns = session.model.columns(data, members)?;
    let mut rows = data.rows.clone();
    let mut left = data.torque.clone();
    for log in data.rows.starts.windows(2) {
        let own = log[0]..log[1];
        rows.valid.clone_from(&data.rows.valid);
        rows.valid.iter_mut().for_each(|valid| valid[own.clone()].fill(false));
        let of_others = whitener.on(&rows);
        let values = of_others.solve(&columns, &data.torque).values;
        for (joint, left) in &mut left.parts {
            for (column, value) in columns.iter().zip(&values) {
                let Some(signal) = column.part(*joint) else { continue };
                left[own.clone()].iter_mut().zip(&signal[own.clone()]).for_each(|(left, x)| *left -= value * x);
            }
        }
    }
    Ok(left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::test_logs::log;
    use crate::identification::effect_model::Arm;
    use crate::identification::effect_model::Trust;
    use crate::identification::model::Model;
    use crate::robot::{InertiaCheck, load};

    #[test]
    fn a_log_has_no_part_in_what_is_said_of_it() {
        let robot =
            load(concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf"), InertiaCheck::Required).unwrap();
        let (model, arm) = (Model::new(&robot), Arm::new(&robot, Trust::Nominal));
        let logs = [1, 2, 3].map(|seed| log(&arm, seed));
        let apart = Session::new(&model, Trust::Nominal, &[&logs[0], &logs[1]], &[&logs[2]]).unwrap();
        let mut session = apart.over_all_logs();
        let rows = &session.logs.train.rows;
        assert_eq!((rows.len(), rows.logs.len()), (apart.logs.train.rows.len() + apart.logs.test.rows.len(), 3));
        let last = rows.starts[2]..rows.starts[3];
        assert_eq!(rows.torque[4][last.clone()], apart.logs.test.rows.torque[4]);
        assert_eq!(rows.valid[4][last.clone()], apart.logs.test.rows.valid[4]);

        let whitener = session.noise_under(&session.logs.train.baseline);
        let before = cross_validated_residual(&session, &[], &whitener).unwrap();
        // More friction on joint 2 in the last log alone.
        let push: Vec<f64> = rows.means(|log| log.motion.qd.channel(1).to_vec());
        let push = push.iter().enumerate().map(|(row, qd)| if last.contains(&row) { 40.0 * qd } else { 0.0 });
        let push = Column::on(1, push.collect());
        let mut logs = session.logs.clone();
        logs.train.torque.add(1.0, &push);
        session.go_on_with(logs);
        let mut change = cross_validated_residual(&session, &[], &whitener).unwrap();
        change.add(-1.0, &before);
        let (change, push) = (change.part(1).unwrap(), push.part(1).unwrap());
        assert!(last.clone().all(|row| (change[row] - push[row]).abs() < 1e-9), "all of it is left where it is");
        assert!((0..last.start).any(|row| change[row].abs() > 1.0), "and the other two are predicted from it");
    }
}
