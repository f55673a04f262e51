//! Bad input: every refusal names the file and line, the key or the joint, and leaves nothing behind.

use super::{ARM, one_joint, sines};
use crate::{Case, ROOT, assert_done, assert_refusal, text};

#[test]
fn scenario_keys() {
    for (from, to, words) in [
        ("schema", "foo = 1\nschema", ["s.toml:2: foo", "unknown field `foo`"]),
        ("step_s = 0.001", "step_s = 0.001\nstp = 1", ["s.toml:13: stp", "unknown field `stp`"]),
        ("seed = 1600\n", "", ["s.toml:1: seed", "missing field"]),
        ("step_s = 0.001\n", "", ["s.toml:10: plant.step_s", "missing field"]),
        ("[sensors]", "[sensorz]", ["s.toml:30: sensorz", "unknown field"]),
        ("seed = 1600", "seed = -1", ["s.toml:4: seed", "-1"]),
        ("seed = 1600", "seed = 1.5", ["s.toml:4: seed", "invalid type"]),
        ("seed = 1600", "seed = 1600\nseed = 1", ["s.toml:5: seed", "duplicate key"]),
        ("[robot]", "[robot", ["s.toml:6", "unclosed table"]),
        ("scenario/1", "scenario/9", ["s.toml:2: schema", "scenario/9"]),
        ("\"short\"", "\"../x\"", ["s.toml:3: name", "../x"]),
        ("\"rk4\"", "\"euler\"", ["s.toml:11: integrator", "rapier_native"]),
        ("\"irb1600_6_120\"", "\"ur10\"", ["s.toml:8: robot.name", "the scenario is for `ur10`"]),
        ("arm.urdf", "none.urdf", ["none.urdf", "No such file"]),
        ("[motion.random]", "[motion]\nfile = \"m.toml\"\n[motion.random]", ["s.toml:22: motion", "exactly one"]),
        ("\"arm.urdf\"", "\".\"", [".: cannot read the URDF", "directory"]),
    ] {
        Case::new(&[(from, to)]).assert_refused(&words);
    }
}

#[test]
fn scenario_numbers() {
    let torque = "torque_noise_nm = [3.0, 4.0, 2.0, 0.45, 0.35, 0.18]";
    for (from, to, words) in [
        (torque, "torque_noise_nm = [1.0, 2.0]", ["s.toml:34: sensors.torque_noise_nm", "2 values for 6 joints"]),
        (torque, "torque_noise_nm = []", ["s.toml:34: sensors.torque_noise_nm", "0 values for 6 joints"]),
        (torque, "torque_noise_nm = \"a\"", ["s.toml:34: torque_noise_nm", "one number per joint"]),
        (torque, "torque_noise_nm = nan", ["s.toml:34: sensors.torque_noise_nm", "NaN"]),
        (torque, "torque_noise_nm = 1e400", ["s.toml:34: torque_noise_nm", "overflow"]),
        (torque, "torque_noise_nm = 1e300", ["s.toml:34: sensors.torque_noise_nm", "1e9"]),
        (torque, "torque_noise_nm = -0.1", ["s.toml:34: sensors.torque_noise_nm", "-0.1"]),
        ("resolution_rad = 1e-5", "resolution_rad = 1e-320", ["s.toml:32: sensors.encoder_resolution_rad", "zero"]),
        ("rate_hz = 500.0", "rate_hz = inf", ["s.toml:31: sensors.rate_hz", "inf"]),
        ("rate_hz = 500.0", "rate_hz = -0.0", ["s.toml:31: sensors.rate_hz", "above zero"]),
        ("rate_hz = 500.0", "rate_hz = 300.0", ["s.toml:31: sensors.rate_hz", "3.3333 plant steps"]),
        ("rate_hz = 500.0", "rate_hz = 5000.0", ["s.toml:31: sensors.rate_hz", "plant steps"]),
        ("window = 61", "window = 0", ["s.toml:38: identification.smoothing_window", "odd"]),
        ("window = 61", "window = 60", ["s.toml:38: identification.smoothing_window", "odd"]),
        ("window = 61", "window = -61", ["s.toml:38: smoothing_window", "-61"]),
        ("window = 61", "window = 1000000001", ["s.toml:38: identification.smoothing_window", "at most"]),
        ("window = 61", "window = 5001", ["s.toml:22: motion.random", "fewer than the 5001"]),
        ("order = 6", "order = 61", ["s.toml:39: identification.smoothing_order", "below 61"]),
        ("order = 6", "order = 1", ["s.toml:39: identification.smoothing_order", "at least 2"]),
        ("decimation = 5", "decimation = 0", ["s.toml:40: identification.decimation", "1 or more"]),
        ("band_rad_s = 0.03", "band_rad_s = nan", ["s.toml:41: identification.reversal_band_rad_s", "NaN"]),
        ("model_error = 0.1", "model_error = 1.0", ["s.toml:17: controller.model_error", "0 .. 1"]),
        ("bandwidth_hz = 5.0", "bandwidth_hz = 1e300", ["s.toml:15: controller.bandwidth_hz", "1e300"]),
        ("moves = 6", "moves = 1", ["s.toml:23: motion.random.moves", "2 moves or more"]),
        ("moves = 6", "moves = 9000000000000000000", ["s.toml:23: motion.random.moves", "at most"]),
        ("duration_s = 4.0", "duration_s = -4.0", ["s.toml:24: motion.random.duration_s", "above zero"]),
        ("duration_s = 4.0", "duration_s = 0.1", ["s.toml:22: motion.random", "51 samples, fewer"]),
    ] {
        Case::new(&[(from, to)]).assert_refused(&words);
    }
    let gravity = "[plant]";
    Case::new(&[(gravity, "gravity_m_s2 = [0, 0, 1e300]\n[plant]")]).assert_refused(&["s.toml:10: robot.gravity_m_s2"]);
}

