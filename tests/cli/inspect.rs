//! `inspect` and `identify` on logs of other programs.

use super::{Case, assert_done, assert_refusal, text};
use std::fmt::Write;

/// A log of the IRB 1600's scenario as CSV, simulated by the command itself.
fn simulated() -> Case {
    let case = Case::new(&[]);
    assert_done(&case.tauscope(&["simulate", "s.toml", "--out", "out", "--quiet"]));
    case
}

fn log_name(case: &Case) -> String {
    let names = super::names(&case.path("out"));
    let found = names.iter().find(|name| name.ends_with(".parquet") || name.ends_with(".csv")).unwrap();
    format!("out/{found}")
}

fn sines(columns: &str, row: impl Fn(f64) -> String) -> String {
    let mut log = format!("{columns}\n");
    for i in 0..1000 {
        let t = 0.004 * f64::from(i);
        writeln!(log, "{t:.4},{}", row(t)).unwrap();
    }
    log
}

fn one_joint(t: f64) -> String {
    format!("{:.7},{:.5}", (3.0 * t).sin(), 5.0 * (3.0 * t).cos() + (7.1 * t).sin() - 2.0 * (3.0 * t).sin())
}

#[test]
fn a_simulated_log_is_clean() {
    let case = simulated();
    let output = case.tauscope(&["inspect", &log_name(&case), "--robot", "arm.urdf", "--json"]);
    assert_done(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["schema"], "tauscope.quality/1");
    assert_eq!(json["usable"], true);
    assert_eq!(json["rows_rejected"], 0);
    assert_eq!(json["joints"].as_array().unwrap().len(), 6);
    for finding in json["findings"].as_array().unwrap() {
        assert_eq!(finding["severity"], "note", "{finding}");
    }
}

#[test]
fn bad_rows_are_named_and_the_rest_is_used() {
    let case = Case::new(&[]);
    let log = sines("time,q1,tau1", one_joint);
    let mut lines: Vec<&str> = log.lines().collect();
    lines[100] = "0.3960,nan,1.0";
    lines[200] = "0.7960,0.1";
    case.write("log.csv", &lines.join("\n"));
    let output = case.tauscope(&["inspect", "log.csv"]);
    assert_done(&output);
    let said = text(&output.stdout);
    assert!(said.contains("998 rows over 3.996 s at 250 Hz") && said.contains("line 101, 201"), "{said}");
}

#[test]
fn a_log_that_cannot_be_used_is_refused_with_the_reason() {
    let case = Case::new(&[]);
    case.write("log.csv", &sines("t,q1,tau1", |_| "0.5,1.25".to_owned()));
    let output = case.tauscope(&["inspect", "log.csv"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stdout).contains("fatal: "), "{}", text(&output.stdout));
    let said = text(&output.stderr);
    assert!(said.contains("log.csv: ") && said.contains("cannot be used") && said.lines().count() == 1, "{said}");
    assert_refusal(&case.tauscope(&["inspect", "none.csv"]), &["none.csv", "No such file"]);
    case.write("x.csv", "a,b\n1,2\n");
    assert_refusal(&case.tauscope(&["inspect", "x.csv"]), &["x.csv:1: t: missing column"]);
    assert_refusal(&case.tauscope(&["inspect", "log.csv", "--dataset", "s.toml"]), &["s.toml", "unknown field"]);
}

#[test]
fn identify_takes_a_dataset() {
    const ARM: &str = r#"<robot name="one"><link name="base"/><joint name="a" type="revolute"><parent link="base"/>
<child link="l1"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="99" velocity="9"/></joint><link name="l1">
<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>"#;
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    // 2 kg m2, 1.5 N m s/rad and 3 N m at the joint, without weight; 50 turns of the motor each, 0.1 N m/A, in degrees.
    let row = |t: f64| {
        let (q, v, a) = ((3.0 * t).sin(), 3.0 * (3.0 * t).cos(), -9.0 * (3.0 * t).sin());
        let current = (2.0 * a + 1.5 * v + 3.0 * v.signum()) / (50.0 * 0.1);
        format!("{:.9},{current:.9}", q * 50.0 * 180.0 / std::f64::consts::PI)
    };
    case.write("log.csv", &sines("t,motor,amps", row));
    case.write(
        "d.toml",
        "schema = \"tauscope.dataset/1\"\nrobot = \"one.urdf\"\n[[train]]\nfile = \"log.csv\"\nto_s = 3.0\n[[test]]\n\
         file = \"log.csv\"\nfrom_s = 3.0\n[columns]\nq = [\"motor\"]\ntau = [\"amps\"]\n[units]\nposition = \"deg\"\n\
         torque = \"A\"\n[motors]\nposition_at = \"motor\"\ngear_ratio = 50\ntorque_constant_nm_a = 0.1\n",
    );
    let output = case.tauscope(&["identify", "--dataset", "d.toml", "--out", "out", "--json"]);
    assert_done(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let parameters = json["without_effects"]["parameters"].as_array().unwrap();
    let value = |symbol: &str| {
        let of = parameters.iter().find(|p| p["name"].as_str().unwrap().starts_with(symbol)).unwrap();
        of["value"].as_f64().unwrap()
    };
    for (symbol, expected) in [("Iyy1", 2.0), ("Fv1", 1.5), ("Fc1", 3.0)] {
        assert!((value(symbol) / expected - 1.0).abs() < 1e-3, "{symbol}: {}", value(symbol));
    }
    assert!(json["without_effects"]["test_rms_nm"][0].as_f64().unwrap() < 0.01);

    let output = case.tauscope(&["run", "--dataset", "d.toml", "--out", "run", "--json"]);
    assert_done(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["schema"], "tauscope.measured/1");
    assert_eq!(json["variants"][1]["signals"], "savitzky_golay");
    assert!(json["variants"][1]["torque_std_held_out_nm"][0].as_f64().unwrap() < 0.01);
    assert!(super::names(&case.path("run")).contains(&"identified.urdf".to_owned()));
    let both = case.tauscope(&["run", "s.toml", "--dataset", "d.toml"]);
    assert!(both.status.code() == Some(2) && text(&both.stderr).contains("cannot be used with"), "{both:?}");
}
