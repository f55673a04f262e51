//! `recording.rrd` read back without a viewer: entities, rows, values against the recording, views of the layout.

use rerun::{ChunkStore, ChunkStoreConfig, StoreKind, TimelineName};
use std::fs::File;
use std::path::Path;
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::model::Model;
use tauscope::identification::prepare::Smoothing;
use tauscope::identification::{consistent, fit};
use tauscope::report::viewer::{self, Film};
use tauscope::scenario::Setup;
use tauscope::study::replay;
use tauscope::study::testbed::{self, Runs, Variant};

/// The recording and the layout in a file.
struct Stores {
    recording: ChunkStore,
    layout: ChunkStore,
}

fn written(film: &Film) -> Stores {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.rrd");
    viewer::write(&path, film).unwrap();
    read(&path)
}

fn read(path: &Path) -> Stores {
    let stores = ChunkStore::from_rrd_reader(&ChunkStoreConfig::DEFAULT, &mut File::open(path).unwrap()).unwrap();
    let (mut recordings, mut layouts) = (Vec::new(), Vec::new());
    for (id, store) in stores {
        match id.kind() {
            StoreKind::Recording => recordings.push(store),
            StoreKind::Blueprint => layouts.push(store),
        }
    }
    assert_eq!((recordings.len(), layouts.len()), (1, 1));
    Stores { recording: recordings.remove(0), layout: layouts.remove(0) }
}

