//! Numbers that stand for a missing value, as -9999.

use crate::recording::columns::Layout;

/// What programs write, without a sign.
const USUAL: [f64; 9] =
    [99.0, 999.0, 9999.0, 99_999.0, 999_999.0, 32_767.0, 32_768.0, 2_147_483_647.0, 2_147_483_648.0];

/// Such a number is this many times larger than all others of its column, and any other number by the second: it is the same to its last
/// digit each time, as no measurement far from all others is.
const LARGER: f64 = 5.0;
const FAR_LARGER: f64 = 100.0;

/// Smaller numbers may be measured.
const SMALLEST: f64 = 99.0;

/// It must come this often; once may be a broken cell.
const OFTEN: usize = 2;

/// Share of the rows that may lack the value: a column that has only two values is a switch.
const MOST: f64 = 0.5;

/// Puts NaN in the place of numbers that stand for a missing value, but in the column of time; returns notes on it.
pub(crate) fn removed(layout: &Layout, header: &[String], columns: &mut [Vec<f64>]) -> Vec<String> {
    let time = layout.time();
    let mut notes = Vec::new();
    for column in layout.used().into_iter().filter(|column| *column != time) {
        let values = &mut columns[column];
        let Some((sentinel, count)) = sentinel(values) else { continue };
        values.iter_mut().filter(|value| **value == sentinel).for_each(|value| *value = f64::NAN);
        notes.push(format!("{sentinel} in {} stands for a missing value ({count} rows)", header[column]));
    }
    notes
}

/// The number of a column that stands for a missing value, and how often it comes.
fn sentinel(values: &[f64]) -> Option<(f64, usize)> {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let largest = finite().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    if largest.abs() < SMALLEST {
        return None;
    }
    let count = finite().filter(|value| *value == largest).count();
    let others = finite().filter(|value| *value != largest).fold(0.0, |most: f64, value| most.max(value.abs()));
    let larger = if USUAL.contains(&largest.abs()) { LARGER } else { FAR_LARGER };
    let stands_for_none = count >= OFTEN
        && (count as f64) < MOST * values.len() as f64
        && others > 0.0
        && largest.abs() > larger * others.max(1.0);
    stands_for_none.then_some((largest, count))
}

#[cfg(test)]
mod tests {
    use super::sentinel;

    #[test]
    fn a_number_far_from_all_others_that_comes_again_is_no_measurement() {
        let with = |number: f64, times: usize, size: f64| {
            let mut values: Vec<f64> = (0..200).map(|row| size * (0.1 * f64::from(row)).sin()).collect();
            values[50..50 + times].fill(number);
            sentinel(&values).map(|(found, _)| found)
        };
        assert_eq!([with(-9999.0, 20, 3.0), with(-9999.0, 2, 180.0)], [Some(-9999.0); 2]);
        assert_eq!(with(1e5, 3, 90.0), Some(1e5));
        // Once, a torque that is cut off, and one that is only large.
        assert_eq!(
            [with(-9999.0, 1, 3.0), with(100.0, 20, 90.0), with(5e3, 20, 90.0), with(999.0, 3, 300.0)],
            [None; 4]
        );
        // A switch.
        let switch: Vec<f64> = (0..200).map(|row| if row % 3 == 0 { 100.0 } else { 0.0 }).collect();
        assert_eq!(sentinel(&switch), None);
    }
}
