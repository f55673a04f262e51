//! What the simulation has already is not found again; what changed since reference logs is, and what did not is not.

use super::{SETUP, answer, logs, with};
use std::sync::LazyLock;
use tauscope::diagnosis::{Conclusion, Diagnosis, Gate, Verdict};
use tauscope::effects::{Placed, find};
use tauscope::recording::{self, Recording};
use tauscope::robot::{InertiaCheck, load};

static CLEAN: LazyLock<Vec<Recording>> = LazyLock::new(|| logs(&SETUP, 1, 2));
static STRIBECK: LazyLock<Vec<Recording>> = LazyLock::new(|| logs(&with(&[stribeck()]), 2, 5));

fn stribeck() -> Placed {
    Placed::typical(find("stribeck_friction").unwrap(), 1)
}

fn placed(name: &str, joint: usize, parameters: &[f64]) -> Placed {
    Placed { effect: find(name).unwrap(), joint, parameters: parameters.to_vec() }
}

/// The diagnosis of the last of `after` by the others, looking for the effects of these tests only.
fn diagnosed(before: &[Recording], present: Vec<Placed>, after: &[Recording]) -> Conclusion {
    let candidates =
        ["payload", "link_inertia_error", "coulomb_friction", "viscous_friction", "rotor_inertia", "stribeck_friction"];
    let (test, train) = after.split_last().unwrap();
    let diagnosis = Diagnosis::of(&SETUP.known).train(train).test([test]).reference(before).present(present);
    answer(diagnosis.candidates(candidates)).into_conclusion().unwrap()
}

fn names(conclusion: &Conclusion) -> Vec<(&'static str, usize)> {
    let families = conclusion.diagnosis.found.iter().map(|found| found.member.candidate.family());
    families.map(|family| (family.effect, family.joint)).collect()
}

#[track_caller]
fn assert_estimated(value: f64, std: f64, truth: f64) {
    assert!((value - truth).abs() < 4.0 * std && std < 0.1 * truth.abs(), "{value} +- {std}, truth {truth}");
}

#[test]
fn a_payload_since_the_reference_is_weighed() {
    // 1.5 kg with its centre of mass at (0.05, -0.03, 0.12) m.
    let typical = Placed::typical(find("payload").unwrap(), 0).parameters;
    let quarter: Vec<f64> = typical.iter().map(|value| 0.25 * value).collect();
    let after = logs(&with(&[placed("payload", 0, &quarter)]), 3, 3);
    let conclusion = diagnosed(&CLEAN, Vec::new(), &after);
    let diagnosis = &conclusion.diagnosis;
    assert_eq!(diagnosis.found.len(), 1, "{:?}", names(&conclusion));
    let set = diagnosis.found[0].alternatives.iter().map(|other| other.family.effect);
    let set: Vec<&str> = set.chain([names(&conclusion)[0].0]).collect();
    assert!(set.contains(&"payload") && set.len() <= 2, "{set:?}");
    // Before the change the model had nothing of it: no mixture of both.
    let described = &diagnosis.errors.simulation_test_rms;
    for (joint, before) in diagnosis.errors.baseline_rms[1].iter().enumerate() {
        assert!(
            (before / described[joint] - 1.0).abs() < 0.15,
            "joint {joint}: {before}, as described {}",
            described[joint]
        );
    }
    let derived = &diagnosis.derived[0];
    for (name, truth) in [("mass", 1.5), ("center_x", 0.05), ("center_y", -0.03), ("center_z", 0.12)] {
        let one = derived.iter().find(|one| one.name == name).unwrap();
        assert_estimated(one.value, one.std, truth);
    }
    let extended = conclusion.extended().unwrap();
    assert!(extended.effects.is_empty() && extended.robot.joints[5].inertia.physical_fault(1e-6).is_none());
}

