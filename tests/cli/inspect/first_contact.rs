//! Logs as they come at the first contact: currents, names of controllers, arrays without names, columns that stand twice, clocks full of
//! gaps.

use super::{ARM, one_joint, simulated, sines};
use crate::{Case, assert_done, assert_refusal, text};
use std::fmt::Write;

/// The table of a CSV file: names, and rows of numbers.
fn table(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let names = lines.next().unwrap().split(',').map(str::to_owned).collect();
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    (names, lines.map(row).collect())
}

/// Currents of motors with unlike constants, and positions in degrees that nothing names: both are found and stand in the corrected
/// description, with which nothing is left to say.
#[test]
fn currents_and_degrees_are_found_together() {
    let constants = [12.0, 9.0, 9.0, 1.5, 1.2, 0.8];
    let case = simulated();
    assert_done(&case.tauscope(&["inspect", &super::log_name(&case), "--convert", "plain.csv"]));
    let (names, rows) = table(&case.read("plain.csv"));
    let mut log = "t".to_owned();
    (1..=6).for_each(|joint| write!(log, ",q{joint}").unwrap());
    (1..=6).for_each(|joint| write!(log, ",motor_current_{joint}").unwrap());
    let place = |name: String| names.iter().position(|own| *own == name).unwrap_or_else(|| panic!("{name}: {names:?}"));
    let of = |prefix: &str| (1..=6).map(|joint| place(format!("{prefix}{joint}"))).collect::<Vec<usize>>();
    let (positions, torques) = (of("q"), of("tau"));
    for row in &rows {
        write!(log, "\n{}", row[0]).unwrap();
        positions.iter().for_each(|&column| write!(log, ",{}", row[column].to_degrees()).unwrap());
        torques
            .iter()
            .zip(constants)
            .for_each(|(&column, constant)| write!(log, ",{}", row[column] / constant).unwrap());
    }
    case.write("log.csv", &(log + "\n"));
    let output = case.tauscope(&["inspect", "log.csv", "--robot", "arm.urdf", "--out", "found"]);
    assert_done(&output);
    let said = text(&output.stdout);
    let warnings: Vec<&str> = said.lines().filter(|line| line.starts_with("warning")).collect();
    assert!(warnings.len() == 1 && warnings[0].contains("the positions are in degrees"), "{said}");
    assert!(said.contains("note: tau: the torques are motor currents"), "{said}");
    let corrected = case.read("found/corrected.toml");
    assert!(corrected.contains("position = \"deg\"") && corrected.contains("torque_constant_nm_a = ["), "{corrected}");
    let again = text(&case.tauscope(&["inspect", "--dataset", "found/corrected.toml"]).stdout);
    assert!(!again.contains("warning") && !again.contains("motor currents. "), "{again}");
}

/// A controller of Denso: commanded and present positions, and torques in percent.
#[test]
fn present_and_commanded_positions_of_a_controller() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    let row = |t: f64| {
        let cells = one_joint(t);
        let (q, torque) = cells.split_once(',').unwrap();
        let degrees = q.parse::<f64>().unwrap().to_degrees();
        format!("{:.5},{degrees:.5},{torque}", degrees + 0.3)
    };
    case.write("log.csv", &sines("time[s],CmdJ1[deg],CurJ1[deg],TrqJ1[%]", row));
    let output = case.tauscope(&["inspect", "log.csv", "--robot", "one.urdf"]);
    assert_done(&output);
    let said = text(&output.stdout);
    assert!(said.contains("-1.000 .. 1.000") && said.contains("columns not used: CmdJ1[deg]"), "{said}");
    assert!(said.contains("TrqJ1[%] and its like are percent of a rated torque"), "{said}");
}

/// The line that a refusal gives for an array works as it stands.
#[test]
fn an_array_without_names_is_split_as_the_refusal_says() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    let row = |t: f64| one_joint(t).replace(',', &format!(",{:.7},", 3.0 * (3.0 * t).cos()));
    case.write("log.csv", &sines("t,obs_0,obs_1,action_0", row));
    let refused = case.tauscope(&["inspect", "log.csv", "--robot", "one.urdf"]);
    assert_refusal(&refused, &["obs_0 to obs_1 are an array without names", "action torques"]);
    let said = text(&refused.stderr);
    let line = &said[said.find("columns = {").unwrap()..];
    let dataset =
        format!("schema = \"tauscope.dataset/1\"\nrobot = \"one.urdf\"\ntrain = [{{ file = \"log.csv\" }}]\n{line}\n");
    case.write("d.toml", &dataset);
    let output = case.tauscope(&["inspect", "--dataset", "d.toml"]);
    assert_done(&output);
    assert!(text(&output.stdout).contains("-1.000 .. 1.000"), "{}", text(&output.stdout));
}

#[test]
fn of_columns_of_one_name_the_used_one_and_the_other_choice_are_said() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    let inspected = |factor: f64| {
        let row = |t: f64| format!("{},{:.7}", one_joint(t), factor * (3.0 * t).sin());
        case.write("log.csv", &sines("t,q1,tau1,q1", row));
        text(&case.tauscope(&["inspect", "log.csv", "--robot", "one.urdf"]).stdout)
    };
    let same = inspected(1.0);
    assert!(
        same.contains("q1 stands twice in the header, with the same values") && !same.contains("warning"),
        "{same}"
    );
    let other = inspected(0.5);
    let warning = "warning: q1: it stands twice in the header, with other values: column 2 is used; a dataset takes column 4 instead";
    assert!(other.contains(warning) && other.contains("[columns] q = [4]"), "{other}");
    let dataset =
        "schema = \"tauscope.dataset/1\"\nrobot = \"one.urdf\"\n[[train]]\nfile = \"log.csv\"\n[columns]\nq = [4]\n";
    case.write("d.toml", dataset);
    let said = text(&case.tauscope(&["inspect", "--dataset", "d.toml"]).stdout);
    assert!(said.contains("-0.500 .. 0.500") && !said.contains("stands twice"), "{said}");
}

/// A logger at 500 Hz that stops for 30 ms after every few rows: 2 kg m2, 1.5 N m s/rad and 3 N m are found in what is left.
#[test]
fn a_log_full_of_short_gaps_is_identified() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    let mut log = "t,q1,tau1\n".to_owned();
    let mut t = 0.0_f64;
    for row in 0..6000 {
        t += if row % 11 == 10 { 0.030 } else { 0.002 };
        let (q, v, a) = (
            (1.3 * t).sin() + 0.3 * (3.1 * t).sin(),
            1.3 * (1.3 * t).cos() + 0.93 * (3.1 * t).cos(),
            -1.69 * (1.3 * t).sin() - 2.883 * (3.1 * t).sin(),
        );
        let torque = 2.0 * a + 1.5 * v + 3.0 * (v / 1e-3).tanh() + 0.02 * (977.0 * t).sin();
        writeln!(log, "{t:.6},{q:.9},{torque:.6}").unwrap();
    }
    case.write("log.csv", &log);
    let output = case.tauscope(&["identify", "--robot", "one.urdf", "--train", "log.csv", "--out", "out", "--json"]);
    assert_done(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let parameters = json["without_effects"]["parameters"].as_array().unwrap();
    let values: Vec<f64> = parameters.iter().map(|parameter| parameter["value"].as_f64().unwrap()).collect();
    for expected in [2.0, 1.5, 3.0] {
        assert!(values.iter().any(|value| (value / expected - 1.0).abs() < 0.03), "{expected}: {values:?}");
    }
}
