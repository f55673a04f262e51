use super::*;
use crate::channels::Channels;
use crate::error::Result;
use crate::quality;
use crate::quality::descriptions::Description;
use crate::recording::Recording;
use crate::robot::{InertiaCheck, Robot, load};
use nalgebra::Vector3;
use std::f64::consts::PI;
use tempfile::TempDir;

const ARM: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
const TWO: &str = r#"<robot name="two"><link name="base"/>
<joint name="a" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="9" velocity="9"/></joint>
<link name="l1"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="b" type="revolute"><origin xyz="1 0 0"/><parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="9" velocity="9"/></joint>
<link name="l2"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
</robot>"#;

struct Case {
    folder: TempDir,
}

impl Case {
    fn new(dataset: &str, log: &str) -> Case {
        let folder = tempfile::tempdir().unwrap();
        let text = format!("schema = \"{SCHEMA}\"\n{dataset}");
        std::fs::write(folder.path().join("d.toml"), text).unwrap();
        std::fs::write(folder.path().join("log.csv"), log).unwrap();
        std::fs::write(folder.path().join("two.urdf"), TWO).unwrap();
        Case { folder }
    }

    fn dataset(&self) -> Result<Dataset> {
        Dataset::load(self.folder.path().join("d.toml"))
    }

    fn robot(&self) -> Robot {
        load(self.folder.path().join("two.urdf"), InertiaCheck::Required).unwrap()
    }

    fn read(&self) -> Result<Recording> {
        let read = self.dataset()?.read(&self.folder.path().join("log.csv"), &self.robot());
        read.map(|sieved| sieved.recording)
    }
}

fn assert_close(found: &Channels, expected: &[&[f64]]) {
    for (joint, expected) in expected.iter().enumerate() {
        for (a, b) in found.channel(joint).iter().zip(*expected) {
            assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "joint {joint}: {a} for {b}");
        }
    }
}

#[test]
fn motor_currents_in_odd_units_come_to_the_joints() {
    let case = Case::new(
        "joints = [\"b\", \"a\"]\n[[train]]\nfile = \"log.csv\"\n[columns]\ntime = \"ms\"\nq = [\"e1\", \"e2\"]\n\
         qd = [\"n1\", \"n2\"]\ntau = [\"i1\", \"i2\"]\n[units]\ntime = \"ms\"\nposition = \"deg\"\nvelocity = \"rpm\"\n\
         torque = \"mA\"\n[motors]\ngear_ratio = [100, 50]\ntorque_constant_nm_a = 0.2\nsign = [1, -1]\n\
         position_at = \"motor\"\n",
        "ms,e1,e2,n1,n2,i1,i2\n0,9000,4500,600,300,1500,-500\n4,18000,0,0,0,0,0\n",
    );
    let log = case.read().unwrap();
    assert_eq!(log.joints, ["a", "b"]);
    assert_close(&Channels::from_vectors(&[log.time]), &[&[0.0, 0.004]]);
    assert_close(&log.q, &[&[-PI / 2.0, 0.0], &[PI / 2.0, PI]]);
    // 300 rpm over 50 is 6 rpm, sign reversed; 600 rpm over 100 too.
    assert_close(&log.qd.unwrap(), &[&[-0.2 * PI], &[0.2 * PI]]);
    // -0.5 A x 0.2 N m/A x 50, sign reversed; 1.5 A x 0.2 x 100.
    assert_close(&log.tau, &[&[5.0], &[30.0]]);
}

#[test]
fn each_joint_may_have_a_unit_of_its_own() {
    let units = |units: &str| {
        let log = "t,q1,q2,qd1,qd2,tau1,tau2\n0,90,250,180,-40,1,2\n1,90,250,180,-40,1,2\n";
        Case::new(&format!("[[train]]\nfile = \"log.csv\"\n[units]\n{units}\n"), log).read()
    };
    let log = units("position = [\"deg\", \"mm\"]\nvelocity = [\"deg/s\", \"mm/s\"]").unwrap();
    assert_close(&log.q, &[&[PI / 2.0; 2], &[0.25; 2]]);
    assert_close(&log.qd.unwrap(), &[&[PI; 2], &[-0.04; 2]]);
    let message = |text: &str| units(text).unwrap_err().to_string();
    assert!(message("position = [\"deg\"]").contains("1 units for 2 joints"));
    assert!(message("position = [\"deg\", \"ft\"]").contains("unknown unit `ft`"));
}

