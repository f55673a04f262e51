//! Effects hidden in simulated logs must be found by a diagnosis that sees the arm's description and the logs alone; where
//! nothing is hidden, nothing may be named; faults of the data come before physics. A small part of what `tauscope blind`
//! does.

use std::sync::LazyLock;
use tauscope::diagnosis::Verdict;
use tauscope::effects::{Placed, find};
use tauscope::identification::effect_model::Trust;
use tauscope::scenario::Setup;
use tauscope::study::blind::fault::Fault;
use tauscope::study::blind::outside::OUTSIDE;
use tauscope::study::blind::{ArmKind, BlindRun, Case, Class, MotionKind, Outcome, run};

const SEED: u64 = 41;

static SETUP: LazyLock<Setup> =
    LazyLock::new(|| Setup::load(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/irb1600.toml"), None).unwrap());

fn effect(name: &str, joint: usize) -> Vec<Placed> {
    vec![Placed::typical(find(name).unwrap(), joint)]
}

fn blind(case: &Case) -> BlindRun {
    run(&SETUP, case).unwrap()
}

/// The parameter called `name` of the first effect found, with its standard deviation, and its true value.
fn parameter(run: &BlindRun, name: &str) -> (f64, f64, f64) {
    let hidden = &run.hidden[0];
    let index = hidden.effect.parameters().iter().position(|parameter| parameter.name == name).unwrap();
    let member = &run.diagnosis.as_ref().unwrap().found[0].member;
    (member.placed.parameters[index], member.std[index], hidden.parameters[index])
}

fn assert_estimated(run: &BlindRun, name: &str) {
    let (value, std, truth) = parameter(run, name);
    assert!((value - truth).abs() < 4.0 * std && std < 0.5 * truth.abs(), "{name}: {value} +- {std}, truth {truth}");
}

#[test]
fn nothing_hidden_in_white_noise() {
    let run = blind(&Case::plain(SEED));
    let diagnosis = run.diagnosis.unwrap();
    assert_eq!((run.judgement.outcome, diagnosis.verdict), (Outcome::Quiet, Verdict::None));
    assert!(diagnosis.not_found.iter().any(|missed| missed.minimum_detectable.is_some()));
}

#[test]
fn nothing_hidden_in_slow_noise_on_a_random_arm() {
    let run = blind(&Case {
        correlation_s: 0.13,
        trust: Trust::Structure,
        arm: ArmKind::Random(6),
        motion: MotionKind::Fourier,
        cut: true,
        ..Case::plain(SEED)
    });
    assert_eq!(run.judgement.outcome, Outcome::Quiet);
    assert!(run.diagnosis.unwrap().not_found.iter().all(|missed| missed.family.effect != "payload"));
}

#[test]
fn stribeck_friction_is_named() {
    let case = Case { trust: Trust::Structure, hidden: effect("stribeck_friction", 1), ..Case::plain(SEED) };
    let run = blind(&case);
    assert_eq!(run.judgement.outcome, Outcome::Named);
    assert!(run.judgement.wrong.is_empty(), "{:?}", run.judgement.wrong);
    assert_estimated(&run, "rise");
    let closed = run.diagnosis.unwrap().gap_closed;
    assert!(closed > 0.9, "{closed}");
}

#[test]
fn payload_is_found_where_inertias_are_trusted() {
    let run = blind(&Case { hidden: effect("payload", 0), ..Case::plain(SEED) });
    let found = &run.diagnosis.unwrap().found[0];
    // Torque cannot tell a body on the flange from one that is part of the last link.
    let others = found.alternatives.iter().map(|other| other.family);
    let mut set: Vec<_> = others.chain([found.member.candidate.family()]).map(|f| (f.effect, f.joint)).collect();
    set.sort_unstable();
    assert_eq!(set, [("link_inertia_error", 5), ("payload", 0)]);
    assert_eq!(run.judgement.outcome, Outcome::OneOf);
    assert!(run.judgement.wrong.is_empty(), "{:?}", run.judgement.wrong);
}

#[test]
fn delay_is_named() {
    let run = blind(&Case { hidden: effect("time_delay", 0), ..Case::plain(SEED) });
    assert_eq!(run.judgement.outcome, Outcome::Named);
    assert_estimated(&run, "delay");
}

#[test]
fn two_effects_are_both_named() {
    let hidden = [effect("torque_ripple", 2), effect("stribeck_friction", 1)].concat();
    let run = blind(&Case { class: Class::Pair, hidden, ..Case::plain(SEED) });
    assert_eq!(run.judgement.each, [Outcome::Named, Outcome::Named]);
}

#[test]
fn a_law_outside_the_library_gets_no_firm_name() {
    let hidden = vec![Placed::typical(OUTSIDE[1], 1)];
    let run = blind(&Case { class: Class::Outside, hidden, ..Case::plain(SEED) });
    assert_eq!(run.judgement.outcome, Outcome::Flagged, "{:?}", run.judgement);
}

#[test]
fn faults_of_the_data_are_named_and_nothing_else() {
    for (fault, stops) in [(Fault::SwappedTorques, true), (Fault::TorqueSign, true), (Fault::ClippedTorque, false)] {
        let run = blind(&Case { class: Class::Fault, fault: Some(fault), ..Case::plain(SEED) });
        assert_eq!(run.judgement.outcome, Outcome::Named, "{fault:?}: {:?}", run.faults);
        assert_eq!(run.diagnosis.is_none(), stops, "{fault:?}");
    }
}
