//! `recording.rrd` read back without a viewer: entities, rows, values against the recording, views of the layout.

mod file;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float32Type, Float64Type, UInt8Type, UInt32Type};
use file::{Chunk, Store, Stores};
use tauscope::channels::Channels;
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::model::Model;
use tauscope::identification::prepare::Smoothing;
use tauscope::identification::{consistent, fit};
use tauscope::report::viewer::{self, Film, Track};
use tauscope::robot::InertiaCheck;
use tauscope::scenario::Setup;
use tauscope::study::replay;
use tauscope::study::testbed::{self, Runs, Variant};

fn written(film: &Film) -> Stores {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.rrd");
    viewer::write(&path, film).unwrap();
    file::read(&path)
}

/// Times, s, and values of a line.
fn line(store: &Store, path: &str) -> Vec<(f64, f64)> {
    let mut rows = Vec::new();
    for chunk in store.of(path) {
        let Some(values) = chunk.component("Scalars:scalars") else { continue };
        let values = values.as_primitive::<Float64Type>().values();
        rows.extend(chunk.times().unwrap().iter().zip(values).map(|(&t, &value)| (t as f64 * 1e-9, value)));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows
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
    let entities = stores.recording.entities();
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
    let mut rows: Vec<(i64, [f32; 4])> = Vec::new();
    for chunk in stores.recording.of("/arm/measured/joint_1") {
        let quaternions = chunk.component("Transform3D:quaternion").unwrap().as_fixed_size_list();
        let parts = quaternions.values().as_primitive::<Float32Type>().values();
        rows.extend(chunk.times().unwrap().iter().copied().zip(parts.as_chunks::<4>().0.iter().copied()));
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
    let entities = stores.layout.entities();
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
fn the_layout_is_one_tree_of_views() {
    let (setup, runs) = short();
    let layout = written(&viewer::scenario::film(&setup, &runs, None).unwrap()).layout;
    let root = layout.numbers::<UInt8Type>("/viewport", "ViewportBlueprint:root_container");
    let hex: String = root.iter().map(|byte| format!("{byte:02x}")).collect();
    let mut open: Vec<String> =
        layout.entities().into_iter().filter(|path| path.replace('-', "") == format!("/container/{hex}")).collect();
    assert_eq!(open.len(), 1, "{hex}");
    // Tabs, horizontal, vertical, grid.
    let (mut kinds, mut views) = ([0; 4], Vec::new());
    while let Some(path) = open.pop() {
        if path.starts_with("/view/") {
            views.push(path);
            continue;
        }
        let kind = layout.numbers::<UInt8Type>(&path, "ContainerBlueprint:container_kind")[0];
        match kind {
            2 => assert_eq!(layout.numbers::<Float32Type>(&path, "ContainerBlueprint:col_shares"), [2.0, 3.0]),
            3 => assert_eq!(layout.numbers::<Float32Type>(&path, "ContainerBlueprint:row_shares"), [3.0, 2.0]),
            4 => assert_eq!(layout.numbers::<UInt32Type>(&path, "ContainerBlueprint:grid_columns"), [2]),
            _ => {}
        }
        kinds[usize::from(kind) - 1] += 1;
        open.extend(layout.texts(&path, "ContainerBlueprint:contents"));
    }
    assert_eq!(kinds, [1, 1, 1, 4]);
    let class = |view: &String| layout.texts(view, "ViewBlueprint:class_identifier").remove(0);
    for (name, count) in [("3D", 1), ("TextDocument", 1), ("TextLog", 1), ("TimeSeries", 4 * 6)] {
        assert_eq!(views.iter().filter(|view| class(view) == name).count(), count, "{name}");
    }
    let origin = |view: &&String| layout.texts(view, "ViewBlueprint:space_origin") == ["/torque/joint_1"];
    let plot = views.iter().find(origin).unwrap();
    assert_eq!(layout.texts(plot, "ViewBlueprint:display_name"), ["joint_1, N m"]);
    assert_eq!(layout.texts(&format!("{plot}/ViewContents"), "ViewContents:query"), ["$origin/**"]);
}

#[test]
fn the_viewer_opens_paused_with_the_whole_run_in_view() {
    let (setup, runs) = short();
    let film = viewer::scenario::film(&setup, &runs, None).unwrap();
    let layout = written(&film).layout;
    let span = film.span().map(|seconds| (1e9 * seconds).round() as i64);
    let mut legends = 0;
    for path in layout.entities() {
        if path.ends_with("/TimeAxis") {
            assert_eq!(layout.numbers::<UInt8Type>(&path, "TimeAxis:link"), [1], "independent");
            let range = layout.values(&path, "TimeAxis:view_range").as_struct();
            let ends = range.columns().iter().map(|end| {
                let end = end.as_union();
                assert_eq!(end.type_names()[end.type_id(0) as usize], "Absolute");
                end.value(0).as_primitive::<arrow_array::types::Int64Type>().value(0)
            });
            assert_eq!(ends.collect::<Vec<_>>(), span);
        } else if path.ends_with("/PlotLegend") {
            legends += usize::from(layout.values(&path, "PlotLegend:visible").as_boolean().value(0));
        } else if path.ends_with("/Background") {
            assert_eq!(layout.numbers::<UInt8Type>(&path, "Background:kind"), [3], "one colour");
        }
    }
    assert_eq!(legends, 4, "of the first joint in each quantity");
    let number = |path: &str, component: &str| layout.numbers::<UInt8Type>(path, component)[0];
    assert_eq!(number("/time_panel", "TimePanelBlueprint:play_state"), 1, "paused");
    assert_eq!(number("/time_panel", "TimePanelBlueprint:state"), 2, "collapsed");
    assert_eq!(layout.texts("/time_panel", "TimePanelBlueprint:timeline"), ["time"]);
    for panel in ["/blueprint_panel", "/selection_panel"] {
        assert_eq!(number(panel, "PanelBlueprint:state"), 1, "hidden");
    }
}

#[test]
fn shapes_have_their_sizes_and_colours() {
    let (setup, runs) = short();
    let recording = written(&viewer::scenario::film(&setup, &runs, None).unwrap()).recording;
    assert_eq!(recording.numbers::<UInt8Type>("/arm", "ViewCoordinates:xyz"), [3, 5, 1], "right, forward, up");
    // The foot of the IRB 1600, solid as measured and in outline as commanded.
    let foot = |path: &str| {
        assert_eq!(recording.numbers::<Float32Type>(path, "Boxes3D:half_sizes"), [0.26, 0.20, 0.04]);
        let at = recording.numbers::<Float32Type>(path, "Transform3D:translation");
        assert_eq!(at, [-0.08, 0.0, 0.04]);
        let color = recording.numbers::<UInt32Type>(path, "Boxes3D:colors")[0];
        (color, recording.numbers::<UInt8Type>(path, "Boxes3D:fill_mode")[0])
    };
    assert_eq!(foot("/arm/measured/shape_0"), (0x383b_40ff, 3));
    assert_eq!(foot("/arm/commanded/shape_0"), (0x56b4_e96e, 1));
}

#[test]
fn meshes_and_capsules_are_shown() {
    let root = env!("CARGO_MANIFEST_DIR");
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(format!("{root}/tests/reference/pendulum.urdf")).unwrap();
    let mesh = "<visual><geometry><mesh filename=\"part.STL\"/></geometry></visual></link>";
    std::fs::write(folder.path().join("mesh.urdf"), text.replace("</link>", mesh)).unwrap();
    std::fs::write(folder.path().join("part.STL"), "solid part\nendsolid part\n").unwrap();
    std::fs::copy(format!("{root}/tests/reference/skew7.urdf"), folder.path().join("plain.urdf")).unwrap();
    let shown = |name: &str| {
        let robot = tauscope::robot::load(folder.path().join(name), InertiaCheck::Ignored).unwrap();
        let q = Channels::from_vectors(&vec![vec![0.0, 0.1]; robot.dof()]);
        let track = Track { name: "measured", ghost: false, time: vec![0.0, 1.0], q };
        let (title, text) = ("arm".to_owned(), "text".to_owned());
        written(&Film { title, robot: &robot, text, tracks: vec![track], signals: vec![], markers: vec![] }).recording
    };
    let mesh = shown("mesh.urdf");
    let path = mesh.entities().into_iter().find(|path| path.ends_with("/shape_0")).unwrap();
    assert_eq!(mesh.texts(&path, "Asset3D:media_type"), ["model/stl"]);
    let blob = mesh.values(&path, "Asset3D:blob").as_list::<i32>().value(0);
    assert_eq!(blob.as_primitive::<UInt8Type>().values().to_vec(), b"solid part\nendsolid part\n");
    assert_eq!(mesh.numbers::<UInt32Type>(&path, "Asset3D:albedo_factor").len(), 1);
    // Without markers there are no rows of them.
    assert!(!mesh.entities().contains(&"/findings".to_owned()));

    let plain = shown("plain.urdf");
    let length = plain.numbers::<Float32Type>("/arm/measured/shape_0", "Capsules3D:lengths")[0];
    let radius = plain.numbers::<Float32Type>("/arm/measured/shape_0", "Capsules3D:radii")[0];
    assert!(length > 0.0 && radius > 0.0);
}

#[test]
fn a_fit_shows_the_identified_arm_and_the_noise_floor() {
    let (setup, runs) = short();
    let model = Model::new(&setup.known);
    let (train, test) = ([&runs.training.recording], [&runs.held_out.recording]);
    let logs = fit::Logs { train: &train, test: &test };
    let smoothing = Smoothing::SavitzkyGolay { window: 61, order: 6, decimation: 5 };
    let preparation = Preparation { smoothing, band: 0.03.into() };
    let plain = fit::fit_effects(&model, Trust::Structure, logs, preparation.clone(), Vec::new()).unwrap();
    let bodies = consistent::consistent(&model, logs, preparation.clone(), &plain).unwrap().robot(&setup.known);
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
    let entities = stores.recording.entities();
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
    let texts: usize = stores.recording.of("/findings").map(Chunk::rows).sum();
    assert_eq!(texts, film.markers.len());
}
