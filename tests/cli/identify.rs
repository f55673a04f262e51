//! What `identify` says of numbers that no drive has.

use super::{Case, ROOT, assert_done, text};
use serde_json::Value;
use std::fmt::Write;

/// A slide that lifts 10 kg: its rotor stands apart from the mass, which gravity shows.
const LIFT: &str = r#"<robot name="lift"><link name="base"/><joint name="lift" type="prismatic"><parent link="base"/>
<child link="l1"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="999" velocity="9"/></joint><link name="l1">
<inertial><mass value="10"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>"#;

/// A folder with the slide and a log of it with this rotor and this Coulomb friction, and with noise of its force.
fn logged(rotor: f64, coulomb: f64) -> Case {
    let case = Case::new(&[]);
    case.write("lift.urdf", LIFT);
    let mut log = "t,q1,qd1,tau1\n".to_owned();
    for row in 0..4000 {
        let t = 0.004 * f64::from(row);
        let (mut q, mut v, mut a) = (0.0, 0.0, 0.0);
        for (size, w, phase) in [(0.5, 1.1, 0.0), (0.2, 2.9, 1.0), (0.05, 6.3, 2.0)] {
            let (sin, cos) = f64::sin_cos(w * t + phase);
            (q, v, a) = (q + size * sin, v + size * w * cos, a - size * w * w * sin);
        }
        let noise = (43_758.5 * (12.9898 * f64::from(row)).sin()).fract();
        let force = 10.0 * (a + 9.81) + rotor * a + 1.5 * v + coulomb * v.signum() + 0.3 * noise;
        writeln!(log, "{t:.4},{q:.9},{v:.9},{force:.9}").unwrap();
    }
    case.write("log.csv", &log);
    case
}

/// What `identify` prints of that, and on standard error.
fn identified(rotor: f64, coulomb: f64) -> [String; 2] {
    let case = logged(rotor, coulomb);
    let output = case.tauscope(&["identify", "--robot", "lift.urdf", "--train", "log.csv", "--out", "out"]);
    assert_done(&output);
    let json: serde_json::Value = serde_json::from_str(&case.read("out/identification.json")).unwrap();
    let said = text(&output.stdout);
    for note in json["notes"].as_array().unwrap() {
        assert!(said.contains(note.as_str().unwrap()), "{said} lacks {note}");
    }
    [said, text(&output.stderr)]
}

#[test]
fn negative_drives_are_named_with_their_causes() {
    let [rotor, coulomb] = ["rotor inertia is negative on lift (-", "Coulomb friction is negative on lift (-"];
    for (drive, negative) in [
        ((2.0, 3.0), vec![]),
        ((-4.0, 3.0), vec![rotor]),
        // A fifth of the mass, and a tenth of it, which filters and masses of files explain.
        ((-2.0, 3.0), vec![rotor]),
        ((-1.0, 3.0), vec![]),
        ((2.0, -3.0), vec![coulomb]),
        ((-4.0, -3.0), vec![rotor, coulomb]),
    ] {
        let [said, errors] = identified(drive.0, drive.1);
        for note in [rotor, coulomb] {
            assert_eq!(said.contains(note), negative.contains(&note), "{drive:?}: {said}");
        }
        // What the viewer shows or not is no concern of who asks for numbers.
        assert!(!errors.contains("WARN"), "{drive:?}: {errors}");
    }
    let [said, _] = identified(-4.0, 3.0);
    assert!(said.contains(" kg)") && said.contains("a mass of the file that is too large"), "{said}");
}

#[test]
fn block_means_take_a_cut_off_for_each_joint() {
    let case = logged(2.0, 3.0);
    let with = |cutoffs: &str| {
        let logs = ["identify", "--robot", "lift.urdf", "--train", "log.csv", "--out", "out"];
        case.tauscope(&[&logs[..], &["--block-means-hz", cutoffs]].concat())
    };
    assert_done(&with("20"));
    let refused = with("20,25");
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("are 2 for 1 joints"), "{}", text(&refused.stderr));
}

/// The parameters of an effect in a document of the results; they follow each other in the same order in both.
fn parameters(effect: &Value) -> Vec<(&str, f64, f64)> {
    let each = effect["parameters"].as_array().unwrap().iter();
    each.map(|one| (one["name"].as_str().unwrap(), one["value"].as_f64().unwrap(), one["std"].as_f64().unwrap()))
        .collect()
}

