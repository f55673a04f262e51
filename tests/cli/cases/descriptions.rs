//! Wrong descriptions of public logs: named in one line, put right in `corrected.toml`, and nothing else is accused.

use super::super::{Case, assert_done, text};
use super::case;
use serde_json::Value;

/// What `inspect` says of some logs, as JSON.
fn inspected(case: &Case, arguments: &[&str]) -> Value {
    let output = case.tauscope(&[&["inspect", "--json", "--out", "out"], arguments].concat());
    assert_done(&output);
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Kinds of the findings worse than notes, without those of the clock and of joints that hardly move.
fn kinds(result: &Value) -> Vec<String> {
    let besides = ["jitter", "gap", "hardly_moves", "outside_limits"];
    let findings = result["findings"].as_array().unwrap().iter().filter(|finding| finding["severity"] != "note");
    let kinds = findings.map(|finding| finding["kind"].as_str().unwrap().to_owned());
    kinds.filter(|kind| !besides.contains(&kind.as_str())).collect()
}

#[test]
#[ignore = "needs the cases folder"]
fn an_arm_mounted_sideways() {
    let case = case("f09_ar5");
    let header = case
        .read("d.toml")
        .lines()
        .filter(|line| line.contains("= ["))
        .map(|line| line.to_owned() + "\n")
        .collect::<String>();
    case.write(
        "all.toml",
        &format!(
            "schema = \"tauscope.dataset/1\"\nrobot = \"ar5.urdf\"\n[[train]]\nfile = \"ar5.csv\"\n[columns]\n{header}"
        ),
    );
    let result = inspected(&case, &["ar5.csv", "--dataset", "all.toml"]);
    assert_eq!(kinds(&result), ["mounting"], "{result}");
    assert_eq!(result["description"]["changes"][0], "gravity is along +x of the base");
    assert!(case.read("out/corrected.toml").contains("gravity_m_s2 = [9.8"), "{}", case.read("out/corrected.toml"));
    let again = inspected(&case, &["ar5.csv", "--dataset", "out/corrected.toml"]);
    assert_eq!(kinds(&again), [""; 0], "{again}");
    let given = inspected(&case, &["ar5.csv", "--dataset", "all.toml", "--gravity", "9.81,0,0"]);
    assert_eq!(kinds(&given), [""; 0], "{given}");
    let output = case.tauscope(&["identify", "--dataset", "d.toml", "--out", "identified", "--json"]);
    assert_done(&output);
    let identified = String::from_utf8(output.stdout).unwrap();
    assert!(identified.contains("gravity is along +x"), "{identified}");
}

#[test]
#[ignore = "needs the cases folder"]
fn a_torque_without_gravity() {
    let case = case("s02_gravity_compensated");
    for logs in [&["train.csv"][..], &["train.csv", "test.csv"]] {
        let result = inspected(&case, &[logs, &["--robot", "ur5.urdf"]].concat());
        assert_eq!(kinds(&result), ["gravity_compensated"], "{result}");
    }
    let arguments =
        ["identify", "--robot", "ur5.urdf", "--train", "train.csv", "--test", "test.csv", "--out", "identified"];
    let output = case.tauscope(&arguments);
    assert_done(&output);
    assert!(text(&output.stdout).contains("gravity-compensated"), "{}", text(&output.stdout));
    assert!(case.read("identified/corrected.toml").contains("gravity_m_s2 = [0.0, 0.0, 0.0]"));
}

#[test]
#[ignore = "needs the cases folder"]
fn a_torque_before_the_gear() {
    let case = case("s13_before_gear");
    let result = inspected(&case, &["train.csv", "test.csv", "--robot", "ur5.urdf"]);
    assert_eq!(kinds(&result), ["torque_unit"], "{result}");
    let said = result["findings"].to_string();
    assert!(said.contains("101 times smaller") && said.contains("gear"), "{said}");
}

#[test]
#[ignore = "needs the cases folder"]
fn a_load_without_direction() {
    let case = case("f08_so101_sage");
    for log in ["custom_motion_flat.csv", "chirp_sweep_flat.csv", "friction_gravity_flat.csv"] {
        let output = case.tauscope(&["inspect", "--json", "--out", "out", log, "--dataset", "d.toml"]);
        assert_eq!(output.status.code(), Some(2));
        let result = serde_json::from_slice(&output.stdout).unwrap();
        assert!(kinds(&result).contains(&"unsigned_torque".to_owned()), "{log}: {result}");
    }
}
