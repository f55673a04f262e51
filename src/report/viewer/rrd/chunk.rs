//! A chunk: rows of an entity as an Arrow record batch, in which metadata say what each column is.

use super::component::{Component, numbers};
use super::ids::Ids;
use arrow_array::types::{DurationNanosecondType, Int64Type, TimestampNanosecondType};
use arrow_array::{Array, ArrayRef, FixedSizeBinaryArray, ListArray, RecordBatch};
use arrow_buffer::OffsetBuffer;
use arrow_schema::{ArrowError, Field, Schema};
use std::collections::HashMap;
use std::sync::Arc;

/// Version of the metadata.
const METADATA_VERSION: &str = "0.1.3";

/// Bytes of an identity.
const ID_BYTES: i32 = 16;

/// Times of the rows on a timeline.
#[derive(Debug, Clone)]
pub(crate) struct Index {
    name: &'static str,
    times: ArrayRef,
    sorted: bool,
}

impl Index {
    /// Times from the start, s.
    pub(crate) fn seconds(name: &'static str, seconds: impl IntoIterator<Item = f64>) -> Self {
        let times: Vec<i64> = seconds.into_iter().map(nanoseconds).collect();
        let sorted = times.is_sorted();
        Index { name, times: numbers::<DurationNanosecondType>(times), sorted }
    }

    /// The date of one row, ns since 1970.
    pub(crate) fn date(name: &'static str, date: i64) -> Self {
        Index { name, times: numbers::<TimestampNanosecondType>([date]), sorted: true }
    }

    /// The number of one row.
    pub(crate) fn number(name: &'static str, number: i64) -> Self {
        Index { name, times: numbers::<Int64Type>([number]), sorted: true }
    }

    fn field(&self) -> Field {
        let metadata = [("rerun:kind", "index"), ("rerun:index_name", self.name)];
        let sorted = self.sorted.then_some(("rerun:is_sorted", "true"));
        Field::new(self.name, self.times.data_type().clone(), true)
            .with_metadata(map(metadata.into_iter().chain(sorted)))
    }
}

/// A time in whole nanoseconds.
pub(crate) fn nanoseconds(seconds: f64) -> i64 {
    (1e9 * seconds).round() as i64
}

/// The rows of `entity` at the times of `indices`; without indices, one row that holds at all times. Every row has the
/// same number of values of a component. Returned is the chunk's identity too.
pub(super) fn chunk(
    ids: &mut Ids,
    entity: &str,
    indices: &[Index],
    components: &[Component],
) -> Result<(u128, RecordBatch), ArrowError> {
    let id = ids.row();
    let rows = indices.first().map_or(1, |index| index.times.len());
    let row_ids: Vec<u8> = (0..rows).flat_map(|_| ids.row().to_be_bytes()).collect();
    let row_ids = FixedSizeBinaryArray::try_new(ID_BYTES, row_ids.into(), None)?;
    let row_field = Field::new("rerun.controls.RowId", row_ids.data_type().clone(), false).with_metadata(map([
        ("rerun:kind", "control"),
        ("rerun:is_sorted", "true"),
        ("ARROW:extension:name", "rerun.datatypes.TUID"),
        ("ARROW:extension:metadata", r#"{"namespace":"row"}"#),
    ]));
    let mut columns: Vec<(Field, ArrayRef)> = vec![(row_field, Arc::new(row_ids))];
    columns.extend(indices.iter().map(|index| (index.field(), index.times.clone())));
    for component in components {
        let (name, count) = (&component.name, component.values.len());
        let each = count / rows.max(1);
        if each * rows != count {
            return Err(ArrowError::InvalidArgumentError(format!("{entity}: {count} values of {name} in {rows} rows")));
        }
        let item = Arc::new(Field::new("item", component.values.data_type().clone(), true));
        let offsets = OffsetBuffer::from_lengths(std::iter::repeat_n(each, rows));
        let lists = ListArray::try_new(item, offsets, component.values.clone(), None)?;
        let field = Field::new(&component.name, lists.data_type().clone(), true).with_metadata(map([
            ("rerun:kind", "data"),
            ("rerun:archetype", &component.archetype),
            ("rerun:component", &component.name),
            ("rerun:component_type", &component.kind),
        ]));
        columns.push((field, Arc::new(lists)));
    }
    let (fields, arrays): (Vec<Field>, Vec<ArrayRef>) = columns.into_iter().unzip();
    let name = format!("chunk_{id:032X}");
    let metadata =
        map([("rerun:id", name.as_str()), ("rerun:entity_path", entity), ("sorbet:version", METADATA_VERSION)]);
    Ok((id, RecordBatch::try_new(Arc::new(Schema::new_with_metadata(fields, metadata)), arrays)?))
}

fn map<'a>(pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> HashMap<String, String> {
    pairs.into_iter().map(|(key, value)| (key.to_owned(), value.to_owned())).collect()
}