#[test]
fn coupling_keeps_the_power() {
    let case = Case::new(
        "[[train]]\nfile = \"log.csv\"\n[motors]\ncoupling = [[1.0, 0.0], [0.5, 2.0]]\ntorque_sign = [1, -1]\n",
        "t,q1,q2,qd1,qd2,tau1,tau2\n0,1,2,3,-1,5,-7\n1,1,2,3,-1,5,-7\n",
    );
    let log = case.read().unwrap();
    assert_close(&log.q, &[&[1.0], &[4.5]]);
    let qd = log.qd.unwrap();
    let power = (0..2).map(|j| qd.channel(j)[0] * log.tau.channel(j)[0]).sum::<f64>();
    assert!((power - (3.0 * 5.0 - 7.0)).abs() < 1e-12, "{power}");
}

#[test]
fn payload_and_mounting() {
    let mut robot = load(ARM, InertiaCheck::Required).unwrap();
    let before = robot.clone();
    let case = Case::new(
        "[[train]]\nfile = \"log.csv\"\n[payload]\nmass_kg = 5.0\ncenter_m = [0, 0, 0.1]\n[mounting]\n\
         gravity_m_s2 = [0, 0, 9.81]\n",
        "",
    );
    case.dataset().unwrap().mount(&mut robot).unwrap();
    assert_eq!(robot.gravity.as_slice(), [0.0, 0.0, 9.81]);
    let (own, old) = (robot.joints[5].inertia, before.joints[5].inertia);
    assert!((own.mass() - old.mass() - 5.0).abs() < 1e-12);
    let tip = before.flange.rotation * Vector3::new(0.0, 0.0, 0.1) + before.flange.translation;
    assert!((own.first_moment() - old.first_moment() - 5.0 * tip).norm() < 1e-12);
    let impossible = Case::new("[[train]]\nfile = \"log.csv\"\n[payload]\nmass_kg = -1.0\n", "");
    let error = impossible.dataset().unwrap().mount(&mut robot).unwrap_err().to_string();
    assert!(error.contains("d.toml:4: payload") && error.contains("negative"), "{error}");
}

#[test]
fn a_part_of_a_file() {
    let rows: String = (0..2000)
        .map(|i| {
            let t = 0.005 * f64::from(i);
            format!("{t},{},{},{},{}\n", (3.0 * t).sin(), (4.0 * t).cos(), (2.0 * t).sin(), (5.0 * t).cos())
        })
        .collect();
    let parts = "[[train]]\nfile = \"log.csv\"\nto_s = 6.0\n[[test]]\nfile = \"log.csv\"\nfrom_s = 6.0\n";
    let case = Case::new(parts, &format!("t,q1,q2,tau1,tau2\n{rows}"));
    let logs = super::ready(case.dataset().unwrap().sieved(&case.robot()).unwrap(), &case.robot()).unwrap();
    assert_eq!((logs.train[0].samples(), logs.test[0].samples()), (1200, 800));
    assert!(logs.train[0].time[1199] < 6.0 && logs.test[0].time[0] >= 6.0);
    let beyond = Case::new("[[train]]\nfile = \"log.csv\"\nfrom_s = 20\n", &format!("t,q1,q2,tau1,tau2\n{rows}"));
    let error = beyond.dataset().unwrap().sieved(&beyond.robot()).unwrap_err().to_string();
    assert!(error.contains("d.toml:2: train") && error.contains("clock goes from 0 s to 9.995 s"), "{error}");
}

#[test]
fn a_log_is_ready_once() {
    let rows: String = (0..2000)
        .map(|i| {
            let t = 0.005 * f64::from(i);
            format!("{t},{},{},{},{}\n", (3.0 * t).sin(), (4.0 * t).cos(), (2.0 * t).sin(), (5.0 * t).cos())
        })
        .collect();
    let log = format!("t,q1,q2,tau1,tau2\n{rows}");
    let case = Case::new("[[train]]\nfile = \"log.csv\"\n[[test]]\nfile = \"copy.csv\"\n", &log);
    std::fs::write(case.folder.path().join("copy.csv"), log).unwrap();
    let refused = super::ready(case.dataset().unwrap().sieved(&case.robot()).unwrap(), &case.robot()).unwrap_err();
    let refused = refused.to_string();
    assert!(
        refused.contains("copy.csv: has the samples of ") && refused.contains("log.csv; give every log once"),
        "{refused}"
    );
}

