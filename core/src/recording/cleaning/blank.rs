//! Rows of a second source that knows no torque: all are exactly zero there, between rows in which they are not.

/// Share of the rows from which on they are those of a second source.
const OFTEN: f64 = 0.05;

/// Most of them in a row: in a longer stretch the motors may be off.
const RUN: usize = 3;

/// Fewer torques are all zero by chance where they are coarse; as few rows as this say nothing either.
const FEWEST_TORQUES: usize = 2;
const FEWEST_ROWS: usize = 50;

/// Share of a torque's usual size that one of a neighbour's torques has at least: a coarse torque passes zero by one digit.
const CLEAR: f64 = 0.1;

/// The rows of `torques`, one signal for each joint, in which a second source has put zeros; none where they are too few, or too many.
pub(super) fn of_second_source(torques: &[&[f64]]) -> Vec<usize> {
    let rows = torques.first().map_or(0, |torque| torque.len());
    let is_blank = |row: usize| torques.iter().all(|torque| torque[row] == 0.0);
    // A torque that is never there is another matter.
    let measured: Vec<&&[f64]> = torques.iter().filter(|torque| torque.iter().any(|value| *value != 0.0)).collect();
    if rows < FEWEST_ROWS || measured.len() < FEWEST_TORQUES {
        return Vec::new();
    }
    let blank: Vec<usize> = (0..rows).filter(|&row| is_blank(row)).collect();
    let usual: Vec<f64> = measured
        .iter()
        .map(|torque| {
            let sizes = torque.iter().filter(|value| **value != 0.0).map(|value| value.abs());
            let (sum, count) = sizes.fold((0.0, 0.0), |(sum, count), size| (sum + size, count + 1.0));
            sum / count
        })
        .collect();
    let is_clear = |row: usize| measured.iter().zip(&usual).any(|(torque, usual)| torque[row].abs() > CLEAR * usual);
    let stands_alone = |&&row: &&usize| {
        let before = (1..=RUN.min(row)).map(|back| row - back).find(|&other| !is_blank(other));
        let behind = (row + 1..=(row + RUN).min(rows - 1)).find(|&other| !is_blank(other));
        matches!((before, behind), (Some(before), Some(behind)) if behind - before <= RUN + 1 && is_clear(before) && is_clear(behind))
    };
    let alone: Vec<usize> = blank.iter().filter(stands_alone).copied().collect();
    if (alone.len() as f64) < OFTEN * rows as f64 { Vec::new() } else { alone }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows found where those for which `is_zero` holds have no torque.
    fn found(is_zero: impl Fn(usize) -> bool) -> Vec<usize> {
        let torque = |phase: f64| {
            let value = |row: usize| if is_zero(row) { 0.0 } else { (0.03 * row as f64 + phase).sin() };
            (0..400).map(value).collect::<Vec<f64>>()
        };
        let torques = [torque(0.5), torque(1.7)];
        of_second_source(&torques.each_ref().map(Vec::as_slice))
    }

    #[test]
    fn zeros_between_torques_are_those_of_a_second_source() {
        assert_eq!(found(|row| row % 4 == 1).len(), 100);
        // Every other row, and three in a row of six.
        assert_eq!(found(|row| row % 2 == 1).len(), 199);
        assert!(found(|row| row % 6 > 2).len() > 190);
    }

    #[test]
    fn motors_that_are_off_and_torques_that_pass_zero_are_measured() {
        assert!(found(|row| (100..200).contains(&row)).is_empty());
        assert!(found(|row| row % 8 > 3).is_empty() && found(|row| row % 30 == 7).is_empty());
        // Coarse torques of an arm that hardly moves: one digit to either side of zero, and now and then more.
        let coarse: Vec<f64> = (0..400).map(|row| [0.0, 0.1, 0.0, -0.1][row % 4] * f64::from(row % 2 == 1)).collect();
        let mut large = coarse.clone();
        large[40..80].fill(20.0);
        assert!(of_second_source(&[&large, &large]).is_empty());
        // One torque only, or none.
        assert!(of_second_source(&[&coarse]).is_empty() && of_second_source(&[]).is_empty());
    }
}
