//! `payload` on logs whose torques another program made, and on a pendulum worked by hand.

use super::{Case, ROOT, assert_done, assert_refusal, text};
use serde_json::Value;
use std::fmt::Write;
use std::process::Output;
use tempfile::TempDir;

const LOGS: [&str; 5] = ["arm.urdf", "before.csv", "after.csv", "elsewhere.csv", "nothing.csv"];

/// A folder with the arm and logs of tests/reference/payload.py.
fn case() -> Case {
    let case = Case { folder: TempDir::new().unwrap() };
    for name in LOGS {
        case.write(name, &std::fs::read_to_string(format!("{ROOT}/tests/reference/payload/{name}")).unwrap());
    }
    case
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", text(&output.stderr)))
}

fn payload(case: &Case, logs: [&str; 2], more: &[&str]) -> Output {
    let fixed = ["payload", logs[0], logs[1], "--robot", "arm.urdf", "--out", "out", "--json"];
    case.tauscope(&[&fixed[..], more].concat())
}

/// Checks a number against the truth: within three standard errors, which are below `largest`.
fn assert_near(quantity: &Value, truth: f64, largest: f64) {
    let [value, error] = ["value", "standard_error"].map(|key| quantity[key].as_f64().unwrap_or(f64::NAN));
    assert!((value - truth).abs() < 3.0 * error && error < largest, "{value} +- {error}, truly {truth}");
}

/// The load of tests/reference/payload.py.
fn assert_true(found: &Value, mass_error: f64) {
    assert_eq!(found["verdict"], "load");
    assert_near(&found["mass_kg"], 1.5, mass_error);
    for (axis, truth) in [0.03, -0.02, 0.09].into_iter().enumerate() {
        assert_near(&found["center_m"][axis], truth, 0.01);
    }
}

#[test]
fn the_load_of_another_program_is_found_at_equal_states() {
    let case = case();
    let output = payload(&case, ["before.csv", "after.csv"], &[]);
    assert_done(&output);
    let found = json(&output);
    assert_eq!((&found["schema"], &found["estimator"]), (&"tauscope.payload/1".into(), &"difference".into()));
    assert_true(&found, 0.02);
    for (place, truth) in [0.022, 0.002, 0.026, -0.001, 0.0015, 0.014].into_iter().enumerate() {
        let element = &found["inertia_kg_m2"][place];
        assert!(element.is_null() || element["standard_error"].as_f64().unwrap() < 0.01);
        if !element.is_null() {
            assert_near(element, truth, 0.01);
        }
    }
    assert_eq!(found["frame"], "flange");
    assert_eq!(found["changed"], Value::Array(Vec::new()), "friction and ripple cancel");
    assert_eq!(case.read("out/payload.json"), text(&output.stdout));
    // What cancels is what makes the joint fit worse.
    assert!(found["other"]["uncertainty"].as_f64() > found["uncertainty"].as_f64());
}

#[test]
fn the_load_is_found_along_another_motion() {
    let case = case();
    let output = payload(&case, ["before.csv", "elsewhere.csv"], &[]);
    assert_done(&output);
    let found = json(&output);
    assert_eq!(found["estimator"], "joint_fit");
    assert_true(&found, 0.1);
}

#[test]
fn several_logs_make_it_more_exact() {
    let case = case();
    let one = json(&payload(&case, ["before.csv", "elsewhere.csv"], &[]));
    let more =
        json(&payload(&case, ["before.csv", "elsewhere.csv"], &["--before", "nothing.csv", "--after", "after.csv"]));
    assert_eq!(more["logs"], serde_json::json!([2, 2]));
    assert!(more["uncertainty"].as_f64() < one["uncertainty"].as_f64());
    assert_true(&more, 0.1);
}

#[test]
fn no_load_is_no_number() {
    let case = case();
    let output = payload(&case, ["before.csv", "nothing.csv"], &["--expect", "0"]);
    assert_done(&output);
    let found = json(&output);
    assert_eq!(found["verdict"], "no_load");
    assert!(found["mass_kg"].is_null() && found["controllers"].is_null());
    assert!(found["mass_below_kg"].as_f64().unwrap() < 0.05, "{found}");
}

#[test]
fn an_expectation_decides_the_exit_code() {
    let case = case();
    case.write("load.toml", "mass_kg = 1.5\ncenter_m = [0.03, -0.02, 0.09]\ntolerance_m = 0.01\n");
    case.write("wrong.toml", "mass_kg = 1.5\ncenter_m = [0.03, 0.08, 0.09]\n");
    case.write("typo.toml", "mas_kg = 1.5\n");
    let code = |more: &[&str]| payload(&case, ["before.csv", "after.csv"], more).status.code();
    assert_eq!(code(&["--expect", "1.5"]), Some(0));
    assert_eq!(code(&["--expect", "1.45"]), Some(0), "within 5 %");
    assert_eq!(code(&["--expect", "1.2"]), Some(1));
    assert_eq!(code(&["--expect", "1.2", "--tolerance", "0.4"]), Some(0));
    assert_eq!(code(&["--expect", "0"]), Some(1));
    assert_eq!(code(&["--expect", "load.toml"]), Some(0));
    assert_eq!(code(&["--expect", "wrong.toml"]), Some(1));
    let refused = |more: &[&str], words: &[&str]| {
        assert_refusal(&payload(&case, ["before.csv", "after.csv"], more), words);
    };
    refused(&["--expect", "-1"], &["--expect", "zero or more"]);
    refused(&["--expect", "load.tml"], &["load.tml", "mass in kg"]);
    refused(&["--expect", "typo.toml"], &["typo.toml:1", "mas_kg"]);
    refused(&["--expect", "1", "--tolerance", "nan"], &["--tolerance"]);
}