#[test]
fn stamps_in_nanoseconds() {
    let rows: String = (0..60u64).map(|i| format!("{},1,2,3,4\n", 1_700_000_000_000_000_000 + 5_000_000 * i)).collect();
    let train = "[[train]]\nfile = \"log.csv\"\n[units]\ntime = \"ns\"\n";
    let log = Case::new(train, &format!("t,q1,q2,tau1,tau2\n{rows}")).read().unwrap();
    assert!(
        (log.samples(), log.time[0].round()) == (60, 1.7e9) && (log.rate_hz() - 200.0).abs() < 0.1,
        "{}",
        log.rate_hz()
    );
}

#[test]
fn mistakes_are_named_by_line_and_key() {
    let train = "[[train]]\nfile = \"log.csv\"\n";
    let log = "t,q1,q2,tau1,tau2\n0,1,2,3,4\n1,2,3,4,5\n";
    for (text, words) in [
        ("".to_owned(), ["train", "at least one log"]),
        (format!("{train}[[test]]\nfile = \"log.csv\"\n"), ["d.toml:4: test", "trained from"]),
        (format!("{train}to_s = 2\n[[test]]\nfile = \"log.csv\"\nfrom_s = 1\n"), ["d.toml:5: test", "trained from"]),
        (format!("{train}from_s = 3\nto_s = 2\n"), ["d.toml:2: train", "from 3 s to 2 s"]),
        (format!("{train}to_s = nan\n"), ["d.toml:2: train", "to NaN s"]),
        (format!("{train}[unit]\n"), ["d.toml:4: unit", "unknown field"]),
        (format!("{train}[units]\nposition = \"gon\"\n"), ["d.toml:5: ", "unknown unit `gon`"]),
        (format!("{train}[units]\ntorque = \"A\"\n"), ["motors.torque_constant_nm_a", "current"]),
        (format!("{train}[motors]\nposition_at = \"motor\"\n"), ["motors.gear_ratio", "at the motors"]),
        (
            format!("{train}[motors]\ngear_ratio = [1, 2, 3]\n"),
            ["d.toml:5: motors.gear_ratio", "3 values for 2 joints"],
        ),
        (format!("{train}[motors]\ngear_ratio = 0\n"), ["d.toml:5: motors.gear_ratio", "other than zero"]),
        (format!("{train}[motors]\nsign = 2\n"), ["d.toml:5: motors.sign", "2 is no sign"]),
        (format!("{train}[motors]\nsign = \"x\"\n"), ["d.toml:5: sign", "one number per joint"]),
        (format!("{train}[motors]\ncoupling = [[1, 1], [1, 1]]\n"), ["d.toml:5: motors.coupling", "singular"]),
        (format!("{train}[motors]\ncoupling = [[1, 1]]\n"), ["d.toml:5: motors.coupling", "2 rows of 2"]),
        (format!("joints = [\"a\", \"x\"]\n{train}"), ["d.toml:2: joints", "robot's joints a, b"]),
        (format!("{train}[columns]\nq = [\"x\", \"y\"]\n"), ["log.csv: x", "no such column"]),
    ] {
        let error = Case::new(&text, log).read().unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{text}: {error}");
    }
    let folder = Case::new("", "");
    std::fs::write(folder.folder.path().join("d.toml"), "schema = \"x/1\"\n").unwrap();
    assert!(folder.dataset().unwrap_err().to_string().contains("d.toml:1: schema: `x/1` is not known"));
    std::fs::write(folder.folder.path().join("d.toml"), "robot = \"arm.urdf\"\n").unwrap();
    let missing = folder.dataset().unwrap_err().to_string();
    assert!(missing.contains("is missing: begin the file with schema = \"tauscope.dataset/1\""), "{missing}");
}

