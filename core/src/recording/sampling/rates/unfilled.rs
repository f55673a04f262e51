//! Rows of zeros at the end or the beginning of a table: of a buffer that was not filled.

use super::rows::keep;
use crate::recording::columns::{ABSENT, Layout};

/// A row may be zero at the start of a motion; time is zero there once.
const LEAST: usize = 2;

/// Leaves out runs of rows in which time and all signals are exactly zero; returns what was done.
pub(crate) fn without_unfilled(layout: &Layout, columns: &mut [Vec<f64>], lines: &mut Vec<usize>) -> Option<String> {
    if layout.time() == ABSENT {
        return None;
    }
    let used = layout.used();
    let zero: Vec<bool> = (0..lines.len()).map(|row| used.iter().all(|&column| columns[column][row] == 0.0)).collect();
    let is_left = |row: usize| {
        let next_to = [row.checked_sub(1), Some(row + 1)];
        !zero[row] || !next_to.into_iter().flatten().any(|other| zero.get(other) == Some(&true))
    };
    let left: Vec<usize> = (0..zero.len()).filter(|&row| is_left(row)).collect();
    let out = zero.len() - left.len();
    if out < LEAST || left.is_empty() {
        return None;
    }
    let first = lines[zero.iter().enumerate().position(|(row, _)| !is_left(row))?];
    keep(&left, columns, lines);
    Some(format!(
        "{out} rows from line {first} on are zero in time and all signals, as those of a buffer that was not filled: they are left out"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_zeros_are_those_of_a_buffer() {
        let header: Vec<String> = ["t", "q1", "tau1"].map(str::to_owned).to_vec();
        let layout = Layout::find("log.csv".as_ref(), None, &header, None).unwrap();
        let left = |time: &[f64], q: &[f64]| {
            let mut columns = vec![time.to_vec(), q.to_vec(), q.to_vec()];
            let mut lines: Vec<usize> = (2..2 + time.len()).collect();
            let said = without_unfilled(&layout, &mut columns, &mut lines);
            (lines, said.map(|said| said.contains("from line 5 on")))
        };
        assert_eq!(left(&[1.0, 2.0, 3.0, 0.0, 0.0], &[1.0, 2.0, 3.0, 0.0, 0.0]), (vec![2, 3, 4], Some(true)));
        // A motion that begins at zero, and an arm that stands there.
        assert_eq!(left(&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0]).1, None);
        assert_eq!(left(&[0.0, 1.0, 2.0], &[0.0, 0.0, 0.0]).1, None);
    }
}
