//! Units that the names of columns give: positions, velocities, accelerations and torques in these are converted to those of SI.

use super::plausible::{self, DoubtfulUnit};
use crate::recording::Recording;
use crate::recording::columns::names::{ACCELERATION, POSITION, QUANTITIES, TORQUE, Unit, VELOCITY};
use std::f64::consts::TAU;

/// Time over which changes of positions are compared with velocities, s.
const COMPARED_S: f64 = 0.1;

/// Converts what has a unit in its name, of position, velocity, acceleration and torque of every joint, and returns what was assumed;
/// with the units of names that are doubtful; `known` quantities stay as they are. Velocities without a unit belong to positions that have one: they are in this unit per second,
/// unless they agree better with positions in SI units.
pub(super) fn in_si(
    log: &mut Recording,
    mut units: [Vec<Option<Unit>>; 4],
    known: [bool; 4],
) -> (Vec<String>, Vec<DoubtfulUnit>) {
    for (own, _) in units.iter_mut().zip(known).filter(|(_, known)| *known) {
        own.fill(None);
    }
    let mut doubts = plausible::doubtful(log, &units, known);
    let positions: Vec<f64> = units[POSITION].iter().map(|unit| unit.map_or(1.0, |unit| unit.factor)).collect();
    let mut factors = [POSITION, VELOCITY, ACCELERATION, TORQUE].map(|quantity| {
        let own = units[quantity].iter().map(|unit| unit.map_or(1.0, |unit| unit.factor));
        own.collect::<Vec<f64>>()
    });
    let unnamed = |quantity: usize| !known[quantity] && units[quantity].iter().all(Option::is_none);
    let follow = !known[POSITION] && per_second_of_positions(log, &positions);
    for quantity in [VELOCITY, ACCELERATION] {
        if follow && unnamed(quantity) && !units[quantity].is_empty() {
            factors[quantity].clone_from(&positions);
            let of_positions = doubts.iter_mut().filter(|doubt| doubt.quantities[POSITION]);
            of_positions.for_each(|doubt| doubt.quantities[quantity] = true);
        }
    }
    let rates_follow = follow && unnamed(VELOCITY) && log.qd.is_some();
    let mut all_notes = Vec::new();
    for (quantity, units) in units.iter().enumerate() {
        let with_rates = quantity == POSITION && rates_follow;
        let doubt = doubts.iter_mut().find(|doubt| doubt.quantities[quantity]);
        let own = notes(log, quantity, units, with_rates, doubt.is_some());
        doubt.into_iter().for_each(|doubt| doubt.notes.extend(own.iter().cloned()));
        all_notes.extend(own);
    }
    let Recording { q, qd, qdd, tau, .. } = log;
    let tables = [Some(q), qd.as_mut(), qdd.as_mut(), Some(tau)];
    for (table, factors) in tables.into_iter().zip(factors) {
        let Some(table) = table else { continue };
        for (joint, factor) in factors.into_iter().enumerate().filter(|(_, factor)| *factor != 1.0) {
            table.channel_mut(joint).iter_mut().for_each(|value| *value *= factor);
        }
    }
    (all_notes, doubts)
}

/// What was assumed about a quantity: one line for each unit other than those of SI.
fn notes(log: &Recording, quantity: usize, units: &[Option<Unit>], with_rates: bool, is_doubtful: bool) -> Vec<String> {
    let mut seen: Vec<Unit> = Vec::new();
    for unit in units.iter().flatten().filter(|unit| unit.factor != 1.0) {
        if !seen.contains(unit) {
            seen.push(*unit);
        }
    }
    let name = QUANTITIES[quantity].name;
    let note = |unit: Unit| {
        let own: Vec<usize> = (0..units.len()).filter(|&joint| units[joint] == Some(unit)).collect();
        let all = own.len() == units.len();
        let plural = if quantity == VELOCITY { "velocities".to_owned() } else { format!("{name}s") };
        let rates = if with_rates { " and velocities" } else { "" };
        let of = match all {
            true => String::new(),
            false => {
                let names: Vec<&str> = own.iter().map(|&joint| log.joints[joint].as_str()).collect();
                format!(" of {}", names.join(", "))
            }
        };
        let Unit { symbol, si, .. } = unit;
        let per_second = if with_rates { format!(" and {symbol}/s") } else { String::new() };
        let table = if quantity == TORQUE { &log.tau } else { &log.q };
        let degrees = symbol == "deg" && quantity == POSITION && all && may_be_radians(log);
        let doubt = match degrees || (is_doubtful && quantity == TORQUE) {
            true => format!(
                "; no {name} exceeds {} {symbol}, though: if they are in {si}, say so there",
                short(plausible::largest(table.as_slice()))
            ),
            false => String::new(),
        };
        format!(
            "{plural}{rates}{of} are in {symbol}{per_second}, the unit of their names: they are converted to {si} (set another with \
             [units] {name} in a dataset){doubt}"
        )
    };
    seen.into_iter().map(note).collect()
}

