//! `diagnose` from outside: what it writes, how faults of the data stop it, and how it refuses what tells nothing.

use super::{Case, assert_done, assert_refusal, text};
use serde_json::Value;
use std::process::Output;
use std::sync::LazyLock;

/// Two logs of the same arm, `out/recording.csv` and `out/held_out.csv`, with Stribeck friction on joint 2.
static LOGS: LazyLock<Case> = LazyLock::new(|| {
    let longer = "moves = 8\nduration_s = 14.0";
    let case = Case::new(&[("moves = 6\nduration_s = 4.0", longer), ("moves = 3\nduration_s = 4.0", longer)]);
    let effect = "\n[[effect]]\nname = \"stribeck_friction\"\njoint = \"joint_2\"\n";
    case.write("s.toml", &(case.read("s.toml") + effect));
    assert_done(&case.tauscope(&["simulate", "s.toml", "--out", "out", "--quiet"]));
    case
});

fn diagnose(train: &str, more: &[&str]) -> Output {
    let out = format!("of_{}", train.replace('/', "_"));
    let first = ["diagnose", "--robot", "arm.urdf", "--train", train, "--out", &out, "--json"];
    LOGS.tauscope(&[&first, more].concat())
}

fn json(output: &Output) -> Value {
    assert_done(output);
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The training log with every row changed, as a file of this name. Columns are given by name.
fn changed(name: &str, rows: impl Iterator<Item = usize>, change: impl Fn(&str, &str) -> String) {
    let log = LOGS.read("out/recording.csv");
    let lines: Vec<&str> = log.lines().filter(|line| !line.starts_with('#')).collect();
    let header: Vec<&str> = lines[0].split(',').collect();
    let mut text = lines[0].to_owned();
    for row in rows.take_while(|row| row + 1 < lines.len()) {
        let cells = lines[row + 1].split(',').zip(&header).map(|(cell, column)| change(column, cell));
        text += "\n";
        text += &cells.collect::<Vec<String>>().join(",");
    }
    LOGS.write(name, &text);
}

const TEST: [&str; 2] = ["--test", "out/held_out.csv"];

#[test]
fn a_diagnosis_is_written_whole() {
    let output = diagnose("out/recording.csv", &[&TEST[..], &["--candidates", "stribeck_friction"]].concat());
    let told = json(&output);
    assert_eq!(told["schema"], "tauscope.diagnosis/1");
    assert_eq!(told["verdict"], "named");
    let finding = &told["findings"][0];
    assert_eq!(
        (finding["effect"].as_str(), finding["joints"][0].as_str()),
        (Some("stribeck_friction"), Some("joint_2"))
    );
    assert_eq!(told["data_quality"].as_array().map(Vec::len), Some(0), "{}", told["data_quality"]);
    let extended = &told["extended"];
    assert!(extended["gap_closed"].as_f64().unwrap() > 0.9, "{extended}");
    assert_eq!(extended["model"], "extended.toml");
    for key in ["test_rms_nm", "resimulated_test_rms_nm"] {
        assert_eq!(extended[key].as_array().map(Vec::len), Some(6), "{extended}");
    }
    assert_eq!(told["simulation"]["structure"].as_array().map(Vec::len), Some(6));
    assert_eq!(serde_json::from_str::<Value>(&LOGS.read("of_out_recording.csv/diagnosis.json")).unwrap(), told);

    // The extended model runs, and with it in the simulation nothing is left to find.
    let scenario = "of_out_recording.csv/extended.toml";
    assert_done(&LOGS.tauscope(&["simulate", scenario, "--out", "again", "--quiet"]));
    let arguments = ["diagnose", "--scenario", scenario, "--train", "out/recording.csv", "--json", "--out", "second"];
    let more = ["--candidates", "stribeck_friction", "--no-resimulation"];
    let second = json(&LOGS.tauscope(&[&arguments[..], &TEST, &more].concat()));
    assert_eq!(second["findings"].as_array().map(Vec::len), Some(0), "{second}");
    assert_ne!(second["verdict"], "named");
}

#[test]
fn wrong_columns_stop_it() {
    changed("flipped.csv", 0.., |column, cell| {
        if column == "tau3" { (-cell.parse::<f64>().unwrap()).to_string() } else { cell.to_owned() }
    });
    changed("degrees.csv", 0.., |column, cell| {
        let is_position = column.starts_with('q') && column.len() == 2;
        if is_position { cell.parse::<f64>().unwrap().to_degrees().to_string() } else { cell.to_owned() }
    });
    changed("still.csv", 0.., |column, cell| if column == "q4" { "0.25".to_owned() } else { cell.to_owned() });
    for (log, kind, place) in [
        ("flipped.csv", "torque_sign", "tau3"),
        ("degrees.csv", "position_unit", "q2"),
        ("still.csv", "hardly_moves", "q4"),
    ] {
        let told = json(&diagnose(log, &TEST));
        assert_eq!(told["verdict"], "not_testable", "{log}");
        assert_eq!(told["findings"].as_array().map(Vec::len), Some(0));
        let faults = told["data_quality"].as_array().unwrap();
        let named = |fault: &&Value| fault["kind"] == kind && fault["where"].as_str().unwrap().starts_with(place);
        let fault = faults.iter().find(named).unwrap_or_else(|| panic!("{log}: {told}"));
        assert_eq!((fault["consequence"].as_str(), fault["log"].as_str()), (Some("stops"), Some(log)));
        assert!(LOGS.path(&format!("of_{log}/diagnosis.json")).exists());
    }
}

#[test]
fn what_can_be_left_out_is() {
    // Every hundredth row twice.
    let twice = (0..7000).flat_map(|row| if row % 100 == 0 { vec![row, row] } else { vec![row] });
    changed("twice.csv", twice, |_, cell| cell.to_owned());
    changed("gap.csv", (0..2500).chain(2800..7000), |_, cell| cell.to_owned());
    let more = [&TEST[..], &["--candidates", "stribeck_friction", "--no-resimulation"]].concat();
    for (log, kind) in [("twice.csv", "duplicate_time"), ("gap.csv", "gap")] {
        let told = json(&diagnose(log, &more));
        assert_eq!(told["verdict"], "named", "{log}");
        let faults = told["data_quality"].as_array().unwrap();
        let found = faults.iter().any(|fault| fault["kind"] == kind && fault["consequence"] == "left_out");
        assert!(found, "{log}: {faults:?}");
    }
}

#[test]
fn what_tells_nothing_is_refused() {
    let all = 0..;
    changed(
        "no_motion.csv",
        all.clone(),
        |column, cell| {
            if column.starts_with('q') { "0.5".to_owned() } else { cell.to_owned() }
        },
    );
    changed("ten.csv", 0..10, |_, cell| cell.to_owned());
    changed("short.csv", 2000..2300, |_, cell| cell.to_owned());
    changed("nan.csv", all, |column, cell| if column == "tau1" { "nan".to_owned() } else { cell.to_owned() });
    LOGS.write("empty.csv", "");
    LOGS.write("other.csv", "t,q1,tau1\n0.0,0.1,2.0\n0.1,0.2,2.5\n");
    for (log, words) in [
        ("no_motion.csv", vec!["no_motion.csv", "no joint moves"]),
        ("ten.csv", vec!["ten.csv", "10 samples"]),
        ("short.csv", vec!["--train", "0.6 s"]),
        ("nan.csv", vec!["nan.csv", "tau1"]),
        ("empty.csv", vec!["empty.csv", "empty"]),
        ("other.csv", vec!["other.csv", "6 joints"]),
        ("none.csv", vec!["none.csv"]),
    ] {
        assert_refusal(&diagnose(log, &TEST), &words);
        assert!(!LOGS.path(&format!("of_{log}")).exists(), "{log} must leave nothing behind");
    }
}

#[test]
fn bad_options_are_refused() {
    let train = "out/recording.csv";
    for (more, words) in [
        (vec!["--test", train], vec!["--test", "same log"]),
        (vec!["--reference", train], vec!["--reference", "same log"]),
        (vec!["--candidates", "stribek_friction"], vec!["stribek_friction", "did you mean `stribeck_friction`"]),
        (vec!["--alpha", "0"], vec!["--alpha"]),
        (vec!["--alpha", "1"], vec!["--alpha"]),
        (vec!["--alpha", "nan"], vec!["--alpha"]),
        (vec!["--scenario", "none.toml"], vec!["none.toml"]),
    ] {
        let out = ["diagnose", "--robot", "arm.urdf", "--train", train, "--out", "refused"];
        assert_refusal(&LOGS.tauscope(&[&out[..], &more].concat()), &words);
    }
    let output = LOGS.tauscope(&["diagnose", "--train", train]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("--robot"), "{output:?}");
}
