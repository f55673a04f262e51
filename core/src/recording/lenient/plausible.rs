//! Units of names that the size of the values makes doubtful: a header was written for another recorder, or by hand.
//!
//! Values are judged by the size of arms alone. A small arm, or a small motion, has those of the name: so a name stays, with a note, until
//! the torques deny it.

use crate::recording::Recording;
use crate::recording::columns::names::{POSITION, TORQUE, Unit, VELOCITY};
use std::f64::consts::TAU;

/// Joints from which an arm is judged: a bench with one or two may move by a degree, or have a motor of a toy.
const JOINTS: usize = 4;

/// In degrees few joints of an arm stay within one turn in rad; half of the joints move by more than this, which is little in degrees and
/// the motion of a log in rad.
const MOVES: f64 = 0.5;

/// Few arms have all their torques below this, N m.
const LEAST_TORQUE: f64 = 0.1;

/// Velocities are the changes of position per second within this ratio.
const SAME: f64 = 1.3;

/// A unit in the names of columns that the size of the values makes doubtful. The values are converted from it all the same.
#[derive(Debug, Clone, PartialEq)]
pub struct DoubtfulUnit {
    /// The unit of the names.
    pub(crate) symbol: &'static str,
    /// What one of it is in SI units: the values were multiplied by this.
    pub(crate) factor: f64,
    /// Whether position, velocity, acceleration and torque were.
    pub(crate) quantities: [bool; 4],
    /// What the corrections of the log say of it.
    pub(crate) notes: Vec<String>,
}

impl DoubtfulUnit {
    /// Whether it is one of torques.
    pub(crate) fn is_of_torque(&self) -> bool {
        self.quantities[TORQUE]
    }
}

/// Doubtful units of positions and torques.
pub(super) fn doubtful(log: &Recording, units: &[Vec<Option<Unit>>; 4], known: [bool; 4]) -> Vec<DoubtfulUnit> {
    let of = |quantity: usize, symbol: &str| {
        let unit = units[quantity].first().copied().flatten().filter(|unit| unit.symbol == symbol)?;
        let is_shared = !known[quantity] && units[quantity].iter().all(|own| *own == Some(unit));
        is_shared.then_some(unit)
    };
    if log.joints() < JOINTS {
        return Vec::new();
    }
    let doubt = |unit: Unit, quantities: &[usize]| DoubtfulUnit {
        symbol: unit.symbol,
        factor: unit.factor,
        quantities: std::array::from_fn(|quantity| quantities.contains(&quantity)),
        notes: Vec::new(),
    };
    let positions = of(POSITION, "deg").filter(|_| may_be_radians(log)).map(|unit| {
        let rates = of(VELOCITY, "deg/s").is_some() && of_positions(log);
        doubt(unit, if rates { &[POSITION, VELOCITY] } else { &[POSITION] })
    });
    let torques = of(TORQUE, "mN m").filter(|unit| largest(log.tau.as_slice()) * unit.factor < LEAST_TORQUE);
    positions.into_iter().chain(torques.map(|unit| doubt(unit, &[TORQUE]))).collect()
}

/// The largest size of the values that are known.
pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().filter(|value| value.is_finite()).fold(0.0, |most, value| most.max(value.abs()))
}

/// Whether positions that the names have in degrees may be in rad.
fn may_be_radians(log: &Recording) -> bool {
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

    /// Symbol and quantities of the doubtful units.
    fn doubts(sieved: &Sieved) -> Vec<(&str, [bool; 4])> {
        sieved.doubts.iter().map(|doubt| (doubt.symbol, doubt.quantities)).collect()
    }

    #[test]
    fn degrees_within_one_turn_in_rad_stay_and_are_doubtful() {
        let largest = |table: &crate::channels::Channels| super::largest(table.as_slice());
        for (joints, swing, known, is_doubtful) in [
            (6, 1.2, false, true),
            (6, 6.2, false, true),
            (6, 6.4, false, false),
            (6, 0.26, false, true),
            (6, 0.24, false, false),
            (3, 1.2, false, false),
            (6, 1.2, true, false),
        ] {
            let read = read(joints, DEGREES, [swing, 40.0], [known; 4]);
            let expected = if known { swing } else { swing.to_radians() };
            assert!((largest(&read.recording.q) / expected - 1.0).abs() < 1e-3, "{joints} {swing} {known}");
            assert!((largest(read.recording.qd.as_ref().unwrap()) / expected / 2.0 - 1.0).abs() < 1e-3);
            let wanted: &[_] = if is_doubtful { &[("deg", [true, true, false, false])] } else { &[] };
            assert_eq!(doubts(&read), wanted, "{joints} {swing} {known}");
            assert!(read.doubts.iter().flat_map(|doubt| &doubt.notes).all(|note| read.corrections.contains(note)));
        }
        // Velocities without a unit are in that of the positions per second.
        let unnamed = read(6, [" [deg]", "", " [Nm]"], [1.2, 40.0], [false; 4]);
        assert_eq!(doubts(&unnamed), [("deg", [true, true, false, false])]);
        assert!(unnamed.corrections.join(" ").contains("no position exceeds 1.2 deg"), "{:?}", unnamed.corrections);
    }

    #[test]
    fn torques_of_a_small_arm_stay_and_are_doubtful() {
        let names = [" [rad]", " [rad/s]", " [mNm]"];
        for (joints, torque, is_doubtful) in [(6, 60.0, true), (6, 70.0, false), (3, 60.0, false)] {
            let read = read(joints, names, [1.0, torque], [false; 4]);
            // One and a half of it at most.
            assert!((super::largest(read.recording.tau.as_slice()) - 1.5e-3 * torque).abs() < 1e-3);
            let wanted: &[_] = if is_doubtful { &[("mN m", [false, false, false, true])] } else { &[] };
            assert_eq!(doubts(&read), wanted, "{joints} {torque}");
        }
    }
}
