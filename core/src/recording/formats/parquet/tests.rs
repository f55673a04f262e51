//! Recordings that come back, and files of other programs.

use super::write::{into_io, write_table};
use super::*;
use crate::error::Result;
use crate::recording::Recording;
use crate::recording::formats::written;
use crate::recording::samples;
use ::parquet::arrow::ArrowWriter;
use ::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use arrow_array::types::Float32Type;
use arrow_array::{ArrayRef, Float32Array, Float64Array, Int64Array, ListArray, RecordBatch, StringArray};
use proptest::prelude::*;
use std::fs::File;
use std::sync::Arc;

fn foreign(columns: Vec<(&str, ArrayRef)>) -> Result<(Recording, Vec<String>)> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.parquet");
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let mut writer = ArrowWriter::try_new(File::create(&path).unwrap(), batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    read(&path, None)
}

fn floats(values: &[f64]) -> ArrayRef {
    Arc::new(Float64Array::from(values.to_vec()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn round_trip_is_bit_for_bit(recording in samples::any_recording()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.parquet");
        write(&path, &recording).unwrap();
        let (read, notes) = read(&path, Some(&recording.joints)).unwrap();
        prop_assert_eq!(samples::bits(&read), samples::bits(&recording));
        prop_assert_eq!(&read, &recording);
        prop_assert!(notes.is_empty());
        write_named(&path, &recording).unwrap();
        prop_assert_eq!(columns(&path)[1].clone(), "gelenk ä,0_position");
        prop_assert_eq!(super::read(&path, None).unwrap(), (recording, notes));
    }
}

/// The names of a file's columns, as other programs see them.
fn columns(path: &std::path::Path) -> Vec<String> {
    let file = ParquetRecordBatchReaderBuilder::try_new(File::open(path).unwrap()).unwrap();
    file.schema().fields().iter().map(|field| field.name().clone()).collect()
}

#[test]
fn columns_carry_the_names_of_joints_in_their_order() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.parquet");
    let mut recording = samples::full(3, 50);
    // Neither in the order of letters nor in that of numbers.
    recording.joints = ["wrist_2", "elbow", "wrist_1"].map(str::to_owned).to_vec();
    write_named(&path, &recording).unwrap();
    let header = columns(&path);
    assert_eq!(header[..4], ["t", "wrist_2_position", "elbow_position", "wrist_1_position"]);
    assert_eq!(header[10..13], ["wrist_2_effort", "elbow_effort", "wrist_1_effort"]);
    assert_eq!(read(&path, None).unwrap(), (recording.clone(), Vec::new()));
    // A file with numbers has the names in its metadata.
    write(&path, &recording).unwrap();
    assert_eq!(columns(&path)[..2], ["t", "q1"]);
    assert_eq!(read(&path, None).unwrap(), (recording.clone(), Vec::new()));
    // Joints that names do not tell apart keep their numbers.
    recording.joints = ["a", "a", "b"].map(str::to_owned).to_vec();
    write_named(&path, &recording).unwrap();
    assert_eq!(columns(&path)[..2], ["t", "q1"]);
}

#[test]
fn more_rows_than_a_batch() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.parquet");
    let recording = samples::full(6, 5000);
    write(&path, &recording).unwrap();
    assert_eq!(read(&path, None).unwrap().0, recording);
}

#[test]
fn logs_of_other_programs() {
    let single: ArrayRef = Arc::new(Float32Array::from(vec![0.1_f32, -2.5]));
    let status: ArrayRef = Arc::new(StringArray::from(vec!["idle", "run"]));
    let (recording, notes) = foreign(vec![
        ("status", status),
        ("elbow_effort", single),
        ("time", floats(&[0.0, 0.1])),
        ("elbow_position", floats(&[1.0, 2.0])),
    ])
    .unwrap();
    assert_eq!(recording.joints, ["elbow"]);
    assert_eq!(recording.q.channel(0), [1.0, 2.0]);
    assert_eq!(recording.tau.channel(0), [f64::from(0.1_f32), -2.5]);
    assert_eq!(notes, ["columns not used: status"]);
}

