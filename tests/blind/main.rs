//! Effects hidden in simulated logs must be found by a diagnosis that sees the arm's description and the logs alone; where
//! nothing is hidden, nothing may be named; faults of the data come before physics. A small part of what `tauscope blind`
//! does.

use std::sync::LazyLock;
use tauscope::diagnosis::Verdict;
use tauscope::effects::{Placed, find};
use tauscope::excitation::random_sequence::random_sequence;
use tauscope::identification::effect_model::Trust;
use tauscope::scenario::{Setup, measure, simulate};
use tauscope::study::blind::fault::Fault;
use tauscope::study::blind::outside::OUTSIDE;
use tauscope::study::blind::power::power_as_measured;
use tauscope::study::blind::{ArmKind, BlindRun, Case, Class, MotionKind, Outcome, Plan, run};

const SEED: u64 = 41;

static SETUP: LazyLock<Setup> =
    LazyLock::new(|| Setup::load(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/irb1600.toml"), None).unwrap());

fn effect(name: &str, joint: usize) -> Vec<Placed> {
    vec![Placed::typical(find(name).unwrap(), joint)]
}

fn blind(case: &Case) -> BlindRun {
    run(&SETUP, case).unwrap()
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
fn two_effects_are_both_named_and_estimated() {
    let hidden = [effect("stribeck_friction", 1), effect("time_delay", 0)].concat();
    let run = blind(&Case { class: Class::Pair, trust: Trust::Structure, hidden, ..Case::plain(SEED) });
    let judgement = &run.judgement;
    assert_eq!((judgement.outcome, &judgement.each[..]), (Outcome::Named, &[Outcome::Named, Outcome::Named][..]));
    assert!(judgement.wrong.is_empty(), "{:?}", judgement.wrong);
    assert!(judgement.errors.len() >= 3 && judgement.errors.iter().all(|error| error.abs() < 4.0), "{judgement:?}");
    let (closed, accounted_for) = (run.diagnosis.unwrap().errors.gap_closed.value, run.accounted_for.unwrap());
    assert!(closed > 0.9 && accounted_for > 0.9, "{closed} {accounted_for}");
    assert!(run.power.iter().chain(&run.power_as_measured).all(|power| *power > 0.99), "{:?}", run.power);
    assert_eq!((run.power.len(), run.power_as_measured.len()), (2, 2));
}

/// No test sees through encoders what their noise drowns in the torque.
#[test]
fn noisy_encoders_hide_effects_from_the_best_of_all_tests() {
    let hidden =
        vec![Placed { effect: find("stribeck_friction").unwrap(), joint: 1, parameters: vec![1.5, 0.15, 2.0] }];
    let power = |encoder_noise: f64| {
        let mut setup = SETUP.clone();
        setup.effects.extend(hidden.iter().cloned());
        setup.sensors.iter_mut().for_each(|sensors| sensors.encoder_noise = encoder_noise);
        let motion = random_sequence(SEED, "power", 0, 9, 16.0, &setup.limits).unwrap();
        let log = measure(&setup, &simulate(&setup, &motion, &mut |_| ()).unwrap(), 0).unwrap();
        power_as_measured(&setup, &hidden, &Case { hidden: hidden.clone(), ..Case::plain(SEED) }, &[log]).unwrap()[0]
    };
    let [fine, noisy] = [1e-6, 1e-3].map(power);
    assert!(fine > 0.95 && noisy < 0.5 * fine, "{fine} {noisy}");
}

#[test]
fn a_law_outside_the_library_gets_no_firm_name() {
    let hidden = vec![Placed::typical(OUTSIDE[0], 1)];
    let run = blind(&Case { class: Class::Outside, hidden, ..Case::plain(SEED) });
    assert_eq!(run.judgement.outcome, Outcome::Flagged, "{:?}", run.judgement);
}

#[test]
fn what_stands_out_for_moments_or_in_time_is_told() {
    // Both were taken for noise: the one is seen at a few moments, the other swings in time.
    for (index, hidden) in [(354, ("outside_rough_spot", 2)), (333, ("outside_drifting_gain", 1))] {
        let run = of_study(20_000, index, hidden);
        assert_eq!(run.judgement.outcome, Outcome::Flagged, "{hidden:?}: {:?}", run.judgement);
    }
}

#[test]
fn a_heavier_link_is_no_firm_balancer() {
    let run = of_study(20_000, 207, ("link_inertia_error", 1));
    assert!(run.judgement.wrong.is_empty(), "{:?}", run.judgement);
}

#[test]
fn faults_of_the_data_are_named_and_nothing_else() {
    for fault in [Fault::SwappedTorques, Fault::TorqueSign, Fault::Degrees] {
        let run = blind(&Case { class: Class::Fault, fault: Some(fault), ..Case::plain(SEED) });
        assert_eq!(run.judgement.outcome, Outcome::Named, "{fault:?}: {:?}", run.faults);
        assert!(run.diagnosis.is_none(), "{fault:?}");
    }
}

/// A run of the full study.
fn of_study(seed: u64, index: usize, hidden: (&str, usize)) -> BlindRun {
    let case = Plan::FULL.cases(seed, SETUP.known.dof()).swap_remove(index);
    assert_eq!((case.hidden[0].effect.about().name, case.hidden[0].joint), hidden);
    blind(&case)
}

#[test]
fn play_is_named_by_its_impacts() {
    let run = of_study(5100, 145, ("backlash", 0));
    assert_eq!((run.judgement.outcome, run.judgement.wrong.len()), (Outcome::Named, 0), "{:?}", run.judgement);
    let diagnosis = run.diagnosis.unwrap();
    let play = diagnosis.found[0].impacts.as_ref().unwrap();
    assert!(play.impacts * 2 > play.changes, "{play:?}");
    let error = (play.half_gap - run.hidden[0].parameters[0]) / play.std;
    assert!(error.abs() < 3.0 && play.std < 0.5 * play.half_gap, "{play:?}");
}

#[test]
fn play_is_named_in_slow_noise() {
    // The program once ended here, over what its teeth do beyond the jumps.
    let run = of_study(9100, 170, ("backlash", 5));
    assert_eq!((run.judgement.outcome, run.judgement.wrong.len()), (Outcome::Named, 0), "{:?}", run.judgement);
}

#[test]
fn a_soft_gear_is_no_eccentric_encoder() {
    // It swings at 4 Hz: a column of first order in the compliance had the wrong sign.
    let run = of_study(4100, 130, ("joint_elasticity", 1));
    assert_eq!((run.judgement.outcome, run.judgement.wrong.len()), (Outcome::Named, 0), "{:?}", run.judgement);
    assert!(run.judgement.errors.iter().all(|error| error.abs() < 3.0), "{:?}", run.judgement);
}

#[test]
fn a_row_at_the_end_of_a_log_is_no_contact() {
    let run = of_study(5100, 136, ("position_dependent_friction", 3));
    assert_eq!((run.judgement.outcome, run.judgement.wrong.len()), (Outcome::Named, 0), "{:?}", run.judgement);
}

#[test]
fn an_offset_beside_other_friction_is_no_firm_asymmetry() {
    // Named first, when the Stribeck friction was not yet in the model and asymmetry took up some of it.
    let run = of_study(12_000, 270, ("stribeck_friction", 1));
    assert!(run.judgement.wrong.is_empty(), "{:?}", run.judgement);
    assert!(run.judgement.outcome.is_right(), "{:?}", run.judgement);
}

#[test]
fn what_fits_better_stays_a_name_beside_what_is_surer() {
    // Faint play was not sure enough, and an elastic gear, which explains less, got the name to itself.
    let run = of_study(12_000, 195, ("backlash", 2));
    assert!(run.judgement.wrong.is_empty(), "{:?}", run.judgement);
}

#[test]
fn all_logs_together_leave_one_name() {
    // The training logs alone leave five, of which two are for other joints. That chance names something else too, at 2 %, is not
    // what is asked here.
    let run = of_study(9100, 211, ("position_dependent_friction", 2));
    assert_eq!(run.judgement.outcome, Outcome::Named, "{:?}", run.judgement);
}

#[test]
fn play_that_hardly_rattles_is_no_firm_elastic_gear() {
    let run = of_study(28_000, 245, ("backlash", 1));
    assert!(run.judgement.wrong.is_empty(), "{:?}", run.judgement);
}

#[test]
fn held_out_logs_that_say_nothing_confirm_nothing() {
    // A torque gain on joint 6 was named: sure on the training logs, and as likely as not by chance on the held-out ones.
    let case = Plan::FULL.cases(28_000, SETUP.known.dof()).swap_remove(65);
    assert!(case.hidden.is_empty());
    assert_eq!(blind(&case).judgement.outcome, Outcome::Quiet);
}

#[test]
fn a_delay_shows_through_the_noise_of_the_encoders() {
    // The accelerations' noise, moved in time, was nearly all that its column held, and the delay seemed five times too short.
    let run = of_study(28_000, 272, ("time_delay", 0));
    assert!(run.judgement.outcome.is_right() && run.judgement.wrong.is_empty(), "{:?}", run.judgement);
}