/// A number with two digits.
fn short(value: f64) -> String {
    let digits = (1.0 - value.abs().log10().floor()).clamp(0.0, 9.0);
    format!("{value:.*}", digits as usize)
}

/// Whether the positions as the file has them could be in rad: no joint of several leaves one turn.
fn may_be_radians(log: &Recording) -> bool {
    log.joints() > 1 && log.q.as_slice().iter().all(|position| position.abs() < TAU)
}

/// Whether velocities are in the unit of the positions per second rather than in SI units; `factors` bring positions to SI units. So
/// they are where nothing shows it.
fn per_second_of_positions(log: &Recording, factors: &[f64]) -> bool {
    let Some(qd) = log.qd.as_ref() else { return false };
    let step = ((COMPARED_S * log.rate_hz()) as usize).max(1);
    // Of the sizes of the changes of position: the logarithm of how many times larger they are than the velocities have it.
    let mut farther = 0.0;
    for joint in (0..log.joints()).filter(|&joint| factors[joint] != 1.0 && log.has_velocity(joint)) {
        let (q, qd) = (log.q.channel(joint), qd.channel(joint));
        let (mut of_positions, mut of_velocities) = (0.0, 0.0);
        for start in (0..q.len().saturating_sub(step)).step_by(step) {
            let end = start + step;
            let path = |k: usize| 0.5 * (qd[k] + qd[k + 1]) * (log.time[k + 1] - log.time[k]);
            of_positions += (q[end] - q[start]).abs();
            of_velocities += (start..end).map(path).sum::<f64>().abs();
        }
        let ratio = of_positions / of_velocities;
        if ratio.is_finite() && ratio > 0.0 {
            // Zero where the units are the same, and this where the velocities are in SI units.
            let si = (1.0 / factors[joint]).ln();
            farther += (ratio.ln() - si).abs() - ratio.ln().abs();
        }
    }
    farther >= 0.0
}

#[cfg(test)]
mod tests {
    use crate::dataset::Dataset;
    use crate::recording::lenient::{ColumnMap, Sieved, load};
    use std::f64::consts::PI;

    const DEGREE: f64 = PI / 180.0;

    /// A log whose positions, velocities and torques are so many times those of SI.
    fn read(header: &str, [angle, rate, torque]: [f64; 3], known: [bool; 4]) -> Sieved {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut text = format!("{header}\n");
        for row in 0..400 {
            let t = 0.01 * f64::from(row);
            let (q, qd) = (1.2 * (2.0 * t).sin(), 2.4 * (2.0 * t).cos());
            text += &format!("{t},{},{},{}\n", angle * q, rate * qd, torque * (q + 3.0));
        }
        std::fs::write(&path, text).unwrap();
        load(&path, None, &ColumnMap { known_units: known, ..ColumnMap::default() }).unwrap()
    }

    /// How many times those of SI the recording has.
    fn left(sieved: &Sieved) -> [f64; 3] {
        let log = &sieved.recording;
        let torque = log.tau.channel(0)[0] / 3.0;
        [log.q.channel(0)[50] / (1.2 * 1f64.sin()), log.qd.as_ref().unwrap().channel(0)[0] / 2.4, torque]
    }

    #[track_caller]
    fn assert_si(sieved: &Sieved) {
        let left = left(sieved);
        assert!(left.iter().all(|left| (left - 1.0).abs() < 1e-9), "{left:?} {:?}", sieved.corrections);
    }

