//! What books write in several forms, and what sampling does, are no second effect.

use super::{SETUP, logs, with};
use tauscope::diagnosis::{Diagnosis, Options, diagnose};
use tauscope::effects::{Placed, find};
use tauscope::recording::Recording;

fn diagnosed(logs: &[Recording], candidates: &[&str]) -> Diagnosis {
    let candidates = candidates.iter().map(|&name| name.to_owned()).collect();
    let (test, train) = logs.split_last().unwrap();
    let train: Vec<&Recording> = train.iter().collect();
    diagnose(&SETUP.known, &train, &[test], &Options { candidates, ..Options::default() }, &mut |_| ()).unwrap()
}

fn families(diagnosis: &Diagnosis) -> Vec<(&'static str, usize)> {
    let families = diagnosis.found.iter().map(|found| found.member.candidate.family());
    families.map(|family| (family.effect, family.joint)).collect()
}

#[test]
fn an_exponential_stribeck_curve_is_one_finding() {
    let tustin = Placed { effect: find("stribeck_friction").unwrap(), joint: 1, parameters: vec![120.0, 0.1, 1.0] };
    let logs = logs(&with(&[tustin]), 21, 3);
    let speed_laws = ["stribeck_friction", "nonlinear_viscous_friction", "presliding_hysteresis"];
    let diagnosis = diagnosed(&logs, &speed_laws);
    assert_eq!(families(&diagnosis), [("stribeck_friction", 1)]);
    let found = &diagnosis.found[0];
    assert_eq!(found.member.placed.parameters[2], 1.0);
    for (value, std, truth) in
        [(0, 120.0), (1, 0.1)].map(|(k, truth)| (found.member.placed.parameters[k], found.member.std[k], truth))
    {
        assert!((value - truth).abs() < 4.0 * std, "{value} +- {std}, truth {truth}");
    }
}

#[test]
fn a_part_of_a_sample_of_delay_is_no_finding() {
    let late = |mut log: Recording, samples: f64| {
        log.tau = log.tau.map(|_, tau| {
            let before = |k: usize| tau[k.saturating_sub(1)];
            (0..tau.len()).map(|k| tau[k] - samples * (tau[k] - before(k))).collect()
        });
        log
    };
    let period = 1.0 / SETUP.scenario.sensors.rate_hz;
    let logs = logs(&SETUP, 22, 3);
    let later = |samples: f64| -> Vec<Recording> { logs.iter().map(|log| late(log.clone(), samples)).collect() };
    let diagnosis = diagnosed(&later(0.1), &["time_delay"]);
    assert_eq!(families(&diagnosis), []);
    let [delay, std] = diagnosis.sampling_delay.unwrap();
    assert!((delay - 0.1 * period).abs() < 4.0 * std, "{delay} +- {std}");
    // One that stands out of the noise is, however short.
    assert_eq!(families(&diagnosed(&later(0.4), &["time_delay"])), [("time_delay", 0)]);
}
