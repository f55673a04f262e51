//! Rows of a second source that is late: it writes states anew that the first has written some rows before.

/// A late source is behind by so many rows at most.
const LATEST: usize = 12;

/// Share of the rows from which on states that come again are those of a second source.
const OFTEN: f64 = 0.05;

/// Fewer rows may repeat others by chance.
const FEWEST: usize = 50;

/// A state comes again where a position left it by more than so many of its smallest changes in between: encoders tremble by one, and joints
/// that creep go to and fro.
const DIGITS: f64 = 3.0;

/// What is wrong with rows that repeat the state of an earlier row, which others have left in between, and what to do.
pub(super) fn finding(positions: &[&[f64]]) -> Option<String> {
    let rows = positions.first()?.len();
    if rows < FEWEST {
        return None;
    }
    let digit = |signal: &&[f64]| {
        let changes = signal.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|change| *change > 0.0);
        changes.fold(f64::INFINITY, f64::min)
    };
    let digits: Vec<f64> = positions.iter().map(digit).collect();
    let same = |one: usize, other: usize| positions.iter().all(|signal| signal[one] == signal[other]);
    let left = |row: usize, between: usize| {
        let left = |(signal, digit): (&&[f64], &f64)| (signal[row] - signal[between]).abs() > DIGITS * digit;
        positions.iter().zip(&digits).any(left)
    };
    let behind = |row: usize| {
        (2..=LATEST.min(row)).find(|&lag| same(row, row - lag) && (1..lag).any(|between| left(row, row - between)))
    };
    let count = (2..rows).filter(|&row| behind(row).is_some()).count();
    (count as f64 > OFTEN * rows as f64).then(|| {
        format!(
            "{:.0} % of the rows repeat the state of an earlier row, which others have left in between: two programs write the joints' states, as two \
             publishers on one topic do, and one of them is late; stop it, or give it a topic of its own, and record again",
            100.0 * count as f64 / rows as f64
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moving(row: usize) -> [f64; 2] {
        let t = 0.05 * row as f64;
        [t.sin(), (1.7 * t).cos()]
    }

    /// What every row is made of, by the number of the row.
    fn found(rows: usize, state: impl Fn(usize) -> [f64; 2]) -> bool {
        let each: Vec<[f64; 2]> = (0..rows).map(state).collect();
        let signals: Vec<Vec<f64>> = (0..2).map(|joint| each.iter().map(|row| row[joint]).collect()).collect();
        finding(&signals.iter().map(Vec::as_slice).collect::<Vec<_>>()).is_some()
    }

    #[test]
    fn a_late_source_repeats_earlier_states() {
        // Every other row is the state before the last, and every fifth.
        assert!(found(400, |row| moving(if row % 2 == 1 { (row / 2).saturating_sub(1) } else { row / 2 })));
        assert!(found(400, |row| moving(if row % 5 == 4 { row - 3 } else { row })));
        // Hardly any rows do, or all states are new, or one is held.
        assert!(!found(400, |row| moving(if row % 25 == 24 { row - 3 } else { row })));
        assert!(!found(400, moving) && !found(400, |row| moving(row / 4)) && !found(49, |row| moving(row & !1)));
    }

    #[test]
    fn an_encoder_that_trembles_repeats_nothing() {
        let trembling = |digits: usize| move |row: usize| [1e-3 * ((row / 3 * digits) % (2 * digits)) as f64, 0.2];
        assert!(!found(400, trembling(1)));
        let creeping = |row: usize| [1e-3 * (row as f64 * 0.05).sin().mul_add(3.0, 0.0).round(), 0.0];
        assert!(!found(400, creeping));
    }
}