#[test]
fn effects_are_estimated_as_diagnose_estimates_them() {
    let case = Case::new(&[]);
    let of = |file: &str| format!("{ROOT}/tests/reference/pendulum{file}");
    let (robot, train, test) = (of(".urdf"), of("/train.csv"), of("/test.csv"));
    let run = |command: &str, more: &[&str]| {
        let logs = ["--robot", &robot, "--train", &train, "--test", &test, "--out", command];
        case.tauscope(&[&[command], &logs[..], more].concat())
    };
    let output = run("identify", &["--effect", "torque_ripple", "--effect", "backlash", "--as-diagnose"]);
    assert_done(&output);
    assert_done(&run("diagnose", &["--candidates", "torque_ripple", "--no-resimulation"]));
    let [identified, diagnosis] = ["identify/identification.json", "diagnose/diagnosis.json"]
        .map(|file| -> Value { serde_json::from_str(&case.read(file)).unwrap() });
    let estimated = &identified["as_diagnose"];
    let (own, found) = (parameters(&estimated["effects"][0]), parameters(&diagnosis["findings"][0]));
    assert!(own.len() >= 3 && own == found[..own.len()], "{own:?} {found:?}");
    assert!(identified["without_effects"].is_object() && identified["with_effects"].is_null());
    assert_eq!(estimated["left_out"][0]["effect"], "backlash");
    let said = text(&output.stdout);
    for words in ["torque_ripple:pivot harmonic", "with effects", "backlash:pivot: left out, since it is measured by"] {
        assert!(said.contains(words), "{said}");
    }

    for (more, words) in [
        (&["--as-diagnose"][..], "--effect"),
        (&["--as-diagnose", "--effect", "torque_ripple", "--window", "31"], "--window"),
        (&["--as-diagnose", "--effect", "backlash"], "measured by its impacts"),
    ] {
        let refused = run("identify", more);
        assert_eq!(refused.status.code(), Some(2));
        assert!(text(&refused.stderr).contains(words), "{}", text(&refused.stderr));
    }
    let again = case.tauscope(&["identify", "--robot", &robot, "--train", &train, "--test", &train, "--out", "again"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("train.csv: has the samples of "), "{}", text(&again.stderr));
}

/// Samples at a limit of the drive are no measurements.
#[test]
fn torques_that_are_cut_off_are_left_out_and_counted() {
    let case = Case::new(&[]);
    let of = |file: &str| format!("{ROOT}/tests/reference/pendulum{file}");
    let limit = 5.0;
    let log = std::fs::read_to_string(of("/train.csv")).unwrap();
    let mut cut_off = 0;
    let mut lines = log.lines();
    let mut text_of_log = format!("{}\n", lines.next().unwrap());
    for line in lines {
        let (motion, torque) = line.rsplit_once(',').unwrap();
        let torque: f64 = torque.parse().unwrap();
        cut_off += usize::from(torque.abs() >= limit);
        text_of_log += &format!("{motion},{}\n", torque.clamp(-limit, limit));
    }
    case.write("cut.csv", &text_of_log);
    let (robot, train, test) = (of(".urdf"), of("/train.csv"), of("/test.csv"));
    let held_out = |train: &str| {
        let output = case.tauscope(&["identify", "--robot", &robot, "--train", train, "--test", &test, "--out", "out"]);
        assert_done(&output);
        let found: Value = serde_json::from_str(&case.read("out/identification.json")).unwrap();
        (found["without_effects"]["test_rms_nm"][0].as_f64().unwrap(), text(&output.stdout).to_owned())
    };
    let ((whole, _), (own, said)) = (held_out(&train), held_out("cut.csv"));
    // Half of the samples are cut off; taken as measurements they make the residual twice as large.
    assert!(own < 1.5 * whole, "{own} {whole}");
    assert!(said.contains(&format!("tau1 (pivot): {cut_off} samples that are cut off at a limit")), "{said}");
}

/// Bursts of 15 ms that are lost at 1 kHz leave pieces of a tenth of a second, which the smoothing window is longer than.
#[test]
fn pieces_shorter_than_the_window_are_left_out() {
    let case = Case::new(&[]);
    case.write("lift.urdf", LIFT);
    let mut log = "t,q1,tau1\n".to_owned();
    let is_lost = |row: u32| (400..415).contains(&(row % 600)) || (515..530).contains(&(row % 600));
    for row in (0..15_000).filter(|row| !is_lost(*row)) {
        let t = 0.001 * f64::from(row);
        let (mut q, mut v, mut a) = (0.0, 0.0, 0.0);
        for (size, w) in [(0.5, 1.1), (0.2, 2.9), (0.05, 6.3)] {
            let (sin, cos) = f64::sin_cos(w * t);
            (q, v, a) = (q + size * sin, v + size * w * cos, a - size * w * w * sin);
        }
        let force = 10.0 * (a + 9.81) + 1.5 * v + 3.0 * v.signum();
        writeln!(log, "{t:.4},{q:.9},{force:.9}").unwrap();
    }
    case.write("log.csv", &log);
    let output = case.tauscope(&["identify", "--robot", "lift.urdf", "--train", "log.csv", "--out", "out"]);
    assert_done(&output);
    let said = text(&output.stdout);
    assert!(said.contains("26 of 51 pieces between gaps of the logs"), "{said}");
}
