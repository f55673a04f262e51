//! Logs with rows that cannot be used, and under other names.

use super::*;
use crate::recording::cleaning::Cause;
use crate::recording::columns::Column;

fn read(text: &str, map: &ColumnMap) -> Result<Sieved> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    std::fs::write(&path, text).unwrap();
    load(&path, None, map)
}

#[test]
fn bad_rows_are_left_out_and_named_by_their_line() {
    let text = "t,q1,tau1\n0,1,2\n1,x,2\n2,nan,2\n3,1,2\n\n4,1\n5,1,1e7\n5.5,1,2,9\n6,1,inf\n7,1,2\n7,1,2\n6.5,1,2\n8,1,2\n9,1,2\n";
    let sieved = read(text, &ColumnMap::default()).unwrap();
    let expected = [
        (3, "q1", Cause::Unreadable),
        (4, "q1", Cause::NotFinite),
        (7, "column 2", Cause::Unreadable),
        (8, "tau1", Cause::Absurd),
        (9, "column 3", Cause::Unreadable),
        (10, "tau1", Cause::NotFinite),
        (12, "t", Cause::DuplicateTime),
        (13, "t", Cause::BackwardTime),
    ];
    let found: Vec<_> = sieved.rejected.iter().map(|r| (r.line, r.column.as_str(), r.cause)).collect();
    assert_eq!(found, expected);
    assert_eq!(sieved.recording.time, [0.0, 3.0, 7.0, 8.0, 9.0]);
    assert_eq!(sieved.lines, [2, 5, 11, 14, 15]);
    assert_eq!(sieved.recording.q.channel(0), [1.0; 5]);
}

#[test]
fn numbers_with_their_units_are_converted_by_them() {
    let text =
        "time,q1,qd1,tau1\n0 ms,90 deg,9 deg/s,1.5 Nm\n10 ms,180 deg,9 deg/s,2.5 Nm\n20 ms,270 deg,9 deg/s,3.5 Nm\n";
    let log = read(text, &ColumnMap::default()).unwrap().recording;
    assert!((log.q.channel(0)[1] - std::f64::consts::PI).abs() < 1e-12 && log.tau.channel(0) == [1.5, 2.5, 3.5]);
    assert_eq!(log.time, [0.0, 0.01, 0.02]);
    // With decimal commas; a name that has the unit too; a title above; a name that a dataset gives.
    for (text, map) in [
        ("Zeit;q1;tau1\n0,00 s;90,0°;1,5 Nm\n0,01 s;180,0°;2,5 Nm\n0,02 s;270,0°;3,5 Nm\n", ColumnMap::default()),
        ("t,q1 [deg],tau1\n0 s,90 deg,1.5\n0.01 s,180 deg,2.5\n0.02 s,270 deg,3.5\n", ColumnMap::default()),
        ("Run 7\nt,q1,tau1\n0 s,90 deg,1.5 Nm\n0.01 s,180 deg,2.5 Nm\n0.02 s,270 deg,3.5 Nm\n", ColumnMap::default()),
        (
            "t,angle,tau1\n0,90 deg,1.5\n0.01,180 deg,2.5\n0.02,270 deg,3.5\n",
            ColumnMap { q: Some(vec![Column::from("angle")]), ..ColumnMap::default() },
        ),
    ] {
        let log = read(text, &map).unwrap().recording;
        assert!((log.q.channel(0)[1] - std::f64::consts::PI).abs() < 1e-12, "{text}: {:?}", log.q);
        assert_eq!((log.time, log.tau.channel(0)), (vec![0.0, 0.01, 0.02], &[1.5, 2.5, 3.5][..]), "{text}");
    }
}

