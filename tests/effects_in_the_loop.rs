//! Every effect of the library in the loop: simulated in rapier with its scenario, then identified with it and without it.

use std::path::PathBuf;
use tauscope::effects::{LIBRARY, Placed, Role};
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::fit::{Fitted, Logs, fit_effects};
use tauscope::identification::model::Model;
use tauscope::identification::prepare::Smoothing;
use tauscope::scenario::Setup;
use tauscope::study::testbed;

/// One effect's scenario, simulated and fitted.
struct Case {
    placed: Placed,
    with: Fitted,
    without: Fitted,
}

fn case(name: &str) -> Case {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("scenarios/effects/{name}.toml"));
    let setup = Setup::load(path, None).unwrap();
    let runs = testbed::record(&setup, &mut |_| {}).unwrap();
    let placed = setup.effects.last().unwrap().clone();
    assert_eq!(placed.effect.about().name, name);
    let trust = if placed.effect.about().hidden_by_base_parameters { Trust::Nominal } else { Trust::Structure };
    let spec = &setup.scenario.identification;
    let cutoff_hz = spec.low_pass_hz.unwrap();
    let smoothing = Smoothing::LowPass { cutoff_hz, decimation: spec.decimation };
    let preparation = Preparation { smoothing, band: spec.reversal_band_rad_s };
    let (train, test) = ([&runs.training.recording], [&runs.held_out.recording]);
    let logs = Logs { train: &train, test: &test };
    let model = Model::new(&setup.known);
    let typical = Placed::typical(placed.effect, placed.joint);
    Case {
        with: fit_effects(&model, trust, logs, preparation, vec![typical]).unwrap(),
        without: fit_effects(&model, trust, logs, preparation, Vec::new()).unwrap(),
        placed,
    }
}

#[test]
fn what_is_simulated_is_found_again() {
    for effect in LIBRARY {
        let name = effect.about().name;
        if std::env::var("ONLY").is_ok_and(|only| !only.split(',').any(|o| o == name)) {
            continue;
        }
        let started = std::time::Instant::now();
        let result = std::panic::catch_unwind(|| case(name));
        let Ok(case) = result else {
            println!("FAIL {name}: panicked");
            continue;
        };
        let std = case.with.fit.estimate.std();
        for (index, place) in case.with.fit.places.iter().enumerate() {
            let Some((_, k)) = *place else { continue };
            let truth = case.placed.parameters[k];
            let value = case.with.fit.estimate.beta[index];
            let parameter = &effect.parameters()[k];
            let sds = (value - truth) / std[index];
            let ok = sds.abs() < 3.0 && ((value - truth) / truth).abs() < 0.05;
            println!(
                "{} {name} {}: {value:.5} for {truth:.5} +- {:.2e} ({sds:.1} sd, {:.1} %) {:?}",
                if ok { "ok  " } else { "FAIL" },
                parameter.name,
                std[index],
                100.0 * (value / truth - 1.0),
                parameter.role == Role::Amplitude
            );
        }
        let worst = (0..6)
            .max_by(|&a, &b| {
                (case.without.test_rms[a] / case.with.test_rms[a])
                    .total_cmp(&(case.without.test_rms[b] / case.with.test_rms[b]))
            })
            .unwrap();
        println!(
            "     {name}: held-out joint {} {:.3} -> {:.3}; all {:.3?} in {:.1?}",
            worst + 1,
            case.without.test_rms[worst],
            case.with.test_rms[worst],
            case.with.test_rms,
            started.elapsed()
        );
    }
}