#[cfg(test)]
mod tests {
    use super::super::component::{Archetype, tuples};
    use super::*;
    use arrow_array::types::{Float32Type, Float64Type};

    const SCALARS: Archetype = Archetype("archetypes.Scalars");

    #[test]
    fn a_row_without_a_time_holds_all_values() {
        let sizes = Archetype("archetypes.Boxes3D").component(
            "half_sizes",
            "components.HalfSize3D",
            tuples::<Float32Type, 3>([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]),
        );
        let (id, batch) = chunk(&mut Ids::new(), "/arm", &[], &[sizes]).unwrap();
        assert_eq!((batch.num_rows(), batch.num_columns()), (1, 2));
        assert_eq!(batch.schema().metadata()["rerun:id"], format!("chunk_{id:032X}"));
        let field = batch.schema().field(1).clone();
        assert_eq!(field.name(), "Boxes3D:half_sizes");
        assert_eq!(field.metadata()["rerun:archetype"], "rerun.archetypes.Boxes3D");
        assert_eq!(field.metadata()["rerun:component_type"], "rerun.components.HalfSize3D");
        let lists = batch.column(1).as_any().downcast_ref::<ListArray>().unwrap();
        assert_eq!(lists.value(0).len(), 2);
    }

    #[test]
    fn rows_at_times_have_a_value_each() {
        let values = SCALARS.component("scalars", "components.Scalar", numbers::<Float64Type>([1.0, f64::NAN, 3.0]));
        let times = Index::seconds("time", [0.0, 0.25, 1e-9]);
        let (_, batch) = chunk(&mut Ids::new(), "/line", &[times], &[values]).unwrap();
        assert_eq!(batch.num_rows(), 3);
        let lists = batch.column(2).as_any().downcast_ref::<ListArray>().unwrap();
        assert!((0..3).all(|row| lists.value(row).len() == 1));
        // The last time is before the second.
        assert!(!batch.schema().field(1).metadata().contains_key("rerun:is_sorted"));
        let sorted = Index::seconds("time", [0.0, 0.25, 0.25]);
        assert_eq!(sorted.field().metadata()["rerun:is_sorted"], "true");
    }

    #[test]
    fn there_may_be_no_rows() {
        let values = SCALARS.component("scalars", "components.Scalar", numbers::<Float64Type>([]));
        let (_, batch) = chunk(&mut Ids::new(), "/line", &[Index::seconds("time", [])], &[values]).unwrap();
        assert_eq!(batch.num_rows(), 0);
    }

    #[test]
    fn rows_with_different_numbers_of_values_are_refused() {
        let values =
            |count| SCALARS.component("scalars", "components.Scalar", numbers::<Float64Type>(vec![0.0; count]));
        let refused = |count| {
            let problem = chunk(&mut Ids::new(), "/line", &[Index::seconds("time", [0.0, 1.0])], &[values(count)]);
            problem.map_err(|problem| problem.to_string()).err()
        };
        assert_eq!((refused(2), refused(4)), (None, None));
        assert!(refused(3).unwrap().contains("/line: 3 values of Scalars:scalars in 2 rows"));
    }

    #[test]
    fn times_are_rounded_to_nanoseconds() {
        assert_eq!(nanoseconds(0.1 + 0.2), 300_000_000);
        assert_eq!(nanoseconds(-1.5e-9), -2);
    }
}
