//! The extended model is a scenario that loads, with the dynamics that were found, and rapier runs it as the fit says.

use super::{SETUP, logs, with};
use tauscope::channels::Channels;
use tauscope::diagnosis::{Diagnosis, ExtendedModel};
use tauscope::dynamics::Motion;
use tauscope::effects::{Placed, Site, find};
use tauscope::identification::effect_model::Trust;
use tauscope::random;
use tauscope::robot::with_parameters;
use tauscope::scenario::{Scenario, Setup};
use tauscope::simulation::engine::EngineKind;

fn random_motion(dof: usize, samples: usize) -> Motion {
    use rand::RngExt;
    let mut source = random::stream(8, "extended model", 0);
    let mut draw =
        || Channels::from_vectors(&vec![(0..samples).map(|_| source.random_range(-2.0..2.0)).collect(); dof]);
    Motion { q: draw(), qd: draw(), qdd: draw() }
}

fn check(trust: Trust) {
    let hidden = Placed::typical(find("stribeck_friction").unwrap(), 1);
    let recordings = logs(&with(&[hidden]), 7, 3);
    let (test, train) = recordings.split_last().unwrap();
    let diagnosis = Diagnosis::of(&SETUP.known).train(train).test([test]).trust(trust);
    let mut conclusion = diagnosis.candidates(["stribeck_friction"]).run().unwrap().into_conclusion().unwrap();
    let extended = conclusion.extended().unwrap().clone();

    let folder = tempfile::tempdir().unwrap();
    let scenario =
        Scenario::of(&extended.robot, "extended.urdf".as_ref(), &extended.effects, None, &conclusion.measured, 5);
    std::fs::write(folder.path().join("extended.urdf"), with_parameters(&extended.robot).unwrap()).unwrap();
    std::fs::write(folder.path().join("extended.toml"), scenario.to_toml().unwrap()).unwrap();
    let setup = Setup::load(folder.path().join("extended.toml"), None).unwrap();
    let motion = random_motion(6, 50);
    let time: Vec<f64> = (0..50).map(f64::from).collect();
    let mut effects = setup.effects.clone();
    effects.retain(|placed| placed.effect.about().site == Site::Joint && placed.effect.of_drive().is_none());
    assert!(effects.iter().any(|placed| placed.effect.about().name == "stribeck_friction"));
    let loaded = ExtendedModel { robot: setup.plant.clone(), effects };
    let (own, loaded) = (extended.torque(&time, &motion), loaded.torque(&time, &motion));
    for (a, b) in own.as_slice().iter().zip(loaded.as_slice()) {
        assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "{a} {b}");
    }

    // Rapier's motor torque misses the measured one by no more than the regression does.
    let [run, own] =
        [EngineKind::Rapier, EngineKind::Recursive].map(|engine| conclusion.resimulate(engine).unwrap().clone());
    for (rapier, own) in run.extended_rms.iter().zip(&own.extended_rms) {
        assert!((rapier - own).abs() < 1e-9 * rapier, "{run:?} {own:?}");
    }
    let pairs = run.extended_rms.iter().zip(&conclusion.diagnosis.errors.extended_test_rms);
    for (simulated, regressed) in pairs {
        assert!(
            (simulated / regressed - 1.0).abs() < 0.15,
            "{run:?} {:?}",
            conclusion.diagnosis.errors.extended_test_rms
        );
    }
    assert!(run.baseline_rms[1] > 1.5 * run.extended_rms[1], "{run:?}");
    assert!(run.gap_closed.value > 0.9 && run.gap_closed.interval[0] > 0.8, "{run:?}");
    assert!(run.described_rms.unwrap()[1] > 1.5 * run.extended_rms[1]);
}

#[test]
fn with_identified_bodies() {
    check(Trust::Structure);
}

#[test]
fn with_trusted_bodies() {
    check(Trust::Nominal);
}

/// A first axis along gravity does not feel the moments of what it carries until the base is tilted: the model with the tilt has them.
#[test]
fn with_moments_that_a_tilt_makes_felt() {
    let tilt = Placed { effect: find("base_tilt").unwrap(), joint: 0, parameters: vec![0.05, -0.04] };
    let mut setup = with(&[tilt]);
    setup.plant.joints[0].inertia.0.iter_mut().for_each(|value| *value *= 2.0);
    let recordings = logs(&setup, 31, 3);
    let (test, train) = recordings.split_last().unwrap();
    let diagnosis = Diagnosis::of(&SETUP.known).train(train).test([test]).trust(Trust::Structure);
    let mut conclusion = diagnosis.candidates(["base_tilt"]).run().unwrap().into_conclusion().unwrap();
    let simulated = conclusion.resimulate(EngineKind::Recursive).unwrap().extended_rms.clone();
    let regressed = &conclusion.diagnosis.errors.extended_test_rms;
    let pairs = simulated.iter().zip(regressed);
    assert!(
        pairs.clone().all(|(simulated, regressed)| (simulated / regressed - 1.0).abs() < 0.15),
        "{simulated:?} {regressed:?}"
    );
}