#[test]
fn offsets_exchanges_and_a_wrong_clock_are_put_right() {
    let case = Case::new(
        "[[train]]\nfile = \"log.csv\"\n[units]\ntime_factor = 1.6\n[motors]\ntorque_offset = [0.5, 0.0]\n\
         position_offset = [0.0, 10.0]\n\
         torques_exchanged = [[\"a\", \"b\"]]\npositions_exchanged = [[\"b\", \"a\"]]\n",
        "t,q1,q2,tau1,tau2\n0,1,2,3.5,4\n1,5,6,7.5,8\n",
    );
    let log = case.read().unwrap();
    assert_close(&Channels::from_vectors(&[log.time]), &[&[0.0, 1.6]]);
    assert_close(&log.q, &[&[12.0, 16.0], &[1.0, 5.0]]);
    assert_close(&log.tau, &[&[4.0, 8.0], &[3.0, 7.0]]);
    for (key, word) in
        [("units]\ntime_factor = 0.0", "above zero"), ("motors]\ntorques_exchanged = [[\"a\", \"x\"]]", "`x`")]
    {
        let case =
            Case::new(&format!("[[train]]\nfile = \"log.csv\"\n[{key}\n"), "t,q1,q2,tau1,tau2\n0,1,2,3,4\n1,5,6,7,8\n");
        let problem = case.read().unwrap_err().to_string();
        assert!(problem.contains(word), "{problem}");
    }
}

/// A dataset with changes reads as the log does that the changes are applied to, whatever the dataset does already.
#[test]
fn a_corrected_dataset_reads_the_corrected_log() {
    use crate::quality::descriptions::Change;
    let more = "[motors]\ngear_ratio = [2, 3]\nsign = [1, -1]\ntorque_at = \"motor\"\nposition_offset = [0.5, -0.25]\n";
    for joints in ["", "joints = [\"b\", \"a\"]\n"] {
        let case = Case::new(
            &format!("robot = \"two.urdf\"\n{joints}[[train]]\nfile = \"log.csv\"\n{more}"),
            "t,q1,q2,tau1,tau2\n0,1,2,3,4\n1,5,6,7,8\n",
        );
        let robot = case.robot();
        for changes in [
            vec![Change::TorqueSign(0)],
            vec![Change::AxisSign(1), Change::TorqueExchange(0, 1)],
            vec![Change::PositionSign(0), Change::JointExchange(0, 1)],
            vec![Change::ZeroOffset(0, 1.5)],
            vec![Change::AxisSign(1), Change::ZeroOffset(1, -0.5), Change::JointExchange(0, 1)],
            vec![Change::AllTorqueSigns, Change::Gravity([9.81, 0.0, 0.0])],
        ] {
            let start = Description::as_given(2, robot.gravity);
            let description = changes.iter().fold(start, |description, &change| description.with(change));
            let mut expected = case.read().unwrap();
            description.apply(&mut expected);
            let dataset = case.dataset().unwrap();
            let units = quality::UnitChanges::default();
            let text = corrected(Some(&dataset), &Named::default(), &robot, &description, units).unwrap();
            let path = case.folder.path().join("corrected.toml");
            std::fs::write(&path, &text).unwrap();
            let again = Dataset::load(&path).unwrap();
            let mut mounted = robot.clone();
            again.mount(&mut mounted).unwrap();
            assert_eq!(mounted.gravity, description.gravity);
            let found = again.read(&case.folder.path().join("log.csv"), &robot).unwrap().recording;
            assert_eq!((found.q, found.tau), (expected.q, expected.tau), "{changes:?}\n{text}");
        }
    }
}

