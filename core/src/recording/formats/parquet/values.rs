//! Values of a column, of any numeric type and in lists.

use arrow_array::{Array, ArrayRef, FixedSizeListArray, Float64Array, LargeListArray, ListArray};
use arrow_schema::DataType;

/// The elements of a list.
pub(super) fn elements(array: &ArrayRef, row: usize) -> Option<ArrayRef> {
    let any = array.as_any();
    if array.is_null(row) {
        return None;
    }
    let list = any.downcast_ref::<ListArray>().map(|list| list.value(row));
    let large = || any.downcast_ref::<LargeListArray>().map(|list| list.value(row));
    let fixed = || any.downcast_ref::<FixedSizeListArray>().map(|list| list.value(row));
    list.or_else(large).or_else(fixed)
}

/// Adds the values of an array to a column; of lists those at `place`. An empty cell is NaN where `lenient`, else an error.
pub(super) fn append(
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
