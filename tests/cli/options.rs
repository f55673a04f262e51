//! Options, output and exit codes.

use super::{Case, ROOT, assert_done, assert_refusal, names, text};
use std::process::Command;
use tauscope::diagnosis::Options;
use tauscope::identification::effect_model::Trust;

const FILES: &[&str] = &[
    "held_out.csv",
    "held_out.parquet",
    "identification.json",
    "manifest.json",
    "recording.csv",
    "recording.parquet",
    #[cfg(feature = "viewer")]
    "recording.rrd",
    "report.html",
    "robot.urdf",
    "scenario.toml",
    "score.json",
];

#[test]
fn json_is_one_object_with_its_schema() {
    let case = Case::new(&[]);
    for (command, schema) in [("run", "tauscope.score/1"), ("simulate", "tauscope.simulated/1")] {
        let output = case.tauscope(&[command, "s.toml", "--json"]);
        assert_done(&output);
        let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(value["schema"], schema);
        assert_eq!(value["scenario"], "short");
        assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
    }
    assert!(!case.path("results/short/score.json").exists(), "simulate replaces what run wrote there");
}

#[test]
fn an_option_for_logs_takes_several() {
    let case = Case::new(&[]);
    assert_done(&case.tauscope(&["simulate", "s.toml", "--out", "out", "--quiet"]));
    let of = |logs: &[&str]| {
        let output = case.tauscope(&[&["identify", "--robot", "arm.urdf", "--json", "--out", "of"], logs].concat());
        assert_done(&output);
        let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        value["without_effects"]["rows"].clone()
    };
    let [one, other] = ["out/recording.csv", "out/held_out.csv"];
    let together = of(&["--train", one, other]);
    assert_eq!(together, of(&["--train", one, "--train", other]));
    assert_ne!(together, of(&["--train", one, "--test", other]));
    // The second file is a log, and not an argument that nobody expects.
    for command in [
        &["diagnose", "--robot", "arm.urdf", "--train"][..],
        &["payload", one, other, "--robot", "arm.urdf", "--before"],
    ] {
        let output = case.tauscope(&[command, &[one, "out/none.csv"]].concat());
        assert!(
            text(&output.stderr).contains("none.csv") && output.status.code() == Some(2),
            "{}",
            text(&output.stderr)
        );
        assert!(!text(&output.stderr).contains("unexpected argument"), "{}", text(&output.stderr));
    }
}

#[test]
fn quiet_prints_nothing() {
    let case = Case::new(&[]);
    for arguments in
        [&["run", "s.toml", "--quiet"][..], &["simulate", "-q", "s.toml"], &["-q", "--json", "run", "s.toml"]]
    {
        let output = case.tauscope(arguments);
        assert_done(&output);
        assert!(output.stdout.is_empty() && output.stderr.is_empty(), "{arguments:?}");
    }
}

