//! Whole tasks beside the kernels: `cargo bench --bench tasks`. The ABB IRB 1600 throughout; `benches/peers/compare.py` measures
//! the same beside other libraries.

use criterion::{Criterion, criterion_group, criterion_main};
use rand::RngExt;
use std::hint::black_box;
use std::path::Path;
use tauscope::channels::Channels;
use tauscope::design::information::Experiment;
use tauscope::dynamics::Motion;
use tauscope::identification::fused::{self, Log};
use tauscope::identification::model::Model;
use tauscope::identification::prepare::{self, Smoothing};
use tauscope::identification::tsqr::Triangle;
use tauscope::random;
use tauscope::scenario::{Setup, measure, simulate_with};
use tauscope::signal::{Edge, SavitzkyGolay};
use tauscope::simulation::engine::EngineKind;

const SAMPLES: usize = 60_000;

fn drawn(channels: usize, samples: usize, label: &str) -> Channels {
    let mut source = random::stream(1, label, 0);
    let mut table = Channels::zeros(channels, samples);
    table.as_mut_slice().fill_with(|| source.random_range(-2.0..2.0));
    table
}

fn setup() -> Setup {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/irb1600.toml");
    Setup::load(Path::new(path), None).expect("the scenario of the repository")
}

fn identification(criterion: &mut Criterion) {
    let model = Model::new(&setup().known);
    let dof = model.dof();
    let [q, qd, qdd] = ["q", "qd", "qdd"].map(|label| drawn(dof, SAMPLES, label));
    let motion = Motion { q, qd, qdd };
    let torque = drawn(dof, SAMPLES, "torque");
    let log = Log { motion: &motion, torque: &torque, valid: None };
    let mut group = criterion.benchmark_group("identification of 60 000 samples");
    group.sample_size(10);
    group.bench_function("fused", |bencher| bencher.iter(|| fused::weighted_least_squares(&model, black_box(log))));
    group.bench_function("structured TSQR", |bencher| bencher.iter(|| fused::triangles(&model, black_box(log))));
    let table = drawn(60, 6 * SAMPLES, "table");
    group.bench_function("TSQR of 360 000 x 60", |bencher| {
        bencher.iter(|| {
            let mut triangle = Triangle::new(60);
            triangle.add(black_box(table.as_slice()), 6 * SAMPLES);
            triangle.factor()
        });
    });
    group.finish();
}

fn smoothing(criterion: &mut Criterion) {
    let signals = drawn(6, SAMPLES, "signals");
    let filters = [0, 1, 2].map(|derivative| {
        SavitzkyGolay::new(31, 4, derivative, 1e-3, Edge::Polynomial).expect("a window longer than the order")
    });
    let mut out = [signals.clone(), signals.clone(), signals.clone()];
    criterion.bench_function("Savitzky-Golay and two derivatives of 6 x 60 000", |bencher| {
        bencher.iter(|| {
            for joint in 0..6 {
                let output = out.each_mut().map(|channels| channels.channel_mut(joint));
                SavitzkyGolay::apply_three(filters.each_ref(), black_box(signals.channel(joint)), output)
                    .expect("signals longer than the window");
            }
        });
    });
}

fn studies(criterion: &mut Criterion) {
    let mut setup = setup();
    let experiment =
        Experiment::new(&setup.known, &[3.0, 4.0, 2.0, 0.45, 0.35, 0.18], 100.0).expect("one noise per joint");
    criterion.bench_function("excitation objective, 1000 points", |bencher| {
        bencher.iter(|| experiment.information(black_box(&setup.motion), 100.0).log_determinant());
    });
    setup.scenario.sensors.rate_hz = 500.0;
    let truth = simulate_with(EngineKind::Recursive, &setup, &setup.motion, &mut |_| ()).expect("a run");
    let model = Model::new(&setup.known);
    criterion.bench_function("Monte Carlo trial of 5000 samples", |bencher| {
        bencher.iter(|| {
            let recording = measure(&setup, &truth, 0).expect("a log");
            let smoothing = Smoothing::SavitzkyGolay { window: 31, order: 4, decimation: 1 };
            let prepared = prepare::measured(&recording, smoothing, 0.0).expect("a log longer than the window");
            let log = Log { motion: &prepared.motion, torque: &prepared.torque, valid: None };
            fused::weighted_least_squares(&model, log)
        });
    });
}

criterion_group!(benches, smoothing, studies, identification);
criterion_main!(benches);