#[test]
fn worn_gears_are_a_change_of_friction() {
    let after = logs(&with(&[placed("coulomb_friction", 2, &[4.0])]), 4, 3);
    let conclusion = diagnosed(&CLEAN, Vec::new(), &after);
    assert_eq!(names(&conclusion), [("coulomb_friction", 2)]);
    let member = &conclusion.diagnosis.found[0].member;
    assert_estimated(member.placed.parameters[0], member.std[0], 4.0);
    let changed = conclusion.extended().unwrap().robot.joints[2].drive.coulomb - SETUP.known.joints[2].drive.coulomb;
    assert!((changed - 4.0).abs() < 1.0, "{changed}");
}

/// By two curved laws the search may reach what two linear ones explain: here a power of the speed, then a Stribeck curve.
#[test]
fn wear_that_raises_viscous_and_lowers_coulomb_friction_is_named_as_both() {
    let drive = SETUP.known.joints[1].drive;
    let wear = [("coulomb_friction", -0.25 * drive.coulomb), ("viscous_friction", 0.6 * drive.viscous)];
    let after = logs(&with(&wear.map(|(name, size)| placed(name, 1, &[size]))), 8, 3);
    let (test, train) = after.split_last().unwrap();
    let names_of_wear = wear.map(|(name, _)| name);
    let laws = names_of_wear.iter().copied().chain(["nonlinear_viscous_friction", "stribeck_friction"]);
    let diagnosis = Diagnosis::of(&SETUP.known).train(train).test([test]).reference(&*CLEAN).candidates(laws);
    let conclusion = answer(diagnosis).into_conclusion().unwrap();
    let mut found = names(&conclusion);
    found.sort_unstable();
    assert_eq!(found, names_of_wear.map(|name| (name, 1)));
    for (name, size) in wear {
        let all = &conclusion.diagnosis.found;
        let member = &all.iter().find(|one| one.member.placed.effect.about().name == name).unwrap().member;
        assert_estimated(member.placed.parameters[0], member.std[0], size);
    }
}

#[test]
fn a_change_may_be_for_the_better() {
    let worn = logs(&with(&[placed("viscous_friction", 3, &[2.0])]), 5, 2);
    let after = logs(&SETUP, 6, 3);
    let conclusion = diagnosed(&worn, Vec::new(), &after);
    assert_eq!(names(&conclusion), [("viscous_friction", 3)]);
    let member = &conclusion.diagnosis.found[0].member;
    assert_estimated(member.placed.parameters[0], member.std[0], -2.0);
}

#[test]
fn what_was_there_before_did_not_change() {
    let conclusion = diagnosed(&STRIBECK[..2], Vec::new(), &STRIBECK[2..]);
    assert_eq!(names(&conclusion), []);
    assert_eq!(conclusion.diagnosis.verdict, Verdict::None);
    let before: Vec<&str> =
        conclusion.diagnosis.before.iter().map(|found| found.member.placed.effect.about().name).collect();
    assert_eq!(before, ["stribeck_friction"]);
}

#[test]
fn what_the_simulation_has_is_not_found_again() {
    assert_eq!(names(&diagnosed(&[], Vec::new(), &STRIBECK[2..])), [("stribeck_friction", 1)]);
    // It need not be known exactly.
    let mut known = stribeck();
    known.parameters.iter_mut().for_each(|value| *value *= 1.05);
    let conclusion = diagnosed(&[], vec![known], &STRIBECK[2..]);
    assert_eq!(names(&conclusion), []);
    let fitted = &conclusion.extended().unwrap().effects[0];
    let rise = (fitted.parameters[0], stribeck().parameters[0]);
    assert!((rise.0 - rise.1).abs() < 0.04 * rise.1, "{rise:?}");
}

