//! Writing of recordings.

use super::metadata::metadata;
use crate::error::{Error, Result};
use crate::recording::Recording;
use crate::recording::formats::written;
use ::parquet::arrow::ArrowWriter;
use ::parquet::basic::{Compression, Encoding};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

/// Writes a recording with numbered columns; the names of the joints stand in the metadata.
///
/// # Errors
/// The file cannot be written, or the signals differ in shape.
pub fn write(path: &Path, recording: &Recording) -> Result<()> {
    write_columns(path, recording, &written::table(recording, false)?)
}

/// Writes a recording with the names of its joints in those of its columns too: `elbow_position`, `elbow_velocity`, `elbow_effort`. Joints
/// that such names would not be read as keep their numbers.
///
/// # Errors
/// As [`write()`].
pub(crate) fn write_named(path: &Path, recording: &Recording) -> Result<()> {
    match written::named(recording)? {
        Some(columns) => write_columns(path, recording, &columns),
        None => write(path, recording),
    }
}

fn write_columns(path: &Path, recording: &Recording, columns: &[(String, &[f64])]) -> Result<()> {
    let failed = |source| Error::io(path, "write the recording", source);
    let file = File::create(path).map_err(failed)?;
    write_table(file, columns, metadata(recording)).map_err(|error| failed(into_io(error)))
}

pub(super) fn write_table(
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

/// The error of the operating system, where there is one.
pub(super) fn into_io(error: ParquetError) -> std::io::Error {
    match error {
        ParquetError::External(inner) => match inner.downcast::<std::io::Error>() {
            Ok(error) => *error,
            Err(inner) => std::io::Error::other(inner),
        },
        other => std::io::Error::other(other),
    }
}
