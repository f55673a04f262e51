//! Units of names that the values contradict: a header was written for another recorder, or by hand.
//!
//! Values are judged by the size of arms alone. A small arm, or a small motion, may have those of the name: so much is asked that
//! no log of several joints has them, and a dataset decides otherwise.

use crate::recording::Recording;
use crate::recording::columns::names::{POSITION, TORQUE, Unit, VELOCITY};
use std::f64::consts::TAU;

/// Joints from which an arm is judged: a bench with one or two may move by a degree, or have a motor of a toy.
const JOINTS: usize = 4;

/// In degrees no joint of an arm leaves one turn in rad, but for an arm that stands stretched at its zeros; half of the joints move
/// by more than this, which is nothing in degrees and the motion of a log in rad.
const MOVES: f64 = 0.5;

/// No arm has all its torques below this, N m: the drives of the smallest servos have ten times as much.
const LEAST_TORQUE: f64 = 0.1;

/// Velocities are the changes of position per second within this ratio.
const SAME: f64 = 1.3;

/// Takes units away that the values contradict, and returns what was assumed instead.
pub(super) fn without_contradicted(
    log: &Recording,
    units: &mut [Vec<Option<Unit>>; 4],
    known: [bool; 4],
) -> Vec<String> {
    let mut notes = Vec::new();
    if log.joints() < JOINTS {
        return notes;
    }
    let all_in = |quantity: usize, symbol: &str| {
        !known[quantity]
            && !units[quantity].is_empty()
            && units[quantity].iter().all(|unit| unit.is_some_and(|unit| unit.symbol == symbol))
    };
    let (degrees, rates) = (all_in(POSITION, "deg") && are_radians(log), all_in(VELOCITY, "deg/s"));
    let millis = all_in(TORQUE, "mN m") && largest(log.tau.as_slice()) * 1e-3 < LEAST_TORQUE;
    if degrees {
        units[POSITION].fill(None);
        let follow = rates && of_positions(log);
        if follow {
            units[VELOCITY].fill(None);
        }
        notes.push(format!(
            "the names of the positions say deg, but no joint leaves one turn in rad and half of them move by more than {MOVES}: they{} are \
             taken in rad; if they are in deg, say so with [units] position = \"deg\" in a dataset",
            if follow { " and the velocities" } else { "" }
        ));
    }
    if millis {
        units[TORQUE].fill(None);
        notes.push(format!(
            "the names of the torques say mN m, in which no joint of this arm would have {LEAST_TORQUE} N m: they are taken in N m; if they are in \
             mN m, say so with [units] torque = \"mNm\" in a dataset"
        ));
    }
    notes
}

fn largest(values: &[f64]) -> f64 {
    values.iter().filter(|value| value.is_finite()).fold(0.0, |most, value| most.max(value.abs()))
}

/// Whether positions that the names have in degrees are in rad.
fn are_radians(log: &Recording) -> bool {
    let moves = |q: &[f64]| {
        let (low, high) =
            q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &q| (low.min(q), high.max(q)));
        high - low > MOVES
    };
    largest(log.q.as_slice()) < TAU && 2 * log.q.iter().filter(|q| moves(q)).count() >= log.joints()
}

/// Whether velocities are the changes of position per second as the file has both.
fn of_positions(log: &Recording) -> bool {
    let Some(qd) = log.qd.as_ref() else { return false };
    let (mut of_positions, mut of_velocities) = (0.0, 0.0);
    for (q, qd) in log.q.iter().zip(qd.iter()) {
        for k in 1..q.len() {
            of_positions += (q[k] - q[k - 1]).abs();
            of_velocities += 0.5 * (qd[k] + qd[k - 1]).abs() * (log.time[k] - log.time[k - 1]);
        }
    }
    let ratio: f64 = of_positions / of_velocities;
    (1.0 / SAME..SAME).contains(&ratio)
}

#[cfg(test)]
mod tests {
    use crate::recording::lenient::{ColumnMap, Sieved, load};

    /// A log of so many joints, with positions of a swing and torques of a size.
    fn read(joints: usize, of_names: [&str; 3], [swing, torque]: [f64; 2], known: [bool; 4]) -> Sieved {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut text = "t".to_owned();
        for (quantity, unit) in ["q", "qd", "tau"].into_iter().zip(of_names) {
            (1..=joints).for_each(|joint| text += &format!(",{quantity}{joint}{unit}"));
        }
        for row in 0..400 {
            let t = 0.01 * f64::from(row);
            let (q, qd) = (swing * (2.0 * t).sin(), 2.0 * swing * (2.0 * t).cos());
            text += &format!("\n{t}");
            for value in [q, qd, torque * (q / swing + 0.5)] {
                (0..joints).for_each(|_| text += &format!(",{value}"));
            }
        }
        std::fs::write(&path, text).unwrap();
        load(&path, None, &ColumnMap { known_units: known, ..ColumnMap::default() }).unwrap()
    }

    const DEGREES: [&str; 3] = [" [deg]", " [deg/s]", " [Nm]"];

    #[test]
    fn degrees_that_are_radians_are_taken_for_these() {
        let largest = |sieved: &Sieved| super::largest(sieved.recording.q.as_slice());
        let fastest = |sieved: &Sieved| super::largest(sieved.recording.qd.as_ref().unwrap().as_slice());
        let radians = read(6, DEGREES, [1.2, 40.0], [false; 4]);
        assert!((largest(&radians) - 1.2).abs() < 1e-3 && (fastest(&radians) - 2.4).abs() < 1e-3);
        assert!(radians.corrections.iter().any(|note| note.contains("taken in rad")), "{:?}", radians.corrections);
        // Two joints, a motion beyond one turn, a small one, and a unit that a dataset gives.
        for (joints, swing) in [(2, 1.2), (6, 6.4), (6, 0.2)] {
            let degrees = read(joints, DEGREES, [swing, 40.0], [false; 4]);
            assert!(
                (largest(&degrees) / swing * 57.3 - 1.0).abs() < 1e-2,
                "{joints} {swing}: {:?}",
                degrees.corrections
            );
        }
        assert!((largest(&read(6, DEGREES, [1.2, 40.0], [true; 4])) - 1.2).abs() < 1e-3);
    }

    #[test]
    fn torques_below_those_of_any_arm_are_in_newton_metres() {
        let names = [" [rad]", " [rad/s]", " [mNm]"];
        let torque = |joints: usize, torque: f64| {
            super::largest(read(joints, names, [1.0, torque], [false; 4]).recording.tau.as_slice())
        };
        assert!((torque(6, 40.0) - 60.0).abs() < 0.1);
        assert!((torque(6, 80.0) - 0.12).abs() < 1e-3 && (torque(3, 40.0) - 0.06).abs() < 1e-3);
    }
}
