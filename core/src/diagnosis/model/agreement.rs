//! A law over all effects: what an effect adds to the torque is the same for `identify` and `diagnose`.

use crate::channels::Channels;
use crate::diagnosis::logs::{FEWEST_ROWS, ORDER, Rows};
use crate::effects::{LIBRARY, Nature, Placed, Scope, Site};
use crate::identification::effect_model::Arm;
use crate::identification::effect_model::{EffectModel, Preparation, Trust};
use crate::identification::model::Model;
use crate::identification::prepare::Smoothing;
use crate::identification::reversals::Band;
use crate::identification::standard::{ROTOR, STANDARD};
use crate::recording::Recording;
use crate::robot::{InertiaCheck, Robot, load};
use crate::signal::{ZeroPhaseLowPass, block_means};

const RATE_HZ: f64 = 500.0;
const SAMPLES: usize = 8000;
/// Cut-off of the positions of the diagnosis, Hz.
const CUTOFF_HZ: f64 = 20.0;
/// Samples of a block of the diagnosis.
const BLOCK: usize = 10;
/// Blocks at either end, where filters differ.
const ENDS: usize = 100;

fn motion(joints: usize) -> Recording {
    let wave = |joint: usize, k: usize| {
        let t = k as f64 / RATE_HZ;
        let slow = 0.15 + 0.03 * joint as f64;
        0.6 * (std::f64::consts::TAU * slow * t).sin() + 0.2 * (std::f64::consts::TAU * 1.7 * slow * t).cos()
    };
    let q: Vec<Vec<f64>> = (0..joints).map(|joint| (0..SAMPLES).map(|k| wave(joint, k)).collect()).collect();
    Recording {
        joints: (1..=joints).map(|joint| format!("joint_{joint}")).collect(),
        time: (0..SAMPLES).map(|k| k as f64 / RATE_HZ).collect(),
        q: Channels::from_vectors(&q),
        tau: Channels::zeros(joints, SAMPLES),
        ..Default::default()
    }
}

/// Torque that `identify` predicts with some effects, `[joint][time]`, by an arm that is described as `described` and identified as `real`.
fn predicted([real, described]: [&Robot; 2], trust: Trust, log: &Recording, placed: Vec<Placed>) -> Vec<Vec<f64>> {
    let preparation = Preparation { smoothing: Smoothing::None, band: Band::Given(0.0) };
    let [true_model, model] = [real, described].map(Model::new);
    let [true_model, mut model] =
        [&true_model, &model].map(|model| EffectModel::new(model, trust, &[log], preparation, placed.clone()).unwrap());
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

fn agree([real, described]: [&Robot; 2], trust: Trust) {
    let log = motion(real.dof());
    let rows = Rows::new(&[&log], CUTOFF_HZ, FEWEST_ROWS).unwrap();
    let mut arm = Arm::new(described, trust);
    if trust == Trust::Structure {
        let model = Model::new(described);
        arm.take(&model, &model.base().values(&Model::standard_values(real)));
    }
    // The same motion for both: the smooth one of the diagnosis, as if it had been measured.
    let motion = &rows.logs[0].motion;
    let smooth =
        Recording { q: motion.q.clone(), qd: Some(motion.qd.clone()), qdd: Some(motion.qdd.clone()), ..log.clone() };
    let robots = [real, described];
    let [of_log, of_smooth] = [&log, &smooth].map(|log| predicted(robots, trust, log, Vec::new()));
    for effect in LIBRARY {
        let about = effect.about();
        let joint = if about.scope == Scope::Arm { 0 } else { 1 };
        // The twist of a gear with play passes the low-pass of the positions, which `identify` does without here.
        let strikes = about.nature == Nature::Play;
        let (log, without, tolerance) = match about.site {
            // What sensors or gears do to positions is differentiated again, by central differences in `identify`.
            Site::Sensor | Site::Gear => (&log, &of_log, if strikes { 0.05 } else { 2e-3 }),
            _ => (&smooth, &of_smooth, 1e-9),
        };
        let mut placed = Placed::typical(*effect, joint);
        if about.nature == Nature::Level {
            placed.parameters[0] = 0.5 * without[joint].iter().fold(0.0, |most: f64, torque| most.max(torque.abs()));
        }
        let added = &arm.added(std::slice::from_ref(&placed), &rows).unwrap()[0];
        let with = predicted(robots, trust, log, vec![placed]);
        let low_pass = ZeroPhaseLowPass::new(ORDER, CUTOFF_HZ, RATE_HZ).unwrap();
        let (mut apart, mut size) = (0.0, 0.0);
        for (joint, (with, without)) in with.iter().zip(without).enumerate() {
            let mut identified: Vec<f64> = with.iter().zip(without).map(|(with, without)| with - without).collect();
            if strikes {
                low_pass.apply_in_place(&mut identified).unwrap();
            }
            let identified = block_means(&identified, BLOCK).unwrap();
            for block in ENDS..identified.len() - ENDS {
                let identified = identified[block];
                let diagnosed = added.part(joint).map_or(0.0, |column| column[block]);
                apart += (identified - diagnosed).powi(2);
                size += diagnosed.powi(2);
            }
        }
        let (apart, size) = (f64::sqrt(apart), f64::sqrt(size));
        assert!(size > 0.0, "{} adds nothing", about.name);
        assert!(apart < tolerance * size, "{} {trust:?}: {apart} of {size}", about.name);
    }
}
