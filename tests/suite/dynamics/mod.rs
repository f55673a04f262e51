//! Inverse dynamics, mass matrix, gravity and regressor against Pinocchio and MuJoCo (numbers and script under
//! tests/reference), and rapier's forward dynamics against the project's own inverse dynamics.

mod trees;
mod written;

use serde::Deserialize;
use tauscope::channels::Channels;
use tauscope::dynamics::{
    Chain, EquationsOfMotion, Lanes, Motion, block_row, forward_dynamics, inverse_dynamics_at, inverse_dynamics_in,
    mass_matrix, regressor_in,
};
use tauscope::robot::{self, InertiaCheck, PARAMETERS, Robot};
use tauscope::simulation::rapier_arm::RapierArm;

#[derive(Deserialize)]
struct Reference {
    joints: Vec<String>,
    parameters: Vec<[f64; PARAMETERS]>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    gravity: [f64; 3],
    tau: Vec<f64>,
    tau_mujoco: Vec<f64>,
    mass_matrix: Vec<Vec<f64>>,
    gravity_torque: Vec<f64>,
    regressor: Vec<Vec<f64>>,
    tip_position: [f64; 3],
    tip_rotation: [[f64; 3]; 3],
}

fn references() -> Vec<(Reference, Robot)> {
    [
        ("irb1600", "urdf/irb1600_6_120.urdf"),
        ("skew7", "tests/reference/skew7.urdf"),
        ("fixed_links", "tests/reference/fixed_links.urdf"),
    ]
    .map(|(name, urdf)| {
        let path = format!("{}/tests/reference/{name}_dynamics.json", env!("CARGO_MANIFEST_DIR"));
        let reference: Reference = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let urdf = format!("{}/{urdf}", env!("CARGO_MANIFEST_DIR"));
        let robot = robot::load(urdf, InertiaCheck::Required).unwrap();
        (reference, robot)
    })
    .into()
}

/// Largest difference over the largest size, at least 1.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let scale = b.iter().fold(1.0f64, |m, v| m.max(v.abs()));
    a.iter().zip(b).fold(0.0f64, |m, (x, y)| m.max((x - y).abs())) / scale
}

#[test]
fn urdf_gives_pinocchios_joints_parameters_and_tip() {
    for (reference, robot) in references() {
        assert_eq!(robot.joint_names(), reference.joints);
        assert!(difference(&robot.inertial_parameters(), &reference.parameters.concat()) < 1e-12, "{}", robot.name);
        for state in &reference.states {
            let tip = robot.frames(&state.q)[robot.dof()];
            assert!(difference(tip.translation.as_slice(), &state.tip_position) < 1e-12);
            assert!(difference(tip.rotation.transpose().as_slice(), &state.tip_rotation.concat()) < 1e-12);
        }
    }
}

#[test]
fn inverse_dynamics_mass_matrix_and_gravity_agree_with_pinocchio_and_mujoco() {
    for (reference, robot) in references() {
        let inertial = robot.inertial_parameters();
        for state in &reference.states {
            let chain = Chain::new(&robot).with_gravity(state.gravity);
            let tau = inverse_dynamics_at(&chain, &inertial, &state.q, &state.qd, &state.qdd);
            assert!(difference(&tau, &state.tau) < 1e-10, "{}: {tau:?} {:?}", robot.name, state.tau);
            assert!(difference(&tau, &state.tau_mujoco) < 1e-10);
            let still = vec![0.0; robot.dof()];
            let gravity = inverse_dynamics_at(&chain, &inertial, &state.q, &still, &still);
            assert!(difference(&gravity, &state.gravity_torque) < 1e-10);
            let mass = mass_matrix(&chain, &inertial, &state.q);
            assert!(difference(mass.transpose().as_slice(), &state.mass_matrix.concat()) < 1e-10);
        }
    }
}

/// Samples of a motion that runs through the states, over and over.
fn batch(states: &[&State], samples: usize) -> Motion {
    let joints = states[0].q.len();
    let table = |value: fn(&State) -> &Vec<f64>| {
        let sample = |joint: usize| (0..samples).map(|k| value(states[k % states.len()])[joint]).collect();
        Channels::from_vectors(&(0..joints).map(sample).collect::<Vec<Vec<f64>>>())
    };
    Motion { q: table(|s| &s.q), qd: table(|s| &s.qd), qdd: table(|s| &s.qdd) }
}

#[test]
fn regressor_and_inverse_dynamics_agree_with_pinocchio_in_all_lanes_with_all_tails() {
    for (reference, robot) in references() {
        for lanes in Lanes::available() {
            for samples in (0..=2 * lanes.width() + 1).chain([reference.states.len()]) {
                in_lanes(lanes, &reference, &robot, samples);
            }
        }
    }
}

