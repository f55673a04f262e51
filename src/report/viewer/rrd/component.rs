//! Components: columns of values under the names and with the types that the viewer knows.

use arrow_array::types::{ArrowPrimitiveType, Int64Type, UInt8Type};
use arrow_array::{
    Array, ArrayRef, BooleanArray, FixedSizeListArray, ListArray, NullArray, PrimitiveArray, StringArray, StructArray,
    UnionArray,
};
use arrow_buffer::OffsetBuffer;
use arrow_schema::{Field, UnionFields};
use std::sync::Arc;

/// Components that the viewer draws together. The name leaves rerun's prefix out: `archetypes.Boxes3D`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Archetype(pub &'static str);

/// A component of an entity, with its values one after the other.
#[derive(Debug, Clone)]
pub(crate) struct Component {
    /// `rerun.archetypes.Boxes3D`.
    pub archetype: String,
    /// `Boxes3D:half_sizes`.
    pub name: String,
    /// `rerun.components.HalfSize3D`.
    pub kind: String,
    /// The values of all rows.
    pub values: ArrayRef,
}

impl Archetype {
    /// A component of this archetype; `kind` is its type without rerun's prefix, `components.HalfSize3D`.
    pub(crate) fn component(self, field: &str, kind: &str, values: ArrayRef) -> Component {
        let short = self.0.rsplit('.').next().unwrap_or(self.0);
        Component {
            archetype: format!("rerun.{}", self.0),
            name: format!("{short}:{field}"),
            kind: format!("rerun.{kind}"),
            values,
        }
    }
}

/// Numbers, or the numbers of an enumeration.
pub(crate) fn numbers<T: ArrowPrimitiveType>(values: impl IntoIterator<Item = T::Native>) -> ArrayRef {
    Arc::new(PrimitiveArray::<T>::from_iter_values(values))
}

/// Vectors and quaternions.
pub(crate) fn tuples<T: ArrowPrimitiveType, const N: usize>(
    values: impl IntoIterator<Item = [T::Native; N]>,
) -> ArrayRef {
    let parts = numbers::<T>(values.into_iter().flatten());
    Arc::new(FixedSizeListArray::new(item::<T>(), N as i32, parts, None))
}

/// Texts.
pub(crate) fn texts(values: impl IntoIterator<Item = impl AsRef<str>>) -> ArrayRef {
    Arc::new(StringArray::from_iter_values(values))
}

/// Yes or no.
pub(crate) fn flag(value: bool) -> ArrayRef {
    Arc::new(BooleanArray::from(vec![value]))
}

/// The bytes of a file.
pub(crate) fn blob(bytes: Vec<u8>) -> ArrayRef {
    let offsets = OffsetBuffer::from_lengths([bytes.len()]);
    Arc::new(ListArray::new(item::<UInt8Type>(), offsets, numbers::<UInt8Type>(bytes), None))
}

/// A range of times, ns, from and to a time of the timeline.
pub(crate) fn interval(from: i64, to: i64) -> ArrayRef {
    let ends = [("start", boundary(from)), ("end", boundary(to))];
    let columns = ends.map(|(name, end)| (Arc::new(Field::new(name, end.data_type().clone(), true)), end));
    Arc::new(StructArray::from(columns.to_vec()))
}

/// The end of a range, which might also be relative to the cursor or infinite.
fn boundary(time: i64) -> ArrayRef {
    /// Variant "Absolute".
    const ABSOLUTE: i8 = 2;
    let none = || Arc::new(NullArray::new(0)) as ArrayRef;
    let variants = [
        ("_null_markers", none(), true),
        ("CursorRelative", numbers::<Int64Type>([]), false),
        ("Absolute", numbers::<Int64Type>([time]), false),
        ("Infinite", none(), true),
    ];
    let fields = variants
        .iter()
        .zip(0..)
        .map(|((name, values, nullable), id)| (id, Arc::new(Field::new(*name, values.data_type().clone(), *nullable))));
    let fields: UnionFields = fields.collect();
    let children = variants.into_iter().map(|(_, values, _)| values).collect();
    let union = UnionArray::try_new(fields, vec![ABSOLUTE].into(), Some(vec![0].into()), children);
    Arc::new(union.expect("one value of a variant that there is"))
}

fn item<T: ArrowPrimitiveType>() -> Arc<Field> {
    Arc::new(Field::new("item", T::DATA_TYPE, false))
}
