//! `diagnose` from outside: what it writes, how faults of the data stop it, and how it refuses what tells nothing.

use super::{Case, assert_done, assert_refusal, assert_stopped, schema, text};
use serde_json::Value;
use std::process::Output;
use std::sync::LazyLock;

/// Two logs of the same arm, `out/recording.csv` and `out/held_out.csv`, with Stribeck friction on joint 2.
pub(crate) static LOGS: LazyLock<Case> = LazyLock::new(|| {
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

/// What a diagnosis printed, which must follow the schema.
fn json(output: &Output) -> Value {
    assert_done(output);
    valid(output)
}

fn valid(output: &Output) -> Value {
    let told = serde_json::from_slice(&output.stdout).unwrap();
    schema::assert_valid(&told);
    told
}

/// The training log with every row changed, as a file of this name. Columns are given by name.
pub(crate) fn changed(name: &str, rows: impl Iterator<Item = usize>, change: impl Fn(&str, &str) -> String) {
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
fn a_search_that_is_ended_says_what_is_known_by_then() {
    let out = ["--out", "of_budget"];
    let base = ["diagnose", "--robot", "arm.urdf", "--train", "out/recording.csv", "--json", "--no-resimulation"];
    let told = json(&LOGS.tauscope(&[&base[..], &TEST, &out, &["--budget", "1ms"]].concat()[..]));
    assert_eq!((&told["unfinished"], &told["verdict"]), (&Value::Bool(true), &Value::from("unexplained")));
    assert!(told["findings"].as_array().unwrap().is_empty());
    // The map is there, and what it shows is no noise.
    let left = &told["unexplained"][0];
    assert_eq!(
        (&left["joint"], &left["structure"]),
        (&Value::from("joint_2"), &Value::from("follows the joint's speed"))
    );
    let lines = text(
        &LOGS
            .tauscope(
                &[&base[..4], &["out/recording.csv", "--no-resimulation"], &TEST, &out, &["--budget", "1ms"]].concat(),
            )
            .stdout,
    );
    assert!(lines.contains("no effect found so far explains") && lines.contains("the search ended early"), "{lines}");
    let bad = LOGS.tauscope(&[&base[..], &TEST, &out, &["--budget", "5 parsecs"]].concat()[..]);
    assert_eq!(bad.status.code(), Some(2));
    assert!(text(&bad.stderr).contains("give a time above zero"), "{}", text(&bad.stderr));
}

#[test]
fn a_diagnosis_is_written_whole() {
    let more = ["--candidates", "stribeck_friction,backlash", "--gravity", "0,0,-9.81"];
    let output = diagnose("out/recording.csv", &[&TEST[..], &more].concat());
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
        ("degrees.csv", "position_unit", "q"),
        ("still.csv", "hardly_moves", "q4"),
    ] {
        let output = diagnose(log, &TEST);
        assert_stopped(&output);
        let told = valid(&output);
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
    changed("nan.csv", all, |column, cell| if column.starts_with("tau") { "nan".to_owned() } else { cell.to_owned() });
    LOGS.write("empty.csv", "");
    LOGS.write("other.csv", "t,q1,tau1\n0.0,0.1,2.0\n0.1,0.2,2.5\n");
    for (log, words) in [
        ("no_motion.csv", vec!["no_motion.csv", "no joint moves"]),
        ("nan.csv", vec!["nan.csv", "tau"]),
        ("ten.csv", vec!["ten.csv", "10 samples"]),
        ("short.csv", vec!["--train", "0.6 s"]),
        ("empty.csv", vec!["empty.csv", "empty"]),
        ("other.csv", vec!["other.csv", "6 joints"]),
        ("none.csv", vec!["none.csv"]),
    ] {
        assert_refusal(&diagnose(log, &TEST), &words);
        assert!(!LOGS.path(&format!("of_{log}")).exists(), "{log} must leave nothing behind");
    }
}

#[test]
fn a_joint_that_creeps_in_the_held_out_log_is_left_out() {
    changed("creeps.csv", 0.., |column, cell| match column {
        "q4" | "qd4" => (1e-4 * cell.parse::<f64>().unwrap()).to_string(),
        _ => cell.to_owned(),
    });
    let told = json(&diagnose("out/recording.csv", &["--test", "creeps.csv"]));
    let notes = told["data_quality"].as_array().unwrap();
    let left_out = notes.iter().find(|note| note["where"] == "tau4 (joint_4)").unwrap_or_else(|| panic!("{notes:?}"));
    let text = left_out["text"].as_str().unwrap();
    assert!(text.contains("hardly in the held-out ones") && text.contains("give a held-out log in which"), "{text}");
}

#[test]
fn bad_options_are_refused() {
    let train = "out/recording.csv";
    // A part of the same log, by another clock.
    changed("later.csv", 1000..6000, |column, cell| match column {
        "t" => (100.0 + cell.parse::<f64>().unwrap()).to_string(),
        _ => cell.to_owned(),
    });
    for (more, words) in [
        (vec!["--test", train], vec!["--test", "samples of --train"]),
        (vec!["--train", train], vec!["--train", "give every log once"]),
        (vec!["--train", "later.csv"], vec!["later.csv", "samples of --train"]),
        (vec!["--reference", train], vec!["--reference", "samples of --train"]),
        (vec!["--candidates", "stribek_friction"], vec!["stribek_friction", "did you mean `stribeck_friction`"]),
        (vec!["--alpha", "0"], vec!["--alpha"]),
        (vec!["--alpha", "1"], vec!["--alpha"]),
        (vec!["--alpha", "nan"], vec!["--alpha"]),
        (vec!["--scenario", "none.toml"], vec!["none.toml"]),
    ] {
        let out = ["diagnose", "--robot", "arm.urdf", "--train", train, "--out", "refused"];
        assert_refusal(&LOGS.tauscope(&[&out[..], &more].concat()), &words);
    }
    for (more, words) in [
        (vec![], "--robot"),
        (vec!["--gravity", "0,0"], "three numbers"),
        (vec!["--gravity", "0,nan,0"], "`nan`"),
        (vec!["--gravity", "0,0,1e300"], "`1e300`"),
        (vec!["--max-findings", "0"], "--max-findings"),
    ] {
        let output = LOGS.tauscope(&[&["diagnose", "--train", train][..], &more].concat());
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains(words), "{output:?}");
    }
}

#[test]
fn a_dataset_is_diagnosed() {
    // The same logs as a controller would give them: degrees, and motor currents over gears, one of them the other way round.
    const GEAR: f64 = 80.0;
    const CONSTANT: f64 = 0.2;
    for (from, to) in [("out/recording.csv", "amps.csv"), ("out/held_out.csv", "amps_held_out.csv")] {
        let log = LOGS.read(from);
        let mut lines = log.lines().filter(|line| !line.starts_with('#'));
        let header: Vec<&str> = lines.next().unwrap().split(',').collect();
        let wanted = |letters: &str| (1..7).map(|joint| format!("{letters}{joint}")).collect::<Vec<String>>();
        let names = [vec!["t".to_owned()], wanted("q"), wanted("tau")].concat();
        let places: Vec<usize> = names.iter().map(|name| header.iter().position(|h| h == name).unwrap()).collect();
        let mut text = format!("t,{},{}", wanted("enc").join(","), wanted("amps").join(","));
        for line in lines {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
            let row = places.iter().zip(&names).map(|(&place, name)| {
                let sign = if name.ends_with('2') { -1.0 } else { 1.0 };
                match name.chars().next() {
                    Some('q') => sign * GEAR * cells[place].to_degrees(),
                    Some('t') if name.len() > 1 => sign * cells[place] / (GEAR * CONSTANT),
                    _ => cells[place],
                }
            });
            text += "\n";
            text += &row.map(|value| value.to_string()).collect::<Vec<String>>().join(",");
        }
        LOGS.write(to, &text);
    }
    let columns = |letters: &str| (1..7).map(|joint| format!("\"{letters}{joint}\"")).collect::<Vec<_>>().join(", ");
    let described = format!(
        "[columns]\nq = [{}]\ntau = [{}]\n[units]\nposition = \"deg\"\ntorque = \"A\"\n[motors]\ngear_ratio = {GEAR}\n\
         torque_constant_nm_a = {CONSTANT}\nsign = [1, -1, 1, 1, 1, 1]\nposition_at = \"motor\"\n",
        columns("enc"),
        columns("amps")
    );
    let head = "schema = \"tauscope.dataset/1\"\nrobot = \"arm.urdf\"\n[[train]]\nfile = \"amps.csv\"\n";
    let with = |name: &str, test: &str| {
        LOGS.write(name, &format!("{head}{test}{described}"));
        let more = ["--candidates", "stribeck_friction", "--no-resimulation", "--json"];
        LOGS.tauscope(&[&["diagnose", "--dataset", name, "--out", &format!("of_{name}")][..], &more].concat())
    };
    let told = json(&with("d.toml", "[[test]]\nfile = \"amps_held_out.csv\"\n"));
    assert_eq!(told["verdict"], "named", "{told}");
    let finding = &told["findings"][0];
    assert_eq!(
        (finding["effect"].as_str(), finding["joints"][0].as_str()),
        (Some("stribeck_friction"), Some("joint_2"))
    );
    // A short part judges, a moment does not, nor does what was found from.
    let part = "to_s = 10.5\n[[test]]\nfile = \"amps.csv\"\nfrom_s = ";
    assert_eq!(json(&with("part.toml", &format!("{part}10.5\n")))["schema"], "tauscope.diagnosis/1");
    assert_refusal(&with("moment.toml", &format!("{part}13.5\n")), &["moment.toml: test", "2 s at the least"]);
    assert_refusal(&with("same.toml", "[[test]]\nfile = \"amps.csv\"\n"), &["same.toml:5: test", "trained from"]);
}
