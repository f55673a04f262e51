//! Rows of a study as Parquet: one row group per chunk, and the times in a file of their own, so that the trials are the
//! same bytes however they were computed.

use super::plan::Identity;
use super::trial::{Found, Row};
use crate::error::{Error, Result};
use crate::study::testbed::Variant;
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch, StringArray, UInt32Array};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::{Compression, Encoding};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::schema::types::ColumnPath;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// Name and version of the layout, kept in the file's metadata.
pub(super) const SCHEMA: &str = "tauscope.montecarlo.trials/1";

/// The columns of trials, in order.
pub(super) fn trials(identity: &Identity, rows: &[Row]) -> Result<RecordBatch> {
    let found = |pick: &dyn Fn(&Found) -> f64| -> ArrayRef {
        Arc::new(Float64Array::from_iter(rows.iter().map(|row| row.outcome.as_ref().ok().map(pick))))
    };
    let numbers =
        |pick: &dyn Fn(&Row) -> u32| -> ArrayRef { Arc::new(UInt32Array::from_iter_values(rows.iter().map(pick))) };
    let noise = |row: &Row| identity.montecarlo.noise[row.level as usize];
    let level =
        |pick: &dyn Fn(&Row) -> Option<f64>| -> ArrayRef { Arc::new(Float64Array::from_iter(rows.iter().map(pick))) };
    let mut columns: Vec<(String, ArrayRef)> = keys(rows);
    columns.insert(1, ("noise_level".into(), numbers(&|row| row.level)));
    columns.insert(2, ("encoder_noise_rad".into(), level(&|row| noise(row).encoder_rad)));
    columns.insert(3, ("torque_noise_nm".into(), level(&|row| noise(row).torque_nm)));
    let failure = rows.iter().map(|row| row.outcome.as_ref().err().map(String::as_str));
    columns.push(("failure".into(), Arc::new(StringArray::from_iter(failure))));
    columns.push(("d_beta".into(), found(&|f| f.d_beta)));
    columns.push(("coverage".into(), found(&|f| f.coverage)));
    for (k, joint) in identity.joints.iter().enumerate() {
        columns.push((format!("torque_std_{joint}"), found(&|f| f.torque_std[k])));
    }
    for k in 0..identity.parameters.len() {
        columns.push((format!("beta_{}", k + 1), found(&|f| f.beta[k])));
    }
    for k in 0..identity.parameters.len() {
        columns.push((format!("std_{}", k + 1), found(&|f| f.std[k])));
    }
    for k in 0..identity.parameters.len() {
        columns.push((format!("true_{}", k + 1), level(&|row| row.truth.get(k).copied())));
    }
    batch(columns)
}

/// The times of the same rows.
pub(super) fn timings(rows: &[Row]) -> Result<RecordBatch> {
    let mut columns = keys(rows);
    columns
        .insert(1, ("noise_level".into(), Arc::new(UInt32Array::from_iter_values(rows.iter().map(|row| row.level)))));
    let seconds = Float64Array::from_iter_values(rows.iter().map(|row| row.seconds));
    columns.push(("seconds".into(), Arc::new(seconds)));
    batch(columns)
}

fn keys(rows: &[Row]) -> Vec<(String, ArrayRef)> {
    vec![
        ("trial".into(), Arc::new(UInt32Array::from_iter_values(rows.iter().map(|row| row.trial)))),
        ("signals".into(), Arc::new(StringArray::from_iter_values(rows.iter().map(|row| row.signals.name())))),
        ("sg_window".into(), Arc::new(UInt32Array::from_iter_values(rows.iter().map(|row| row.window)))),
        ("estimator".into(), Arc::new(StringArray::from_iter_values(rows.iter().map(|row| row.estimator.as_str())))),
    ]
}

fn batch(columns: Vec<(String, ArrayRef)>) -> Result<RecordBatch> {
    // What may be empty in one chunk must be allowed to be in all, so that their layouts agree.
    let nullable = |array: &ArrayRef| array.as_any().is::<Float64Array>();
    let columns = columns.into_iter().map(|(name, array)| {
        let may_be_empty = nullable(&array) || name == "failure";
        (name, array, may_be_empty)
    });
    RecordBatch::try_from_iter_with_nullable(columns)
        .map_err(|problem| Error::request("trials", format!("make no table: {problem}")))
}

