//! Recordings as Parquet: the columns of [`super::csv`], and with them robot, joint names and provenance.

use super::Recording;
use super::columns::{self, Layout};
use crate::error::{Error, Result};
use ::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use ::parquet::arrow::{ArrowWriter, ProjectionMask};
use ::parquet::basic::{Compression, Encoding};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use arrow::array::{Array, ArrayRef, Float32Array, Float64Array, RecordBatch};
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

const ROBOT: &str = "tauscope.robot";
/// A JSON array of names.
const JOINTS: &str = "tauscope.joints";
/// Followed by the key of the entry.
const PROVENANCE: &str = "tauscope.provenance.";

/// Writes a recording.
///
/// # Errors
/// The file cannot be written, or the signals differ in shape.
pub fn write(path: &Path, recording: &Recording) -> Result<()> {
    let columns = columns::table(recording)?;
    let failed = |source| Error::io(path, "write the recording", source);
    let file = File::create(path).map_err(failed)?;
    write_table(file, &columns, metadata(recording)).map_err(|error| failed(into_io(error)))
}

fn write_table(
    writer: impl Write + Send,
    columns: &[(String, &[f64])],
    metadata: Vec<KeyValue>,
) -> std::result::Result<(), ParquetError> {
    // Neighbouring samples share sign and exponent: with the bytes of all values sorted by place, snappy finds them.
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_dictionary_enabled(false)
        .set_encoding(Encoding::BYTE_STREAM_SPLIT)
        .set_key_value_metadata(Some(metadata))
        .build();
    let arrays = columns.iter().map(|(name, values)| {
        let array: ArrayRef = Arc::new(Float64Array::from(values.to_vec()));
        (name, array)
    });
    let batch = RecordBatch::try_from_iter(arrays)?;
    let mut writer = ArrowWriter::try_new(writer, batch.schema(), Some(properties))?;
    writer.write(&batch)?;
    writer.finish()?;
    Ok(())
}

fn metadata(recording: &Recording) -> Vec<KeyValue> {
    let joints = serde_json::Value::from(recording.joints.clone()).to_string();
    let mut entries = vec![KeyValue::new(ROBOT.into(), recording.robot.clone()), KeyValue::new(JOINTS.into(), joints)];
    let provenance = recording.provenance.iter();
    entries.extend(provenance.map(|(key, value)| KeyValue::new(format!("{PROVENANCE}{key}"), value.clone())));
    entries
}

/// Reads a recording and notes on what in the file was not used. `joints` are the robot's joints in order; without
/// them the file's own names or numbers are taken. Columns are called as in [`super::csv`] and hold 64- or 32-bit
/// floating-point numbers.
///
/// # Errors
/// An unreadable file, columns that are missing or not numbers, other joints than `joints`, values that are empty or
/// not finite, time that does not increase.
pub fn read(path: &Path, joints: Option<&[String]>) -> Result<(Recording, Vec<String>)> {
    let mut table = Table::read(path, joints, &Ok, false)?;
    if let Some(fault) = table.layout.fault(&table.columns) {
        let place = format!("{}, row {}", table.header[fault.column], fault.row + 1);
        return Err(Error::input(path, None, place, fault.problem));
    }
    let notes = std::mem::take(&mut table.layout.notes);
    Ok((table.recording(), notes))
}

/// The names of the columns.
pub(super) fn header(path: &Path) -> Result<Vec<String>> {
    let file = File::open(path).map_err(|source| Error::io(path, "read the recording", source))?;
    let broken = |error: ParquetError| Error::input(path, None, "Parquet", format!("the file cannot be read: {error}"));
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(broken)?;
    Ok(builder.schema().fields().iter().map(|field| field.name().clone()).collect())
}

/// The columns as numbers, whatever their values.
pub(super) struct Table {
    pub header: Vec<String>,
    pub layout: Layout,
    /// Values of the columns in use, indexed as the header.
    pub columns: Vec<Vec<f64>>,
    metadata: HashMap<String, String>,
}