#[test]
fn faults_are_named_by_column_and_row() {
    let texts: ArrayRef = Arc::new(StringArray::from(vec!["0", "1"]));
    let empty: ArrayRef = Arc::new(Float64Array::from(vec![Some(1.0), None]));
    let good = || floats(&[1.0, 2.0]);
    let cases = [
        (vec![("t", good()), ("q1", good())], "log.parquet: tau1: missing column"),
        (vec![("t", texts), ("q1", good()), ("tau1", good())], "t: the column is of type Utf8"),
        (vec![("t", good()), ("q1", empty), ("tau1", good())], "q1: row 2 is empty"),
        (vec![("t", good()), ("q1", floats(&[0.0, f64::NAN])), ("tau1", good())], "q1, row 2: NaN"),
        (vec![("t", floats(&[1.0, 1.0])), ("q1", good()), ("tau1", good())], "t, row 2: time must increase"),
        (vec![("t", floats(&[])), ("q1", floats(&[])), ("tau1", floats(&[]))], "rows: the file has columns"),
    ];
    for (columns, expected) in cases {
        let error = foreign(columns).unwrap_err().to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

#[test]
fn other_joints_and_broken_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.parquet");
    let recording = samples::full(2, 50);
    write(&path, &recording).unwrap();
    let error = read(&path, Some(&["axis_1".to_owned(), "axis_3".to_owned()])).unwrap_err().to_string();
    assert!(error.contains("axis_3") && error.contains("axis_2_position"), "{error}");
    let bytes = std::fs::read(&path).unwrap();
    for length in [0, 3, bytes.len() / 2, bytes.len() - 1] {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let error = read(&path, None).unwrap_err().to_string();
        assert!(error.contains("log.parquet: Parquet: the file cannot be read"), "{error}");
    }
}

#[test]
fn joints_are_taken_by_name_in_any_order() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.parquet");
    let recording = samples::full(3, 50);
    write(&path, &recording).unwrap();
    let wanted = ["axis_3".to_owned(), "axis_1".to_owned()];
    let (found, _) = read(&path, Some(&wanted)).unwrap();
    assert_eq!(found.joints, wanted);
    assert_eq!(found.tau.channel(0), recording.tau.channel(2));
    assert_eq!(found.q.channel(1), recording.q.channel(0));
    assert_eq!(found.truth.unwrap().qdd.channel(0), recording.truth.as_ref().unwrap().qdd.channel(2));
}

#[test]
fn lists_are_joints_in_order() {
    let lists = |offset: f32| -> ArrayRef {
        let rows = (0..3).map(|row| Some(vec![Some(row as f32), Some(row as f32 + offset)]));
        Arc::new(ListArray::from_iter_primitive::<Float32Type, _, _>(rows))
    };
    let index: ArrayRef = Arc::new(Int64Array::from(vec![0, 1, 2]));
    let columns = || vec![("frame_index", index.clone()), ("action", lists(9.0)), ("observation.state", lists(0.5))];
    let mut whole = columns();
    whole.extend([("timestamp", floats(&[0.0, 0.1, 0.2])), ("observation.effort", lists(2.5))]);
    let (recording, notes) = foreign(whole).unwrap();
    assert_eq!(recording.q.channel(1), [0.5, 1.5, 2.5]);
    assert_eq!(recording.tau.channel(1), [2.5, 3.5, 4.5]);
    assert_eq!(notes, ["columns not used: frame_index, action[0..1]"]);
    let mut without = columns();
    without.push(("timestamp", floats(&[0.0, 0.1, 0.2])));
    let error = foreign(without).unwrap_err().to_string();
    assert!(error.contains("no column of torque") && error.contains("observation.state[0..1]"), "{error}");
}

#[test]
fn a_full_disk_is_named_by_the_operating_system() {
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    let recording = samples::full(1, 3);
    let error = write_table(full, &written::table(&recording, false).unwrap(), Vec::new()).unwrap_err();
    assert_eq!(into_io(error).kind(), std::io::ErrorKind::StorageFull);
}
