//! Files that are not there, that cannot be written, that do not name their columns, and several that are one log.

use super::{ARM, one_joint, sines};
use crate::{Case, ROOT, assert_done, assert_refusal, text};

/// Rows of time, position and torque.
fn rows() -> String {
    sines("", one_joint).trim_start().to_owned()
}

#[test]
fn a_log_that_is_not_there_is_reported_as_that() {
    let case = Case::new(&[]);
    for name in
        ["none.npz", "none.npy", "none.parquet", "none.mcap", "none.db3", "none.mat", "none", "none/", "none/a.csv"]
    {
        let said = case.tauscope(&["inspect", name]);
        assert_refusal(&said, &[name.trim_end_matches('/'), "No such file or directory"]);
        assert!(!text(&said.stderr).contains("extension"), "{}", text(&said.stderr));
    }
}

#[test]
fn a_converted_log_that_cannot_be_written_is_named_as_the_user_did() {
    let case = Case::new(&[]);
    case.write("log.csv", &format!("t,q1,tau1\n{}", rows()));
    case.write("file", "");
    for (name, words) in [
        ("x.npz", "written as .csv, .parquet"),
        ("x", "written as .csv, .parquet"),
        ("none/x.csv", "No such file or directory"),
        ("file/x.csv", "Not a directory"),
    ] {
        let said = case.tauscope(&["inspect", "log.csv", "--convert", name]);
        assert_refusal(&said, &[name, words]);
        assert!(!text(&said.stderr).contains(".tauscope"), "{}", text(&said.stderr));
    }
}

#[test]
fn a_table_without_names_is_read_by_the_numbers_of_its_columns() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    for (name, content) in
        [("log.csv", rows()), ("log.dat", rows().replace(',', " ")), ("log.txt", rows().replace(',', "\t"))]
    {
        case.write(name, &content);
        let dataset = |columns: &str| {
            let text = format!(
                "schema = \"tauscope.dataset/1\"\nrobot = \"one.urdf\"\n[[train]]\nfile = \"{name}\"\n[columns]\n{columns}\n"
            );
            case.write("d.toml", &text);
            case.tauscope(&["inspect", "--dataset", "d.toml"])
        };
        let said = dataset("time = 1\nq = [2]\ntau = [3]");
        assert_done(&said);
        assert!(text(&said.stdout).contains("1000 rows over 3.996 s at 250 Hz"), "{name}: {}", text(&said.stdout));
        assert_done(&dataset("rate_hz = 250\nq = [2]\ntau = [3]"));
        assert_refusal(&dataset("time = 1\nq = [4]\ntau = [3]"), &["column 4", "those of the file are 1 to 3"]);
        assert_refusal(&dataset(""), &["no line names the columns", "[columns] time = 1, q = [2, 3]"]);
    }
}

/// Positions in one file, torques in another, and no time in either.
#[test]
fn columns_in_several_files() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    let log = sines("t,q1,tau1", one_joint);
    let column = |place: usize, name: &str| {
        let cells = log.lines().skip(1).map(|line| line.split(',').nth(place).unwrap());
        std::iter::once(name).chain(cells).collect::<Vec<_>>().join("\n")
    };
    case.write("q.csv", &column(1, "q0"));
    case.write("tau.csv", &column(2, "tau1"));
    assert_refusal(
        &case.tauscope(&["inspect", "q.csv"]),
        &["no column of time", "none of torque", "rate_hz", "files = ["],
    );
    let dataset = |parts: &str| {
        case.write("d.toml", &format!("schema = \"tauscope.dataset/1\"\nrobot = \"one.urdf\"\n{parts}"));
    };
    dataset(
        "[[train]]\nfiles = [\"q.csv\", \"tau.csv\"]\nrate_hz = 250\nto_s = 3.0\n[[test]]\nfiles = [\"q.csv\", \"tau.csv\"]\n\
         rate_hz = 250\nfrom_s = 3.0\n",
    );
    let output = case.tauscope(&["identify", "--dataset", "d.toml", "--out", "out", "--json"]);
    assert_done(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(json["without_effects"]["test_rms_nm"][0].as_f64().unwrap() > 0.0, "{json}");
    // One of the files stands for the log that it is a part of.
    let inspected = case.tauscope(&["inspect", "tau.csv", "--dataset", "d.toml"]);
    assert_done(&inspected);
    assert!(text(&inspected.stdout).contains("1000 rows over 3.996 s at 250 Hz"), "{}", text(&inspected.stdout));
    assert_refusal(&case.tauscope(&["inspect", "tau.csv"]), &["no column of time", "none of position", "files = ["]);
    dataset("[[train]]\nfiles = [\"q.csv\", \"tau.csv\"]\nfile = \"q.csv\"\n");
    assert_refusal(&case.tauscope(&["identify", "--dataset", "d.toml", "--out", "o2"]), &["d.toml", "files = ["]);
    case.write(
        "short.csv",
        &log.lines().take(500).map(|line| line.split(',').nth(2).unwrap()).collect::<Vec<_>>().join("\n"),
    );
    dataset("[[train]]\nfiles = [\"q.csv\", \"short.csv\"]\nrate_hz = 250\n");
    assert_refusal(
        &case.tauscope(&["identify", "--dataset", "d.toml", "--out", "o3"]),
        &["1000 and 499 rows", "matched"],
    );
}

