//! Public logs of real arms: they load, their findings make sense, their base parameters are found. They are not part of the project:
//! `cargo test --release --test measured -- --ignored` runs these tests on a folder that has them.

mod descriptions;
mod diagnosis;
mod payload;

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use tauscope::dataset;
use tauscope::effects::{self, Placed};
use tauscope::identification::consistent::consistent;
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::fit::{Logs, fit_effects};
use tauscope::identification::model::Model;
use tauscope::identification::prepare::Smoothing;
use tauscope::identification::reversals::Band;
use tauscope::quality::{self, Kind, Report, Severity};
use tauscope::recording::Recording;
use tauscope::robot::{self, InertiaCheck, Robot};

/// The folder, from the environment or beside the project.
fn folder() -> PathBuf {
    let given = std::env::var_os("TAUSCOPE_MEASURED").map(PathBuf::from);
    let folder = given.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/measured"));
    assert!(folder.is_dir(), "no folder {}: give that of the measured logs in TAUSCOPE_MEASURED", folder.display());
    folder
}

/// What a command prints with `--json`; it must end well.
fn printed(command: &mut Command) -> Value {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn arm(folder: &Path, urdf: &str) -> Robot {
    robot::load(folder.join(urdf), InertiaCheck::Ignored).unwrap()
}

fn report(folder: &Path, log: &str, robot: &Robot) -> Report {
    quality::inspect(&folder.join(log), Some(robot)).unwrap()
}

/// Part of the torque that a fit of all base parameters leaves on logs it did not see, per joint.
fn held_out(robot: &Robot, train: &[&Recording], test: &[&Recording], window: usize) -> Vec<f64> {
    let model = Model::new(robot);
    let smoothing = Smoothing::SavitzkyGolay { window, order: 6, decimation: (window / 12).max(1) };
    let preparation = Preparation { smoothing, band: 0.03.into() };
    let logs = Logs { train, test };
    let fitted = fit_effects(&model, Trust::Structure, logs, preparation.clone(), Vec::new()).unwrap();
    let found = consistent(&model, logs, preparation, &fitted).unwrap();
    for joint in &found.robot(robot).joints {
        assert_eq!(joint.inertia.physical_fault(0.0), None, "{}", joint.name);
    }
    let rms = |signal: &[f64]| (signal.iter().map(|v| v * v).sum::<f64>() / signal.len() as f64).sqrt();
    (0..robot.dof()).map(|joint| fitted.test_rms[joint] / rms(test[0].tau.channel(joint))).collect()
}

/// What fits without and with an effect leave on the held-out logs, N m.
fn with_effect(
    robot: &Robot,
    trust: Trust,
    [train, test]: [&[&Recording]; 2],
    (effect, joint): (&str, usize),
) -> [Vec<f64>; 2] {
    let model = Model::new(robot);
    let window = (0.12 * train[0].rate_hz()).round() as usize | 1;
    let smoothing = Smoothing::SavitzkyGolay { window, order: 6, decimation: (window / 12).max(1) };
    let preparation = Preparation { smoothing, band: 0.03.into() };
    let placed = Placed::typical(effects::find(effect).unwrap(), joint);
    [Vec::new(), vec![placed]]
        .map(|placed| fit_effects(&model, trust, Logs { train, test }, preparation.clone(), placed).unwrap().test_rms)
}

#[test]
#[ignore = "needs the folder of measured logs"]
fn kuka_kr300() {
    let folder = folder();
    let robot = arm(&folder, "kr300/kr300_nominal.urdf");
    let mut notes = Vec::new();
    let mut log = |name: &str| dataset::plain(&folder.join(name), &robot, &mut notes).unwrap().remove(0);
    let (a, b, c) = (log("kr300/kr300_A.csv"), log("kr300/kr300_B.csv"), log("kr300/kr300_C.csv"));
    for name in ["kr300/kr300_A.csv", "kr300/kr300_B.csv", "kr300/kr300_C.csv"] {
        let report = report(&folder, name, &robot);
        assert!(report.usable && (report.clock.rate_hz - 250.0).abs() < 1e-6 && report.rejected.is_empty());
        let loud: Vec<_> = report.findings.iter().filter(|f| f.severity != Severity::Note).collect();
        assert!(loud.is_empty(), "{name}: {loud:?}");
        assert!(report.findings.iter().any(|f| f.kind == Kind::UnusedColumns && f.text.contains("qlink1")));
    }
    let left = held_out(&robot, &[&a, &b], &[&c], 31);
    println!("kr300 A, B -> C: {left:.3?}");
    assert!(left.iter().all(|share| *share < 0.5), "{left:?}");

    // The balancer on axis 2, all four parameters free, from A alone, against the standard deviation of torque of B and C.
    let both = [b.tau.channel(1), c.tau.channel(1)].concat();
    let mean = both.iter().sum::<f64>() / both.len() as f64;
    let spread = (both.iter().map(|tau| (tau - mean).powi(2)).sum::<f64>() / both.len() as f64).sqrt();
    let [without, with] = with_effect(&robot, Trust::Nominal, [&[&a], &[&b, &c]], ("gravity_balancer", 1));
    println!("kr300 A -> B, C, axis 2: {:.0} -> {:.0} N m of {spread:.0}", without[1], with[1]);
    assert!(without[1] > 0.6 * spread && with[1] < 0.25 * spread, "{} -> {}", without[1], with[1]);
}

#[test]
#[ignore = "needs the folder of measured logs"]
fn staubli_tx40() {
    let folder = folder();
    let robot = arm(&folder, "tx40/tx40.urdf");
    let report = report(&folder, "tx40/tx40_1kHz.csv", &robot);
    assert!(report.usable && (report.clock.rate_hz - 1000.0).abs() < 1e-6 && report.duration_s > 8.9);
    assert!(report.findings.iter().all(|f| f.severity == Severity::Note), "{:?}", report.findings);
    assert!(report.condition_number.unwrap() < 20.0, "the motion was made to excite");
    let log = dataset::plain(&folder.join("tx40/tx40_1kHz.csv"), &robot, &mut Vec::new()).unwrap().remove(0);
    let left = held_out(&robot, &[&log.time_slice(..6.0)], &[&log.time_slice(6.0..)], 121);
    println!("tx40, first 6 s -> rest: {left:.3?}");
    // Joints 5 and 6 are coupled, which the arm's own model does not know.
    assert!(left[..4].iter().all(|share| *share < 0.2) && left[4..].iter().all(|share| *share > 0.2), "{left:?}");
    let (first, rest) = (log.time_slice(..6.0), log.time_slice(6.0..));
    let [without, with] = with_effect(&robot, Trust::Structure, [&[&first], &[&rest]], ("joint_coupling", 4));
    println!("tx40, joints 5 and 6: {:.2?} -> {:.2?} N m", &without[4..], &with[4..]);
    assert!((4..6).all(|joint| with[joint] < 0.5 * without[joint]), "{without:?} -> {with:?}");
}

#[test]
#[ignore = "needs the folder of measured logs"]
fn universal_robots_ur10() {
    let folder = folder();
    let robot = arm(&folder, "ur10/ur10_kinematics_only.urdf");
    let report = report(&folder, "ur10/ur10_salerno.csv", &robot);
    assert!(report.usable && (report.clock.rate_hz - 125.0).abs() < 0.01 && report.rejected.is_empty());
    assert!(report.findings.iter().all(|f| f.severity == Severity::Note), "{:?}", report.findings);
    let log = dataset::plain(&folder.join("ur10/ur10_salerno.csv"), &robot, &mut Vec::new()).unwrap().remove(0);
    let left = held_out(&robot, &[&log.time_slice(..18.0)], &[&log.time_slice(18.0..)], 15);
    println!("ur10, first 18 s -> rest: {left:.3?}");
    assert!(left[..3].iter().all(|share| *share < 0.3), "{left:?}");
    let (first, rest) = (log.time_slice(..18.0), log.time_slice(18.0..));
    let gain = |effect, joint: usize| {
        let [without, with] = with_effect(&robot, Trust::Structure, [&[&first], &[&rest]], (effect, joint));
        with[joint] / without[joint]
    };
    let (loaded, concave, dip) =
        (gain("load_dependent_friction", 1), gain("nonlinear_viscous_friction", 0), gain("stribeck_friction", 0));
    println!(
        "ur10 held out: load on j2 {loaded:.2}, power on j1 {concave:.2}, Stribeck on j1 {dip:.2} of what was left"
    );
    assert!(loaded < 0.5 && concave < 0.8 && dip > 0.9, "{loaded} {concave} {dip}");
}

/// One sliding axis, slow in m/s; published (Janot, Gautier and Brunot 2019): 203.50 N s/m, 20.394 N, -3.165 N.
#[test]
#[ignore = "needs the folder of measured logs"]
fn emps() {
    let folder = folder();
    let robot = arm(&folder, "emps/emps.urdf");
    let log = dataset::plain(&folder.join("emps/emps_est.csv"), &robot, &mut Vec::new()).unwrap().remove(0);
    let smoothing = Smoothing::SavitzkyGolay { window: 121, order: 6, decimation: 10 };
    let preparation = Preparation { smoothing, band: Band::OfNoise };
    let placed = vec![Placed::typical(effects::find("torque_offset").unwrap(), 0)];
    let logs = Logs { train: &[&log], test: &[] };
    let fitted = fit_effects(&Model::new(&robot), Trust::Structure, logs, preparation, placed).unwrap();
    let found = &fitted.fit.estimate.beta;
    println!("emps: {found:.4?}");
    for (value, published) in found[1..].iter().zip([203.5, 20.394, -3.165]) {
        assert!((value / published - 1.0).abs() < 0.015, "{found:?}");
    }
}
