//! Serial arms drawn at random: links that get shorter and lighter towards the flange, axes as industrial arms have them,
//! friction of some per cent of a joint's load, rotors, and torque noise of 0.5 to 1 % of it.

use crate::dynamics::{Chain, inverse_dynamics_at};
use crate::effects::drive_friction;
use crate::excitation::JointLimits;
use crate::random;
use crate::robot::{Addresses, Drive, GRAVITY, Inertia, Joint, JointKind, Limits, Pose, Robot};
use crate::scenario::{Setup, misjudged};
use chacha20::ChaCha8Rng;
use nalgebra::{Matrix3, Vector3};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

/// Axes of industrial arms, base to flange.
const PATTERNS_6: [&str; 5] = ["zyyxyx", "zyyxyz", "zyyyzy", "zyyzyz", "zxxyxy"];
const PATTERNS_7: [&str; 3] = ["zyzyzyz", "zyxyxyx", "zyyxyxz"];

/// Points whose spread is that of a link's mass.
const POINTS: usize = 30;

/// States over which the load of the joints is taken.
const STATES: usize = 60;

/// Relative error of the controller's model.
const MODEL_ERROR: f64 = 0.1;

/// `setup` with an arm of `dof` turning joints, drawn from `seed`, in place of its own; without effects.
pub(crate) fn random_setup(setup: &Setup, dof: usize, seed: u64) -> Setup {
    let mut source = random::stream(seed, "blind arm", 0);
    let mut robot = bodies(dof, &mut source);
    let load = drives(&mut robot, &mut source);
    let mut setup = setup.clone();
    setup.scenario.effects.clear();
    let first = setup.sensors[0];
    setup.sensors = load
        .iter()
        .map(|load| {
            let mut sensor = first;
            sensor.torque_noise = load * source.random_range(0.005..0.01);
            sensor.encoder_resolution = std::f64::consts::TAU / f64::from(1u32 << source.random_range(18..=20));
            sensor
        })
        .collect();
    setup.limits = robot
        .joints
        .iter()
        .enumerate()
        .map(|(index, joint)| JointLimits {
            lower: joint.limits.lower,
            upper: joint.limits.upper,
            velocity: joint.limits.velocity,
            acceleration: if index < 3 { source.random_range(6.0..15.0) } else { source.random_range(15.0..40.0) },
        })
        .collect();
    setup.nominal = misjudged(&robot, MODEL_ERROR, &mut source);
    setup.effects = drive_friction(&robot);
    setup.plant = robot.clone();
    setup.known = robot;
    setup
}

fn bodies(dof: usize, source: &mut ChaCha8Rng) -> Robot {
    let patterns: &[&str] = if dof == 7 { &PATTERNS_7 } else { &PATTERNS_6 };
    let pattern = patterns[source.random_range(0..patterns.len())];
    let mut mass = source.random_range(20.0..80.0);
    let mut length: f64 = source.random_range(0.3..0.9);
    let mut bone = Vector3::new(0.0, 0.0, source.random_range(0.1..0.5));
    let mut joints = Vec::with_capacity(dof);
    for (index, axis) in pattern.chars().cycle().take(dof).enumerate() {
        if index > 0 {
            mass = f64::max(2.0, mass * source.random_range(0.45..0.85));
            length = f64::max(0.1, length * source.random_range(0.5..1.0));
        }
        let origin = Pose { rotation: Matrix3::identity(), translation: bone };
        bone = along(axis, length, source);
        let center = bone * source.random_range(0.25..0.65) + (0.06 * length + 0.01) * normal(source);
        let reach = source.random_range(1.6..3.0);
        joints.push(Joint {
            name: format!("joint_{}", index + 1),
            link: format!("link_{}", index + 1),
            kind: JointKind::Revolute,
            origin,
            axis: match axis {
                'x' => Vector3::x(),
                'y' => Vector3::y(),
                _ => Vector3::z(),
            },
            limits: Limits {
                lower: -reach,
                upper: reach,
                velocity: source.random_range(1.5..3.0),
                effort: f64::INFINITY,
            },
            inertia: Inertia::from_center_of_mass(mass, center, bulk(mass, &bone, source)),
            drive: Drive::default(),
        });
    }
    let flange = Pose { rotation: Matrix3::identity(), translation: bone * source.random_range(0.3..1.0) };
    Robot {
        name: format!("random_{dof}r"),
        source: "random".into(),
        gravity: GRAVITY.into(),
        columns: joints.iter().map(|joint| joint.name.clone()).collect(),
        joints,
        flange,
        tree: None,
        actuators: Vec::new(),
        addresses: Addresses::default(),
        held: Vec::new(),
        assumed: Vec::new(),
        guessed: Vec::new(),
        lifted: Vec::new(),
        notes: Vec::new(),
    }
}