#[test]
fn the_table_has_a_line_per_joint_and_variant() {
    let case = Case::new(&[]);
    let output = case.tauscope(&["run", "s.toml"]);
    assert_done(&output);
    let printed = text(&output.stdout);
    for word in
        ["52 base parameters", "joint_1", "joint_6", "paper's ratio", "exact", "raw", "savitzky_golay", "Results in"]
    {
        assert!(printed.contains(word), "{printed}");
    }
    for word in ["S-G / Butterworth", "butterworth ", "window of 61 samples (0.122 s), order 6", "forward and backward"]
    {
        assert!(printed.contains(word), "{printed}");
    }
    assert!(!printed.contains("chosen by the noise"), "the scenario gives the window: {printed}");
    assert_eq!(names(&case.path("results/short")), FILES);
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_gives_others() {
    let case = Case::new(&[]);
    for (out, seed) in [("a", "5"), ("b", "5"), ("c", "6")] {
        assert_done(&case.tauscope(&["run", "s.toml", "--out", out, "--seed", seed]));
    }
    let bytes = |folder: &str, file: &str| std::fs::read(case.path(folder).join(file)).unwrap();
    for file in ["recording.csv", "recording.parquet", "held_out.csv", "held_out.parquet", "identification.json"] {
        assert_eq!(bytes("a", file), bytes("b", file), "{file}");
        assert_ne!(bytes("a", file), bytes("c", file), "{file}");
    }
    assert!(case.read("a/scenario.toml").contains("seed = 5"));
}

/// A scenario that leaves the window open has it chosen by the noise; the usual low-pass goes by the motion, which stays the same.
#[test]
fn more_noise_takes_a_longer_window_and_the_same_low_pass() {
    let scores = |noise: &str| {
        let case = Case::new(&[]);
        let text = case.read("s.toml").replace("smoothing_window = 61\n", "");
        case.write("s.toml", &text.replace("encoder_noise_rad = 1.5e-5", &format!("encoder_noise_rad = {noise}")));
        let output = case.tauscope(&["run", "s.toml", "--json"]);
        assert_done(&output);
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(json["window_chosen_by_noise"], true);
        assert!(json["butterworth_problem"].is_null() && json["variants"][1]["smoothing"].is_null());
        json
    };
    let (little, much) = (scores("1.5e-5"), scores("3e-4"));
    let case = Case::new(&[("smoothing_window = 61\n", "")]);
    let printed = text(&case.tauscope(&["run", "s.toml"]).stdout);
    assert!(printed.contains("(window chosen by the noise of the positions)"), "{printed}");
    let smoothing = |json: &serde_json::Value, variant: usize, name: &str| {
        assert_eq!(json["variants"][variant]["signals"], name);
        assert_eq!(json["variants"][variant]["smoothing"]["kind"], name);
        json["variants"][variant]["smoothing"].clone()
    };
    let window = |json| smoothing(json, 2, "savitzky_golay")["window"].as_u64().unwrap();
    assert!(
        (31..=81).contains(&window(&little)) && window(&much) > window(&little) + 20,
        "{} {}",
        window(&little),
        window(&much)
    );
    let cutoff = |json, which: &str| smoothing(json, 3, "butterworth")[which].as_f64().unwrap();
    for json in [&little, &much] {
        assert!((cutoff(json, "position_cutoff_hz") / cutoff(json, "torque_cutoff_hz") - 4.0).abs() < 1e-9);
        for gain in ["over_butterworth_training", "over_butterworth_held_out"] {
            assert_eq!(json["smoothing_gain"][gain].as_array().unwrap().len(), 6);
        }
    }
    let change = cutoff(&much, "torque_cutoff_hz") / cutoff(&little, "torque_cutoff_hz");
    assert!((0.8..1.25).contains(&change), "{change}");
}

/// The merged scenario stands on its own: run from its folder it gives the recording again.
#[test]
fn the_merged_scenario_can_be_run_again() {
    let case = Case::new(&[]);
    assert_done(&case.tauscope(&["simulate", "s.toml", "--seed", "18446744073709551615", "--out", "deep/out"]));
    let merged = case.read("deep/out/scenario.toml");
    for word in ["# The scenario as it was run", "rapier3d 0.36", "seed = 18446744073709551615", "\"robot.urdf\""] {
        assert!(merged.contains(word), "{merged}");
    }
    std::fs::remove_file(case.path("arm.urdf")).unwrap();
    assert_done(&case.tauscope(&["simulate", "deep/out/scenario.toml", "--out", "again"]));
    assert_eq!(case.read("deep/out/recording.csv"), case.read("again/recording.csv"));
}

/// Without a command it runs `scenarios/irb1600.toml`.
#[test]
fn the_default_command_is_the_main_job() {
    let case = Case::new(&[]);
    std::fs::create_dir(case.path("scenarios")).unwrap();
    std::fs::rename(case.path("s.toml"), case.path("scenarios/irb1600.toml")).unwrap();
    std::fs::rename(case.path("arm.urdf"), case.path("scenarios/arm.urdf")).unwrap();
    assert_done(&case.tauscope(&["--quiet", "--out", "default"]));
    assert_done(&case.tauscope(&["run", "scenarios/irb1600.toml", "--quiet", "--out", "named"]));
    assert_eq!(names(&case.path("default")), FILES);
    assert_eq!(case.read("default/recording.csv"), case.read("named/recording.csv"));
}

#[test]
fn the_shipped_scenario_is_the_default() {
    let output = Command::new(env!("CARGO_BIN_EXE_tauscope")).arg("--help").current_dir(ROOT).output().unwrap();
    assert!(text(&output.stdout).contains("tauscope run scenarios/irb1600.toml"));
    tauscope::scenario::Setup::load(format!("{ROOT}/scenarios/irb1600.toml"), None).unwrap();
}

#[test]
fn help_explains_and_wrong_usage_is_refused() {
    let case = Case::new(&[]);
    let help = case.tauscope(&["--help"]);
    assert_done(&help);
    for word in ["run", "simulate", "--json", "--seed", "--out", "--quiet", "Exit codes", "scenarios/irb1600.toml"] {
        assert!(text(&help.stdout).contains(word), "{word}");
    }
    for wrong in [
        &["bogus"][..],
        &["run", "--bogus"],
        &["run", "a", "b"],
        &["run", "--seed", "x"],
        &["run", "--seed", "-1"],
        &["run", "--seed", "1e3"],
        &["run", "--seed", "18446744073709551616"],
    ] {
        let output = case.tauscope(wrong);
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
        assert!(!output.stderr.is_empty());
    }
}

/// A reader that has had enough (`tauscope | head`) is no error; one that cannot be written to is.
#[cfg(unix)]
#[test]
fn output_that_nobody_reads() {
    let case = Case::new(&[]);
    for flag in ["", "--json"] {
        let output = case.bash(&format!("\"$TAUSCOPE\" run s.toml {flag} | true; exit ${{PIPESTATUS[0]}}"));
        assert_done(&output);
        assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
    }
    if std::path::Path::new("/dev/full").exists() {
        assert_refusal(&case.bash("exec \"$TAUSCOPE\" run s.toml > /dev/full"), &["standard output", "space"]);
        let output = case.bash("exec \"$TAUSCOPE\" run none.toml 2> /dev/full");
        assert_eq!(output.status.code(), Some(2));
    }
}

/// The text between two others.
fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    let (_, after) = text.split_once(from).unwrap_or_else(|| panic!("{from} is not in {text}"));
    after.split_once(to).unwrap_or_else(|| panic!("no {to} after {from}")).0
}

