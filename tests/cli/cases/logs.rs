//! Logs of other programs: each is read as it is, or refused with what it is and what to do.

use super::super::{Case, assert_done, assert_refusal, text};
use super::case;

fn inspected(case: &Case, arguments: &[&str]) -> String {
    let output = case.tauscope(&[&["inspect"], arguments].concat());
    assert_done(&output);
    text(&output.stdout)
}

/// What `inspect` reports of a log that cannot be used.
fn inspected_in_vain(case: &Case, arguments: &[&str]) -> String {
    let output = case.tauscope(&[&["inspect"], arguments].concat());
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stdout));
    text(&output.stdout)
}

#[track_caller]
fn assert_says(said: &str, words: &[&str]) {
    assert!(words.iter().all(|word| said.contains(word)), "{said} lacks one of {words:?}");
}

#[test]
#[ignore = "needs the cases folder"]
fn positions_and_torques_in_two_files() {
    let case = case("f05_airbot");
    assert_refusal(
        &case.tauscope(&["inspect", "identification_q_real.csv"]),
        &["no column of time", "none of torque", "rate_hz = 100", "files = ["],
    );
    assert_refusal(
        &case.tauscope(&["inspect", "identification_tau_real.csv"]),
        &["no column of time", "none of position", "rate_hz = 100", "files = ["],
    );
    let part = |range: &str| {
        format!("files = [\"identification_q_real.csv\", \"identification_tau_real.csv\"]\nrate_hz = 100\n{range}\n")
    };
    let [train, test] = ["to_s = 20", "from_s = 20"].map(part);
    case.write(
        "two.toml",
        &format!("schema = \"tauscope.dataset/1\"\nrobot = \"airbot.urdf\"\n[[train]]\n{train}[[test]]\n{test}"),
    );
    let output = case.tauscope(&["identify", "--dataset", "two.toml", "--out", "out", "--json"]);
    assert_done(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let torques = [0.406, 1.76, 3.87, 0.5, 0.711, 0.124];
    for (joint, torque) in torques.into_iter().enumerate() {
        let rms = json["without_effects"]["test_rms_nm"][joint].as_f64().unwrap();
        assert!(rms < 0.5 * torque, "{joint}: {rms}");
    }
    assert_says(&inspected(&case, &["airbot.csv"]), &["2998 rows", "positions are numbered from 0 and torques from 1"]);
}

#[test]
#[ignore = "needs the cases folder"]
fn tables_with_blanks_between_the_cells() {
    assert_says(&inspected(&case("f06_panda_gaz"), &["panda.txt"]), &["902 rows", "202 Hz"]);
    let case = case("f11_rtde_csv");
    for log in ["rtde_space.csv", "ur_rtde_comma.csv"] {
        let said = inspected(&case, &[log, "--robot", "ur10e.urdf"]);
        assert_says(&said, &["1500 rows", "motor currents", "wrist_3_joint"]);
    }
}

#[test]
#[ignore = "needs the cases folder"]
fn lists_in_cells_and_microseconds() {
    assert_says(
        &inspected_in_vain(&case("f08_so101_sage"), &["chirp_sweep.csv"]),
        &["6000 rows", "49.9 Hz", "time is taken to be in us"],
    );
}

/// A servo's load without its sign, of joints that stick at reversals: neither is frozen nor has another sign.
#[test]
#[ignore = "needs the cases folder"]
fn loads_without_sign() {
    let case = case("f08_so101_sage");
    for log in ["chirp_sweep", "custom_motion", "friction_gravity"] {
        for said in [
            inspected_in_vain(&case, &[&format!("{log}.csv")]),
            inspected_in_vain(&case, &[&format!("{log}_flat.csv"), "--dataset", "d.toml"]),
        ] {
            assert_says(&said, &["the signs were lost"]);
            assert!(!said.contains("frozen") && !said.contains("wrong sign"), "{said}");
        }
    }
}

#[test]
#[ignore = "needs the cases folder"]
fn files_of_other_kinds() {
    let case = case("f10_wrong_kind");
    for (file, words) in [
        ("log.bag", ["bag of ROS 1", "rosbags-convert"]),
        ("DATA_EMPS.mat", ["MATLAB", "scipy.io"]),
        ("log.xlsx", ["spreadsheet", "libreoffice"]),
        ("log.json", ["JSON", "read_json"]),
        ("log.npy", ["500 x 3", "np.savez"]),
        ("arm.sdf", ["SDF", "--robot"]),
        ("ur10e.urdf.xacro", ["xacro file", "`xacro ur10e.urdf.xacro -o robot.urdf`"]),
        ("xacro_named.urdf", ["xacro file", "`xacro xacro_named.urdf"]),
        ("sdf_named.urdf", ["SDF", "sdf2mjcf"]),
        ("so101.xml", ["MuJoCo", "--robot"]),
    ] {
        assert_refusal(&case.tauscope(&["inspect", file]), &words);
    }
    for file in ["log.npz", "log.tsv", "log.txt", "log.dat", "log_space.csv"] {
        assert_says(&inspected(&case, &[file]), &["500 rows over 4.990 s at 100.0 Hz"]);
    }
}

#[test]
#[ignore = "needs the cases folder"]
fn names_survive_every_conversion() {
    let case = case("f22_convert");
    let mut from = "a.mcap";
    for to in ["b2.csv", "c.parquet", "d.mcap", "e.db3", "f.csv"] {
        inspected(&case, &[from, "--convert", to]);
        from = to;
    }
    assert!(case.read("f.csv").starts_with("t,elbow_joint_position,shoulder_lift_joint_position,"));
    let robot = super::case("s09_coarse_clock");
    std::fs::copy(robot.path("ur5.urdf"), case.path("ur5.urdf")).unwrap();
    let lines = |log: &str| {
        let said = inspected(&case, &[log, "--robot", "ur5.urdf"]);
        said.lines().filter(|line| line.contains("_joint ")).map(str::to_owned).collect::<Vec<_>>()
    };
    let original = lines("a.mcap");
    assert_eq!(original.len(), 6);
    for log in ["b2.csv", "c.parquet", "d.mcap", "e.db3", "f.csv", "a.parquet"] {
        assert_eq!(lines(log), original, "{log}");
    }
}

#[test]
#[ignore = "needs the cases folder"]
fn lists_of_parquet() {
    let case = case("f23_lerobot");
    assert_refusal(
        &case.tauscope(&["inspect", "episode_000000.parquet"]),
        &["no column of torque", "observation.state[0..5]", "action[0..5]"],
    );
    assert_says(&inspected(&case, &["episode_effort.parquet"]), &["543 rows", "degrees"]);
}

#[test]
#[ignore = "needs the cases folder"]
fn clocks_of_few_steps() {
    let case = case("s09_coarse_clock");
    for (log, rate) in [("train.csv", "at 250.0 Hz"), ("c125_train.csv", "at 125.0 Hz")] {
        let said = inspected(&case, &[log, "--robot", "ur5.urdf"]);
        assert_says(&said, &["the clock is coarse (steps of 10.000 ms)", rate, "0 rows left out"]);
        assert!(!said.contains("warning"), "{said}");
    }
}

#[test]
#[ignore = "needs the cases folder"]
fn drivers_without_effort() {
    let case = case("s20_zero_effort");
    let inspect = |bag: &str| case.tauscope(&["inspect", bag, "--robot", "ur5.urdf"]);
    let zero = inspect("bag_a");
    assert_eq!(zero.status.code(), Some(2));
    assert_says(&text(&zero.stderr), &["zero on all joints", "does not report it"]);
    assert_refusal(&inspect("bag_b"), &["torque", "driver"]);
    let velocity = inspect("bag_c");
    assert_done(&velocity);
    assert_says(&text(&velocity.stdout), &["the velocity of wrist_1_joint holds no value"]);
    let torque = inspect("bag_d");
    assert_done(&torque);
    assert_says(&text(&torque.stdout), &["tau6 (wrist_3_joint): there is no torque of this joint in the log"]);
}
