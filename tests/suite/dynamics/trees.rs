//! Trees, held joints and joints that follow others against Pinocchio and MuJoCo (numbers and script: tests/reference/trees.py),
//! and rapier's forward dynamics of trees against the project's own.

use super::difference;
use serde::Deserialize;
use std::collections::BTreeMap;
use tauscope::channels::Channels;
use tauscope::dynamics::{
    Chain, EquationsOfMotion, Lanes, Motion, block_row, forward_dynamics, inverse_dynamics_at, inverse_dynamics_in,
    mass_matrix, regressor_in,
};
use tauscope::robot::{Choice, InertiaCheck, LinearMap, PARAMETERS, Robot, Tree, description};
use tauscope::simulation::rapier_arm::RapierArm;

/// Agreement wanted, relative to the largest entry.
const DIGITS: f64 = 1e-10;

#[derive(Deserialize)]
struct Reference {
    coordinates: Vec<String>,
    joints: Vec<Body>,
    held: BTreeMap<String, f64>,
    parameters: Vec<[f64; PARAMETERS]>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct Body {
    name: String,
    body: String,
    coordinate: String,
    multiplier: f64,
    offset: f64,
}

#[derive(Deserialize)]
struct State {
    x: Vec<f64>,
    xd: Vec<f64>,
    xdd: Vec<f64>,
    gravity: [f64; 3],
    tau: Vec<f64>,
    mass_matrix: Vec<Vec<f64>>,
    mass_matrix_with_rotors: Vec<Vec<f64>>,
    gravity_torque: Vec<f64>,
    regressor: Vec<Vec<f64>>,
    applied: Option<Vec<f64>>,
    acceleration: Option<Vec<f64>>,
}

fn read(json: &std::path::Path, robot: &std::path::Path) -> (Reference, Robot) {
    let reference: Reference = serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    let choice =
        Choice { joints: Some(reference.coordinates.clone()), hold: reference.held.clone(), ..Choice::default() };
    let robot = description::read(robot).unwrap().robot(&choice, InertiaCheck::Ignored).unwrap();
    (reference, robot)
}

fn own(json: &str, robot: &str) -> (Reference, Robot) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/trees");
    read(&folder.join(json), &folder.join(robot))
}

fn all() -> Vec<(Reference, Robot)> {
    let mut all: Vec<_> = ["two_finger", "two_arms", "palletiser", "hollow_wrist", "humanoid_free"]
        .map(|name| own(&format!("{name}.json"), &format!("{name}.urdf")))
        .into();
    all.push(own("palletiser.json", "palletiser.xml"));
    all
}

fn check(reference: &Reference, robot: &Robot) {
    let name = &robot.source.display();
    assert_eq!(robot.joint_names(), reference.coordinates, "{name}");
    assert_eq!(robot.bodies(), reference.joints.len(), "{name}");
    for (body, given) in reference.joints.iter().enumerate() {
        let (joint, coupling) = (robot.body(body), robot.coupling(body));
        assert_eq!((&joint.name, &joint.link), (&given.name, &given.body), "{name}");
        assert_eq!(robot.joints[coupling.coordinate].name, given.coordinate, "{name} {}", given.name);
        assert!((coupling.multiplier - given.multiplier).abs() < 1e-12, "{name} {}", given.name);
        assert!((coupling.offset - given.offset).abs() < 1e-12, "{name} {}", given.name);
    }
    let inertial = robot.inertial_parameters();
    let parameters = reference.parameters.concat();
    assert!(difference(&inertial, &parameters) < DIGITS, "{name}: parameters {}", difference(&inertial, &parameters));
    let armature: Vec<f64> = robot.joints.iter().map(|joint| joint.drive.armature).collect();
    for state in &reference.states {
        let dof = robot.dof();
        let chain = Chain::new(robot).with_gravity(state.gravity);
        let tau = inverse_dynamics_at(&chain, &inertial, &state.x, &state.xd, &state.xdd);
        assert!(difference(&tau, &state.tau) < DIGITS, "{name}: torque {}", difference(&tau, &state.tau));
        let still = vec![0.0; dof];
        let gravity = inverse_dynamics_at(&chain, &inertial, &state.x, &still, &still);
        assert!(difference(&gravity, &state.gravity_torque) < DIGITS, "{name}: gravity");
        let matrix = mass_matrix(&chain, &inertial, &state.x);
        assert!(difference(matrix.transpose().as_slice(), &state.mass_matrix.concat()) < DIGITS, "{name}: mass matrix");
        for lanes in Lanes::available() {
            // Three samples: the state, another and the state again.
            let table = |one: &[f64]| {
                let mut table = Channels::zeros(dof, 3);
                table.set(0, one);
                table.set(2, one);
                table
            };
            let motion = Motion { q: table(&state.x), qd: table(&state.xd), qdd: table(&state.xdd) };
            let torque = inverse_dynamics_in(lanes, &chain, &inertial, &motion);
            let rows = regressor_in(lanes, &chain, &motion);
            for sample in [0, 2] {
                assert!(difference(&torque.at(sample), &state.tau) < DIGITS, "{name} {lanes:?}");
                for coordinate in 0..dof {
                    let own: Vec<f64> = (0..robot.bodies() * PARAMETERS)
                        .map(|c| rows.channel(block_row(dof, c / PARAMETERS, c % PARAMETERS, coordinate))[sample])
                        .collect();
                    let wanted = &state.regressor[coordinate];
                    assert!(difference(&own, wanted) < DIGITS, "{name} {lanes:?}: regressor of {coordinate}");
                }
            }
        }
        let (Some(applied), Some(acceleration)) = (&state.applied, &state.acceleration) else { continue };
        let equations = EquationsOfMotion::new(&chain, &inertial, &still, &state.x, &state.xd);
        let found = equations.accelerations(applied);
        assert!(difference(&found, acceleration) < 1e-8, "{name}: {}", difference(&found, acceleration));
        for lanes in Lanes::available() {
            let table = |one: &[f64]| Channels::from_vectors(&one.iter().map(|&v| vec![v; 5]).collect::<Vec<_>>());
            let mut batch = Channels::zeros(dof, 5);
            let states = [&table(&state.x), &table(&state.xd), &table(applied)];
            forward_dynamics(lanes, &chain, [&inertial, &still], states, &mut batch);
            assert!(difference(&batch.at(4), acceleration) < 1e-8, "{name} {lanes:?}");
        }
        // With rotors: M qdd = tau - h, so that M times the response of a joint is the unit torque.
        let equations = EquationsOfMotion::new(&chain, &inertial, &armature, &state.x, &state.xd);
        for joint in 0..dof {
            let response = nalgebra::DVector::from_vec(equations.response(joint));
            let unit = nalgebra::DMatrix::from_fn(dof, dof, |i, j| state.mass_matrix_with_rotors[i][j]) * response;
            let wanted: Vec<f64> = (0..dof).map(|k| f64::from(u8::from(k == joint))).collect();
            assert!(difference(unit.as_slice(), &wanted) < 1e-8, "{name}: rotors");
        }
    }
}