#[test]
fn units_that_differ_within_a_column_are_named_by_line_and_column() {
    let problem = |text: &str| read(text, &ColumnMap::default()).unwrap_err().to_string();
    let two = problem("t,q1,tau1\n0,0.5 rad,1\n1,30 deg,2\n2,0.5 rad,3\n");
    assert!(two.contains("log.csv:3: q1 [rad]: '30 deg' is in deg where the cells above are in rad"), "{two}");
    let name = problem("t,q1 [deg],tau1\n0,0.5 rad,1\n1,0.6 rad,2\n");
    assert!(name.contains("log.csv:1: q1 [deg]: the cells are in rad where the name says deg"), "{name}");
    // A cell without a unit, or the first with one, costs its row.
    let sieved = read("t,q1,tau1\n0,0.5 rad,1\n1,0.6,2\n2,0.7 rad,3\n", &ColumnMap::default()).unwrap();
    assert_eq!((sieved.recording.time, sieved.rejected[0].line), (vec![0.0, 2.0], 3));
    assert!(sieved.rejected[0].problem.contains("'0.6' has no unit where"), "{:?}", sieved.rejected);
}

/// Of two arms in one list the dataset names the second: the columns of the first are those of no joint.
#[test]
fn columns_of_a_list_are_chosen_by_their_names() {
    let list = |k: i32| format!("\"[{k}, {}, {}]\"", k + 1, k + 2);
    let rows: String = (0..5).map(|k| format!("{k},{},{}\n", list(k), list(10 * k))).collect();
    let column = |name: &str| Some(vec![Column::from(name)]);
    let map =
        ColumnMap { q: column("observation.state[2]"), tau: column("observation.effort[2]"), ..ColumnMap::default() };
    let log = read(&format!("t,observation.state,observation.effort\n{rows}"), &map).unwrap().recording;
    assert_eq!((log.q.channel(0), log.joints.len()), (&[2.0, 3.0, 4.0, 5.0, 6.0][..], 1));
    assert_eq!(log.tau.channel(0), [2.0, 12.0, 22.0, 32.0, 42.0]);
}

#[test]
fn commas_of_thousands_and_comments_between_rows() {
    let text = "t,q1,tau1\n0,1,\"999\"\n# a marker, of three\n1,2,\"1,500\"\n2,3,\"-12,345\"\n# the end\n";
    let sieved = read(text, &ColumnMap::default()).unwrap();
    assert_eq!(sieved.recording.tau.channel(0), [999.0, 1500.0, -12345.0]);
    assert_eq!((sieved.rejected.len(), &sieved.lines[..]), (0, &[2, 4, 5][..]), "{:?}", sieved.rejected);
    let either = read("t,q1,tau1\n0,1,\"1,500\"\n1,2,\"2,500\"\n", &ColumnMap::default()).unwrap_err().to_string();
    assert!(either.contains("'1,500' may be thousands or a fraction"), "{either}");
}

#[test]
fn a_quote_that_is_not_closed_costs_its_line_only() {
    let text = "t,note,q1,tau1\n0,\"a, b\",1,2\n1,c,\"1,2\n2,\"d,1,2\n3,e,1,2\n4,\"f\",\"1\",2\n5,g,1,\"2\n6,,1,2\n";
    let sieved = read(text, &ColumnMap::default()).unwrap();
    let found: Vec<_> = sieved.rejected.iter().map(|r| (r.line, r.column.as_str(), r.cause)).collect();
    assert_eq!(found, [(3, "q1", Cause::Unreadable), (7, "tau1", Cause::Unreadable)]);
    assert_eq!(sieved.recording.time, [0.0, 2.0, 3.0, 4.0, 6.0]);
}

#[test]
fn a_time_that_jumps_ahead_costs_one_row() {
    let sieved = read("t,q1,tau1\n0,1,2\n1,1,2\n900,1,2\n3,1,2\n4,1,2\n", &ColumnMap::default()).unwrap();
    assert_eq!(sieved.recording.time, [0.0, 1.0, 3.0, 4.0]);
    assert_eq!(sieved.rejected[0].line, 4);
}

