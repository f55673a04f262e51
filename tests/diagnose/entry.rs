//! The library's entry: what it refuses, and what it does about a wrong description.

use super::{SETUP, answer, logs, with};
use tauscope::diagnosis::{Consequence, Diagnosis, DiagnosisBuilder, Progress, Verdict};
use tauscope::effects::{Placed, find};
use tauscope::quality::Kind;
use tauscope::recording::Recording;

#[track_caller]
fn assert_refused(diagnosis: DiagnosisBuilder, words: [&str; 2]) {
    let message = diagnosis.run().unwrap_err().to_string();
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
}

#[test]
fn what_cannot_be_diagnosed_is_refused() {
    let logs = logs(&SETUP, 41, 2);
    let [train, test] = &logs[..] else { panic!("two logs") };
    let diagnosis = || Diagnosis::of(&SETUP.known);
    assert_refused(diagnosis().test([test]), ["training logs", "at least one"]);
    assert_refused(diagnosis().train([train]).test([train]), ["test log 1", "training log 1"]);
    assert_refused(diagnosis().train([("a.csv", train), ("b.csv", train)]), ["b.csv", "a.csv"]);
    let part = |seconds: f64| train.time_slice(1.0..=1.0 + seconds);
    assert_refused(diagnosis().train([part(3.0)]), ["training logs", "3.0 s"]);
    let moment = test.time_slice(1.0..=2.0);
    let labels = ["a", "b", "c"].map(str::to_owned);
    assert_refused(diagnosis().train([train]).test([moment]).labels(labels), ["b: ", "1.0 s"]);
    assert_refused(diagnosis().train([train]).alpha(1.0), ["alpha", "between 0 and 1"]);
    assert_refused(diagnosis().train([train]).candidates(["stribek_friction"]), ["stribek", "stribeck_friction"]);
}

#[test]
fn a_wrong_sign_in_all_logs_is_corrected_or_stops() {
    let flipped = |mut log: Recording| {
        log.tau.channel_mut(2).iter_mut().for_each(|tau| *tau = -*tau);
        log
    };
    let flipped: Vec<Recording> = logs(&SETUP, 42, 2).into_iter().map(flipped).collect();
    let diagnosis =
        || Diagnosis::of(&SETUP.known).train(&flipped[..1]).test(&flipped[1..]).candidates(["torque_offset"]);
    let consequence = |faults: &[tauscope::diagnosis::DataFault]| {
        let sign = faults.iter().find(|fault| fault.kind == Kind::TorqueSign);
        sign.map(|fault| fault.consequence)
    };

    let stopped = answer(diagnosis().correct(false));
    assert_eq!((stopped.verdict(), consequence(&stopped.faults)), (Verdict::NotTestable, Some(Consequence::Stops)));
    assert!(stopped.description.is_some() && stopped.logs.train[0].tau == flipped[0].tau);

    let mut progress = Vec::new();
    let corrected = answer(diagnosis().progress(|one| progress.push(one)));
    assert_eq!((corrected.verdict(), consequence(&corrected.faults)), (Verdict::None, Some(Consequence::Corrected)));
    let used = corrected.logs.train[0].tau.channel(2).iter();
    assert!(used.zip(flipped[0].tau.channel(2)).all(|(used, given)| *used == -given));
    assert_eq!(progress.first(), Some(&Progress::Screened));
}

/// A direction of gravity that was corrected in steps of some degrees leaves no tilt of the base to find.
#[test]
fn a_mounting_that_is_corrected_is_no_tilt() {
    let tilt = find("base_tilt").unwrap();
    let mounted = with(&[Placed { effect: tilt, joint: 0, parameters: vec![0.0, 0.72] }]);
    let logs = logs(&mounted, 43, 2);
    let diagnosis = Diagnosis::of(&SETUP.known).train(&logs[..1]).test(&logs[1..]);
    let answer = answer(diagnosis.candidates(["base_tilt", "torque_offset"]));
    let off = (answer.robot.gravity - mounted.plant.gravity).norm() / 9.81;
    assert!(off.to_degrees() < 0.3, "{off} rad: {}", answer.robot.gravity);
    let told: Vec<&str> = answer.findings().iter().map(|finding| finding.effect).collect();
    assert!(!told.contains(&"base_tilt"), "{told:?}");
    let corrected = &answer.description.as_ref().unwrap().description;
    assert_eq!(corrected.gravity, answer.robot.gravity);
    assert!(answer.faults.iter().any(|fault| fault.kind == Kind::Mounting), "{:?}", answer.faults);
}