#[test]
fn the_effect_at_fault() {
    let good = "[[effect]]\nname = \"coulomb_friction\"\njoint = \"joint_1\"\n";
    let band = "band_rad_s = 0.03\n";
    for (bad, words) in [
        ("[[effect]]\nname = \"stribek\"\n", ["s.toml:45: effect 2", "stribek"]),
        ("[[effect]]\nname = \"coulomb_friction\"\n", ["s.toml:45: effect 2", "name one of joint_1"]),
        ("[[effect]]\nname = \"coulomb_friction\"\njoint = \"elbow\"\n", ["s.toml:45: effect 2", "joint `elbow`"]),
        ("[[effect]]\njoint = \"joint_1\"\n", ["s.toml:45: effect.name", "missing field"]),
    ] {
        Case::new(&[(band, &format!("{band}{good}{bad}"))]).assert_refused(&words);
    }
}

/// Demands that no machine can meet are refused before memory or hours are spent on them.
#[test]
fn absurd_sizes() {
    for (edits, words) in [
        (&[("duration_s = 4.0", "duration_s = 1e12")][..], ["s.toml:22: motion.random", "samples"]),
        (&[("duration_s = 4.0", "duration_s = 1e300")], ["s.toml:22: motion.random", "samples"]),
        (&[("step_s = 0.001", "step_s = 1e-12")], ["s.toml:22: motion.random", "steps"]),
        (&[("step_s = 0.001", "step_s = 1e-9"), ("rate_hz = 500.0", "rate_hz = 1e9")], ["motion.random", "samples"]),
    ] {
        Case::new(edits).assert_refused(&words);
    }
}

#[test]
fn files_that_are_no_scenario() {
    let case = Case::new(&[]);
    case.write("empty.toml", "");
    case.write("dataset.toml", "schema = \"tauscope.dataset/1\"\n[[train]]\nfile = \"log.csv\"\n");
    std::fs::write(case.path("binary.toml"), [0xff, 0xfe, 0]).unwrap();
    for (file, words) in [
        ("none.toml", ["none.toml", "No such file"]),
        (".", [".: cannot read the scenario", "directory"]),
        ("empty.toml", ["empty.toml:1: schema", "missing field"]),
        ("binary.toml", ["binary.toml", "UTF-8"]),
        ("arm.urdf", ["arm.urdf: the scenario", "with --robot"]),
        ("dataset.toml", ["dataset.toml: the scenario", "give it with --dataset"]),
    ] {
        assert_refusal(&case.tauscope(&["run", file]), &words);
        assert_refusal(&case.tauscope(&["simulate", file]), &words);
    }
}