/// A table of plain numbers, whose columns the dataset numbers.
#[test]
fn columns_of_a_file_without_names_are_numbered() {
    let of = |columns: &str, log: &str| {
        Case::new(&format!("[[train]]\nfile = \"log.csv\"\n[columns]\n{columns}"), log).read()
    };
    let rows = "0 1 2 3 4\n1 5 6 7 8\n";
    let log = of("time = 1\nq = [3, 2]\ntau = [5, 4]\n", rows).unwrap();
    assert_eq!(log.time, [0.0, 1.0]);
    assert_close(&log.q, &[&[2.0, 6.0], &[1.0, 5.0]]);
    assert_close(&log.tau, &[&[4.0, 8.0], &[3.0, 7.0]]);
    for (columns, words) in [
        ("time = 1\nq = [2, 9]\ntau = [4, 5]\n", "column 9: there is no such column; those of the file are 1 to 5"),
        ("time = 1\nq = [2.5, 3]\ntau = [4, 5]\n", "the name of a column, or its number counted from 1"),
        ("", "no line names the columns"),
    ] {
        let error = of(columns, rows).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

/// Positions whose unit nothing settles make no identification, as they make no diagnosis.
#[test]
fn positions_in_an_unknown_unit_are_refused() {
    let rows: String = (0..4000)
        .map(|i| {
            let t = 0.005 * f64::from(i);
            let counts = |rate: f64| (2048.0 + 900.0 * (rate * t).sin()).round();
            format!("{t},{},{},{:.6},{:.6}\n", counts(1.7), counts(2.3), (1.7 * t).cos(), (2.3 * t).cos())
        })
        .collect();
    let case = Case::new("[[train]]\nfile = \"log.csv\"\n", &format!("t,q1,q2,tau1,tau2\n{rows}"));
    let refused = super::ready(case.dataset().unwrap().sieved(&case.robot()).unwrap(), &case.robot()).unwrap_err();
    let refused = refused.to_string();
    assert!(refused.contains("the log cannot be used: positions up to") && refused.contains("gear_ratio"), "{refused}");
}

/// One of two logs is in degrees: no unit of a dataset is right for both.
#[test]
fn logs_in_two_units_of_position_are_refused_by_the_file_to_convert() {
    let rows = |unit: f64, seed: f64| -> String {
        let row = |i: u32| {
            let t = 0.005 * f64::from(i);
            let q = |rate: f64| unit * 1.5 * (rate * t + seed).sin();
            format!("{t},{},{},{:.6},{:.6}\n", q(1.7), q(2.3), (1.7 * t).cos(), (2.3 * t).cos())
        };
        (0..4000).map(row).collect()
    };
    let header = "t,q1,q2,tau1,tau2\n";
    let case = Case::new(
        "[[train]]\nfile = \"log.csv\"\n[[test]]\nfile = \"other.csv\"\n",
        &format!("{header}{}", rows(1.0, 0.0)),
    );
    std::fs::write(case.folder.path().join("other.csv"), format!("{header}{}", rows(180.0 / PI, 1.0))).unwrap();
    let refused = super::ready(case.dataset().unwrap().sieved(&case.robot()).unwrap(), &case.robot()).unwrap_err();
    let refused = refused.to_string();
    assert!(refused.contains("other.csv") && refused.contains("convert this file"), "{refused}");
}

/// A torque without its sign determines nothing; where no other is left the log is refused.
#[test]
fn a_torque_without_its_sign_is_left_out() {
    let log = |signs: [bool; 2]| {
        let rows: String = (0..4000)
            .map(|i| {
                let t = 0.005 * f64::from(i);
                let own = |rate: f64, lost: bool| {
                    let tau = (rate * t).cos() - 0.3 * (rate * t).sin();
                    format!("{:.9}", if lost { tau.abs() } else { tau })
                };
                format!("{t},{},{},{},{}\n", (1.7 * t).sin(), (2.3 * t).sin(), own(1.7, signs[0]), own(2.3, signs[1]))
            })
            .collect();
        let case = Case::new("[[train]]\nfile = \"log.csv\"\n", &format!("t,q1,q2,tau1,tau2\n{rows}"));
        super::ready(case.dataset().unwrap().sieved(&case.robot()).unwrap(), &case.robot())
    };
    let one = log([false, true]).unwrap();
    assert!(one.train[0].has_torque(0) && !one.train[0].has_torque(1));
    assert!(
        one.notes.iter().any(|note| note.contains("without its sign is left out") && note.ends_with(": b")),
        "{:?}",
        one.notes
    );
    let refused = log([true, true]).unwrap_err().to_string();
    assert!(refused.contains("cannot be used") && refused.contains("sign"), "{refused}");
}

#[test]
fn degrees_of_a_dataset_stay_however_small() {
    let text = "[[train]]\nfile = \"log.csv\"\n[units]\nposition = UNIT\n";
    for unit in ["\"deg\"", "[\"deg\", \"deg\"]"] {
        for (last, is_noted) in [(-6.2, true), (-6.3, false)] {
            let rows = format!("t,q1,q2,tau1,tau2\n0,0.5,-1,1,2\n1,1.5,{last},1,2\n");
            let case = Case::new(&text.replace("UNIT", unit), &rows);
            let [train, _] = case.dataset().unwrap().sieved(&case.robot()).unwrap();
            let log = &train[0].1;
            assert!((log.recording.q.channel(1)[1] - f64::to_radians(last)).abs() < 1e-15);
            let noted = log.corrections.iter().any(|note| note.contains("set it to \"rad\""));
            assert_eq!(noted, is_noted, "{unit} {last}: {:?}", log.corrections);
        }
    }
}
