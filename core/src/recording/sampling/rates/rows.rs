//! The rows of a source.

/// A source with fewer rows shows no rate.
pub(super) const FEWEST: usize = 100;

/// Keeps these rows and no others.
pub(super) fn keep(rows: &[usize], columns: &mut [Vec<f64>], lines: &mut Vec<usize>) {
    *lines = rows.iter().map(|&row| lines[row]).collect();
    for column in columns.iter_mut().filter(|column| !column.is_empty()) {
        *column = rows.iter().map(|&row| column[row]).collect();
    }
}