#[test]
fn rows_in_reverse_order_keep_their_lines() {
    let row = |k: usize| format!("{},{},{}", 0.5 * k as f64, 0.1 * k as f64, if k == 7 { "x" } else { "2" });
    let rows: Vec<String> = (0..40).rev().map(row).collect();
    let sieved = read(&format!("t,q1,tau1\n{}\n", rows.join("\n")), &ColumnMap::default()).unwrap();
    assert_eq!((sieved.recording.samples(), sieved.recording.q.channel(0)[..2].to_vec()), (39, vec![0.0, 0.1]));
    assert!(
        sieved.recording.time.is_sorted() && sieved.corrections[0].contains("backwards"),
        "{:?}",
        sieved.corrections
    );
    // The row of k = 0 is the last of the file.
    assert_eq!((sieved.lines[0], sieved.lines[38]), (41, 2));
    assert_eq!((sieved.rejected.len(), sieved.rejected[0].line), (1, 34));
}

#[test]
fn a_file_without_a_usable_row_is_refused() {
    let error = read("t,q1,tau1\n0,x,1\n1,y,1\n", &ColumnMap::default()).unwrap_err().to_string();
    assert!(error.contains("log.csv:2: q1: none of the 2 rows"), "{error}");
}

/// Torques of two joints, of which the second ends early.
fn read_torque_with_gaps() -> Sieved {
    let row = |k: usize| format!("{},{},{},{},{}", 0.01 * k as f64, k, k, k, if k < 60 { "1" } else { "" });
    let rows: Vec<String> = (0..200).map(row).collect();
    read(&format!("t,q1,q2,tau1,tau2\n{}\n", rows.join("\n")), &ColumnMap::default()).unwrap()
}

#[test]
fn missing_velocities_cost_their_joint_or_their_rows() {
    let log = |header: &str, row: &dyn Fn(usize, f64) -> String| {
        let rows = (0..200).map(|row_index| {
            let t = 0.01 * row_index as f64;
            format!("{t:.2},{},{},{},{},{}", t.sin(), t.cos(), t, -t, row(row_index, t))
        });
        let rows: Vec<String> = rows.collect();
        read(&format!("t,q1,q2,tau1,tau2,{header}\n{}\n", rows.join("\n")), &ColumnMap::default()).unwrap()
    };
    // No column, no value, gaps: joint 1 keeps its velocity and all its rows.
    for (header, row, word) in [
        ("qd1", Box::new(|_, t: f64| t.cos().to_string()) as Box<dyn Fn(usize, f64) -> String>, "has no velocity"),
        ("qd1,qd2", Box::new(|_, t| format!("{},nan", t.cos())), "holds no value"),
        ("qd1,qd2", Box::new(|k, t| format!("{},{}", t.cos(), if k % 3 == 0 { "" } else { "1" })), "has gaps"),
    ] {
        let sieved = log(header, &row);
        assert_eq!((sieved.recording.samples(), sieved.rejected.len()), (200, 0), "{word}");
        assert_eq!([0, 1].map(|joint| sieved.recording.has_velocity(joint)), [true, false], "{word}");
        assert!((sieved.recording.qd.unwrap().channel(0)[100] - 1f64.cos()).abs() < 1e-12);
        assert!(
            sieved.corrections.iter().any(|note| note.contains(word) && note.contains("joint_2")),
            "{:?}",
            sieved.corrections
        );
    }
    let few = log("qd1,qd2", &|k, t| {
        let second = if k == 7 { String::new() } else { (-t.sin()).to_string() };
        format!("{},{second}", t.cos())
    });
    assert_eq!(few.rejected.iter().map(|row| row.line).collect::<Vec<_>>(), [9]);
    assert_eq!([0, 1].map(|joint| few.recording.has_velocity(joint)), [true, true]);
    let torque = read_torque_with_gaps();
    assert_eq!((torque.recording.samples(), torque.rejected.len()), (200, 0));
    assert_eq!([0, 1].map(|joint| torque.recording.has_torque(joint)), [true, false], "{:?}", torque.corrections);
    let none = log("qd1,qd2", &|k, _| if k % 3 == 0 { ",".to_owned() } else { "1,1".to_owned() });
    assert_eq!((none.recording.samples(), none.recording.qd), (200, None));
}

