//! What is found and does not matter is listed, not reported.

use super::{SETUP, logs, with};
use serde_json::Value;
use tauscope::diagnosis::{Conclusion, Criteria, Diagnosis, Gate, Options};
use tauscope::effects::{Placed, find};
use tauscope::recording::Recording;

/// An offset of this many N m on a joint.
fn offset(joint: usize, torque: f64) -> Placed {
    let mut placed = Placed::typical(find("torque_offset").unwrap(), joint);
    placed.parameters[0] = torque;
    placed
}

fn concluded(logs: &[Recording], criteria: Criteria) -> (Conclusion, Value) {
    let (test, train) = logs.split_last().unwrap();
    let candidates = ["torque_offset", "stribeck_friction"].map(str::to_owned).to_vec();
    let options = Options { candidates, criteria, ..Options::default() };
    let answer = Diagnosis::of(&SETUP.known).train(train).test([test]).options(options).run().unwrap();
    let json = serde_json::from_str(&answer.to_json()).unwrap();
    (answer.into_conclusion().unwrap(), json)
}

#[test]
fn a_surely_seen_effect_that_is_too_small_to_matter_is_listed() {
    // 0.6 N m is seen within 40 s, and is neither 2 % of the torque nor a tenth of what the Stribeck friction leaves.
    let mut stribeck = Placed::typical(find("stribeck_friction").unwrap(), 1);
    stribeck.parameters[0] = 20.0;
    let logs = logs(&with(&[stribeck, offset(1, 0.6)]), 61, 3);
    let (conclusion, json) = concluded(&logs, Criteria::default());
    let found = &conclusion.diagnosis.found;
    assert!(found.iter().all(|one| one.member.placed.effect.about().name == "stribeck_friction"), "{found:?}");
    let [minor] = &conclusion.diagnosis.minor[..] else { panic!("{:?}", conclusion.diagnosis.minor) };
    assert_eq!(minor.failed.gate, Gate::Size);
    assert!(
        minor.failed.value < 1.0 && (0.05..1.0).contains(&minor.size[1]),
        "{} {:?}",
        minor.failed.value,
        minor.size
    );
    assert_eq!(json["smaller_findings"][0]["effect"], "torque_offset");
    assert_eq!(json["smaller_findings"][0]["failed"]["gate"], "size");
    assert_eq!(json["criteria"]["share_of_torque"], 0.02);

    // Whoever asks for smaller ones is not refused for the size.
    let all = Criteria { share_of_torque: 1e-4, ..Criteria::default() };
    let (conclusion, _) = concluded(&logs, all);
    let refused: Vec<_> = conclusion
        .diagnosis
        .minor
        .iter()
        .map(|minor| (&minor.found.member.placed, minor.failed, &minor.size))
        .collect();
    assert!(refused.iter().all(|(_, failed, _)| failed.gate != Gate::Size), "{refused:?}");
}

#[test]
fn a_small_effect_that_is_all_there_is_is_a_finding() {
    // Gravity takes up most of it: what it adds to the model is 0.3 % of the torque, less than 2 % and more than a tenth of that.
    let logs = logs(&with(&[offset(1, 6.0)]), 62, 3);
    let (conclusion, _) = concluded(&logs, Criteria::default());
    let [found] = &conclusion.diagnosis.found[..] else { panic!("{:?}", conclusion.diagnosis.minor) };
    let (value, std) = (found.member.placed.parameters[0], found.member.std[0]);
    assert!((value - 6.0).abs() < 4.0 * std && std < 1.0, "{value} +- {std}");
}
