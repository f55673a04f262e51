//! Recordings as Parquet: the columns of [`super::csv`], and with them robot, joint names and provenance.

use super::Recording;
use super::columns::Layout;
use super::names::{self, Joint, QUANTITIES};
use super::written;
use crate::error::{Error, Result};
use ::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use ::parquet::arrow::{ArrowWriter, ProjectionMask};
use ::parquet::basic::{Compression, Encoding};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use arrow_array::{Array, ArrayRef, FixedSizeListArray, Float64Array, LargeListArray, ListArray, RecordBatch};
use arrow_schema::DataType;
use std::collections::{BTreeMap, BTreeSet, HashMap};
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
    let columns = written::table(recording, false)?;
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
/// them the file's own names or numbers are taken. Columns are called as in [`super::csv`] and hold numbers, or lists of
/// them.
///
/// # Errors
/// An unreadable file, columns that are missing or not numbers, other joints than `joints`, values that are empty or
/// not finite, time that does not increase.
pub fn read(path: &Path, joints: Option<&[String]>) -> Result<(Recording, Vec<String>)> {
    let mut table = Table::open(path)?;
    let own = std::mem::take(&mut table.own_joints);
    let mut layout = Layout::find(path, None, &table.header, joints.or(own.as_deref()))?;
    let columns = table.rows(path, &table.header, &layout.used(), false)?;
    if let Some(fault) = layout.fault(&columns) {
        let place = format!("{}, row {}", table.header[fault.column], fault.row + 1);
        return Err(Error::input(path, None, place, fault.problem));
    }
    let notes = std::mem::take(&mut layout.notes);
    let mut recording = layout.recording(columns);
    table.describe(&mut recording);
    Ok((recording, notes))
}

/// A file of which the columns are known.
pub(super) struct Table {
    /// Names of the columns, a list's one for each of its numbers.
    pub header: Vec<String>,
    /// Names of the joints, in the order of their numbers, where the file has them.
    pub own_joints: Option<Vec<String>>,
    /// For each name the column in the file and, of a list, the place in it.
    places: Vec<(usize, Option<usize>)>,
    metadata: HashMap<String, String>,
}

fn broken(path: &Path, error: impl std::fmt::Display) -> Error {
    Error::input(path, None, "Parquet", format!("the file cannot be read: {error}"))
}

fn builder(path: &Path) -> Result<ParquetRecordBatchReaderBuilder<File>> {
    let file = File::open(path).map_err(|source| Error::io(path, "read the recording", source))?;
    ParquetRecordBatchReaderBuilder::try_new(file).map_err(|error| broken(path, error))
}

impl Table {
    /// Reads the file's metadata on its columns, and how long its lists are.
    pub fn open(path: &Path) -> Result<Table> {
        let builder = builder(path)?;
        let metadata = builder.metadata().file_metadata().key_value_metadata();
        let metadata: HashMap<String, String> = metadata
            .into_iter()
            .flatten()
            .filter_map(|entry| Some((entry.key.clone(), entry.value.clone()?)))
            .collect();
        let own_joints = own_joints(path, &metadata)?;
        let fields: Vec<_> = builder.schema().fields().iter().cloned().collect();
        let is_list =
            |kind: &DataType| matches!(kind, DataType::List(_) | DataType::LargeList(_) | DataType::FixedSizeList(..));
        let lists: Vec<usize> = (0..fields.len()).filter(|&column| is_list(fields[column].data_type())).collect();
        let mut lengths = HashMap::new();
        if !lists.is_empty() {
            let projection = ProjectionMask::roots(builder.parquet_schema(), lists.iter().copied());
            let first = builder.with_projection(projection).with_batch_size(1).build();
            let first = first.map_err(|error| broken(path, error))?.next();
            if let Some(batch) = first {
                let batch = batch.map_err(|error| broken(path, error))?;
                for (&column, array) in lists.iter().zip(batch.columns()) {
                    lengths.insert(column, elements(array, 0).map_or(0, |elements| elements.len()));
                }
            }
        }
        let mut table = Table { header: Vec::new(), own_joints, places: Vec::new(), metadata };
        for (column, field) in fields.iter().enumerate() {
            match lengths.get(&column) {
                Some(&length) => {
                    table.header.extend((0..length).map(|place| format!("{}[{place}]", field.name())));
                    table.places.extend((0..length).map(|place| (column, Some(place))));
                }
                None => {
                    table.header.push(field.name().clone());
                    table.places.push((column, None));
                }
            }
        }
        table.name_columns();
        Ok(table)
    }

