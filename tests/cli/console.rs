//! What the command prints, as a whole: snapshots of tables, verdicts, help and errors. `INSTA_UPDATE=always cargo test --test cli console`
//! writes them anew; read the difference before it is committed.

use super::diagnose::{LOGS, changed};
use super::{Case, assert_done, assert_stopped, text};
use std::process::{Command, Output};

/// What a command printed, without what depends on the machine: paths, times, numbers that are rounding, and the widths of columns that
/// these change.
fn assert_snapshot(name: &str, case: &Case, printed: &str) {
    let mut settings = settings();
    let folder = case.folder.path().canonicalize().unwrap();
    settings.add_filter(&regex_of(&folder.to_string_lossy()), "[folder]");
    settings.add_filter(&regex_of(&case.folder.path().to_string_lossy()), "[folder]");
    settings.add_filter(r"\d+(\.\d+)? ms\b", "[time] ms");
    settings.add_filter(r"\b\d(\.\d+)?e-1\d\b", "[rounding]");
    settings.add_filter(r"(\S) {2,}", "$1  ");
    settings.add_filter(r"(?m)^ +", " ");
    settings.bind(|| insta::assert_snapshot!(name, printed.trim_end()));
}

fn settings() -> insta::Settings {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings
}

/// A regular expression of a text as it is.
fn regex_of(text: &str) -> String {
    let escaped = |c: char| if c.is_alphanumeric() || c == '/' { c.to_string() } else { format!("\\{c}") };
    text.chars().map(escaped).collect()
}

fn printed(output: &Output) -> String {
    assert_done(output);
    text(&output.stdout)
}

#[test]
fn a_run() {
    let case = Case::new(&[]);
    assert_snapshot("run", &case, &printed(&case.tauscope(&["run", "s.toml"])));
}

#[test]
fn a_simulation() {
    let case = Case::new(&[]);
    assert_snapshot("simulate", &case, &printed(&case.tauscope(&["simulate", "s.toml"])));
}

#[test]
fn logs_as_they_are_and_with_faults() {
    let plain = LOGS.tauscope(&["inspect", "out/recording.csv", "--robot", "arm.urdf"]);
    assert_snapshot("inspect", &LOGS, &printed(&plain));
    changed("console.csv", (0..2500).chain(2800..7000), |column, cell| match column {
        "tau3" => (-cell.parse::<f64>().unwrap()).to_string(),
        _ => cell.to_owned(),
    });
    let wrong = LOGS.tauscope(&["inspect", "console.csv", "--robot", "arm.urdf", "--out", "console_inspected"]);
    assert_snapshot("inspect_faults", &LOGS, &(text(&wrong.stdout) + &text(&wrong.stderr)));
}

#[test]
fn an_identification() {
    let logs = ["--train", "out/recording.csv", "--test", "out/held_out.csv", "--effect", "stribeck_friction:joint_2"];
    let first = ["identify", "--robot", "arm.urdf", "--out", "console_identified"];
    assert_snapshot("identify", &LOGS, &printed(&LOGS.tauscope(&[&first[..], &logs].concat())));
}

#[test]
fn diagnoses() {
    let output = |train: &str, out: &str, candidates: &str| {
        let logs = ["--train", train, "--test", "out/held_out.csv", "--candidates", candidates, "--out", out];
        LOGS.tauscope(&[&["diagnose", "--robot", "arm.urdf"][..], &logs].concat())
    };
    let diagnose = |train: &str, out: &str, candidates: &str| printed(&output(train, out, candidates));
    let named = diagnose("out/recording.csv", "console_named", "stribeck_friction,torque_offset");
    assert_snapshot("diagnose_named", &LOGS, &named);
    let unexplained = diagnose("out/recording.csv", "console_unexplained", "torque_offset");
    assert_snapshot("diagnose_unexplained", &LOGS, &unexplained);
    changed("console_sign.csv", 0.., |column, cell| match column {
        "tau3" => (-cell.parse::<f64>().unwrap()).to_string(),
        _ => cell.to_owned(),
    });
    let stopped = output("console_sign.csv", "console_stopped", "torque_offset");
    assert_stopped(&stopped);
    assert_snapshot("diagnose_stopped", &LOGS, &text(&stopped.stdout));
}