/// Writes batches of one layout, a row group each.
pub(super) struct Writer<'a> {
    path: &'a Path,
    file: Option<ArrowWriter<File>>,
    metadata: Vec<KeyValue>,
}

impl<'a> Writer<'a> {
    /// Will write to `path` as the first batch comes.
    pub(super) fn new(path: &'a Path, identity: &Identity) -> Result<Self> {
        let study = serde_json::to_string(identity)
            .map_err(|problem| Error::request("study", format!("cannot be written: {problem}")))?;
        let metadata = vec![KeyValue::new("schema".into(), SCHEMA.to_owned()), KeyValue::new("study".into(), study)];
        Ok(Writer { path, file: None, metadata })
    }

    /// Writes a batch as a row group.
    pub(super) fn write(&mut self, batch: &RecordBatch) -> Result<()> {
        let path = self.path;
        let failed = |problem: ParquetError| Error::io(path, "write the trials", into_io(problem));
        if self.file.is_none() {
            let file = File::create(path).map_err(|source| Error::io(path, "write the trials", source))?;
            let made = ArrowWriter::try_new(file, batch.schema(), Some(properties(batch, &self.metadata)));
            self.file = Some(made.map_err(failed)?);
        }
        let Some(file) = &mut self.file else { return Ok(()) };
        file.write(batch).and_then(|()| file.flush()).map_err(failed)
    }

    /// Ends the file and makes sure that it is on the disk.
    pub(super) fn finish(self) -> Result<()> {
        let failed = |source| Error::io(self.path, "write the trials", source);
        let Some(writer) = self.file else {
            return Err(Error::request("trials", "there are none to write"));
        };
        let file = writer.into_inner().map_err(|problem| failed(into_io(problem)))?;
        file.sync_all().map_err(failed)
    }
}

fn properties(batch: &RecordBatch, metadata: &[KeyValue]) -> WriterProperties {
    let mut builder = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_statistics_enabled(EnabledStatistics::None)
        .set_key_value_metadata(Some(metadata.to_vec()));
    for (field, array) in batch.schema().fields().iter().zip(batch.columns()) {
        if array.as_any().is::<Float64Array>() {
            let column = ColumnPath::from(field.name().as_str());
            builder = builder
                .set_column_dictionary_enabled(column.clone(), false)
                .set_column_encoding(column, Encoding::BYTE_STREAM_SPLIT);
        }
    }
    builder.build()
}

fn into_io(problem: ParquetError) -> std::io::Error {
    match problem {
        ParquetError::External(inner) => {
            inner.downcast::<std::io::Error>().map_or_else(std::io::Error::other, |error| *error)
        }
        other => std::io::Error::other(other),
    }
}

fn open(path: &Path) -> Result<ParquetRecordBatchReaderBuilder<File>> {
    let file = File::open(path).map_err(|source| Error::io(path, "read the trials", source))?;
    ParquetRecordBatchReaderBuilder::try_new(file).map_err(|problem| broken(path, &problem.to_string()))
}

fn broken(path: &Path, problem: &str) -> Error {
    Error::input(path, None, "Parquet", format!("the trials cannot be read: {problem}"))
}

/// Number of row groups of a file.
pub(super) fn groups(path: &Path) -> Result<usize> {
    Ok(open(path)?.metadata().num_row_groups())
}

/// One row group as a batch.
pub(super) fn read(path: &Path, group: usize) -> Result<RecordBatch> {
    let builder = open(path)?;
    let rows = builder.metadata().row_group(group).num_rows().max(1) as usize;
    let mut reader = builder
        .with_row_groups(vec![group])
        .with_batch_size(rows)
        .build()
        .map_err(|problem| broken(path, &problem.to_string()))?;
    let batch = reader.next().ok_or_else(|| broken(path, "a row group is empty"))?;
    batch.map_err(|problem| broken(path, &problem.to_string()))
}

