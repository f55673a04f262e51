//! Numbers that identification and diagnosis get right on logs of other people's arms.

use super::super::{assert_done, assert_refusal, schema, text};
use super::{Case, case};
use serde_json::Value;

fn identified(case: &Case, arguments: &[&str]) -> Value {
    let output = case.tauscope(&[&["identify", "--json", "--out", "out"], arguments].concat());
    assert_done(&output);
    serde_json::from_slice(&output.stdout).unwrap()
}

fn diagnosed(case: &Case, arguments: &[&str]) -> Value {
    let output = case.tauscope(&[&["diagnose", "--json", "--no-resimulation", "--out", "told"], arguments].concat());
    assert_done(&output);
    let told = serde_json::from_slice(&output.stdout).unwrap();
    schema::assert_valid(&told);
    told
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap_or(f64::NAN)).collect()
}

const UR5: [&str; 6] = ["--robot", "ur5.urdf", "--train", "train.csv", "--test", "test.csv"];

#[test]
#[ignore = "needs the cases folder"]
fn two_joints_that_move_are_identified_and_diagnosed() {
    let case = case("s07_two_joints");
    let fit = identified(&case, &UR5);
    let left = numbers(&fit["without_effects"]["test_rms_nm"]);
    let joints: Vec<&str> = fit["joints"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    // Of 40 N m; on the first the hidden friction at low speed is left.
    for name in ["shoulder_lift_joint", "elbow_joint"] {
        let place = joints.iter().position(|joint| *joint == name).unwrap();
        assert!(left[place] > 0.0 && left[place] < 1.5, "{name}: {left:?}");
    }
    let told = diagnosed(&case, &UR5);
    let found = told["findings"].as_array().unwrap().iter().find(|found| found["effect"] == "stribeck_friction");
    let found = found.unwrap_or_else(|| panic!("{told}"));
    assert_eq!((&found["joints"][0], &found["verdict"]), (&"shoulder_lift_joint".into(), &"named".into()), "{told}");
}

#[test]
#[ignore = "needs the cases folder"]
fn logs_of_fifty_and_sixty_hertz_are_diagnosed() {
    let case = case("s08_slow_log");
    for rate in ["r50", "r60"] {
        let logs = [format!("{rate}_train.csv"), format!("{rate}_test.csv")];
        let arguments = ["--robot", "ur5.urdf", "--train", &logs[0], "--test", &logs[1]];
        let fit = identified(&case, &arguments);
        assert!(numbers(&fit["without_effects"]["test_rms_nm"]).iter().all(|left| *left < 0.5), "{fit}");
        let told = diagnosed(&case, &arguments);
        assert_eq!(told["findings"].as_array().map(Vec::len), Some(0), "{told}");
        for name in ["out", "told"] {
            std::fs::remove_dir_all(case.path(name)).unwrap();
        }
    }
}

#[test]
#[ignore = "needs the cases folder"]
fn slower_logs_are_identified_and_not_diagnosed() {
    let case = case("s08_slow_log");
    for log in ["r60_train.csv", "r60_test.csv"] {
        // Every third row: 20 Hz.
        let text = case.read(log);
        let mut lines = text.lines();
        let head = lines.next().unwrap();
        let rows: Vec<&str> = lines.step_by(3).collect();
        case.write(log, &format!("{head}\n{}\n", rows.join("\n")));
    }
    let arguments = ["--robot", "ur5.urdf", "--train", "r60_train.csv", "--test", "r60_test.csv"];
    identified(&case, &arguments);
    let refusal = case.tauscope(&[&["diagnose", "--out", "told"], &arguments[..]].concat());
    assert_refusal(&refusal, &["20.000 Hz", "50 Hz", "identify"]);
}

#[test]
#[ignore = "needs the cases folder"]
fn a_heavy_arm_without_inertials_gets_bodies_as_heavy_as_it_is() {
    let case = case("f07_irb4600");
    let arguments = ["--robot", "irb4600_stripped.urdf", "--train", "train.csv", "--test", "test.csv"];
    let fit = identified(&case, &arguments);
    let side = |name: &str, logs: &str| numbers(&fit[name][logs]);
    for (plain, bodies) in side("without_effects", "train_rms_nm").iter().zip(side("consistent", "train_rms_nm")) {
        assert!(bodies < 1.01 * plain, "{bodies} for {plain}");
    }
    for (plain, bodies) in side("without_effects", "test_rms_nm").iter().zip(side("consistent", "test_rms_nm")) {
        assert!(bodies < 1.05 * plain, "{bodies} for {plain}");
    }
}

#[test]
#[ignore = "needs the cases folder"]
fn a_real_log_of_fifty_hertz_is_identified() {
    let case = case("f09_ar5");
    let fit = identified(&case, &["--dataset", "d_grav.toml"]);
    let left = numbers(&fit["without_effects"]["test_rms_nm"]);
    assert!(left.iter().all(|left| *left < 1.0), "{left:?}");
    let printed = text(&case.tauscope(&["diagnose", "--dataset", "d_grav.toml", "--out", "told"]).stdout);
    assert!(printed.starts_with("Verdict: ") || printed.starts_with("The logs cannot be diagnosed"), "{printed}");
}
