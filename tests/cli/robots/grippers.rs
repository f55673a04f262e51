//! Arms with joints beyond those under study: scenarios that hold a gripper, and logs that have it here and there.

use crate::{Case, ROOT, assert_done, assert_refusal, text};
use std::fmt::Write;

/// A scenario of the arm of four joints whose hand has two fingers, with `robot` in its table of the robot.
fn scenario(robot: &str) -> Case {
    let case = Case::new(&[
        ("name = \"irb1600_6_120\"", &format!("name = \"two_finger\"\n{robot}")),
        ("[10.0, 10.0, 12.0, 35.0, 40.0, 50.0]", "[6.0, 5.0, 8.0, 10.0]"),
        ("[3.0, 4.0, 2.0, 0.45, 0.35, 0.18]", "[0.3, 0.3, 0.1, 0.05]"),
    ]);
    let arm = std::fs::read_to_string(format!("{ROOT}/tests/reference/trees/two_finger.urdf")).unwrap();
    let limited = arm.replace(
        "type=\"continuous\">",
        "type=\"revolute\"><limit lower=\"-3\" upper=\"3\" effort=\"60\" velocity=\"3\"/>",
    );
    case.write("arm.urdf", &limited);
    case
}

#[test]
fn a_scenario_holds_the_fingers() {
    let case = scenario("tip = \"tcp\"\nhold = { finger_left_joint = 0.01 }");
    let output = case.tauscope(&["run", "s.toml", "--out", "out"]);
    assert_done(&output);
    let said = text(&output.stdout);
    assert!(
        said.contains(
            "where the logs show them or [hold] has them: finger_left_joint 0.0100 m, finger_right_joint 0.0100 m\n"
        ) && said.contains("joint_4"),
        "{said}"
    );
    let found: serde_json::Value = serde_json::from_str(&case.read("out/identification.json")).unwrap();
    let parameters = found["variants"][0]["parameters"].as_array().unwrap();
    assert!(parameters.iter().any(|p| p["name"] == "Fv4") && parameters.iter().all(|p| p["name"] != "Fv5"));
    for parameter in parameters {
        let [value, truth] = ["value", "truth"].map(|key| parameter[key].as_f64().unwrap());
        assert!((value - truth).abs() <= 1e-4 * truth.abs() + 1e-6, "{parameter}");
    }
    // The merged scenario holds them too, and names of the joints do the same as the tip.
    assert_done(&case.tauscope(&["simulate", "out/scenario.toml", "--out", "again"]));
    assert_eq!(case.read("again/recording.csv"), case.read("out/recording.csv"));
    let named = scenario(
        "joints = [\"joint_1\", \"joint_2\", \"joint_3\", \"joint_4\"]\n[robot.hold]\nfinger_left_joint = 0.01",
    );
    assert_done(&named.tauscope(&["simulate", "s.toml", "--out", "out"]));
    assert_eq!(named.read("out/recording.csv"), case.read("out/recording.csv"));
}

#[test]
fn what_a_scenario_asks_of_its_robot_is_checked() {
    for (robot, words) in [
        // Without a choice all joints that move by themselves do.
        ("", ["limits.acceleration_rad_s2", "4 values for 5 joints"]),
        ("tip = \"tool\"", ["s.toml:9: robot.tip", "no such link"]),
        ("tip = \"tcp\"\njoints = [\"joint_1\"]", ["robot.tip", "not both"]),
        ("joints = [\"joint_1\", \"joint_9\"]", ["robot.joints", "no such joint"]),
        ("joints = [\"joint_2\", \"joint_1\"]", ["robot.joints", "joint_1, joint_2; name them so"]),
        ("tip = \"tcp\"\nhold = { joint_1 = 0.5 }", ["robot.hold", "those are finger_left_joint, finger_right_joint"]),
        ("tip = \"tcp\"\nhold = { finger_left_joint = nan }", ["robot.hold", "give a position"]),
    ] {
        scenario(robot).assert_refused(&words);
    }
}

/// Two joints, the second of which bends the arm.
const BENT: &str = r#"<robot name="bent"><link name="base"/>
<joint name="a" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="9" velocity="9"/></joint>
<link name="l1"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="b" type="revolute"><origin xyz="1 0 0"/><parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="9" velocity="9"/></joint>
<link name="l2"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
</robot>"#;

