//! What is wrong with the description of public logs is named, and nothing else.

use super::{arm, folder};
use std::path::Path;
use tauscope::quality::descriptions::{Change, Verdict, is_description};
use tauscope::quality::{Kind, Together, examine_together};
use tauscope::recording::lenient::{self, ColumnMap, Sieved};

fn together(folder: &Path, urdf: &str, logs: &[&str]) -> Together {
    let robot = arm(folder, urdf);
    let names = robot.joint_names();
    let read = |log: &&str| lenient::load(folder.join(log), Some(&names), &ColumnMap::default()).unwrap();
    let sieved: Vec<Sieved> = logs.iter().map(read).collect();
    examine_together(&sieved.iter().collect::<Vec<_>>(), Some(&robot)).unwrap()
}

fn verdict(folder: &Path, urdf: &str, logs: &[&str]) -> Verdict {
    together(folder, urdf, logs).verdict.unwrap()
}

#[test]
#[ignore = "needs the folder of measured logs"]
fn an_arm_that_hangs_on_a_wall() {
    let folder = folder();
    let verdict = verdict(&folder, "ar5/ar5.urdf", &["ar5/ar5_real.csv"]);
    let [Change::Gravity(gravity)] = verdict.description.changes[..] else { panic!("{verdict:?}") };
    assert!(gravity[0] > 9.0 && gravity[1] == 0.0 && gravity[2] == 0.0, "{gravity:?}");
    assert!(verdict.beyond_doubt && verdict.after < 0.2 * verdict.before, "{verdict:?}");
}

#[test]
#[ignore = "needs the folder of measured logs"]
fn one_torque_of_six_has_the_wrong_sign_in_all_logs() {
    let folder = folder();
    let logs = ["shanghai/traj1.csv", "shanghai/traj2.csv", "shanghai/traj3.csv"];
    let all = verdict(&folder, "shanghai/shanghai.urdf", &logs);
    assert_eq!(all.description.changes, [Change::TorqueSign(2)]);
    assert!(all.beyond_doubt, "{all:?}");
    for log in logs {
        let one = verdict(&folder, "shanghai/shanghai.urdf", &[log]);
        assert_eq!(one.description.changes, [Change::TorqueSign(2)], "{log}");
    }
}

#[test]
#[ignore = "needs the folder of measured logs"]
fn right_logs_are_not_accused() {
    let folder = folder();
    let one: [(&str, &[&str]); 13] = [
        ("kr300/kr300_nominal.urdf", &["kr300/kr300_A.csv", "kr300/kr300_B.csv", "kr300/kr300_C.csv"]),
        ("tx40/tx40.urdf", &["tx40/tx40_1kHz.csv"]),
        ("ur10/ur10_kinematics_only.urdf", &["ur10/ur10_salerno.csv"]),
        ("emps/emps.urdf", &["emps/emps_est.csv"]),
        ("emps/emps.urdf", &["emps/emps_pulses.csv"]),
        ("psm/psm.urdf", &["psm/none.csv", "psm/one.csv", "psm/two.csv"]),
        ("psm/psm.urdf", &["psm/none.csv"]),
        ("psm/psm.urdf", &["psm/ins105.csv"]),
        ("psm/psm.urdf", &["psm/par205.csv"]),
        ("openarm/j.urdf", &["openarm/j3.csv"]),
        ("openarm/j.urdf", &["openarm/j3c.csv"]),
        ("ur5e/level.urdf", &["ur5e/j4.csv"]),
        ("ur5e/vertical.urdf", &["ur5e/j5.csv"]),
    ];
    let others = [Kind::Frozen, Kind::VelocityUnit, Kind::TorqueUnit, Kind::UnsignedTorque, Kind::PositionUnit];
    for (urdf, logs) in one {
        for report in together(&folder, urdf, logs).reports {
            let accused = report.findings.iter().find(|f| is_description(f.kind) || others.contains(&f.kind));
            assert_eq!(accused, None, "{logs:?}");
        }
    }
}

#[test]
#[ignore = "needs the folder of measured logs"]
fn a_clock_that_is_wrong_by_a_factor() {
    let folder = folder();
    for (urdf, log) in [("ur5e/level.urdf", "ur5e/j4.csv"), ("ur5e/vertical.urdf", "ur5e/j5.csv")] {
        let report = together(&folder, urdf, &[log]).reports.remove(0);
        let factor = report.units.time_factor.unwrap();
        assert!((1.5..1.75).contains(&factor), "{log}: {factor}");
        assert!(report.findings.iter().any(|finding| finding.kind == Kind::ClockFactor), "{log}");
    }
}
