//! Studies and accuracy checks from outside: a kill keeps finished trials, a worse identification fails.

use super::{Case, ROOT};
use std::process::{Command, Stdio};

/// A small study on its own.
fn case() -> Case {
    let case = Case::new(&[]);
    let text = std::fs::read_to_string(format!("{ROOT}/tests/scenarios/montecarlo.toml")).unwrap();
    case.write("s.toml", &text.replace("../../urdf/irb1600_6_120.urdf", "arm.urdf"));
    case
}

fn code(output: &std::process::Output) -> i32 {
    output.status.code().unwrap()
}

#[test]
fn a_killed_study_keeps_its_finished_trials_and_resumes() {
    let case = case();
    let arguments = ["montecarlo", "s.toml", "--trials", "64", "--quiet", "--out"];
    let whole = case.tauscope(&[&arguments[..], &["whole"]].concat());
    assert_eq!(code(&whole), 0, "{whole:?}");

    let mut worker = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .args(arguments)
        .arg("killed")
        .env("RAYON_NUM_THREADS", "1")
        .current_dir(case.folder.path())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let finished = || {
        let files = std::fs::read_dir(case.path("killed/unfinished")).into_iter().flatten().flatten();
        files.filter(|file| file.file_name().to_string_lossy().starts_with("trials_")).count()
    };
    while finished() < 3 && worker.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    worker.kill().unwrap();
    worker.wait().unwrap();
    assert!((3..64).contains(&finished()), "{} of 64", finished());

    let refused = case.tauscope(&[&arguments[..], &["killed"]].concat());
    assert_eq!(code(&refused), 2);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--resume"), "{refused:?}");
    let other = case.tauscope(&["montecarlo", "s.toml", "--trials", "63", "--quiet", "--resume", "--out", "killed"]);
    assert!(String::from_utf8_lossy(&other.stderr).contains("another study"), "{other:?}");
    let resumed = case.tauscope(&[&arguments[..], &["killed", "--resume"]].concat());
    assert_eq!(code(&resumed), 0, "{resumed:?}");
    for name in ["trials.parquet", "summary.json", "study.json", "scenario.toml", "robot.urdf"] {
        assert!(case.read_bytes(&format!("whole/{name}")) == case.read_bytes(&format!("killed/{name}")), "{name}");
    }
}

#[test]
fn one_trial_and_the_summary_as_json() {
    let case = case();
    let study = ["montecarlo", "s.toml", "--trials", "3", "--json"];
    let summary = case.tauscope(&[&study[..], &["--out", "out", "--noise-levels", "1e-5:0.5,1e-4"]].concat());
    let summary: serde_json::Value = serde_json::from_slice(&summary.stdout).unwrap();
    assert_eq!(summary["schema"], "tauscope.montecarlo/1");
    assert_eq!(summary["cells"][0]["torque_nm"], 0.5);
    assert_eq!(summary["cells"][1]["encoder_rad"], 1e-4);
    assert_eq!(summary["parameters"].as_array().unwrap().len(), 52);
    let trial = case.tauscope(&[&study[..], &["--trial", "2"]].concat());
    let trial: serde_json::Value = serde_json::from_slice(&trial.stdout).unwrap();
    assert_eq!(trial["schema"], "tauscope.montecarlo.trial/1");
    assert!(trial["rows"][0]["found"]["d_beta"].as_f64().unwrap() > 0.0);
    let beyond = case.tauscope(&[&study[..], &["--trial", "3"]].concat());
    assert!(String::from_utf8_lossy(&beyond.stderr).contains("trials 0 to 2"), "{beyond:?}");
}

#[test]
fn a_part_of_an_array_job_is_found_in_the_environment() {
    let case = case();
    let output = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .args(["montecarlo", "s.toml", "--trials", "4", "--quiet", "--out", "out"])
        .env("SLURM_ARRAY_TASK_ID", "2")
        .env("SLURM_ARRAY_TASK_MIN", "1")
        .env("SLURM_ARRAY_TASK_COUNT", "4")
        .current_dir(case.folder.path())
        .output()
        .unwrap();
    assert_eq!(code(&output), 0, "{output:?}");
    assert!(case.path("out/shard_0001_of_0004/trials.parquet").exists());
}

