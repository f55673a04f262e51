//! Files of several recordings one behind another, each with a clock of its own from the same start, as data sets of episodes are.

use crate::signal::size_quantile;

/// Rows of the shortest recording.
const FEWEST: usize = 50;

/// Usual steps within which all recordings begin at the same time.
const STEPS: f64 = 2.0;

/// Time that is put between two recordings, s: a log is cut at gaps as long.
const APART_S: f64 = 10.0;

/// Puts recordings behind each other whose times in seconds all begin anew; returns what was done, and the first row of each but the first.
pub(super) fn undo(time: &mut [f64]) -> Option<(String, Vec<usize>)> {
    let first = *time.first()?;
    let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
    let usual = size_quantile(steps.filter(|step| *step > 0.0), 0.5);
    let mut starts = vec![0];
    starts.extend((1..time.len()).filter(|&row| time[row] < time[row - 1]));
    let ends = starts.iter().skip(1).copied().chain([time.len()]);
    let are_long = starts.iter().zip(ends).all(|(start, end)| end - start >= FEWEST);
    let begin_anew = starts.iter().all(|&start| (time[start] - first).abs() <= STEPS * usual);
    if starts.len() < 2 || !are_long || !begin_anew || !time.iter().all(|time| time.is_finite()) {
        return None;
    }
    for &start in &starts[1..] {
        let by = time[start - 1] + APART_S - time[start];
        time[start..].iter_mut().for_each(|time| *time += by);
    }
    let said = format!(
        "the file holds {} recordings one behind another, each with times from {first} s on: they are put {APART_S} s apart, and none goes on \
         into the next",
        starts.len()
    );
    Some((said, starts.split_off(1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn episodes(lengths: &[usize], start: f64) -> Vec<f64> {
        lengths.iter().flat_map(|&length| (0..length).map(move |row| start + 0.02 * row as f64)).collect()
    }

    #[test]
    fn recordings_that_begin_anew_are_kept_apart() {
        let mut time = episodes(&[100, 50, 200], 0.5);
        let (said, begins) = undo(&mut time).unwrap();
        assert!(said.contains("3 recordings"), "{said}");
        assert_eq!(begins, [100, 150]);
        let gaps: Vec<usize> = (1..time.len()).filter(|&row| time[row] - time[row - 1] > 1.0).collect();
        assert_eq!(gaps, [100, 150]);
        assert!(time.is_sorted() && (time[100] - time[99] - APART_S).abs() < 1e-9);
    }

    #[test]
    fn a_clock_that_steps_back_is_another_fault() {
        // One that goes on from another time, single rows out of order, and one that only goes on.
        let mut set_back = episodes(&[100, 100], 0.0);
        set_back[100..].iter_mut().for_each(|time| *time += 0.7);
        let mut swapped = episodes(&[200], 0.0);
        swapped.swap(20, 21);
        for mut time in [set_back, swapped, episodes(&[200], 0.0), episodes(&[100, 49], 0.0), vec![]] {
            let before = time.clone();
            assert_eq!(undo(&mut time), None);
            assert_eq!(time, before);
        }
    }
}
