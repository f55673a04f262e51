//! Every effect of the library in the loop: simulated in rapier with its scenario, then identified with it and without it.

use rayon::prelude::*;
use std::path::PathBuf;
use tauscope::effects::{LIBRARY, Placed};
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::fit::{Fitted, Logs, fit_effects};
use tauscope::identification::model::Model;
use tauscope::identification::prepare::Smoothing;
use tauscope::scenario::Setup;
use tauscope::study::testbed;

/// Effects that the arm's own parameters stand for: without them the fit finds a changed friction or rotor instead.
const OF_THE_BASELINE: [&str; 3] = ["viscous_friction", "coulomb_friction", "rotor_inertia"];

/// Its impacts are followed only roughly by a model that sees smoothed positions: the gap lowers the residual but does not
/// come back within a few per cent.
const ROUGH: &str = "backlash";

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
    let smoothing = Smoothing::LowPass { cutoff_hz: spec.low_pass_hz.unwrap(), decimation: spec.decimation };
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

/// What is wrong with a case, in words.
fn faults(name: &str) -> Vec<String> {
    let case = case(name);
    let mut faults = Vec::new();
    let std = case.with.fit.estimate.std();
    for (index, place) in case.with.fit.places.iter().enumerate() {
        let Some((_, k)) = *place else { continue };
        let (truth, value) = (case.placed.parameters[k], case.with.fit.estimate.beta[index]);
        let (sds, share) = ((value - truth) / std[index], (value / truth - 1.0).abs());
        let parameter = case.placed.effect.parameters()[k].name;
        println!("{name} {parameter}: {value:.5e} for {truth:.5e}, {sds:.1} sd, {:.1} %", 100.0 * share);
        if name != ROUGH && !(sds.abs() < 3.0 && share < 0.05) {
            faults.push(format!("{name} {parameter}: {value:e} for {truth:e} ({sds:.1} sd, {:.1} %)", 100.0 * share));
        }
    }
    // What the effect carries is what the two fits predict differently on the held-out motion; without it the residual
    // must rise by that much.
    let (with, without) = (&case.with.test_rms, &case.without.test_rms);
    let ratio = (0..with.len()).map(|j| without[j] / with[j]).fold(0.0, f64::max);
    println!("{name}: without it {ratio:.2} times the held-out residual");
    if !OF_THE_BASELINE.contains(&name) && ratio < RISE {
        faults.push(format!("{name}: without it the held-out residual is only {ratio:.3} times as large"));
    }
    faults
}

/// Least rise of the held-out residual of some joint when an effect is left out; the smallest effect here is that of
/// rapier's native stepping, which lies far below the torque noise of a real arm.
const RISE: f64 = 1.003;

#[test]
fn what_is_simulated_is_found_again() {
    let faults: Vec<String> = LIBRARY.par_iter().flat_map(|effect| faults(effect.about().name)).collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}