/// The library, the command and Python ask the same question where nothing is said.
#[test]
fn defaults_of_a_diagnosis_agree() {
    let Options { trust, alpha, max_findings, seed, candidates, criteria } = Options::default();
    let share = criteria.share_of_torque * 100.0;
    let trust = match trust {
        Trust::Nominal => "nominal",
        Trust::Structure => "structure",
    };
    let defaults = [
        ("trust", trust.to_owned()),
        ("alpha", alpha.to_string()),
        ("max_findings", max_findings.to_string()),
        ("least_share", share.to_string()),
    ];
    let help = std::fs::read_to_string(format!("{ROOT}/tests/cli/snapshots/help_diagnose.snap")).unwrap();
    let python = std::fs::read_to_string(format!("{ROOT}/python/tauscope/_commands.py")).unwrap();
    let signature = between(&python, "\ndef diagnose(", "\n) -> ");
    for (name, default) in defaults {
        let by_command =
            between(between(&help, &format!("--{} ", name.replace('_', "-")), "\n      --"), "[default: ", "]");
        assert_eq!(by_command, default, "--{name}");
        let argument = between(signature, &format!("\n    {name}: "), ",\n");
        let by_python = between(&format!("{argument}\n"), " = ", "\n").trim_matches('"').to_owned();
        let same = by_python == default || by_python.parse::<f64>().is_ok_and(|number| Ok(number) == default.parse());
        assert!(same, "{name} of Python: {by_python}, not {default}");
    }
    // All of the library, and the seed that the help names.
    assert!(candidates.is_empty() && signature.contains("\n    candidates: Sequence[str] | None = None,"));
    assert!(seed == 0 && help.contains("diagnose: 0)") && signature.contains("\n    seed: int | None = None,"));
}
