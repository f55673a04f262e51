//! Every effect of the library in the loop: simulated in rapier with its scenario, then identified with it and without it.

use rayon::prelude::*;
use std::path::PathBuf;
use tauscope::effects::{Hidden, LIBRARY, Placed};
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::fit::{Fitted, Logs, fit_effects};
use tauscope::identification::model::Model;
use tauscope::identification::prepare::Smoothing;
use tauscope::scenario::Setup;
use tauscope::study::testbed;

/// Effects that the arm's own parameters stand for: without them the fit finds a changed friction or rotor instead.
const OF_THE_BASELINE: [&str; 3] = ["viscous_friction", "coulomb_friction", "rotor_inertia"];

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
    let hidden = placed.effect.about().hidden_by_base_parameters;
    let trust = if hidden == Hidden::No { Trust::Structure } else { Trust::Nominal };
    let spec = &setup.scenario.identification;
    let smoothing = Smoothing::LowPass { cutoff_hz: spec.low_pass_hz.unwrap(), decimation: spec.decimation };
    let preparation = Preparation { smoothing, band: spec.reversal_band_rad_s.into() };
    let (train, test) = ([&runs.training.recording], [&runs.held_out.recording]);
    let logs = Logs { train: &train, test: &test };
    let model = Model::new(&setup.known);
    let typical = Placed::typical(placed.effect, placed.joint);
    Case {
        with: fit_effects(&model, trust, logs, preparation.clone(), vec![typical]).unwrap(),
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
        if !(sds.abs() < 3.0 && share < 0.05) {
            faults.push(format!("{name} {parameter}: {value:e} for {truth:e} ({sds:.1} sd, {:.1} %)", 100.0 * share));
        }
    }
    if !OF_THE_BASELINE.contains(&name) {
        faults.extend(rise_fault(name, &case.with, &case.without));
    }
    faults
}

/// What an effect carries is what the fits with and without it predict differently on the held-out motion. Leaving it out
/// must raise the sum of squares by that much: what the better fit leaves is noise and has nothing to do with it. The
/// joint that the effect reaches most is looked at.
fn rise_fault(name: &str, with: &Fitted, without: &Fitted) -> Option<String> {
    let pairs = |joint: usize| {
        let rows = with.test.residual[joint].iter().zip(&without.test.residual[joint]);
        rows.filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect::<Vec<(f64, f64)>>()
    };
    let mean = |joint: usize, of: fn(f64, f64) -> f64| {
        let rows = pairs(joint);
        rows.iter().map(|&(a, b)| of(a, b)).sum::<f64>() / rows.len() as f64
    };
    let reached = |joint: usize| mean(joint, |a, b| (b - a).powi(2)) / mean(joint, |a, _| a * a);
    let joint = (0..with.test.residual.len()).max_by(|&a, &b| reached(a).total_cmp(&reached(b)))?;
    let (carried, noise) = (mean(joint, |a, b| (b - a).powi(2)), mean(joint, |a, _| a * a));
    let rise = mean(joint, |a, b| b * b - a * a);
    // Four standard errors of the product of noise and effect, with rows that are about independent after decimation.
    let chance = 8.0 * (noise * carried / pairs(joint).len() as f64).sqrt();
    println!(
        "{name}: carries {:.3} of noise {:.3} N m, sum of squares rises by {:.3} of that",
        carried.sqrt(),
        noise.sqrt(),
        rise / carried
    );
    ((rise - carried).abs() > 0.25 * carried + chance || rise <= 0.0)
        .then(|| format!("{name}: carries {carried:e}, but the mean square rises by {rise:e}"))
}

#[test]
fn what_is_simulated_is_found_again() {
    let faults: Vec<String> = LIBRARY.par_iter().flat_map(|effect| faults(effect.about().name)).collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}