/// A link mostly across the axis of the next bend.
fn along(axis: char, length: f64, source: &mut ChaCha8Rng) -> Vector3<f64> {
    let main = match (axis, source.random_range(0..3)) {
        ('z', _) | (_, 0) => Vector3::z(),
        (_, 1) => Vector3::x(),
        _ => Vector3::new(1.0, 0.0, 0.4),
    };
    length * (main + 0.15 * normal(source)).normalize()
}

/// Inertia about the centre of mass of points strewn along the link, which is always one that a body can have.
fn bulk(mass: f64, bone: &Vector3<f64>, source: &mut ChaCha8Rng) -> Matrix3<f64> {
    let size = bone.map(|value| 0.25 * value.abs() + 0.06);
    let points: Vec<Vector3<f64>> = (0..POINTS).map(|_| normal(source).component_mul(&size)).collect();
    let mean = points.iter().sum::<Vector3<f64>>() / POINTS as f64;
    let second = points.iter().map(|p| (p - mean) * (p - mean).transpose()).sum::<Matrix3<f64>>() / POINTS as f64;
    mass * (Matrix3::identity() * second.trace() - second)
}

fn normal(source: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| StandardNormal.sample(source))
}

/// Gives the joints friction of some per cent of their load, and rotors of a tenth of the link's inertia to all of it. Returns
/// the load, root mean square, N m.
fn drives(robot: &mut Robot, source: &mut ChaCha8Rng) -> Vec<f64> {
    let (chain, inertial, dof) = (Chain::new(robot), robot.inertial_parameters(), robot.dof());
    let (mut squares, mut masses) = (vec![0.0; dof], vec![0.0; dof]);
    for _ in 0..STATES {
        let q: Vec<f64> = robot.joints.iter().map(|j| 0.6 * j.limits.upper * source.random_range(-1.0..1.0)).collect();
        let mut draw = |size: f64| -> Vec<f64> {
            (0..dof).map(|_| size * Distribution::<f64>::sample(&StandardNormal, source)).collect()
        };
        let (qd, qdd) = (draw(1.0), draw(3.0));
        let still = vec![0.0; dof];
        let torque = inverse_dynamics_at(&chain, &inertial, &q, &qd, &qdd);
        let weight = inverse_dynamics_at(&chain, &inertial, &q, &still, &still);
        for joint in 0..dof {
            squares[joint] += torque[joint].powi(2) / STATES as f64;
            let mut unit = still.clone();
            unit[joint] = 1.0;
            let with = inverse_dynamics_at(&chain, &inertial, &q, &still, &unit);
            masses[joint] += (with[joint] - weight[joint]) / STATES as f64;
        }
    }
    let load: Vec<f64> = squares.iter().map(|square| square.sqrt()).collect();
    for ((joint, load), mass) in robot.joints.iter_mut().zip(&load).zip(masses) {
        let coulomb = load * source.random_range(0.03..0.12);
        joint.drive = Drive {
            coulomb,
            viscous: coulomb * source.random_range(0.3..1.5),
            armature: mass * source.random_range(0.1..1.0),
        };
    }
    load
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawn_arms_can_exist_and_differ_by_seed() {
        let setup = Setup::load(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/irb1600.toml"), None).unwrap();
        for (seed, dof) in [(1, 6), (2, 7), (3, 6), (4, 7)] {
            let arm = random_setup(&setup, dof, seed);
            assert_eq!((arm.known.dof(), arm.sensors.len(), arm.limits.len()), (dof, dof, dof));
            for joint in &arm.known.joints {
                assert_eq!(joint.inertia.physical_fault(1e-9), None);
                assert!(joint.drive.armature > 0.0 && joint.drive.coulomb > 0.0);
            }
            assert_eq!(arm.known, random_setup(&setup, dof, seed).known);
            assert_ne!(arm.known, random_setup(&setup, dof, seed + 10).known);
        }
    }
}