/// Values of a column of whole numbers.
pub(super) fn whole<'a>(path: &Path, batch: &'a RecordBatch, name: &str) -> Result<&'a UInt32Array> {
    column(path, batch, name)
}

/// Values of a column of numbers.
pub(super) fn float<'a>(path: &Path, batch: &'a RecordBatch, name: &str) -> Result<&'a Float64Array> {
    column(path, batch, name)
}

/// Values of a column of texts.
pub(super) fn text<'a>(path: &Path, batch: &'a RecordBatch, name: &str) -> Result<&'a StringArray> {
    column(path, batch, name)
}

fn column<'a, T: Array + 'static>(path: &Path, batch: &'a RecordBatch, name: &str) -> Result<&'a T> {
    let found = batch.column_by_name(name).and_then(|array| array.as_any().downcast_ref::<T>());
    found.ok_or_else(|| {
        Error::input(path, None, name, "this column is missing or of another type; is it a study's file?")
    })
}

/// Mean times by smoothing and estimator.
///
/// ```
/// use tauscope::study::testbed::Variant;
/// # use tauscope::scenario::Setup;
/// # use tauscope::study::montecarlo::{Overrides, Plan, Study};
/// # let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// # let (estimators, windows) = (Some(vec!["wls".to_owned()]), Some(vec![0, 61]));
/// # let overrides = Overrides { trials: Some(4), estimators, windows, ..Overrides::default() };
/// # let study = Study::new(setup.clone(), Plan::new(&setup, overrides)?)?;
/// # let folder = tempfile::tempdir().unwrap();
/// # let (stop, path) = (std::sync::atomic::AtomicBool::new(false), folder.path().join("study"));
/// # use tauscope::study::montecarlo::{Progress, Shard, StudyFolder};
/// # let opened = StudyFolder::open(&path, &study, Shard::WHOLE, false)?;
/// # let finished = opened.run(&study, &Progress { done: &|_| (), stop: &stop }, &|_, _| String::new())?;
/// # let (summary, timings, _) = finished.expect("nothing stopped it");
///
/// // How long an estimate took with a smoothing that was tried; none for one that was not.
/// assert!(timings.mean(Variant::SavitzkyGolay, 61, "wls").is_some_and(|seconds| seconds > 0.0));
/// assert_eq!(timings.mean(Variant::SavitzkyGolay, 31, "wls"), None);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Timings {
    sums: Vec<Timing>,
}

/// Times of one smoothing and estimator.
#[derive(Debug, Clone, PartialEq)]
struct Timing {
    signals: String,
    window: u32,
    estimator: String,
    sum: f64,
    count: usize,
}

impl Timings {
    pub(super) fn add(&mut self, path: &Path, batch: &RecordBatch) -> Result<()> {
        let (signals, windows) = (text(path, batch, "signals")?, whole(path, batch, "sg_window")?);
        let estimators = text(path, batch, "estimator")?;
        let seconds = float(path, batch, "seconds")?;
        for row in 0..batch.num_rows() {
            let (signals, window, estimator) = (signals.value(row), windows.value(row), estimators.value(row));
            let sum = seconds.value(row);
            match self.sums.iter_mut().find(|own| own.is_of(signals, window, estimator)) {
                Some(own) => (own.sum, own.count) = (own.sum + sum, own.count + 1),
                None => {
                    let (signals, estimator) = (signals.to_owned(), estimator.to_owned());
                    self.sums.push(Timing { signals, window, estimator, sum, count: 1 });
                }
            }
        }
        Ok(())
    }

    /// Mean time of an estimator with a smoothing, preparation of the rows included, s.
    pub fn mean(&self, signals: Variant, window: u32, estimator: &str) -> Option<f64> {
        let found = self.sums.iter().find(|own| own.is_of(signals.name(), window, estimator));
        found.map(|own| own.sum / own.count as f64)
    }
}

impl Timing {
    fn is_of(&self, signals: &str, window: u32, estimator: &str) -> bool {
        self.signals == signals && self.window == window && self.estimator == estimator
    }
}