/// What only the log to judge by has can have no name, and "nothing" would be wrong too.
#[test]
fn a_load_in_the_held_out_log_alone_is_told() {
    // 3 kg. Twice as much makes the checks of the logs doubt the scale of the torques.
    let typical = Placed::typical(find("payload").unwrap(), 0).parameters;
    let half: Vec<f64> = typical.iter().map(|value| 0.5 * value).collect();
    let loaded = logs(&with(&[placed("payload", 0, &half)]), 3, 1);
    let [first, second] = &CLEAN[..] else { panic!("two logs") };
    let all = [first.clone(), second.clone(), loaded[0].clone()];
    let conclusion = diagnosed(&[], Vec::new(), &all);
    let diagnosis = &conclusion.diagnosis;
    assert_eq!((diagnosis.verdict, names(&conclusion)), (Verdict::Unexplained, vec![]));
    assert!(diagnosis.unexplained.iter().any(|left| left.joint == 1), "{:?}", diagnosis.unexplained);
    assert!(diagnosis.unexplained.iter().all(|left| left.structure == "is in the held-out logs alone"));
    // Residual against training rows, against parts of these, and what one set of parameters for all logs leaves.
    assert!(
        diagnosis.unexplained.iter().all(|left| left.passed.len() == 3 && left.passed.iter().all(|one| one.passed))
    );
    assert!(diagnosis.next_experiment.contains("one load"), "{}", diagnosis.next_experiment);
}

/// Torque that comes before its motion lags by no time: the refusal says so.
#[test]
fn a_lag_that_cannot_be_is_refused_with_its_gate() {
    let all = logs(&with(&[placed("time_delay", 0, &[-0.004])]), 9, 3);
    let (test, train) = all.split_last().unwrap();
    let diagnosis = Diagnosis::of(&SETUP.known).train(train).test([test]).candidates(["torque_lag"]);
    let diagnosis = answer(diagnosis).into_conclusion().unwrap().diagnosis;
    assert!(diagnosis.found.is_empty());
    let refused: Vec<_> = diagnosis.rejected.iter().filter(|one| one.failed.gate == Gate::WithinBounds).collect();
    assert!(refused.iter().any(|one| one.slot.0.effect == "torque_lag"), "{:?}", diagnosis.rejected);
    assert!(refused.iter().all(|one| !one.failed.passed && one.failed.value > one.failed.threshold), "{refused:?}");
}

/// The arm of `reference/payload`, whose joints have a torque ripple that is no candidate here, before and after it took up 1.5 kg.
#[test]
fn what_both_lack_cancels_where_logs_follow_the_motions_of_the_reference() {
    let file = |name: &str| format!("{}/tests/reference/payload/{name}", env!("CARGO_MANIFEST_DIR"));
    let robot = load(file("arm.urdf"), InertiaCheck::Ignored).unwrap();
    let [before, after] = ["before.csv", "after.csv"].map(|name| recording::load(file(name), None).unwrap());
    let candidates = ["payload", "link_inertia_error", "coulomb_friction", "viscous_friction", "torque_offset"];
    let builder = Diagnosis::of(&robot).train([&after]).reference([&before]).candidates(candidates);
    let conclusion = answer(builder).into_conclusion().unwrap();
    let diagnosis = &conclusion.diagnosis;
    assert!(diagnosis.scope.equal_states.is_some_and(|share| share > 0.8), "{:?}", diagnosis.scope.equal_states);
    assert_eq!(names(&conclusion), [("payload", 0)]);
    assert!(diagnosis.unexplained.is_empty(), "{:?}", diagnosis.unexplained);
    for (name, truth) in [("mass", 1.5), ("center_x", 0.03), ("center_y", -0.02), ("center_z", 0.09)] {
        let one = diagnosis.derived[0].iter().find(|one| one.name == name).unwrap();
        assert_estimated(one.value, one.std, truth);
    }
    let load = diagnosis.load.as_ref().unwrap().mass_kg.unwrap();
    assert!((load.value - 1.5).abs() < 4.0 * load.standard_error && load.standard_error < 0.01, "{load:?}");
    // The bodies of the arm stay as the reference shows them, the load hangs on its last link.
    let extended = conclusion.extended().unwrap();
    assert!(extended.effects.is_empty() && extended.robot.joints[4].inertia.mass() > 1.0);
}
