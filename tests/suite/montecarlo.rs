//! Monte Carlo studies: the same bytes however they are computed, and estimators that are as biased as theory has it.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use tauscope::dynamics::Motion;
use tauscope::identification::model::Model;
use tauscope::scenario::{NoiseLevel, RandomMotion, Setup, simulate, simulate_with};
use tauscope::simulation::engine::EngineKind;
use tauscope::study::closed_loop::ClosedLoop;
use tauscope::study::montecarlo::{Cell, Overrides, Plan, Progress, Shard, Study, StudyFolder, Summary, merge};

fn setup() -> Setup {
    Setup::load(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/scenarios/montecarlo.toml"), None).unwrap()
}

fn study(trials: usize, estimators: &[&str], noise: &[f64]) -> Study {
    let setup = setup();
    let levels = noise.iter().map(|&std| NoiseLevel { encoder_rad: Some(std), torque_nm: None }).collect();
    let overrides = Overrides {
        trials: Some(trials),
        estimators: Some(estimators.iter().map(|name| name.to_string()).collect()),
        windows: None,
        butterworth: false,
        noise: Some(levels),
    };
    let plan = Plan::new(&setup, overrides).unwrap();
    Study::new(setup, plan).unwrap()
}

/// Runs a study, or a part of it, until `stop_after` chunks are done.
fn run(study: &Study, out: &Path, shard: Shard, resume: bool, stop_after: usize) -> Option<Summary> {
    let (stop, done) = (AtomicBool::new(false), AtomicUsize::new(0));
    let tick = |_: usize| {
        if done.fetch_add(1, Ordering::Relaxed) + 1 >= stop_after {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let folder = StudyFolder::open(out, study, shard, resume).unwrap();
    folder
        .run(study, &Progress { done: &tick, stop: &stop }, &|_, _| String::new())
        .unwrap()
        .map(|(summary, ..)| summary)
}

fn bytes(folder: &Path) -> Vec<Vec<u8>> {
    ["trials.parquet", "summary.json", "study.json"].map(|name| std::fs::read(folder.join(name)).unwrap()).to_vec()
}

fn threads(count: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap()
}

#[test]
fn threads_interruptions_and_shards_leave_the_bytes_as_they_are() {
    // 140 trials make 70 chunks of two.
    let study = study(140, &["wls"], &[1e-5]);
    let base = tempfile::tempdir().unwrap();
    let place = |name: &str| base.path().join(name);
    let summary = threads(1).install(|| run(&study, &place("one"), Shard::WHOLE, false, usize::MAX)).unwrap();
    let reference = bytes(&place("one"));
    assert_eq!(summary.cells.iter().map(|cell| cell.found).collect::<Vec<_>>(), [140, 0][..1]);
    assert!(!place("one").join("unfinished").exists());

    // Stopped and continued, on more threads.
    assert!(threads(3).install(|| run(&study, &place("resumed"), Shard::WHOLE, false, 5)).is_none());
    let kept = std::fs::read_dir(place("resumed/unfinished")).unwrap().count();
    assert!(kept > 5, "finished chunks are kept: {kept} files");
    assert!(StudyFolder::open(&place("resumed"), &study, Shard::WHOLE, false).is_err(), "not begun anew unasked");
    threads(3).install(|| run(&study, &place("resumed"), Shard::WHOLE, true, usize::MAX)).unwrap();
    assert_eq!(bytes(&place("resumed")), reference);
    // Finished: resuming computes nothing and says the same.
    assert_eq!(run(&study, &place("resumed"), Shard::WHOLE, true, usize::MAX).unwrap(), summary);

    // In three parts, in another order.
    for index in [2, 0] {
        run(&study, &place("parts"), Shard { index, count: 3 }, true, usize::MAX).unwrap();
    }
    let problem = merge(&[place("parts")], &place("merged"), &|_, _| String::new()).unwrap_err().to_string();
    assert!(problem.contains("missing: trials 2 to 3, trials 8 to 9"), "{problem}");
    run(&study, &place("parts"), Shard { index: 1, count: 3 }, true, usize::MAX).unwrap();
    let (merged, ..) = merge(&[place("parts")], &place("merged"), &|_, _| String::new()).unwrap();
    assert_eq!(merged, summary);
    assert_eq!(bytes(&place("merged")), reference);

    let part = place("parts/shard_0001_of_0003");
    let problem =
        merge(&[place("parts"), part.clone()], &place("merged"), &|_, _| String::new()).unwrap_err().to_string();
    assert!(problem.contains("trials 2 to 3: here and in"), "{problem}");
    let problem = merge(&[place("merged/none")], &place("x"), &|_, _| String::new()).unwrap_err().to_string();
    assert!(problem.contains("merged/none"), "{problem}");
}

#[test]
fn parts_of_another_study_are_refused() {
    let (one, other) = (study(2, &["ols"], &[1e-5]), study(2, &["ols"], &[2e-5]));
    let base = tempfile::tempdir().unwrap();
    run(&one, &base.path().join("a"), Shard { index: 0, count: 2 }, false, usize::MAX).unwrap();
    run(&other, &base.path().join("b"), Shard { index: 1, count: 2 }, false, usize::MAX).unwrap();
    let problem = merge(&[base.path().join("a"), base.path().join("b")], &base.path().join("c"), &|_, _| String::new())
        .unwrap_err();
    assert!(problem.to_string().contains("another study"), "{problem}");
    assert!(!base.path().join("c").exists());
}

#[test]
fn noise_biases_least_squares_and_not_instrumental_variables() {
    let study = study(6, &["wls", "iv", "didim"], &[1e-5, 1e-3]);
    let base = tempfile::tempdir().unwrap();
    let summary = run(&study, &base.path().join("s"), Shard::WHOLE, false, usize::MAX).unwrap();
    let cell = |level: u32, estimator: &str| -> &Cell {
        summary.cells.iter().find(|cell| cell.noise_level == level && cell.estimator == estimator).unwrap()
    };
    let biased = |level, estimator| cell(level, estimator).biased.unwrap();
    // Of 52 parameters under no bias about 0.5 % pass three standard errors, some more with six trials' spread.
    for estimator in ["wls", "iv", "didim"] {
        assert!(biased(0, estimator) < 0.12, "{estimator}: {}", biased(0, estimator));
    }
    assert!(biased(1, "wls") > 0.5, "{}", biased(1, "wls"));
    assert!(biased(1, "iv") < 0.12, "{}", biased(1, "iv"));
    assert!(biased(1, "didim") < 0.12, "{}", biased(1, "didim"));
    let error = |estimator| cell(1, estimator).d_beta.unwrap().p50;
    assert!(
        error("didim") < error("iv") && error("iv") < 0.8 * error("wls"),
        "{} {} {}",
        error("didim"),
        error("iv"),
        error("wls")
    );
    // Output error does not look at the positions at all.
    assert_eq!(cell(0, "didim").bias, cell(1, "didim").bias);
}

#[test]
fn a_trial_replays_alone_and_depends_on_the_seed() {
    let study = study(5, &["wls"], &[1e-5]);
    let beta = |study: &Study, trial| study.trial(trial)[0].outcome.clone().unwrap().beta;
    assert_eq!(beta(&study, 3), beta(&study, 3));
    assert_ne!(beta(&study, 3), beta(&study, 4));
    let mut other = setup();
    other.scenario.seed += 1;
    let plan =
        Plan::new(&other, Overrides { trials: Some(5), windows: Some(vec![31]), ..Overrides::default() }).unwrap();
    assert_ne!(beta(&Study::new(other, plan).unwrap(), 3), beta(&study, 3));
}

#[test]
fn drawn_plants_motions_and_starts_are_found_too() {
    let mut setup = setup();
    let spec = setup.scenario.montecarlo.as_mut().unwrap();
    spec.plant_error = 0.2;
    spec.start_error = 0.1;
    spec.random_motion = Some(RandomMotion { moves: 6, duration_s: 8.0 });
    spec.estimators = vec!["wls".into(), "didim".into()];
    let plan = Plan::new(&setup, Overrides::default()).unwrap();
    let study = Study::new(setup, plan).unwrap();
    let rows: Vec<_> = (0..3).flat_map(|trial| study.trial(trial)).collect();
    assert_eq!(rows.len(), 6);
    assert_ne!(rows[0].truth, rows[2].truth);
    assert_eq!(rows[0].truth, rows[1].truth);
    for row in &rows {
        let found = row.outcome.as_ref().unwrap();
        assert!(found.coverage > 0.75, "{} of trial {}: {}", row.estimator, row.trial, found.coverage);
        // The drives of the first three joints move tons of N m; a few are noise.
        assert!(found.torque_std.iter().all(|&std| std < 3.0), "{:?}", found.torque_std);
    }
}

#[test]
fn impossible_plans_are_refused_by_name() {
    let setup = setup();
    let plan = |overrides: Overrides| Plan::new(&setup, overrides).map(drop).unwrap_err().to_string();
    let names = |names: &[&str]| Some(names.iter().map(|name| name.to_string()).collect());
    for (overrides, expected) in [
        (Overrides { trials: Some(0), ..Default::default() }, "trials: 0"),
        (Overrides { estimators: names(&["mle"]), ..Default::default() }, "estimator `mle`"),
        (Overrides { estimators: names(&["wls", "wls"]), ..Default::default() }, "wls is given twice"),
        (Overrides { windows: Some(vec![30]), ..Default::default() }, "30"),
        (
            Overrides {
                noise: Some(vec![NoiseLevel { encoder_rad: Some(-1.0), torque_nm: None }]),
                ..Default::default()
            },
            "noise level",
        ),
    ] {
        let problem = plan(overrides);
        assert!(problem.contains(expected), "{expected}: {problem}");
    }
}

#[test]
fn the_closed_loop_of_the_true_parameters_moves_as_the_plant_in_rapier() {
    let setup = setup();
    let model = Model::new(&setup.known);
    let truth = simulate(&setup, &setup.motion, &mut |_| ()).unwrap().signals;
    let own = simulate_with(EngineKind::Recursive, &setup, &setup.motion, &mut |_| ()).unwrap().signals;
    let worst = |a: &tauscope::channels::Channels, b: &tauscope::channels::Channels| {
        let scale = b.as_slice().iter().fold(0.0f64, |m, v| m.max(v.abs()));
        a.as_slice().iter().zip(b.as_slice()).fold(0.0f64, |m, (x, y)| m.max((x - y).abs())) / scale
    };
    assert!(worst(&own.q, &truth.q) < 1e-12, "{:e}", worst(&own.q, &truth.q));
    assert!(worst(&own.tau, &truth.tau) < 1e-9, "{:e}", worst(&own.tau, &truth.tau));

    // From base parameters alone, in steps of one sample.
    let beta = model.base().values(&Model::standard_values(&setup.plant));
    let Motion { q, qd, .. } = ClosedLoop::new(&setup, &model, &setup.motion).motion(&beta).unwrap();
    assert!(worst(&q, &truth.q) < 1e-4, "{:e}", worst(&q, &truth.q));
    assert!(worst(&qd, &truth.qd) < 1e-2, "{:e}", worst(&qd, &truth.qd));

    let mut impossible = beta;
    impossible.iter_mut().for_each(|value| *value = -*value);
    let problem = ClosedLoop::new(&setup, &model, &setup.motion).motion(&impossible).unwrap_err().to_string();
    assert!(problem.contains("mass matrix"), "{problem}");
}
