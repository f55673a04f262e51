//! Logs of an arm for unit tests.

use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::identification::effect_model::Arm;
use crate::random;
use crate::recording::Recording;
use rand_distr::{Distribution, StandardNormal};

const RATE: f64 = 250.0;

/// Six seconds of waves of the arm, with noise on the torque.
pub(super) fn log(arm: &Arm, seed: u64) -> Recording {
    let mut source = random::stream(seed, "log", 0);
    let time: Vec<f64> = (0..1500).map(|k| f64::from(k) / RATE).collect();
    let hz = |joint: usize| 0.3 + 0.07 * joint as f64 + 0.05 * seed as f64;
    let wave = |f: fn(f64) -> f64, order: i32, sign: f64| {
        let of = |joint: usize| {
            let omega = std::f64::consts::TAU * hz(joint);
            time.iter().map(|t| 0.5 * sign * omega.powi(order) * f(omega * t + joint as f64)).collect()
        };
        Channels::from_vectors(&(0..6).map(of).collect::<Vec<Vec<f64>>>())
    };
    let motion = Motion { q: wave(f64::sin, 0, 1.0), qd: wave(f64::cos, 1, 1.0), qdd: wave(f64::sin, 2, -1.0) };
    let mut tau = arm.torque(&motion, &motion);
    tau.as_mut_slice().iter_mut().for_each(|tau| {
        let noise: f64 = StandardNormal.sample(&mut source);
        *tau += noise;
    });
    Recording { joints: (1..=6).map(|j| format!("joint_{j}")).collect(), time, q: motion.q, tau, ..Default::default() }
}