#[test]
fn numbers_in_a_urdf() {
    let mass = "<mass value=\"103.8\"";
    for (from, to, words) in [
        (mass, "<mass value=\"NaN\"", ["arm.urdf:51: value of <mass> in `link_1`", "finite"]),
        (mass, "<mass value=\"1e400\"", ["arm.urdf:51: value of <mass>", "finite"]),
        (mass, "<mass value=\"1e300\"", ["arm.urdf:51: value of <mass>", "1e9"]),
        (mass, "<mass value=\"abc\"", ["arm.urdf:51: value of <mass>", "abc"]),
        ("<mass value=\"103.8\"", "<mass was=\"103.8\"", ["arm.urdf:51: value of <mass>", "missing"]),
        ("<mass value=\"103.8\"", "<mass value=\"-5\"", ["arm.urdf:48: link `link_1`", "negative"]),
        ("ixx=\"2.1948\"", "ixx=\"1e3\"", ["link `link_1`", "triangle inequality"]),
        ("ixx=\"2.1948\"", "ixx=\"-1\"", ["link `link_1`", "negative principal moment"]),
        ("<axis xyz=\"0 0 1\"", "<axis xyz=\"0 0\"", ["xyz of <axis> in `joint_1`", "3 number(s), found 2"]),
        ("<axis xyz=\"0 0 1\"", "<axis xyz=\"0 0 0\"", ["joint `joint_1`", "no direction"]),
        ("effort=\"1400\"", "effort=\"-1\"", ["joint `joint_1`", "must not be negative"]),
        ("friction=\"60\"", "friction=\"-60\"", ["joint `joint_1`", "friction -60"]),
        ("armature=\"45\"", "armature=\"-45\"", ["joint `joint_1`", "armature"]),
    ] {
        Case::new(&[]).with_urdf(from, to).assert_refused(&words);
    }
}