    #[test]
    fn units_of_names_are_converted() {
        let (degrees, rpm) = (1.0 / DEGREE, 30.0 / PI);
        for (header, factors, words) in [
            (
                "t,q1 [deg],qd1 [deg/s],tau1 [Nm]",
                [degrees, degrees, 1.0],
                vec!["positions are in deg", "velocities are in deg/s"],
            ),
            ("t,q1_deg,qd1_rpm,tau1_mNm", [degrees, rpm, 1e3], vec!["in deg", "in rpm", "torques are in mN m"]),
            ("t,q1 (deg),qd1,tau1", [degrees, degrees, 1.0], vec!["positions and velocities are in deg and deg/s"]),
            ("t,q1 (deg),qd1,tau1", [degrees, 1.0, 1.0], vec!["positions are in deg"]),
            ("t,a_position[mm],a_velocity[mm/s],a_effort[kN]", [1e3, 1e3, 1e-3], vec!["in mm", "in mm/s", "in kN"]),
            ("time,q1,qd1,tau1\ns,deg,deg/s,kgf.cm", [degrees, degrees, 10.197_162_129_779], vec!["kgf cm"]),
            ("t,q1 [rad],qd1 [rad/s],tau1 [Nm]", [1.0; 3], vec![]),
        ] {
            let sieved = read(header, factors, [false; 4]);
            assert_si(&sieved);
            assert_eq!(sieved.corrections.is_empty(), words.is_empty(), "{:?}", sieved.corrections);
            for word in words {
                assert!(sieved.corrections.iter().any(|note| note.contains(word)), "{word}: {:?}", sieved.corrections);
            }
        }
        let amperes = read("t,q1,qd1,tau1 [mA]", [1.0, 1.0, 1e3], [false; 4]);
        assert_si(&amperes);
        assert!(amperes.currents);
    }

    #[test]
    fn a_unit_that_is_known_otherwise_stays() {
        let sieved = read("t,q1 [deg],qd1 [deg/s],tau1 [mNm]", [1.0; 3], [true; 4]);
        assert_si(&sieved);
        assert!(sieved.corrections.is_empty(), "{:?}", sieved.corrections);
        // A dataset says so.
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let urdf = r#"<robot name="one"><link name="base"/><joint name="a" type="revolute"><parent link="base"/><child link="l1"/>
<axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="99" velocity="9"/></joint><link name="l1"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>"#;
        std::fs::write(at("one.urdf"), urdf).unwrap();
        let rows: String = (0..60).map(|row| format!("{},{},1\n", 0.01 * f64::from(row), row)).collect();
        std::fs::write(at("log.csv"), format!("t,angle [deg],tau1\n{rows}")).unwrap();
        let robot = crate::robot::load(at("one.urdf"), crate::robot::InertiaCheck::Required).unwrap();
        let last = |units: &str| {
            let text = format!(
                "schema = \"tauscope.dataset/1\"\n[[train]]\nfile = \"log.csv\"\n[columns]\nq = [\"angle [deg]\"]\n{units}"
            );
            std::fs::write(at("d.toml"), text).unwrap();
            let log = Dataset::load(at("d.toml")).unwrap().read(&at("log.csv"), &robot).unwrap().recording;
            log.q.channel(0)[59]
        };
        assert_eq!([last(""), last("[units]\nposition = \"rad\"\n")].map(|q| (q * 1e6).round()), [1_029_744.0, 59e6]);
    }

    #[test]
    fn positions_in_degrees_within_one_turn_in_rad_raise_a_doubt() {
        let said = |largest: f64| {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("log.csv");
            let row = |row: i32| format!("{},{},0.1,{row},1\n", 0.01 * f64::from(row), largest * f64::from(row) / 99.0);
            let rows: String = (0..100).map(row).collect();
            std::fs::write(&path, format!("t,q1 [deg],q2 [deg],tau1,tau2\n{rows}")).unwrap();
            load(&path, None, &ColumnMap::default()).unwrap().corrections.join("; ")
        };
        assert!(said(6.2).contains("if they are in rad") && !said(6.4).contains("if they are in rad"), "{}", said(6.2));
    }
}