#[test]
fn a_worse_identification_fails_the_check() {
    let case = case();
    let check = ["check", "s.toml", "--baseline", "base/line.json"];
    let missing = case.tauscope(&check);
    assert_eq!(code(&missing), 2);
    assert!(String::from_utf8_lossy(&missing.stderr).contains("--update"), "{missing:?}");
    let made = case.tauscope(&[&check[..], &["--update", "--trials", "6"]].concat());
    assert_eq!(code(&made), 0, "{made:?}");
    let same = case.tauscope(&check);
    assert_eq!(code(&same), 0, "{same:?}");

    // Other draws are no worse than chance.
    let drawn = case.tauscope(&[&check[..], &["--seed", "11"]].concat());
    assert_eq!(code(&drawn), 0, "{}", String::from_utf8_lossy(&drawn.stdout));

    // A filter far too wide for the motion: the torque is right, the accelerations are not.
    let text = case.read("s.toml");
    case.write("s.toml", &text.replace("smoothing_window = 31", "smoothing_window = 151"));
    let worse = case.tauscope(&check);
    let table = String::from_utf8_lossy(&worse.stdout);
    assert_eq!(code(&worse), 1, "{table}");
    assert!(table.contains("figures are worse") && table.contains("savitzky_golay: torque std of joint_2"), "{table}");
    assert!(!table.contains("raw:") && !table.contains("butterworth:"), "the others are as they were: {table}");

    // The same of common practice, whose low-pass then takes the motion with the noise.
    case.write("s.toml", &text.replace("smoothing_window = 31", "smoothing_window = 31\nlow_pass_hz = 0.5"));
    let worse = case.tauscope(&check);
    let table = String::from_utf8_lossy(&worse.stdout);
    assert_eq!(code(&worse), 1, "{table}");
    assert!(table.contains("butterworth: torque std of joint_2"), "{table}");
    assert!(!table.contains("raw:") && !table.contains("savitzky_golay:"), "the others are as they were: {table}");
}

#[test]
fn common_practice_is_a_smoothing_of_a_study() {
    let case = case();
    let study = ["montecarlo", "s.toml", "--trials", "3", "--sg-windows", "0,31", "--estimators", "wls"];
    let with = case.tauscope(&[&study[..], &["--butterworth", "--json", "--out", "out"]].concat());
    let summary: serde_json::Value = serde_json::from_slice(&with.stdout).unwrap();
    let cells = summary["cells"].as_array().unwrap();
    let signals: Vec<_> = cells.iter().map(|cell| (cell["signals"].as_str(), cell["sg_window"].as_u64())).collect();
    let expected = [("raw", 0), ("savitzky_golay", 31), ("butterworth", 0)];
    assert_eq!(signals, expected.map(|(signals, window)| (Some(signals), Some(window))));
    let error = |cell: usize| cells[cell]["d_beta"]["p50"].as_f64().unwrap();
    assert!(error(2) < error(0), "{summary}");
    assert_eq!(summary["best_windows"].as_array().unwrap().len(), 1);

    // The table names it, the scenario may ask for it, and without either it is not there.
    let text = case.read("s.toml").replace("trials = 12", "trials = 12\nbutterworth = true");
    let plain = case.tauscope(&[&study[..], &["--out", "plain"]].concat());
    case.write("s.toml", &text);
    let asked = case.tauscope(&[&study[..], &["--out", "asked"]].concat());
    assert!(String::from_utf8_lossy(&asked.stdout).contains("Butterworth"), "{asked:?}");
    assert!(!String::from_utf8_lossy(&plain.stdout).contains("Butterworth"), "{plain:?}");
    assert!(case.read("out/report.html").contains("Butterworth"));
}

#[test]
fn the_montecarlo_key_at_fault() {
    for (bad, words) in [
        ("trials = 0", ["montecarlo.trials", "make no study"]),
        ("plant_error = 1.0", ["montecarlo.plant_error", "0 .. 1"]),
        ("start_error = -0.1", ["montecarlo.start_error", "0 .. 1"]),
        ("raw_decimation = 0", ["montecarlo.raw_decimation", "1 or more"]),
        ("noise = [{ encoder_rad = -1.0 }]", ["montecarlo.noise", "from zero up"]),
        ("noise = [{ encoder = 1.0 }]", ["noise", "unknown field"]),
        ("random_motion = { moves = 6, duration_s = 0.1 }", ["montecarlo.random_motion", "26 samples"]),
        ("engine = \"bullet\"", ["engine", "unknown variant"]),
    ] {
        let case = case();
        case.write("s.toml", &case.read("s.toml").replace("trials = 12", bad));
        case.assert_refused(&words);
    }
}