#[test]
fn a_tree_is_shown_with_what_is_held() {
    let case = Case::new(&[]);
    case.write("arm.urdf", &std::fs::read_to_string(format!("{ROOT}/tests/reference/branching.urdf")).unwrap());
    let output = case.tauscope(&["robot", "arm.urdf", "--joints", "right_joint", "--json"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.contains("tauscope.robot/1"), "{text}");
    let shown: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(shown["dof"], 1);
    let roles: Vec<&str> = shown["joints"].as_array().unwrap().iter().map(|j| j["role"].as_str().unwrap()).collect();
    assert!(roles.contains(&"coordinate") && roles.contains(&"held"), "{text}");
    let output = case.tauscope(&["robot", "arm.urdf", "--joints", "no_such_joint"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn arms_that_are_no_chain() {
    let case = Case::new(&[]);
    case.write("arm.urdf", &std::fs::read_to_string(format!("{ROOT}/tests/reference/cyclic.urdf")).unwrap());
    case.assert_refused(&["arm.urdf:54: joint `closing_joint`", "closed loop"]);
    for (from, to, words) in [
        ("</robot>", "", ["arm.urdf:1: XML", "not well-formed"]),
        ("name=\"joint_3\"", "name=\"joint_2\"", ["joint `joint_2`", "two joints have this name"]),
        ("<link name=\"link_3\"", "<link name=\"link_2\"", ["link `link_2`", "two links have this name"]),
        ("<parent link=\"link_2\"", "<parent link=\"link_9\"", ["joint `joint_3`", "no link `link_9`"]),
    ] {
        Case::new(&[]).with_urdf(from, to).assert_refused(&words);
    }
    let case = Case::new(&[]);
    for (text, words) in [("", ["arm.urdf:1: XML", "root"]), ("<html/>", ["arm.urdf: <robot>", "there is no link"])] {
        case.write("arm.urdf", text);
        case.assert_refused(&words);
    }
}

/// A motion file for the IRB 1600 in which joint 2 goes out to `via` and back in 4 s.
fn motion_file(via: f64) -> String {
    let mut text = String::from(
        "schema = \"tauscope.motion/1\"\nrobot = \"irb1600_6_120\"\n\
         joints = [\"joint_1\", \"joint_2\", \"joint_3\", \"joint_4\", \"joint_5\", \"joint_6\"]\n\
         kind = \"freudenstein\"\n[data]\nduration_s = 4.0\n",
    );
    for joint in 1..=6 {
        let via = if joint == 2 { via } else { 0.3 };
        text += &format!("[[data.joints]]\nduration_s = [2.0, 2.0]\nvia = [{via}]\n");
    }
    text
}

#[test]
fn motions_outside_the_limits() {
    let case =
        Case::new(&[("[held_out.random]", "[held_out]\nfile = \"m.toml\""), ("moves = 3\nduration_s = 4.0\n", "")]);
    case.write("m.toml", &motion_file(2.5));
    // Joint 2 goes to 110 degrees, 1.9199 rad.
    let position = "2.50000 rad (143.24 deg) at t = 2.0000 s passes the upper position limit";
    case.assert_refused(&["s.toml:27: held_out.file", "joint_2", position, "by 5.801e-1 rad"]);
    case.write("m.toml", &motion_file(1.5).replace("irb1600_6_120", "other").replace("joint_3", "elbow"));
    case.assert_refused(&["s.toml:27: held_out.file", "joint 3 is \"elbow\""]);
    case.write("m.toml", &motion_file(1.5).replace("via = [1.5]", "via = [nan]"));
    case.assert_refused(&["m.toml:5", "joint 2: via"]);
    case.write("m.toml", "");
    case.assert_refused(&["m.toml:1: schema", "missing field"]);
    std::fs::remove_file(case.path("m.toml")).unwrap();
    case.assert_refused(&["m.toml", "No such file"]);
}

/// An arm whose range leaves out zero has no motion from there, and says which joint it is.
#[test]
fn a_range_without_zero() {
    Case::new(&[]).with_urdf("lower=\"-1.0995574287564276\"", "lower=\"0.2\"").assert_refused(&[
        "s.toml:22: motion.random",
        "joint 2",
        "lower limit",
    ]);
}

#[test]
fn identification_without_enough_motion() {
    Case::new(&[("band_rad_s = 0.03", "band_rad_s = 100.0")]).assert_refused(&["exact signals", "joint 1", "0 usable"]);
}

#[test]
fn torques_without_their_signs_stop_inspect_and_identify() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    let mut log = "t,q1,tau1\n".to_owned();
    for i in 0..4000 {
        let t = 0.004 * f64::from(i);
        let (q, v, a) = ((3.0 * t).sin(), 3.0 * (3.0 * t).cos(), -9.0 * (3.0 * t).sin());
        log += &format!("{t:.4},{q:.9},{:.9}\n", (2.0 * a + 1.5 * v + 3.0 * v.signum()).abs());
    }
    case.write("log.csv", &log);
    let output = case.tauscope(&["inspect", "log.csv", "--robot", "one.urdf"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stdout).contains("fatal: tau1 (a)"), "{}", text(&output.stdout));
    assert_refusal(&case.tauscope(&["identify", "--robot", "one.urdf", "--train", "log.csv"]), &["log.csv", "sign"]);
}

#[test]
fn inertias_that_say_nothing_are_named() {
    let case = Case::new(&[]);
    let (inertial, end) = (ARM.find("<inertial>").unwrap(), ARM.find("</inertial>").unwrap() + "</inertial>".len());
    case.write("one.urdf", &format!("{}{}", &ARM[..inertial], &ARM[end..]));
    case.write("log.csv", &sines("t,q1,tau1", one_joint));
    let identify = ["identify", "--robot", "one.urdf", "--train", "log.csv", "--out", "out"];
    for arguments in [&["inspect", "log.csv", "--robot", "one.urdf"][..], &identify] {
        let output = case.tauscope(arguments);
        assert_done(&output);
        assert!(text(&output.stdout).contains("describes no inertias"), "{}", text(&output.stdout));
    }
}