fn in_lanes(lanes: Lanes, reference: &Reference, robot: &Robot, samples: usize) {
    let dof = robot.dof();
    let mut gravities: Vec<[f64; 3]> = reference.states.iter().map(|s| s.gravity).collect();
    gravities.dedup();
    for gravity in gravities {
        let states: Vec<&State> = reference.states.iter().filter(|s| s.gravity == gravity).collect();
        let chain = Chain::new(robot).with_gravity(gravity);
        let motion = batch(&states, samples);
        let torque = inverse_dynamics_in(lanes, &chain, &robot.inertial_parameters(), &motion);
        let rows = regressor_in(lanes, &chain, &motion);
        assert_eq!([torque.samples(), rows.samples()], [samples; 2]);
        for (sample, state) in (0..samples).zip(states.iter().cycle()) {
            let context = format!("{} in {} lanes, sample {sample} of {samples}", robot.name, lanes.name());
            assert!(difference(&torque.at(sample), &state.tau) < 1e-10, "{context}");
            for joint in 0..dof {
                let own: Vec<f64> = (0..dof * PARAMETERS)
                    .map(|c| rows.channel(block_row(dof, c / PARAMETERS, c % PARAMETERS, joint))[sample])
                    .collect();
                assert!(difference(&own, &state.regressor[joint]) < 1e-10, "{context}, joint {joint}");
            }
        }
    }
}

#[test]
fn rapiers_accelerations_satisfy_the_inverse_dynamics() {
    for (reference, mut robot) in references() {
        for state in &reference.states {
            robot.gravity = state.gravity.into();
            let mut arm = RapierArm::new(&robot).unwrap();
            let tau: Vec<f64> = state.tau.iter().zip(&state.qdd).map(|(t, a)| 0.7 * t + 3.0 * a).collect();
            let mut qdd = vec![0.0; robot.dof()];
            arm.forward_dynamics(&state.q, &state.qd, &tau, &mut qdd);
            let mut needed =
                inverse_dynamics_at(&Chain::new(&robot), &robot.inertial_parameters(), &state.q, &state.qd, &qdd);
            for (value, (joint, a)) in needed.iter_mut().zip(robot.joints.iter().zip(&qdd)) {
                *value += joint.drive.armature * a;
            }
            assert!(difference(&needed, &tau) < 1e-12, "{}: {:e}", robot.name, difference(&needed, &tau));
            let mass = mass_matrix(&Chain::new(&robot), &robot.inertial_parameters(), &state.q);
            for joint in 0..robot.dof() {
                let response = nalgebra::DVector::from_vec(arm.response(joint));
                let mut unit = &mass * &response;
                for (value, (j, a)) in unit.iter_mut().zip(robot.joints.iter().zip(response.iter())) {
                    *value += j.drive.armature * a;
                }
                unit[joint] -= 1.0;
                assert!(unit.amax() < 1e-9, "{}: response of joint {joint}: {unit}", robot.name);
            }
        }
    }
}

#[test]
fn forward_dynamics_agree_with_pinocchio_and_rapier() {
    for (reference, mut robot) in references() {
        let inertial = robot.inertial_parameters();
        let none = vec![0.0; robot.dof()];
        for state in &reference.states {
            let chain = Chain::new(&robot).with_gravity(state.gravity);
            let equations = EquationsOfMotion::new(&chain, &inertial, &none, &state.q, &state.qd);
            let qdd = equations.accelerations(&state.tau);
            assert!(difference(&qdd, &state.qdd) < 1e-10, "{}: {:e}", robot.name, difference(&qdd, &state.qdd));
            // Torque on a joint answers to the mass matrix: M (M^-1 e) = e.
            for joint in 0..robot.dof() {
                let response = equations.response(joint);
                let back: Vec<f64> =
                    state.mass_matrix.iter().map(|row| row.iter().zip(&response).map(|(m, r)| m * r).sum()).collect();
                let unit: Vec<f64> = (0..robot.dof()).map(|row| f64::from(row == joint)).collect();
                assert!(difference(&back, &unit) < 1e-10, "{} joint {joint}: {back:?}", robot.name);
            }

            robot.gravity = state.gravity.into();
            let armature: Vec<f64> = robot.joints.iter().map(|joint| joint.drive.armature).collect();
            let with_rotors = EquationsOfMotion::new(&chain, &inertial, &armature, &state.q, &state.qd);
            let mut rapier = vec![0.0; robot.dof()];
            RapierArm::new(&robot).unwrap().forward_dynamics(&state.q, &state.qd, &state.tau, &mut rapier);
            let own = with_rotors.accelerations(&state.tau);
            assert!(difference(&own, &rapier) < 1e-12, "{}: {:e}", robot.name, difference(&own, &rapier));
            assert!(with_rotors.smallest_pivot() > 0.0);
            in_lanes_and_tails(&chain, [&inertial, &armature], state, &rapier);
        }
    }
}

/// Batches of one state, in all lanes with all tails, must agree with rapier's accelerations.
fn in_lanes_and_tails(chain: &Chain, arm: [&[f64]; 2], state: &State, rapier: &[f64]) {
    for lanes in Lanes::available() {
        for samples in 0..=2 * lanes.width() + 1 {
            let repeated = |values: &[f64]| {
                Channels::from_vectors(&values.iter().map(|&value| vec![value; samples]).collect::<Vec<Vec<f64>>>())
            };
            let mut qdd = repeated(&vec![f64::NAN; chain.dof()]);
            let tables = [&state.q, &state.qd, &state.tau].map(|values| repeated(values));
            forward_dynamics(lanes, chain, arm, tables.each_ref(), &mut qdd);
            for sample in 0..samples {
                let off = difference(&qdd.at(sample), rapier);
                assert!(off < 1e-12, "{} lanes, sample {sample} of {samples}: {off:e}", lanes.name());
            }
        }
    }
}
