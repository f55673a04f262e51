//! A robot written as a MuJoCo model is the same robot to MuJoCo (`tests/reference/mjcf.py`).

use super::difference;
use serde_json::Value;
use tauscope::dynamics::{Chain, inverse_dynamics_at};
use tauscope::robot::{self, InertiaCheck};

fn path(file: &str) -> String {
    format!("{}/tests/reference/{file}", env!("CARGO_MANIFEST_DIR"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn mujoco_moves_the_model_that_is_written_for_it() {
    let robot = robot::load(path("skew7.urdf"), InertiaCheck::Required).unwrap();
    let written = std::fs::read_to_string(path("mjcf/written.xml")).unwrap();
    assert_eq!(
        robot::to_mjcf(&robot),
        written,
        "mjcf/written.xml is no longer what is written: renew it and run mjcf.py"
    );
    let reference: Value = serde_json::from_str(&std::fs::read_to_string(path("mjcf/written.json")).unwrap()).unwrap();
    for (joint, own) in reference["joints"].as_array().unwrap().iter().zip(&robot.joints) {
        assert_eq!(joint["name"], own.name.as_str());
        let drive = ["damping", "friction", "armature"].map(|name| joint[name].as_f64().unwrap());
        assert_eq!(drive, [own.drive.viscous, own.drive.coulomb, own.drive.armature]);
    }
    let (chain, parameters) = (Chain::new(&robot), robot.inertial_parameters());
    for state in reference["states"].as_array().unwrap() {
        let [q, qd, qdd, tau] = ["q", "qd", "qdd", "tau"].map(|name| numbers(&state[name]));
        let own = inverse_dynamics_at(&chain, &parameters, &q, &qd, &qdd);
        assert!(difference(&own, &tau) < 1e-9, "{own:?} {tau:?}");
    }
}

#[test]
fn a_model_that_was_written_is_read_as_the_same_robot() {
    let robot = robot::load(path("skew7.urdf"), InertiaCheck::Required).unwrap();
    let read = robot::load(path("mjcf/written.xml"), InertiaCheck::Required).unwrap();
    assert_eq!(read.dof(), robot.dof());
    for (own, joint) in read.joints.iter().zip(&robot.joints) {
        assert_eq!(
            (&own.name, own.kind, own.drive, own.limits.effort),
            (&joint.name, joint.kind, joint.drive, joint.limits.effort)
        );
        assert_eq!([own.limits.lower, own.limits.upper], [joint.limits.lower, joint.limits.upper]);
    }
    assert!(difference(&read.inertial_parameters(), &robot.inertial_parameters()) < 1e-9);
}
