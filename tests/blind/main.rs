//! Effects hidden in simulated logs must be found by a diagnosis that sees the arm's description and the logs alone; where
//! nothing is hidden, nothing may be named; faults of the data come before physics. A small part of what `tauscope blind`
//! does.

use std::sync::LazyLock;
use tauscope::diagnosis::{Gate, Verdict};
use tauscope::effects::{Placed, find};
use tauscope::excitation::random_sequence::random_sequence;
use tauscope::identification::effect_model::Trust;
use tauscope::scenario::{Setup, measure, simulate};
use tauscope::study::blind::fault::Fault;
use tauscope::study::blind::outside::OUTSIDE;
use tauscope::study::blind::power::power_as_measured;
use tauscope::study::blind::{ArmKind, BlindRun, Case, Class, MotionKind, Outcome, run};

const SEED: u64 = 41;

static SETUP: LazyLock<Setup> =
    LazyLock::new(|| Setup::load(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/irb1600.toml"), None).unwrap());

fn effect(name: &str, joint: usize) -> Vec<Placed> {
    vec![Placed::typical(find(name).unwrap(), joint)]
}

/// What a run of the study hid. The run is written out: a number of the plan is another run once the library grows.
fn hides(name: &str, joint: usize, parameters: &[f64]) -> Placed {
    let effect = find(name).ok().or(OUTSIDE.into_iter().find(|law| law.about().name == name)).unwrap();
    Placed { effect, joint, parameters: parameters.to_vec() }
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
    let rough = Case {
        class: Class::Outside,
        arm: ArmKind::Random(6),
        hidden: vec![hides("outside_rough_spot", 2, &[20.0, 0.11397801369171762, 0.07598534246114508])],
        ..Case::plain(3_982_568_362_247_121_193)
    };
    let drifting = Case {
        class: Class::Outside,
        trust: Trust::Structure,
        arm: ArmKind::Random(7),
        cut: true,
        hidden: vec![hides("outside_drifting_gain", 1, &[-0.02, 7.287992552633867])],
        ..Case::plain(15_719_112_665_189_065_097)
    };
    for case in [rough, drifting] {
        assert_eq!(blind(&case).judgement.outcome, Outcome::Flagged, "{case:?}");
    }
}

#[test]
fn a_heavier_link_is_no_firm_balancer() {
    let run = blind(&Case {
        class: Class::Faint,
        motion: MotionKind::Fourier,
        cut: true,
        severity: 0.3,
        hidden: vec![hides("link_inertia_error", 1, &[10.0, -2.5, 1.0, 0.5, 0.3, -0.25, -0.8, -0.125, 0.05, -0.9])],
        ..Case::plain(1_925_216_992_788_344_751)
    });
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

#[test]
fn play_is_named_by_its_impacts() {
    let run = blind(&Case {
        class: Class::Single,
        correlation_s: 0.5,
        arm: ArmKind::Random(7),
        motion: MotionKind::Fourier,
        hidden: vec![hides("backlash", 0, &[0.0005])],
        ..Case::plain(14_094_663_571_587_312_605)
    });
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
    let run = blind(&Case {
        class: Class::Single,
        correlation_s: 0.13,
        trust: Trust::Structure,
        arm: ArmKind::Random(7),
        motion: MotionKind::Fourier,
        hidden: vec![hides("backlash", 5, &[0.0005])],
        ..Case::plain(6_100_118_243_871_798_321)
    });
    assert_eq!((run.judgement.outcome, run.judgement.wrong.len()), (Outcome::Named, 0), "{:?}", run.judgement);
}

#[test]
fn a_soft_gear_is_no_eccentric_encoder() {
    // It swings at 4 Hz: a column of first order in the compliance had the wrong sign.
    let run = blind(&Case {
        class: Class::Single,
        correlation_s: 0.13,
        trust: Trust::Structure,
        arm: ArmKind::Random(7),
        motion: MotionKind::Fourier,
        hidden: vec![hides("joint_elasticity", 1, &[4e-6])],
        ..Case::plain(7_207_096_315_278_684_981)
    });
    assert_eq!((run.judgement.outcome, run.judgement.wrong.len()), (Outcome::Named, 0), "{:?}", run.judgement);
    assert!(run.judgement.errors.iter().all(|error| error.abs() < 3.0), "{:?}", run.judgement);
}

#[test]
fn a_row_at_the_end_of_a_log_is_no_contact() {
    let run = blind(&Case {
        class: Class::Single,
        correlation_s: 0.13,
        trust: Trust::Structure,
        arm: ArmKind::Random(6),
        hidden: vec![hides("position_dependent_friction", 3, &[-20.0, -10.0])],
        ..Case::plain(10_353_588_268_055_508_009)
    });
    assert_eq!((run.judgement.outcome, run.judgement.wrong.len()), (Outcome::Named, 0), "{:?}", run.judgement);
}

#[test]
fn an_offset_beside_other_friction_is_no_firm_asymmetry() {
    // Named first, when the Stribeck friction was not yet in the model and asymmetry took up some of it.
    let run = blind(&Case {
        class: Class::Pair,
        arm: ArmKind::Random(6),
        motion: MotionKind::Fourier,
        hidden: vec![
            hides("stribeck_friction", 1, &[25.0, 0.1422695460137105, 2.0]),
            hides("torque_offset", 1, &[5.0]),
        ],
        ..Case::plain(8_587_839_250_541_042_861)
    });
    assert!(run.judgement.wrong.is_empty(), "{:?}", run.judgement);
    assert!(run.judgement.outcome.is_right(), "{:?}", run.judgement);
}

#[test]
fn what_fits_better_stays_a_name_beside_what_is_surer() {
    // Faint play was not sure enough, and an elastic gear, which explains less, got the name to itself.
    let run = blind(&Case {
        class: Class::Faint,
        arm: ArmKind::Random(6),
        severity: 0.3,
        hidden: vec![hides("backlash", 2, &[0.0005])],
        ..Case::plain(15_365_366_363_460_461_792)
    });
    assert!(run.judgement.wrong.is_empty(), "{:?}", run.judgement);
}

#[test]
fn all_logs_together_leave_one_name() {
    // The training logs alone leave five, of which two are for other joints. That chance names something else too, at 2 %, is not
    // what is asked here.
    let run = blind(&Case {
        class: Class::Faint,
        correlation_s: 0.13,
        trust: Trust::Structure,
        arm: ArmKind::Random(6),
        motion: MotionKind::Fourier,
        severity: 0.3,
        hidden: vec![hides("position_dependent_friction", 2, &[-20.0, -10.0])],
        ..Case::plain(5_193_867_414_490_845_882)
    });
    // It adds 0.17 % to the torque of its joint, less than matters: it is listed among what is smaller.
    let diagnosis = run.diagnosis.unwrap();
    let [minor] = &diagnosis.minor[..] else { panic!("{} smaller ones", diagnosis.minor.len()) };
    let family = minor.found.member.candidate.family();
    assert_eq!((family.effect, family.joint, minor.failed.gate), ("position_dependent_friction", 2, Gate::Size));
    assert!(minor.found.alternatives.is_empty() && diagnosis.found.is_empty(), "{:?}", minor.found.alternatives);
}

#[test]
fn play_that_hardly_rattles_is_no_firm_elastic_gear() {
    let run = blind(&Case {
        class: Class::Faint,
        correlation_s: 0.13,
        trust: Trust::Structure,
        arm: ArmKind::Random(7),
        cut: true,
        severity: 0.3,
        hidden: vec![hides("backlash", 1, &[0.0005])],
        ..Case::plain(7_941_080_769_162_599_837)
    });
    assert!(run.judgement.wrong.is_empty(), "{:?}", run.judgement);
}

#[test]
fn held_out_logs_that_say_nothing_confirm_nothing() {
    // A torque gain on joint 6 was named: sure on the training logs, and as likely as not by chance on the held-out ones.
    let case = Case {
        class: Class::Quiet,
        correlation_s: 0.5,
        trust: Trust::Structure,
        arm: ArmKind::Random(6),
        ..Case::plain(1_470_912_147_844_311_904)
    };
    assert_eq!(blind(&case).judgement.outcome, Outcome::Quiet);
}

#[test]
fn a_delay_shows_through_the_noise_of_the_encoders() {
    // The accelerations' noise, moved in time, was nearly all that its column held, and the delay seemed five times too short.
    let run = blind(&Case {
        class: Class::Pair,
        correlation_s: 0.5,
        motion: MotionKind::Fourier,
        hidden: vec![
            hides("time_delay", 0, &[-0.004]),
            hides("nonlinear_viscous_friction", 1, &[60.0, 0.49308610746299913, 0.01]),
        ],
        ..Case::plain(10_984_266_695_065_949_510)
    });
    assert!(run.judgement.outcome.is_right() && run.judgement.wrong.is_empty(), "{:?}", run.judgement);
}