#[test]
fn a_load_that_was_taken_off_asks_for_the_other_order() {
    let case = case();
    assert_refusal(&payload(&case, ["after.csv", "before.csv"], &[]), &["1.5", "taken off", "other order"]);
}

#[test]
fn bad_input_is_refused_with_the_reason() {
    let case = case();
    let fixed = ["payload", "before.csv"];
    assert_refusal(&case.tauscope(&[&fixed[..], &["after.csv"]].concat()), &["--robot", "URDF"]);
    let with = ["--robot", "arm.urdf"];
    assert_refusal(&case.tauscope(&[&fixed[..], &["nowhere.csv"], &with[..]].concat()), &["nowhere.csv"]);
    let at = |link| case.tauscope(&[&fixed[..], &["after.csv", "--at", link], &with[..]].concat());
    assert_refusal(&at("nowhere"), &["--at", "nowhere", "flange"]);
    assert_refusal(&at("base"), &["--at", "base", "moves it"]);
}

#[test]
fn another_frame_holds_the_same_load() {
    let case = case();
    let found = json(&payload(&case, ["before.csv", "after.csv"], &["--at", "wrist"]));
    assert_eq!(found["frame"], "wrist");
    assert_near(&found["mass_kg"], 1.5, 0.02);
    // The flange is 0.07 m along z, turned by 0.4 rad about it.
    let (sin, cos) = 0.4f64.sin_cos();
    for (axis, truth) in [0.03 * cos + 0.02 * sin, 0.03 * sin - 0.02 * cos, 0.16].into_iter().enumerate() {
        assert_near(&found["center_m"][axis], truth, 0.01);
    }
}

#[test]
fn datasets_describe_either_side() {
    let case = case();
    let dataset = |log: &str| {
        format!(
            "schema = \"tauscope.dataset/1\"\nrobot = \"arm.urdf\"\n[[train]]\nfile = \"{log}\"\n[units]\ntorque = \"mNm\"\n"
        )
    };
    case.write("b.toml", &dataset("before.csv"));
    case.write("a.toml", &dataset("after.csv"));
    let output = case.tauscope(&["payload", "b.toml", "a.toml", "--out", "out", "--json"]);
    assert_done(&output);
    // A thousandth of the torque is a thousandth of the mass.
    assert_near(&json(&output)["mass_kg"], 1.5e-3, 2e-5);
}

#[test]
fn the_text_has_numbers_frames_and_controllers() {
    let case = case();
    let output = case.tauscope(&["payload", "before.csv", "after.csv", "--robot", "arm.urdf", "--out", "out"]);
    assert_done(&output);
    let said = text(&output.stdout);
    for words in [
        "Verdict: a load of 1.",
        "as exact as the torque constants: 1 % of gain is 1 % of mass",
        "load at flange",
        "equal states",
        "\"centerOfMass\"",
        "set_payload(1.",
        "$LOAD = {M 1.",
        "PERS loaddata",
    ] {
        assert!(said.contains(words), "{said} lacks {words}");
    }
}

/// A pendulum about y with a point of 2 kg at 0.5 m, swung by hand: tau = (J + m l^2) qdd + m g l cos q ... with friction.
fn pendulum(first_moment: f64, inertia: f64, which: f64) -> String {
    let mut log = "t,q1,tau1\n".to_owned();
    for i in 0..2000 {
        let t = 0.01 * f64::from(i);
        let (mut q, mut qd, mut qdd) = (0.0, 0.0, 0.0);
        for (size, omega) in [(0.8, 1.1), (0.4, 2.3 * which), (0.2, 4.1)] {
            q += size * f64::sin(omega * t);
            qd += size * omega * f64::cos(omega * t);
            qdd -= size * omega * omega * f64::sin(omega * t);
        }
        // Turned about +y by q, a point along x sinks by sin q: gravity pulls with -m g x cos q, the motor holds against it.
        let rigid = inertia * qdd - 9.81 * first_moment * q.cos();
        // What no model has, the same at the same place.
        let noise = 1e-3 * ((f64::from(i * i % 1009) / 1009.0) - 0.5);
        let tau = rigid + 0.5 * qd.signum() + 0.2 * qd + noise;
        writeln!(log, "{t:.2},{q:.6},{tau:.6}").unwrap();
    }
    log
}

#[test]
fn a_point_on_a_pendulum_has_a_first_moment_and_an_inertia_but_no_mass() {
    let case = Case { folder: TempDir::new().unwrap() };
    case.write(
        "arm.urdf",
        "<robot name=\"p\"><link name=\"base\"/><link name=\"bar\"/><joint name=\"j\" type=\"continuous\">\
         <parent link=\"base\"/><child link=\"bar\"/><axis xyz=\"0 1 0\"/></joint></robot>",
    );
    // 1 kg at 0.3 m, and then 2 kg at 0.5 m more: 1 kg m and 0.5 kg m2.
    case.write("before.csv", &pendulum(0.3, 0.09, 1.0));
    case.write("after.csv", &pendulum(0.3 + 2.0 * 0.5, 0.09 + 2.0 * 0.25, 1.0));
    let output = payload(&case, ["before.csv", "after.csv"], &["--expect", "2"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let found = json(&output);
    assert_eq!(found["verdict"], "mass_not_determined");
    assert!(found["mass_kg"].is_null() && found["center_m"][0].is_null(), "{found}");
    assert_near(&found["first_moment_kg_m"][0], 1.0, 0.01);
    assert_near(&found["inertia_about_frame_kg_m2"][2], 0.5, 0.01);
    assert!(found["not_determined"][0].as_str().unwrap().starts_with("mass"));
    assert!(found["expected"]["reasons"][0].as_str().unwrap().contains("do not determine the mass"));
}