/// A log in which the first joint moves and the second is at `b`, which begins the motion elsewhere too: a log is given once.
fn bent(b: impl Fn(f64) -> f64) -> String {
    let mut log = String::from("t,a_position,b_position,a_effort,b_effort\n");
    for i in 0..2000 {
        let own = 0.004 * f64::from(i);
        // By no whole number of samples, or the logs would have most of them in common.
        let t = own + 1.2345 * b(0.0);
        let q = 0.8 * (1.3 * t).sin() + 0.4 * (3.1 * t).sin();
        let a = -9.81 * q.cos() - 3.0 * (1.3 * 1.3 * 0.8 * (1.3 * t).sin() + 3.1 * 3.1 * 0.4 * (3.1 * t).sin());
        writeln!(log, "{own:.3},{q:.6},{:.6},{a:.5},{:.5}", b(own), -(q + b(own)).cos()).unwrap();
    }
    log
}

#[test]
fn a_joint_that_stands_elsewhere_in_every_log_is_noted() {
    let case = Case::new(&[]);
    case.write("bent.urdf", BENT);
    case.write("up.csv", &bent(|_| 0.8));
    case.write("down.csv", &bent(|_| 0.3));
    case.write("moves.csv", &bent(|t| 0.5 * t.sin()));
    let both = ["identify", "--robot", "bent.urdf", "--train", "up.csv", "--test", "down.csv", "--out"];
    let said = |more: &[&str]| {
        let output = case.tauscope(&[&both[..], more].concat());
        assert_done(&output);
        text(&output.stdout)
    };
    let kept = said(&["o1"]);
    let words = "at 0.3000 rad in down.csv and at 0.8000 rad in up.csv";
    assert!(kept.contains(&format!("joint `b` stands still in every log, {words}: it keeps its coordinate")), "{kept}");
    // Nothing advises what would be wrong in one of the logs.
    assert!(!kept.contains("--joints"), "{kept}");
    let held = said(&["o2", "--joints", "a"]);
    assert!(held.contains(&format!("joint `b` is not under study and stands {words}: it is held between")), "{held}");
    assert!(held.contains("where the logs show them or [hold] has them: b 0.5500 rad"), "{held}");
    // The first joint's place is of no account to itself: what carries nothing that moves is not noted, what is carried is.
    let inspected = |logs: &[&str], more: &[&str]| {
        let output = case.tauscope(&[&["inspect"], logs, &["--robot", "bent.urdf"], more].concat());
        text(&output.stdout)
    };
    let moving = inspected(&["moves.csv"], &["--joints", "a"]);
    assert!(moving.contains("Note: joints not under study move in the logs") && moving.contains("(b)"), "{moving}");
    let one = inspected(&["up.csv", "down.csv"], &["--joints", "a"]);
    assert_eq!(one.matches("Note: joint `b` is not under study and stands").count(), 1, "{one}");
    // Where a dataset says where it stands, that holds.
    case.write(
        "d.toml",
        "schema = \"tauscope.dataset/1\"\nrobot = \"bent.urdf\"\njoints = [\"a\"]\n[[train]]\nfile = \"up.csv\"\n\
         [[test]]\nfile = \"down.csv\"\n[hold]\nb = 0.4\n",
    );
    let output = case.tauscope(&["identify", "--dataset", "d.toml", "--out", "o3"]);
    assert_done(&output);
    let chosen = text(&output.stdout);
    assert!(
        chosen.contains("where the logs show them or [hold] has them: b 0.4000 rad")
            && !chosen.contains("held between"),
        "{chosen}"
    );
}

#[test]
fn inspect_notes_what_is_read_of_the_robot_once() {
    let case = Case::new(&[]);
    case.write("bent.urdf", &BENT.replace("xyz=\"1 0 0\"", "xyz=\"1 0 0\" rpy=\"1.5708 0 0\""));
    case.write("up.csv", &bent(|_| 0.8));
    case.write("down.csv", &bent(|_| 0.8));
    let output = case.tauscope(&["inspect", "up.csv", "down.csv", "--robot", "bent.urdf"]);
    let said = text(&output.stdout);
    // One on the rounded angle, one on the joint that stands still.
    assert_eq!(said.matches("Note: ").count(), 2, "{said}");
    assert!(
        said.contains("stand still")
            && said.matches("1.5708").count() == 1
            && said.contains("1.5708")
            && said.find("Note: ") > said.find("down.csv: "),
        "{said}"
    );
    let json = case.tauscope(&["inspect", "up.csv", "down.csv", "--robot", "bent.urdf", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["notes"].as_array().unwrap().len(), 2, "{json}");
    assert!(json["others"][0]["notes"].is_null());
    let output = case.tauscope(&["inspect", "up.csv", "--robot", "none.urdf"]);
    assert_refusal(&output, &["none.urdf"]);
}
