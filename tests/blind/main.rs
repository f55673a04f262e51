//! Effects hidden in simulated logs must be found by a diagnosis that sees the arm's description and the logs alone; where
//! nothing is hidden, nothing may be named. A small part of what `tauscope blind` does.

use tauscope::diagnosis::Verdict;
use tauscope::effects::{Placed, find};
use tauscope::identification::effect_model::Trust;
use tauscope::scenario::Setup;
use tauscope::study::blind::{BlindRun, Case, Outcome, run};

const SEED: u64 = 41;

fn blind(hidden: Option<(&str, usize)>, correlation_s: f64, trust: Trust) -> BlindRun {
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/irb1600.toml");
    let setup = Setup::load(scenario, None).unwrap();
    let hidden = hidden.map(|(effect, joint)| Placed::typical(find(effect).unwrap(), joint));
    run(&setup, &Case { seed: SEED, hidden, severity: 1.0, correlation_s, trust }).unwrap()
}

/// The parameter called `name` of the first effect found, with its standard deviation, and its true value.
fn parameter(run: &BlindRun, name: &str) -> (f64, f64, f64) {
    let hidden = run.hidden.as_ref().unwrap();
    let index = hidden.effect.parameters().iter().position(|parameter| parameter.name == name).unwrap();
    let member = &run.diagnosis.found[0].member;
    (member.placed.parameters[index], member.std[index], hidden.parameters[index])
}

fn assert_estimated(run: &BlindRun, name: &str) {
    let (value, std, truth) = parameter(run, name);
    assert!((value - truth).abs() < 4.0 * std && std < 0.5 * truth.abs(), "{name}: {value} +- {std}, truth {truth}");
}

#[test]
fn nothing_hidden_in_white_noise() {
    let run = blind(None, 0.0, Trust::Nominal);
    assert_eq!(run.outcome, Outcome::Quiet);
    assert_eq!(run.diagnosis.verdict, Verdict::None);
    assert!(run.diagnosis.not_found.iter().any(|missed| missed.minimum_detectable.is_some()));
}

#[test]
fn nothing_hidden_in_slow_noise() {
    let run = blind(None, 0.13, Trust::Structure);
    assert_eq!(run.outcome, Outcome::Quiet);
    assert!(run.diagnosis.not_found.iter().all(|missed| missed.family.effect != "payload"));
}

#[test]
fn stribeck_friction_is_named() {
    let run = blind(Some(("stribeck_friction", 1)), 0.0, Trust::Structure);
    assert_eq!((run.outcome, run.extra), (Outcome::Named, 0));
    assert_estimated(&run, "rise");
    assert!(run.diagnosis.gap_closed > 0.9, "{}", run.diagnosis.gap_closed);
}

#[test]
fn payload_is_found_where_inertias_are_trusted() {
    let run = blind(Some(("payload", 0)), 0.0, Trust::Nominal);
    let found = &run.diagnosis.found[0];
    // Torque cannot tell a body on the flange from one that is part of the last link.
    let others = found.alternatives.iter().map(|other| other.family);
    let mut set: Vec<_> = others.chain([found.member.candidate.family()]).map(|f| (f.effect, f.joint)).collect();
    set.sort_unstable();
    assert_eq!((set, run.extra), (vec![("link_inertia_error", 5), ("payload", 0)], 0));
}

#[test]
fn delay_is_named() {
    let run = blind(Some(("time_delay", 0)), 0.0, Trust::Nominal);
    assert_eq!(run.outcome, Outcome::Named);
    assert_estimated(&run, "delay");
}