/// Times, s, and values of a line.
fn line(store: &ChunkStore, path: &str) -> Vec<(f64, f64)> {
    let scalars = rerun::Scalars::descriptor_scalars().component;
    let mut rows = Vec::new();
    for chunk in store.iter_physical_chunks().filter(|chunk| chunk.entity_path().to_string() == path) {
        let times =
            chunk.iter_component_indices(TimelineName::from_static_str("time"), scalars).map(|(t, _)| t.as_i64());
        let values = chunk.iter_slices::<f64>(scalars).map(|row| row[0]);
        rows.extend(times.zip(values).map(|(t, value)| (t as f64 * 1e-9, value)));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows
}

fn entities(store: &ChunkStore) -> Vec<String> {
    store.all_entities_sorted().into_iter().map(|path| path.to_string()).collect()
}

fn short() -> (Setup, Runs) {
    let setup = Setup::load(format!("{}/tests/scenarios/short.toml", env!("CARGO_MANIFEST_DIR")), None).unwrap();
    let runs = testbed::record(&setup, &mut |_| ()).unwrap();
    (setup, runs)
}

#[test]
fn a_run_is_in_the_recording() {
    let (setup, runs) = short();
    let model = Model::new(&setup.known);
    let scored = testbed::identify(&setup, &model, &runs, Variant::SavitzkyGolay).unwrap();
    let film = viewer::scenario::film(&setup, &runs, Some((&model, &scored))).unwrap();
    let stores = written(&film);
    let entities = entities(&stores.recording);
    for joint in setup.plant.joint_names() {
        for line in [
            "torque/J/measured",
            "torque/J/simulated",
            "torque/J/identified",
            "residual/J/controller_model",
            "residual/J/identified",
            "residual/J/noise_floor",
            "position/J/measured",
            "position/J/commanded",
            "velocity/J/measured",
            "velocity/J/simulated",
        ] {
            let path = format!("/{}", line.replace('J', &joint));
            assert!(entities.contains(&path), "{path} is not among {entities:?}");
        }
    }
    for path in ["/verdict", "/findings", "/arm/measured/joint_1/joint_2", "/arm/commanded/joint_1/joint_2"] {
        assert!(entities.iter().any(|entity| entity == path), "{path} is not among {entities:?}");
    }

    // The training motion with its own times, a break, the held-out motion a second later.
    let (training, held_out) = (&runs.training.recording, &runs.held_out.recording);
    let torque = line(&stores.recording, "/torque/joint_2/measured");
    assert_eq!(torque.len(), training.samples() + 1 + held_out.samples());
    for (sample, (t, value)) in torque[..training.samples()].iter().enumerate() {
        assert!((t - training.time[sample]).abs() < 1e-8);
        assert_eq!(*value, training.tau.channel(1)[sample]);
    }
    assert!(torque[training.samples()].1.is_nan());
    let shift = training.time[training.samples() - 1] + viewer::PAUSE_S;
    for (sample, (t, value)) in torque[training.samples() + 1..].iter().enumerate() {
        assert!((t - shift - held_out.time[sample]).abs() < 1e-8);
        assert_eq!(*value, held_out.tau.channel(1)[sample]);
    }
    // What is left is measured less identified.
    let (identified, left) = (
        line(&stores.recording, "/torque/joint_2/identified"),
        line(&stores.recording, "/residual/joint_2/identified"),
    );
    let mut compared = 0;
    for ((measured, identified), left) in
        torque.iter().zip(&identified).zip(&left).filter(|(_, left)| left.1.is_finite())
    {
        assert!((measured.1 - identified.1 - left.1).abs() < 1e-9);
        compared += 1;
    }
    assert!(compared > training.samples() / 2, "{compared}");
}

#[test]
fn the_arm_moves_as_measured() {
    let (setup, runs) = short();
    let stores = written(&viewer::scenario::film(&setup, &runs, None).unwrap());
    let quaternions = rerun::Transform3D::descriptor_quaternion().component;
    let mut rows: Vec<(i64, [f32; 4])> = Vec::new();
    for chunk in stores.recording.iter_physical_chunks() {
        if chunk.entity_path().to_string() == "/arm/measured/joint_1" {
            let times = chunk
                .iter_component_indices(TimelineName::from_static_str("time"), quaternions)
                .map(|(t, _)| t.as_i64());
            rows.extend(times.zip(chunk.iter_slices::<[f32; 4]>(quaternions).map(|row| row[0])));
        }
    }
    rows.sort_by_key(|row| row.0);
    // 50 poses a second over both motions.
    let seconds = runs.training.recording.duration() + runs.held_out.recording.duration();
    assert!((rows.len() as f64 - 50.0 * seconds).abs() < 6.0, "{} poses in {seconds} s", rows.len());
    // Joint 1 turns about the vertical.
    let recording = &runs.training.recording;
    for &(nanoseconds, [x, y, z, w]) in rows.iter().take(100) {
        let sample = (nanoseconds as f64 * 1e-9 * recording.rate_hz()).round() as usize;
        let half = 0.5 * recording.q.channel(0)[sample];
        assert!(x.abs() < 1e-6 && y.abs() < 1e-6);
        assert!((f64::from(z).atan2(f64::from(w)) - half).abs() < 1e-6, "{z} {w} {half}");
    }
}

#[test]
fn the_layout_has_a_view_for_every_plot() {
    let (setup, runs) = short();
    let stores = written(&viewer::scenario::film(&setup, &runs, None).unwrap());
    let entities = entities(&stores.layout);
    let count =
        |ending: &str| entities.iter().filter(|path| path.starts_with("/view/") && path.ends_with(ending)).count();
    // The arm, the verdict, the findings, and four quantities of six joints.
    assert_eq!(count("/ViewContents"), 3 + 4 * 6);
    assert_eq!((count("/TimeAxis"), count("/PlotLegend")), (4 * 6, 4 * 6));
    assert_eq!((count("/EyeControls3D"), count("/Background")), (1, 1));
    for path in ["/viewport", "/time_panel", "/blueprint_panel", "/selection_panel"] {
        assert!(entities.iter().any(|entity| entity == path), "{path}");
    }
}

#[test]
fn a_fit_shows_the_identified_arm_and_the_noise_floor() {
    let (setup, runs) = short();
    let model = Model::new(&setup.known);
    let (train, test) = ([&runs.training.recording], [&runs.held_out.recording]);
    let logs = fit::Logs { train: &train, test: &test };
    let smoothing = Smoothing::SavitzkyGolay { window: 61, order: 6, decimation: 5 };
    let preparation = Preparation { smoothing, band: 0.03.into() };
    let plain = fit::fit_effects(&model, Trust::Structure, logs, preparation, Vec::new()).unwrap();
    let bodies = consistent::consistent(&model, logs, preparation, &plain).unwrap().robot(&setup.known);
    let replayed = replay::replay(&bodies, &test, preparation).unwrap();

    // The noise that the sensors add, as far as the filter lets it through: 61 samples and order 6 leave 19 % of it.
    for (joint, (noise, sensor)) in plain.test.noise.iter().zip(&setup.sensors).enumerate() {
        let share = noise / sensor.torque_noise;
        assert!((0.25..0.45).contains(&share), "joint {joint}: {share}");
    }
    // The simulated arm follows the measured motion, and needs about the measured torque.
    for joint in 0..6 {
        let (q, own) = (test[0].q.channel(joint), replayed[0].q.channel(joint));
        assert!(q.iter().zip(own).all(|(a, b)| (a - b).abs() < 5e-3), "joint {joint} strays");
        let (tau, own) = (test[0].tau.channel(joint), replayed[0].torque.channel(joint));
        let rms = |of: &dyn Fn(f64, f64) -> f64| {
            // The loop settles at the start, and smoothing knows little of the ends.
            let rows = tau[250..tau.len() - 60].iter().zip(&own[250..]);
            (rows.clone().map(|(&a, &b)| of(a, b).powi(2)).sum::<f64>() / rows.len() as f64).sqrt()
        };
        let (missed, all, noise) = (rms(&|a, b| a - b), rms(&|a, _| a), setup.sensors[joint].torque_noise);
        assert!(missed < 2.0 * noise + 0.05 * all, "joint {joint}: {missed} of {all}, noise {noise}");
    }

    let shown = viewer::fit::Shown { plain: &plain, extended: None, replayed: Some(&replayed) };
    let stores = written(&viewer::fit::film(&setup.known, logs, shown));
    let entities = entities(&stores.recording);
    for path in [
        "/arm/measured/joint_1/joint_2",
        "/arm/simulated/joint_1/joint_2",
        "/residual/joint_1/identified",
        "/residual/joint_1/noise_floor",
        "/residual/joint_1/minus_noise_floor",
        "/torque/joint_1/simulated",
        "/position/joint_1/simulated",
    ] {
        assert!(entities.iter().any(|entity| entity == path), "{path} is not among {entities:?}");
    }
    let floor = line(&stores.recording, "/residual/joint_1/noise_floor");
    assert!(floor.iter().all(|(_, value)| *value == plain.test.noise[0]) && floor.len() == 2, "{floor:?}");
    let simulated = line(&stores.recording, "/torque/joint_1/simulated");
    assert_eq!(simulated.iter().map(|row| row.1).collect::<Vec<_>>(), replayed[0].torque.channel(0));
}

#[test]
fn findings_are_marked_in_time() {
    let scenario = format!("{}/scenarios/effects/stribeck_friction.toml", env!("CARGO_MANIFEST_DIR"));
    let setup = Setup::load(scenario, None).unwrap();
    let runs = testbed::record(&setup, &mut |_| ()).unwrap();
    let (train, test) = (&runs.training.recording, &runs.held_out.recording);
    let diagnosis = tauscope::diagnosis::Diagnosis::of(&setup.known).train([train]).test([test]);
    let answer = diagnosis.candidates(["stribeck_friction"]).run().unwrap();
    let found = answer.diagnosis().unwrap();

    // What the evidence holds row by row is what the answer sums up.
    let evidence = &found.evidence;
    for joint in 0..6 {
        for (rows, rms) in [
            (&evidence.described, &found.errors.simulation_test_rms),
            (&evidence.baseline, &found.errors.baseline_rms[1]),
            (&evidence.extended, &found.errors.extended_test_rms),
        ] {
            let counted: Vec<f64> =
                rows[joint].iter().zip(&evidence.valid[joint]).filter(|(_, ok)| **ok).map(|(r, _)| *r).collect();
            let own = (counted.iter().map(|r| r * r).sum::<f64>() / counted.len() as f64).sqrt();
            assert!((own - rms[joint]).abs() < 1e-9 * rms[joint], "joint {joint}: {own} {}", rms[joint]);
        }
    }
    assert_eq!(evidence.ranking[0].family.joint, 1);

    let film = viewer::diagnosis::film(&setup.known, &[test], found, "Verdict", None);
    let marks: Vec<_> = film.markers.iter().filter(|marker| marker.finding).collect();
    assert!(!marks.is_empty() && marks.len() <= 5);
    for mark in marks {
        assert!(
            mark.text.contains("stribeck_friction on joint_2") && mark.text.contains("N m on joint_2"),
            "{}",
            mark.text
        );
        // Friction rises as the joint slows down: where it acts most, the joint is slow.
        let row = evidence.time.iter().position(|t| (t - mark.time).abs() < 1e-9).unwrap();
        assert!(evidence.qd[1][row].abs() < 0.2, "{}", evidence.qd[1][row]);
    }
    let stores = written(&film);
    assert!(line(&stores.recording, "/residual/joint_2/with_findings").len() >= evidence.len());
    let texts: usize = stores
        .recording
        .iter_physical_chunks()
        .filter(|chunk| chunk.entity_path().to_string() == "/findings")
        .map(|chunk| chunk.num_rows())
        .sum();
    assert_eq!(texts, film.markers.len());
}
