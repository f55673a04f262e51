//! `tauscope excite` as a program: files, exit codes, interruption.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tauscope::design::Envelope;
use tauscope::excitation::{MotionFile, Reference};
use tauscope::scenario::Arm;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

fn excite(out: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tauscope"));
    command.current_dir(ROOT).arg("excite").args(arguments).arg("--out").arg(out);
    command
}

/// A copy of the main scenario with `from` replaced by `to`.
fn altered(folder: &Path, from: &str, to: &str) -> PathBuf {
    let text = std::fs::read_to_string(Path::new(ROOT).join("scenarios/irb1600.toml")).unwrap();
    assert!(text.contains(from), "{from}");
    let path = folder.join("altered.toml");
    std::fs::write(&path, text.replace(from, to).replace("../urdf", &format!("{ROOT}/urdf"))).unwrap();
    path
}

/// The file holds a motion of `duration_s` that keeps every limit of the main scenario.
fn assert_valid(path: &Path, duration_s: f64) {
    let arm = Arm::load(Path::new(ROOT).join("scenarios/irb1600.toml"), None).unwrap();
    let file = MotionFile::read(path).unwrap();
    let motion = file.for_arm(&arm.known.name, &arm.known.joint_names()).unwrap();
    assert!((motion.duration_s() - duration_s).abs() < 1e-12);
    Envelope::new(&arm.known, &arm.limits, arm.scenario.limits.workspace).unwrap().check(&motion).unwrap();
}

fn refusal(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn the_same_seed_writes_the_same_bytes_on_one_and_two_threads() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two] = ["1", "2"].map(|threads| {
        let file = folder.path().join(format!("{threads}.toml"));
        let arguments = ["--evaluations", "300", "--duration", "20", "--seed", "3", "--json"];
        let output = excite(&file, &arguments).env("RAYON_NUM_THREADS", threads).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(found["motion"]["rank"], 52);
        assert_eq!(found["seed"], 3);
        assert_valid(&file, 20.0);
        std::fs::read(file).unwrap()
    });
    assert!(one == two);
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_the_best_motion_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("new/motion.toml");
    let mut child = excite(&file, &["--evaluations", "100000000", "--quiet"]).spawn().unwrap();
    while !file.exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before the interrupt");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert_valid(&file, 10.0);
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert_valid(&file, 10.0);
    let names: Vec<_> = std::fs::read_dir(file.parent().unwrap()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["motion.toml"]);
}

#[test]
fn a_budget_of_time_ends_the_search() {
    let folder = tempfile::tempdir().unwrap();
    let output = excite(folder.path(), &["--budget", "500ms", "--kind", "quintic"]).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert_valid(&folder.path().join("motion.toml"), 10.0);
}

#[test]
fn infeasible_requests_name_the_limit_and_write_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("motion.toml");
    let run = |scenario: &Path, more: &[&str]| {
        let arguments: Vec<&str> = [&[scenario.to_str().unwrap(), "--evaluations", "100"], more].concat();
        refusal(&excite(&file, &arguments).output().unwrap())
    };
    let high = altered(folder.path(), "floor_m = 0.0", "floor_m = 1.2");
    assert!(run(&high, &[]).contains("floor_m"));
    let fixed = altered(folder.path(), "= [10.0, 10.0, 12.0", "= [10.0, 0.0, 12.0");
    let message = run(&fixed, &[]);
    assert!(message.contains("joint_2") && message.contains("acceleration"), "{message}");
    let main = Path::new(ROOT).join("scenarios/irb1600.toml");
    assert!(run(&main, &["--duration", "0.01"]).contains("duration"));
    assert!(run(&main, &["--budget", "0"]).contains("--budget"));
    assert!(run(&main, &["--budget-s", "0"]).contains("give a time above zero"), "the option's former name");
    assert!(run(&main, &["--kind", "sine"]).contains("possible values"));
    assert!(!file.exists());
}

#[test]
fn the_comparison_holds_all_kinds_the_median_and_the_single_move() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--compare", "--evaluations", "100", "--json"];
    let output = excite(&folder.path().join("motion.toml"), &arguments).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = found["rows"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().map(|row| row["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["freudenstein", "fourier", "quintic", "bspline", "random, median", "single move"]);
    assert_eq!(rows[5]["rank"], 51);
    for row in &rows[..4] {
        assert_eq!(row["rank"], 52);
        assert!(row["held_out"].as_f64().unwrap() < 0.2, "{row}");
    }
}

#[test]
fn the_motions_of_the_main_scenario_keep_every_limit() {
    assert_valid(&Path::new(ROOT).join("scenarios/motions/irb1600_10s.toml"), 10.0);
    assert_valid(&Path::new(ROOT).join("scenarios/motions/irb1600_held_out.toml"), 10.0);
}