    /// Puts the names of the joints that the file keeps in the place of their numbers, so that a reader may want them in any
    /// order. Joints that were never named keep their numbers.
    fn name_columns(&mut self) {
        let Some(own) = &self.own_joints else { return };
        if own.iter().enumerate().all(|(joint, name)| *name == format!("joint_{}", joint + 1)) {
            return;
        }
        for column in &mut self.header {
            let meaning = names::meanings(column).into_iter().find(|meaning| meaning.rank == 0);
            let Some(meaning) = meaning else { continue };
            if let Joint::Number(number) = meaning.joint
                && let Some(name) = number.checked_sub(1).and_then(|joint| own.get(joint))
            {
                let truth = if meaning.truth { names::TRUE } else { "" };
                *column = format!("{name}{}{truth}", QUANTITIES[meaning.quantity].suffixes[0]);
            }
        }
    }

    /// Reads the columns `used`; the others stay empty. `header` names them in messages. Empty cells are NaN where `lenient`,
    /// else an error.
    pub fn rows(&self, path: &Path, header: &[String], used: &[usize], lenient: bool) -> Result<Vec<Vec<f64>>> {
        let builder = builder(path)?;
        let roots: BTreeSet<usize> = used.iter().map(|&column| self.places[column].0).collect();
        let projection = ProjectionMask::roots(builder.parquet_schema(), roots.iter().copied());
        let reader = builder.with_projection(projection).build().map_err(|error| broken(path, error))?;
        let mut columns = vec![Vec::new(); header.len()];
        for batch in reader {
            let batch = batch.map_err(|error| broken(path, error))?;
            for (root, array) in roots.iter().zip(batch.columns()) {
                for &column in used.iter().filter(|column| self.places[**column].0 == *root) {
                    append(array, self.places[column].1, &mut columns[column], lenient)
                        .map_err(|problem| Error::input(path, None, &header[column], problem))?;
                }
            }
        }
        if used.iter().any(|&column| columns[column].is_empty()) {
            return Err(Error::input(path, None, "rows", "the file has columns but no row"));
        }
        Ok(columns)
    }

    /// Adds the file's metadata on the recording.
    pub fn describe(&self, recording: &mut Recording) {
        recording.robot = self.metadata.get(ROBOT).cloned().unwrap_or_default();
        recording.provenance = provenance(&self.metadata);
    }
}

fn own_joints(path: &Path, metadata: &HashMap<String, String>) -> Result<Option<Vec<String>>> {
    let names = metadata.get(JOINTS).map(|text| serde_json::from_str(text)).transpose();
    names.map_err(|error| {
        Error::input(path, None, JOINTS, format!("this entry of the metadata must be a JSON array of names: {error}"))
    })
}

fn provenance(metadata: &HashMap<String, String>) -> BTreeMap<String, String> {
    let entries = metadata.iter();
    entries.filter_map(|(key, value)| Some((key.strip_prefix(PROVENANCE)?.to_owned(), value.clone()))).collect()
}

/// The elements of a list.
fn elements(array: &ArrayRef, row: usize) -> Option<ArrayRef> {
    let any = array.as_any();
    if array.is_null(row) {
        return None;
    }
    let list = any.downcast_ref::<ListArray>().map(|list| list.value(row));
    let large = || any.downcast_ref::<LargeListArray>().map(|list| list.value(row));
    let fixed = || any.downcast_ref::<FixedSizeListArray>().map(|list| list.value(row));
    list.or_else(large).or_else(fixed)
}

fn append(
    array: &ArrayRef,
    place: Option<usize>,
    column: &mut Vec<f64>,
    lenient: bool,
) -> std::result::Result<(), String> {
    if let Some(place) = place {
        for row in 0..array.len() {
            let value = elements(array, row).filter(|list| place < list.len());
            match value {
                Some(list) => append(&list.slice(place, 1), None, column, lenient)?,
                None => column.push(f64::NAN),
            }
        }
        return Ok(());
    }
    if array.null_count() > 0 && !lenient {
        let row = column.len() + (0..array.len()).find(|&row| array.is_null(row)).unwrap_or(0) + 1;
        return Err(format!("row {row} is empty; a number goes here"));
    }
    let start = column.len();
    let kind = array.data_type();
    if let Some(values) = array.as_any().downcast_ref::<Float64Array>() {
        column.extend_from_slice(values.values());
    } else if kind.is_numeric() || matches!(kind, DataType::Timestamp(..)) {
        let whole = |array: &ArrayRef| match kind {
            DataType::Timestamp(..) => arrow_cast::cast(array, &DataType::Int64),
            _ => Ok(array.clone()),
        };
        let values = whole(array).and_then(|array| arrow_cast::cast(&array, &DataType::Float64));
        let values = values.map_err(|error| error.to_string())?;
        let values = values.as_any().downcast_ref::<Float64Array>().ok_or("its numbers cannot be read")?;
        column.extend_from_slice(values.values());
    } else {
        return Err(format!("the column is of type {kind}; floating-point numbers go here"));
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
    use arrow_array::types::Float32Type;
    use arrow_array::{Float32Array, Int64Array, ListArray, StringArray};
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
        let columns =
            || vec![("frame_index", index.clone()), ("action", lists(9.0)), ("observation.state", lists(0.5))];
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
}
