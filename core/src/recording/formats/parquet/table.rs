//! A file as a table.

use super::metadata::{describe, own_joints};
use super::values::{append, elements};
use crate::error::{Error, Result};
use crate::recording::Recording;
use crate::recording::columns::names::{self, Joint, QUANTITIES};
use ::parquet::arrow::ProjectionMask;
use ::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use arrow_schema::DataType;
use std::collections::{BTreeSet, HashMap};
use std::fs::File;
use std::path::Path;

/// A file of which the columns are known.
pub(in crate::recording) struct Table {
    /// Names of the columns, a list's one for each of its numbers.
    pub header: Vec<String>,
    /// Names of the joints, in the order of their numbers, where the file has them.
    pub own_joints: Option<Vec<String>>,
    /// For each name the column in the file and, of a list, the place in it.
    places: Vec<(usize, Option<usize>)>,
    metadata: HashMap<String, String>,
}

fn broken(path: &Path, error: impl std::fmt::Display) -> Error {
    let error = error.to_string();
    // The reader names the compression that it was built without.
    let cure = match error.split_once("Disabled feature at compile time: ") {
        Some((_, compression)) => format!(
            ": {compression} is not read; save the file with another compression, in pandas by \
             df.to_parquet(\"log.parquet\", compression=\"zstd\")"
        ),
        None => String::new(),
    };
    Error::input(path, None, "Parquet", format!("the file cannot be read: {error}{cure}"))
}

fn builder(path: &Path) -> Result<ParquetRecordBatchReaderBuilder<File>> {
    let file = File::open(path).map_err(|source| Error::io(path, "read the recording", source))?;
    ParquetRecordBatchReaderBuilder::try_new(file).map_err(|error| broken(path, error))
}

impl Table {
    /// Reads the file's metadata on its columns, and how long its lists are.
    pub(crate) fn open(path: &Path) -> Result<Table> {
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
    pub(crate) fn rows(&self, path: &Path, header: &[String], used: &[usize], lenient: bool) -> Result<Vec<Vec<f64>>> {
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
    pub(crate) fn describe(&self, recording: &mut Recording) {
        describe(&self.metadata, recording);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_compression_that_is_not_read_has_a_cure() {
        let said =
            broken(Path::new("a.parquet"), "Parquet error: Disabled feature at compile time: brotli").to_string();
        assert!(said.ends_with("brotli is not read; save the file with another compression, in pandas by df.to_parquet(\"log.parquet\", compression=\"zstd\")"), "{said}");
        assert!(!broken(Path::new("a.parquet"), "EOF").to_string().contains("compression"));
    }
}