#[test]
fn the_catalogue_of_effects() {
    let case = Case::new(&[]);
    assert_snapshot("effects", &case, &printed(&case.tauscope(&["effects"])));
    assert_snapshot("effects_one", &case, &printed(&case.tauscope(&["effects", "stribeck_friction"])));
}

#[test]
fn a_robot() {
    let case = Case::new(&[]);
    assert_snapshot("robot", &case, &printed(&case.tauscope(&["robot", "arm.urdf"])));
}

#[test]
fn a_study_and_a_check() {
    let case = Case::new(&[]);
    let study = ["montecarlo", "s.toml", "--trials", "2", "--sg-windows", "0,61", "--butterworth", "--out", "study"];
    // The last column is time.
    let table = printed(&case.tauscope(&study)).replace(" ms\n", "\n");
    let lines = table.lines().map(|line| match line.rsplit_once(' ') {
        Some((start, last)) if last.parse::<f64>().is_ok() && line.contains('%') => format!("{start} [time]"),
        _ => line.to_owned(),
    });
    assert_snapshot("montecarlo", &case, &lines.collect::<Vec<_>>().join("\n"));
    let check = ["check", "s.toml", "--baseline", "b.json"];
    let made = case.tauscope(&[&check[..], &["--update", "--trials", "2"]].concat());
    assert_snapshot("check_update", &case, &printed(&made));
    assert_snapshot("check", &case, &printed(&case.tauscope(&check)));
}

#[test]
fn errors() {
    let case = Case::new(&[]);
    case.write("empty.csv", "");
    case.write("other.csv", "t,q1,tau1\n0.0,0.1,2.0\n0.1,0.2,2.5\n");
    case.write("key.toml", &case.read("s.toml").replace("seed = ", "sed = "));
    let diagnose = ["diagnose", "--robot", "arm.urdf", "--train"];
    let tried: [Vec<&str>; 10] = [
        vec!["run", "none.toml"],
        vec!["run", "key.toml"],
        vec!["diagnose"],
        vec!["diagnose", "--train", "other.csv"],
        [&diagnose[..], &["none.csv"]].concat(),
        [&diagnose[..], &["empty.csv"]].concat(),
        [&diagnose[..], &["other.csv"]].concat(),
        [&diagnose[..], &["other.csv", "--candidates", "stribek_friction"]].concat(),
        vec!["identify", "--train", "other.csv"],
        vec!["view", "none"],
    ];
    let said = tried.map(|arguments| {
        let output = case.tauscope(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        format!("$ tauscope {}\n{}", arguments.join(" "), text(&output.stderr))
    });
    assert_snapshot("errors", &case, &said.join("\n"));
}

#[test]
fn help_of_every_command() {
    let commands = [
        "",
        "run",
        "identify",
        "inspect",
        "paper",
        "simulate",
        "excite",
        "diagnose",
        "payload",
        "blind",
        "montecarlo",
        "montecarlo merge",
        "check",
        "robot",
        "view",
        "effects",
    ];
    for command in commands {
        let mut tauscope = Command::new(env!("CARGO_BIN_EXE_tauscope"));
        tauscope.args(command.split_whitespace()).arg("--help").env_remove("COLUMNS");
        let help = printed(&tauscope.output().unwrap());
        assert!(help.contains("Example:\n  tauscope "), "{command} has no example");
        let name = if command.is_empty() { "help".to_owned() } else { format!("help_{}", command.replace(' ', "_")) };
        settings().bind(|| insta::assert_snapshot!(name, help));
    }
}