impl Table {
    /// Reads all rows. `rename` may call the columns by other names. Empty cells are NaN where `lenient`, else an error.
    pub fn read(
        path: &Path,
        joints: Option<&[String]>,
        rename: &dyn Fn(Vec<String>) -> Result<Vec<String>>,
        lenient: bool,
    ) -> Result<Table> {
        let file = File::open(path).map_err(|source| Error::io(path, "read the recording", source))?;
        let broken = |error: String| Error::input(path, None, "Parquet", format!("the file cannot be read: {error}"));
        let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(|error| broken(error.to_string()))?;

        let metadata = builder.metadata().file_metadata().key_value_metadata();
        let metadata: HashMap<String, String> = metadata
            .into_iter()
            .flatten()
            .filter_map(|entry| Some((entry.key.clone(), entry.value.clone()?)))
            .collect();
        let own_joints = own_joints(path, &metadata)?;
        if let (Some(own), Some(joints)) = (&own_joints, joints)
            && own != joints
        {
            let problem =
                format!("the log is of the joints {}, the robot has the joints {}", own.join(", "), joints.join(", "));
            return Err(Error::input(path, None, JOINTS, problem));
        }

        let header = rename(builder.schema().fields().iter().map(|field| field.name().clone()).collect())?;
        let layout = Layout::find(path, None, &header, joints.or(own_joints.as_deref()))?;
        let used = layout.used();
        let projection = ProjectionMask::roots(builder.parquet_schema(), used.iter().copied());
        let reader = builder.with_projection(projection).build().map_err(|error| broken(error.to_string()))?;
        let mut columns = vec![Vec::new(); header.len()];
        for batch in reader {
            let batch = batch.map_err(|error| broken(error.to_string()))?;
            for (&column, array) in used.iter().zip(batch.columns()) {
                append(array, &mut columns[column], lenient)
                    .map_err(|problem| Error::input(path, None, &header[column], problem))?;
            }
        }
        if used.iter().any(|&column| columns[column].is_empty()) {
            return Err(Error::input(path, None, "rows", "the file has columns but no row"));
        }
        Ok(Table { header, layout, columns, metadata })
    }

    /// The recording with what the file says about it.
    pub fn recording(self) -> Recording {
        let mut recording = self.layout.recording(self.columns);
        recording.robot = self.metadata.get(ROBOT).cloned().unwrap_or_default();
        recording.provenance = provenance(self.metadata);
        recording
    }
}

fn own_joints(path: &Path, metadata: &HashMap<String, String>) -> Result<Option<Vec<String>>> {
    let names = metadata.get(JOINTS).map(|text| serde_json::from_str(text)).transpose();
    names.map_err(|error| {
        Error::input(path, None, JOINTS, format!("this entry of the metadata must be a JSON array of names: {error}"))
    })
}

fn provenance(metadata: HashMap<String, String>) -> BTreeMap<String, String> {
    let entries = metadata.into_iter();
    entries.filter_map(|(key, value)| Some((key.strip_prefix(PROVENANCE)?.to_owned(), value))).collect()
}

fn append(array: &ArrayRef, column: &mut Vec<f64>, lenient: bool) -> std::result::Result<(), String> {
    if array.null_count() > 0 && !lenient {
        let row = column.len() + (0..array.len()).find(|&row| array.is_null(row)).unwrap_or(0) + 1;
        return Err(format!("row {row} is empty; a number goes here"));
    }
    let start = column.len();
    if let Some(values) = array.as_any().downcast_ref::<Float64Array>() {
        column.extend_from_slice(values.values());
    } else if let Some(values) = array.as_any().downcast_ref::<Float32Array>() {
        column.extend(values.values().iter().map(|&value| f64::from(value)));
    } else {
        return Err(format!("the column is of type {}; floating-point numbers go here", array.data_type()));
    }
    if array.null_count() > 0 {
        (0..array.len()).filter(|&row| array.is_null(row)).for_each(|row| column[start + row] = f64::NAN);
    }
    Ok(())
}

fn into_io(error: ParquetError) -> std::io::Error {
    match error {
        ParquetError::External(inner) => match inner.downcast::<std::io::Error>() {
            Ok(error) => *error,
            Err(inner) => std::io::Error::other(inner),
        },
        other => std::io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples;
    use super::*;
    use arrow::array::{Int64Array, StringArray};
    use proptest::prelude::*;

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
            prop_assert_eq!(read, recording);
            prop_assert!(notes.is_empty());
        }
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
        let integers: ArrayRef = Arc::new(Int64Array::from(vec![0, 1]));
        let empty: ArrayRef = Arc::new(Float64Array::from(vec![Some(1.0), None]));
        let good = || floats(&[1.0, 2.0]);
        let cases = [
            (vec![("t", good()), ("q1", good())], "log.parquet: tau1: missing column"),
            (vec![("t", integers), ("q1", good()), ("tau1", good())], "t: the column is of type Int64"),
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
        let others = ["axis_2".to_owned(), "axis_1".to_owned()];
        let error = read(&path, Some(&others)).unwrap_err().to_string();
        assert!(error.contains("axis_1, axis_2, the robot has the joints axis_2, axis_1"), "{error}");
        let bytes = std::fs::read(&path).unwrap();
        for length in [0, 3, bytes.len() / 2, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..length]).unwrap();
            let error = read(&path, None).unwrap_err().to_string();
            assert!(error.contains("log.parquet: Parquet: the file cannot be read"), "{error}");
        }
    }

    #[test]
    fn a_full_disk_is_named_by_the_operating_system() {
        let Ok(full) = File::options().write(true).open("/dev/full") else { return };
        let recording = samples::full(1, 3);
        let error = write_table(full, &columns::table(&recording).unwrap(), Vec::new()).unwrap_err();
        assert_eq!(into_io(error).kind(), std::io::ErrorKind::StorageFull);
    }
}
