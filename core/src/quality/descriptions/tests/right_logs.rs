//! Right logs of arms whose described bodies are wrong by half, on motions that separate little.

use super::*;

/// The arm with bodies that differ by up to 60 per cent in mass, by 3 cm in their centres and by a factor of two in inertia.
fn with_wrong_bodies(robot: &Robot, seed: u64) -> Robot {
    let mut random = random::stream(seed, "wrong_bodies", 0);
    let mut other = robot.clone();
    for joint in &mut other.joints {
        let center = joint.inertia.center_of_mass();
        let mass = joint.inertia.mass() * random.random_range(0.6..1.6);
        let moved = nalgebra::Vector3::from_fn(|_, _| random.random_range(-0.03..0.03));
        let tensor = joint.inertia.tensor_about_center() * random.random_range(0.5..2.0);
        joint.inertia = Inertia::from_center_of_mass(mass, center + moved, tensor);
    }
    other
}

/// A log on which all joints follow one chirp.
fn chirp(robot: &Robot, seed: u64) -> Sieved {
    let mut random = random::stream(seed, "chirp", 0);
    let (rate_hz, seconds) = (100.0, 20.0);
    let samples = (rate_hz * seconds) as usize;
    let mut motion = Motion::zeros(robot.dof(), samples);
    for joint in 0..robot.dof() {
        let side = if random.random_range(0.0..1.0) < 0.5 { -1.0 } else { 1.0 };
        let (center, swing) = (random.random_range(-0.4..0.4), 0.6 * side * random.random_range(0.5..1.2));
        for i in 0..samples {
            let t = i as f64 / rate_hz;
            let turn = std::f64::consts::TAU;
            let (phase, rate, change) = (turn * (0.05 * t + 0.01 * t * t), turn * (0.05 + 0.02 * t), turn * 0.02);
            motion.q.channel_mut(joint)[i] = center + 0.5 * swing * (1.0 - phase.cos());
            motion.qd.channel_mut(joint)[i] = 0.5 * swing * phase.sin() * rate;
            motion.qdd.channel_mut(joint)[i] = 0.5 * swing * (phase.cos() * rate * rate + phase.sin() * change);
        }
    }
    let mut tau = inverse_dynamics(&Chain::new(robot), &robot.inertial_parameters(), &motion);
    let mut q = motion.q.clone();
    for joint in 0..robot.dof() {
        let size = crate::linear::root_mean_square(tau.channel(joint));
        for i in 0..samples {
            let v = motion.qd.channel(joint)[i];
            let noise: f64 = StandardNormal.sample(&mut random);
            tau.channel_mut(joint)[i] += size * (0.2 * (v / 0.005).tanh() + 0.2 * v + 0.01 * noise);
            let noise: f64 = StandardNormal.sample(&mut random);
            q.channel_mut(joint)[i] += 1e-5 * noise;
        }
    }
    let time = (0..samples).map(|i| i as f64 / rate_hz).collect();
    let recording = Recording { joints: robot.joint_names(), time, q, qd: None, tau, ..Recording::default() };
    Sieved { lines: (2..samples + 2).collect(), recording, ..Sieved::default() }
}

#[test]
fn bodies_that_are_wrong_by_half_accuse_no_log_of_joints_that_move_as_one() {
    let mut wrong = Vec::new();
    for (place, robot) in [irb(), arm("tests/reference/skew7.urdf")].iter().enumerate() {
        for seed in 0..4 {
            let log = chirp(&with_wrong_bodies(robot, seed), 10 * place as u64 + seed);
            let told = accusations(&[log], Some(robot));
            if !told.is_empty() {
                wrong.push(format!("{}, {seed}: {told:?}", robot.name));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