/// Units in the names of columns are used, as those of time are, and the [units] of a dataset overrule them.
#[test]
fn units_in_the_names_of_columns() {
    let case = Case::new(&[]);
    case.write("one.urdf", ARM);
    let degrees = 180.0 / std::f64::consts::PI;
    let row = |t: f64| {
        let mut cells = one_joint(t);
        let comma = cells.find(',').unwrap();
        let q: f64 = cells[..comma].parse().unwrap();
        cells.replace_range(..comma, &format!("{:.7}", degrees * q));
        cells
    };
    for header in ["t,q1 [deg],tau1 [Nm]", "t,q1_deg,tau1_nm", "t,a_position[deg],a_effort", "t,q1,tau1\ns,deg,Nm"] {
        case.write("log.csv", &sines(header, row));
        let said = case.tauscope(&["inspect", "log.csv", "--robot", "one.urdf"]);
        assert_done(&said);
        let said = text(&said.stdout);
        assert!(
            said.contains("-1.000 .. 1.000") && said.contains("positions are in deg, the unit of their names"),
            "{said}"
        );
        assert!(!said.contains("warning"), "{said}");
    }
    let dataset = "schema = \"tauscope.dataset/1\"\nrobot = \"one.urdf\"\n[[train]]\nfile = \"log.csv\"\n[units]\nposition = \"rad\"\n";
    case.write("d.toml", dataset);
    let said = text(&case.tauscope(&["inspect", "--dataset", "d.toml"]).stdout);
    assert!(said.contains("the positions are in degrees") && !said.contains("the unit of their names"), "{said}");
    // The name says rad and the numbers say degrees: these are believed, and the correction overrules the name.
    case.write("log.csv", &sines("t,q1 [rad],tau1", row));
    let said = case.tauscope(&["inspect", "log.csv", "--robot", "one.urdf", "--out", "out"]);
    assert!(text(&said.stdout).contains("the positions are in degrees"), "{}", text(&said.stdout));
    assert!(case.read("out/corrected.toml").contains("position = \"deg\""));
    let said = text(&case.tauscope(&["inspect", "--dataset", "out/corrected.toml"]).stdout);
    assert!(said.contains("-1.000 .. 1.000") && !said.contains("warning"), "{said}");
}

/// Torques that a controller computed are taken where none was measured, with a warning; currents with what makes torques of them.
#[test]
fn logs_of_ur_without_measured_torques() {
    let case = Case::new(&[]);
    let said = |columns: &str| {
        case.write("log.csv", &sines(columns, one_joint));
        let said = case.tauscope(&["inspect", "log.csv"]);
        assert_done(&said);
        text(&said.stdout)
    };
    let of_controller = said("timestamp,actual_q_0,target_moment_0");
    assert!(
        of_controller.contains("warning: tau: target_moment_0 and its like are torques that the controller"),
        "{of_controller}"
    );
    let currents = said("timestamp,actual_q_0,actual_current_0");
    assert!(currents.contains("motor currents") && currents.contains("torque_constant_nm_a"), "{currents}");
    let measured = said("timestamp,actual_q_0,joint_torque_0");
    assert!(!measured.contains("warning") && !measured.contains("current"), "{measured}");
}

/// A rod of 2 kg that swings at up to 1.2 rad/s, on a joint whose friction falls from 5 to 2 N m.
#[test]
fn friction_that_falls_with_speed_is_said_to() {
    let case = Case::new(&[]);
    std::fs::copy(format!("{ROOT}/tests/reference/pendulum.urdf"), case.path("rod.urdf")).unwrap();
    let swing = |friction: fn(f64) -> f64| {
        let mut rows = "t,q1,tau1\n".to_owned();
        for k in 0..6000 {
            let t = 0.005 * f64::from(k);
            let (sin, cos) = (1.3 * t).sin_cos();
            let (more_sin, more_cos) = (0.47 * t).sin_cos();
            let (q, v) = (0.7 * sin + 0.6 * more_sin, 0.91 * cos + 0.282 * more_cos);
            let a = -1.183 * sin - 0.132_54 * more_sin;
            let tau = 0.77 * a + 9.81 * q.sin() + friction(v) + 0.01 * (1e4 * t).sin();
            rows += &format!("{t:.3},{q:.9},{tau:.6}\n");
        }
        rows
    };
    case.write("falls.csv", &swing(|v| v.signum() * (2.0 + 3.0 * (-v.abs() / 0.5).exp())));
    case.write("rises.csv", &swing(|v| 2.0 * v.signum() + 0.4 * v));
    let identified = |log: &str| {
        let output =
            case.tauscope(&["identify", "--robot", "rod.urdf", "--train", log, "--out", log.trim_end_matches(".csv")]);
        assert_done(&output);
        text(&output.stdout)
    };
    let falls = identified("falls.csv");
    assert!(falls.contains("viscous friction is negative on pivot"), "{falls}");
    assert!(falls.contains("--effect stribeck_friction:pivot"), "{falls}");
    assert!(!identified("rises.csv").contains("negative"));
}
