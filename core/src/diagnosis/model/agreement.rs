//! A law over all effects: what an effect adds to the torque is the same for `identify` and `diagnose`. So is its estimate by ordinary least
//! squares on the same rows.

use crate::channels::Channels;
use crate::diagnosis::criteria::Levels;
use crate::diagnosis::logs::{FEWEST_ROWS, Rows};
use crate::diagnosis::model::columns;
use crate::diagnosis::regression::{Column, solve};
use crate::effects::{self, LIBRARY, Nature, Placed, Scope};
use crate::identification::effect_model::Arm;
use crate::identification::effect_model::{EffectModel, Preparation, Trust};
use crate::identification::joint_regression::JointRegression;
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
/// Highest cut-off of the positions of the diagnosis, Hz.
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

/// Cut-off of the positions of each joint, Hz.
fn cutoffs_hz(joints: usize) -> Vec<f64> {
    (0..joints).map(|joint| CUTOFF_HZ - 1.5 * joint as f64).collect()
}

fn preparation(joints: usize) -> Preparation {
    let smoothing = Smoothing::BlockMeans { cutoffs_hz: cutoffs_hz(joints), block: BLOCK };
    Preparation { smoothing, band: Band::Given(0.0) }
}

/// Torque that `identify` predicts with some effects, `[joint][time]`, by an arm that is described as `described` and identified as `real`.
fn predicted([real, described]: [&Robot; 2], trust: Trust, log: &Recording, placed: Vec<Placed>) -> Vec<Vec<f64>> {
    let [true_model, model] = [real, described].map(Model::new);
    let [true_model, mut model] = [&true_model, &model]
        .map(|model| EffectModel::new(model, trust, &[log], preparation(log.joints()), placed.clone()).unwrap());
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
    let fewest = vec![Some(FEWEST_ROWS); real.dof()];
    let cutoffs_hz = cutoffs_hz(real.dof());
    let rows = Rows::logged_through(None, &[&log], (&cutoffs_hz, CUTOFF_HZ), &fewest, &Levels::default()).unwrap();
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
            let away_from_ends = &without[joint][ENDS..without[joint].len() - ENDS];
            placed.parameters[0] = 0.5 * away_from_ends.iter().fold(0.0, |most: f64, torque| most.max(torque.abs()));
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

/// Effects whose columns do not depend on what else is estimated.
const LINEAR: [&str; 4] = ["torque_offset", "joint_spring", "stribeck_friction", "torque_ripple"];

/// Part of its standard deviation by which an estimate may differ.
const OF_DEVIATION: f64 = 1e-6;

#[test]
fn identify_and_diagnose_have_the_same_least_squares_estimate_on_the_same_rows() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
    let robot = load(path, InertiaCheck::Required).unwrap();
    let (dof, model) = (robot.dof(), Model::new(&robot));
    let mut log = motion(dof);
    // Any torque has an estimate.
    let mut noise = random::stream(4, "torque", 0);
    let mut drawn = || -> Vec<f64> { (0..SAMPLES).map(|_| StandardNormal.sample(&mut noise)).collect() };
    log.tau = Channels::from_vectors(&(0..dof).map(|_| drawn()).collect::<Vec<_>>());
    let (cutoffs_hz, fewest) = (cutoffs_hz(dof), vec![Some(FEWEST_ROWS); dof]);
    let rows = Rows::logged_through(None, &[&log], (&cutoffs_hz, CUTOFF_HZ), &fewest, &Levels::default()).unwrap();
    let arm = Arm::new(&robot, Trust::Structure);
    for name in LINEAR {
        let placed = Placed::typical(effects::find(name).unwrap(), 1);
        let identified = EffectModel::new(&model, Trust::Structure, &[&log], preparation(dof), vec![placed.clone()]);
        let regression = identified.unwrap().regression().unwrap();
        let valid: Vec<Vec<bool>> = regression
            .iter()
            .zip(&rows.valid)
            .map(|(one, valid)| {
                let both = one.valid.iter().zip(valid).map(|(a, b)| *a && *b).enumerate();
                both.map(|(row, ok)| ok && (ENDS..rows.len() - ENDS).contains(&row)).collect()
            })
            .collect();
        assert!(valid.iter().all(|valid| valid.iter().filter(|ok| **ok).count() > FEWEST_ROWS));
        // Where parameters of `identify` are placed, the effect's are the last.
        let count = regression.iter().flat_map(|one| &one.parameters).max().unwrap() + 1;
        let of_parameter = |parameter: usize| {
            let of_joint = |(joint, one): (usize, &JointRegression)| {
                let place = one.parameters.iter().position(|own| *own == parameter)?;
                Some((joint, one.columns.channel(place).to_vec()))
            };
            Column::of(regression.iter().enumerate().filter_map(of_joint).collect()).masked(&valid)
        };
        let torque = Column::new(regression.iter().map(|one| one.torque.clone())).masked(&valid);
        let of_identify = solve(&(0..count).map(of_parameter).collect::<Vec<_>>(), &torque);
        let own = columns(&arm, &rows, std::slice::from_ref(&placed)).unwrap().concat();
        let amplitudes = own.len();
        let all: Vec<Column> =
            arm.baseline(&model, &rows).into_iter().chain(own).map(|one| one.masked(&valid)).collect();
        let torque = Column::new(rows.torque.iter().cloned()).masked(&valid);
        let of_diagnose = solve(&all, &torque);
        for back in 1..=amplitudes {
            let [a, b] =
                [(&of_identify, count - back), (&of_diagnose, all.len() - back)].map(|(one, at)| one.values[at]);
            let std = of_diagnose.std(all.len() - back);
            assert!((a - b).abs() < OF_DEVIATION * std, "{name}: {a} and {b} +- {std}");
        }
    }
}
