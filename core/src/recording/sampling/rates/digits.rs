//! Values that repeat because they have few digits: a slow signal stays within one step of its last digit over several rows.

/// Where a signal changes by more than so many of its steps, mostly, it is not within one of them in the next row: what repeats
/// there was not measured anew.
pub(super) const DIGITS: f64 = 3.5;

/// Whether few digits may be why the signals `of` repeat between the rows `new`. They are not where one signal changes in most of
/// these rows, and mostly by several of its smallest changes.
pub(super) fn may_be_why(columns: &[Vec<f64>], of: &[usize], new: &[usize]) -> bool {
    !of.iter().any(|&column| {
        let values = &columns[column];
        let rows = new.iter().filter(|row| **row > 0);
        let mut changes: Vec<f64> =
            rows.map(|&row| (values[row] - values[row - 1]).abs()).filter(|c| *c > 0.0).collect();
        changes.sort_by(f64::total_cmp);
        let middle = changes.get(changes.len() / 2);
        2 * changes.len() > new.len() && middle.is_some_and(|middle| *middle > DIGITS * changes[0])
    })
}

#[cfg(test)]
mod tests {
    use super::may_be_why;

    #[test]
    fn a_constant_speed_in_few_digits_shows_no_rate() {
        // 2.67 rows per digit.
        let slow: Vec<f64> = (0..800).map(|row| (row as f64 / 2.67).floor()).collect();
        let new: Vec<usize> = (1..800).filter(|&row| slow[row] != slow[row - 1]).collect();
        assert!(may_be_why(&[slow], &[0], &new));
        // Every third row new, at a speed of 3 to 9 digits per row.
        let held: Vec<f64> = (0..800).map(|row| ((row / 3) as f64 * 0.05).sin() * 360.0).map(f64::round).collect();
        let new: Vec<usize> = (1..800).filter(|&row| held[row] != held[row - 1]).collect();
        assert!(!may_be_why(&[held], &[0], &new));
    }
}
