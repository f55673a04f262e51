//! A law over all effects: what an effect adds to the torque is the same for `identify` and `diagnose`.

use crate::channels::Channels;
use crate::diagnosis::logs::{FEWEST_ROWS, Rows};
use crate::diagnosis::regression::Column;
use crate::effects::{LIBRARY, Nature, Placed, Scope};
use crate::identification::effect_model::Arm;
use crate::identification::effect_model::{EffectModel, Preparation, Trust};
use crate::identification::model::Model;
use crate::identification::prepare::Smoothing;
use crate::identification::reversals::Band;
use crate::identification::standard::{ROTOR, STANDARD};
use crate::random;
use crate::recording::Recording;
use crate::robot::{InertiaCheck, Robot, load};
use rand_distr::{Distribution, StandardNormal};

const RATE_HZ: f64 = 500.0;
const SAMPLES: usize = 8000;
/// Cut-off of the positions of the diagnosis, Hz.
const CUTOFF_HZ: f64 = 20.0;
/// Samples of a block of the diagnosis.
const BLOCK: usize = 10;
/// Noise of the positions, rad.
const ENCODER_NOISE: f64 = 1e-5;
/// Blocks at either end that are not compared.
const ENDS: usize = 100;
/// Part of an effect's torque by which the two may differ.
const ROUNDING: f64 = 1e-9;

fn motion(joints: usize) -> Recording {
    let wave = |joint: usize, k: usize| {
        let t = k as f64 / RATE_HZ;
        let slow = 0.15 + 0.03 * joint as f64;
        0.6 * (std::f64::consts::TAU * slow * t).sin() + 0.2 * (std::f64::consts::TAU * 1.7 * slow * t).cos()
    };
    let q: Vec<Vec<f64>> = (0..joints).map(|joint| (0..SAMPLES).map(|k| wave(joint, k)).collect()).collect();
    let mut noise = random::stream(3, "positions", 0);
    let mut read = |q: &f64| -> f64 {
        let drawn: f64 = StandardNormal.sample(&mut noise);
        q + ENCODER_NOISE * drawn
    };
    let q: Vec<Vec<f64>> = q.iter().map(|q| q.iter().map(&mut read).collect()).collect();
    Recording {
        joints: (1..=joints).map(|joint| format!("joint_{joint}")).collect(),
        time: (0..SAMPLES).map(|k| k as f64 / RATE_HZ).collect(),
        q: Channels::from_vectors(&q),
        tau: Channels::zeros(joints, SAMPLES),
        ..Default::default()
    }
}

fn preparation() -> Preparation {
    let smoothing = Smoothing::BlockMeans { cutoff_hz: CUTOFF_HZ, block: BLOCK };
    Preparation { smoothing, band: Band::Given(0.0) }
}

/// Torque that `identify` predicts with some effects, `[joint][time]`, by an arm that is described as `described` and identified as `real`.
fn predicted([real, described]: [&Robot; 2], trust: Trust, log: &Recording, placed: Vec<Placed>) -> Vec<Vec<f64>> {
    let [true_model, model] = [real, described].map(Model::new);
    let [true_model, mut model] = [&true_model, &model]
        .map(|model| EffectModel::new(model, trust, &[log], preparation(), placed.clone()).unwrap());
    model.set_baseline(true_model.baseline());
    let bodies = model.found_arm();
    let model = model.with_bodies(bodies);
    let linear = [model.baseline().to_vec(), model.get(&model.amplitudes())].concat();
    let rows = model.regression().unwrap();
    // The log's torque is zero: what is known is taken off it.
    rows.iter().map(|joint| joint.residual(&linear).iter().map(|left| -left).collect()).collect()
}

#[test]
fn identify_and_diagnose_have_the_same_torque_of_every_effect() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
    let real = load(path, InertiaCheck::Required).unwrap();
    agree([&real, &real], Trust::Nominal);
    // What gears carry, and friction under load, follow the bodies as identified.
    let mut standard = Model::standard_values(&real);
    standard.chunks_mut(STANDARD).for_each(|body| body[..ROTOR].iter_mut().for_each(|moment| *moment *= 1.5));
    agree([&real, &Model::with_standard_values(&real, &standard)], Trust::Structure);
}

/// Root of the sum of squares over joints and rows of the difference of two torques, and that of the second, away from the ends.
fn apart(identified: &[Vec<f64>], diagnosed: &Column) -> [f64; 2] {
    let (mut apart, mut size) = (0.0, 0.0);
    for (joint, identified) in identified.iter().enumerate() {
        for block in ENDS..identified.len() - ENDS {
            let diagnosed = diagnosed.part(joint).map_or(0.0, |column| column[block]);
            apart += (identified[block] - diagnosed).powi(2);
            size += diagnosed.powi(2);
        }
    }
    [apart, size].map(f64::sqrt)
}

fn agree([real, described]: [&Robot; 2], trust: Trust) {
    let log = motion(real.dof());
    let rows = Rows::new(&[&log], CUTOFF_HZ, FEWEST_ROWS).unwrap();
    let mut arm = Arm::new(described, trust);
    if trust == Trust::Structure {
        let model = Model::new(described);
        arm.take(&model, &model.base().values(&Model::standard_values(real)));
    }
    let without = predicted([real, described], trust, &log, Vec::new());
    for effect in LIBRARY {
        let about = effect.about();
        let joint = if about.scope == Scope::Arm { 0 } else { 1 };
        let mut placed = Placed::typical(*effect, joint);
        if about.nature == Nature::Level {
            placed.parameters[0] = 0.5 * without[joint].iter().fold(0.0, |most: f64, torque| most.max(torque.abs()));
        }
        let added = &arm.added(std::slice::from_ref(&placed), &rows).unwrap()[0];
        let with = predicted([real, described], trust, &log, vec![placed]);
        let pairs = with.iter().zip(&without).map(|(with, without)| with.iter().zip(without).map(|(a, b)| a - b));
        let difference: Vec<Vec<f64>> = pairs.map(Iterator::collect).collect();
        let [apart, size] = apart(&difference, added);
        assert!(size > 0.0, "{} adds nothing", about.name);
        assert!(apart < ROUNDING * size, "{} {trust:?}: {apart} of {size}", about.name);
    }
}