#[test]
fn trees_and_followers_agree_with_pinocchio_and_mujoco() {
    for (reference, robot) in all() {
        check(&reference, &robot);
    }
}

#[test]
fn rapier_moves_trees_as_the_own_dynamics_do() {
    for (reference, robot) in all().into_iter().filter(|(_, robot)| robot.followers().is_empty()) {
        let mut arm = RapierArm::new(&robot).unwrap();
        let (inertial, chain) = (robot.inertial_parameters(), Chain::new(&robot));
        let armature: Vec<f64> = robot.joints.iter().map(|joint| joint.drive.armature).collect();
        for state in &reference.states {
            let applied = inverse_dynamics_at(&chain, &inertial, &state.x, &state.xd, &state.xdd);
            let mut found = vec![0.0; robot.dof()];
            arm.forward_dynamics(&state.x, &state.xd, &applied, &mut found);
            let wanted =
                EquationsOfMotion::new(&chain, &inertial, &armature, &state.x, &state.xd).accelerations(&applied);
            let apart = difference(&found, &wanted);
            assert!(apart < 1e-8, "{}: {apart}", robot.name);
        }
    }
}

/// Any robot with numbers of `trees.py`: `TAUSCOPE_TREES` names a folder of pairs NAME.json and NAME.urdf.
#[test]
#[ignore = "needs the numbers of public robots in TAUSCOPE_TREES"]
fn public_robots_agree_with_pinocchio() {
    let folder = std::env::var("TAUSCOPE_TREES").expect("TAUSCOPE_TREES");
    for entry in std::fs::read_dir(folder).unwrap() {
        let json = entry.unwrap().path();
        if json.extension().is_some_and(|extension| extension == "json") {
            let (reference, robot) = read(&json, &json.with_extension("urdf"));
            check(&reference, &robot);
        }
    }
}

/// A robot whose followers have a coordinate each, seen through the linear map, is the robot: q = A x + b, torque = A' tau.
#[test]
fn followers_are_free_joints_seen_through_the_linear_map() {
    for name in ["palletiser", "hollow_wrist"] {
        let (reference, robot) = own(&format!("{name}.json"), &format!("{name}.urdf"));
        let mut free = robot.clone();
        let tree = robot.tree.as_ref().unwrap();
        free.joints.extend(tree.followers.iter().map(|follower| follower.joint.clone()));
        free.tree = Some(Tree { followers: Vec::new(), ..tree.clone() });
        let map = LinearMap::new(robot.dof(), (0..robot.bodies()).map(|body| vec![robot.coupling(body)]).collect());
        for state in &reference.states {
            let table =
                |values: &[f64]| Channels::from_vectors(&values.iter().map(|value| vec![*value]).collect::<Vec<_>>());
            let x = Motion { q: table(&state.x), qd: table(&state.xd), qdd: table(&state.xdd) };
            let q = Motion { q: map.positions(&x.q), qd: map.rates(&x.qd), qdd: map.rates(&x.qdd) };
            let torque = |robot: &Robot, motion: &Motion| {
                inverse_dynamics_in(Lanes::best(), &Chain::new(robot), &robot.inertial_parameters(), motion)
            };
            let (own, seen) = (torque(&robot, &x), map.torques(&torque(&free, &q)));
            assert!(difference(own.as_slice(), seen.as_slice()) < DIGITS, "{name}");
        }
    }
}