#[test]
fn columns_under_other_names() {
    let text = "stamp,q1,angle,tau1,amps,qd1\n0,1,2,3,4,5\n1,1,2,3,4,5\n";
    let list = |name: &str| Some(vec![name.into()]);
    let map = ColumnMap { time: Some("stamp".into()), q: list("angle"), tau: list("amps"), ..ColumnMap::default() };
    let sieved = read(text, &map).unwrap();
    assert_eq!(sieved.recording.q.channel(0), [2.0, 2.0]);
    assert_eq!(sieved.recording.tau.channel(0), [4.0, 4.0]);
    assert_eq!(sieved.recording.qd.unwrap().channel(0), [5.0, 5.0]);
    assert_eq!(sieved.notes, ["columns not used: (q1), (tau1)"]);
    let error = read(text, &ColumnMap { q: list("winkel"), ..map }).unwrap_err().to_string();
    assert!(error.contains("winkel") && error.contains("angle"), "{error}");
}

/// As numpy.savetxt writes them: no line names the columns, which the data set numbers.
#[test]
fn columns_by_number() {
    let number = |column: usize| Some(vec![Column::Number(column)]);
    let map = ColumnMap { time: Some(Column::Number(1)), q: number(3), tau: number(2), ..ColumnMap::default() };
    for text in [
        "0,4,2\n1,5,3\n2,6,4\n",
        "0 4 2\n1 5 3\n2 6 4\n",
        "0;4,0;2\n1;5,0;3\n2;6,0;4\n",
        "a,b,c\n0,4,2\n1,5,3\n2,6,4\n",
    ] {
        let sieved = read(text, &map).unwrap();
        assert_eq!(sieved.recording.time, [0.0, 1.0, 2.0], "{text}");
        assert_eq!(sieved.recording.q.channel(0), [2.0, 3.0, 4.0], "{text}");
        assert_eq!(sieved.recording.tau.channel(0), [4.0, 5.0, 6.0], "{text}");
        assert_eq!(sieved.lines[0], if text.starts_with('a') { 2 } else { 1 });
    }
    let rows = "0,4,2\n1,5,3\n";
    let at_rate = ColumnMap { rate_hz: Some(100.0), time: None, ..map.clone() };
    assert_eq!(read(rows, &at_rate).unwrap().recording.time, [0.0, 0.01]);
    for column in [0, 4] {
        let error = read(rows, &ColumnMap { q: number(column), ..map.clone() }).unwrap_err().to_string();
        assert!(
            error.contains(&format!("column {column}: there is no such column; those of the file are 1 to 3")),
            "{error}"
        );
    }
    let error = read(rows, &ColumnMap::default()).unwrap_err().to_string();
    assert!(error.contains("3 columns of numbers; no line names") && error.contains("q = [2, 3]"), "{error}");
}

#[cfg(feature = "parquet")]
#[test]
fn empty_cells_of_a_parquet_file_cost_their_rows() {
    use ::parquet::arrow::ArrowWriter;
    use arrow_array::{ArrayRef, Float64Array, RecordBatch};
    use std::sync::Arc;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.parquet");
    let column = |values: Vec<Option<f64>>| -> ArrayRef { Arc::new(Float64Array::from(values)) };
    let batch = RecordBatch::try_from_iter([
        ("t", column(vec![Some(0.0), Some(1.0), Some(2.0)])),
        ("q1", column(vec![Some(0.0), None, Some(2.0)])),
        ("tau1", column(vec![Some(5.0), Some(6.0), Some(7.0)])),
    ])
    .unwrap();
    let mut writer = ArrowWriter::try_new(std::fs::File::create(&path).unwrap(), batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    let sieved = load(&path, None, &ColumnMap::default()).unwrap();
    assert_eq!(sieved.recording.tau.channel(0), [5.0, 7.0]);
    assert_eq!((sieved.rejected[0].line, sieved.rejected[0].column.as_str()), (2, "q1"));
}
