//! Robots and logs as their owners have them go through `identify`.

use super::super::{Case, assert_done, assert_refusal, text};
use super::case;
use serde_json::Value;

/// What `identify` finds, with what it says on the way.
fn identified(case: &Case, out: &str, arguments: &[&str]) -> (Value, String) {
    let output = case.tauscope(&[&["identify", "--json", "--out", out], arguments].concat());
    assert_done(&output);
    (serde_json::from_slice(&output.stdout).unwrap(), text(&output.stderr))
}

/// Residuals of the held-out log, where there is one, else of the training log, N m, each below the bound of its joint.
#[track_caller]
fn assert_explains(found: &Value, bounds: &[f64]) {
    let of = |logs: &str| found["without_effects"][logs].as_array().unwrap();
    let left = if of("test_rms_nm").is_empty() { of("train_rms_nm") } else { of("test_rms_nm") };
    let below = |(left, bound): (&Value, &f64)| left.as_f64().unwrap() < *bound;
    assert!(left.len() == bounds.len() && left.iter().zip(bounds).all(below), "{left:?} {bounds:?}");
}

/// The fingers are held, whether or not the log has them.
#[test]
#[ignore = "needs the cases folder"]
fn f01_an_arm_with_two_fingers() {
    let case = case("f01_panda_hand");
    for log in ["train.csv", "with_fingers.csv"] {
        let arguments = ["--robot", "panda.urdf", "--train", log, "--test", "test.csv"];
        let (found, said) = identified(&case, &format!("{log}.out"), &arguments);
        assert_explains(&found, &[0.12, 0.2, 0.12, 0.1, 0.015, 0.02, 0.012]);
        assert!(said.contains("panda_finger_joint1") || found.to_string().contains("panda_finger_joint1"), "{said}");
    }
}

#[test]
#[ignore = "needs the cases folder"]
fn f06_a_real_arm_with_sensors_behind_the_gears() {
    let (found, _) = identified(&case("f06_panda_gaz"), "out", &["--dataset", "d.toml"]);
    assert_explains(&found, &[1.0, 1.0, 1.1, 0.5, 0.08, 0.15, 0.04]);
}

#[test]
#[ignore = "needs the cases folder"]
fn f16_every_variant_of_one_arm() {
    let case = case("f16_urdf_strict");
    let logs = ["--train", "train.csv"];
    for letter in ["a", "b", "c", "d", "e", "f", "g", "h", "i", "k", "l", "m", "n", "o", "p", "q"] {
        let urdf = format!("{letter}.urdf");
        let trust = if letter == "i" { "nominal" } else { "structure" };
        let arguments = [&["--robot", &urdf, "--trust", trust][..], &logs].concat();
        let (found, _) = identified(&case, letter, &arguments);
        assert_explains(&found, &[0.2, 0.36, 0.15, 0.05, 0.05, 0.04]);
    }
    let swapped = case.tauscope(&[&["identify", "--robot", "j.urdf", "--out", "j"], &logs[..]].concat());
    assert_refusal(&swapped, &["shoulder_pan_joint", "lower"]);
}

/// Friction below zero, as least squares leave it, is not used.
#[test]
#[ignore = "needs the cases folder"]
fn f17_friction_below_zero() {
    let case = case("f17_negative_damping");
    for (other, files) in [("f05_airbot", ["airbot1.csv", "a.toml"]), ("f09_ar5", ["ar5.csv", "d_grav.toml"])] {
        let other = super::case(other);
        files.iter().for_each(|file| _ = std::fs::copy(other.path(file), case.path(file)).unwrap());
    }
    for (dataset, urdf, bounds) in [
        ("a.toml", "airbot_updated.urdf", &[0.3, 0.7, 0.7, 0.1, 0.2, 0.03][..]),
        ("d_grav.toml", "ar5_friction.urdf", &[0.6, 1.1, 0.3, 0.6, 0.1, 0.4, 0.1]),
    ] {
        let lines = case.read(dataset);
        let lines = lines.lines().map(|line| match line.starts_with("robot") {
            true => format!("robot = \"{urdf}\"\n"),
            false => format!("{line}\n"),
        });
        case.write(dataset, &lines.collect::<String>());
        let (found, _) = identified(&case, &format!("{urdf}.out"), &["--dataset", dataset]);
        assert_explains(&found, bounds);
    }
}

/// Of a tree with two arms, a head and grippers, the arm that moves; the others stand still in the log.
#[test]
#[ignore = "needs the cases folder"]
fn f20_one_arm_of_two() {
    let case = case("f20_baxter");
    let arguments = ["--robot", "baxter.urdf", "--train", "train.csv"];
    let (found, _) = identified(&case, "out", &arguments);
    assert_explains(&found, &[0.3; 7]);
    let joints = found["joints"].as_array().unwrap();
    assert!(joints.iter().all(|joint| joint.as_str().unwrap().starts_with("right_")), "{joints:?}");
}
