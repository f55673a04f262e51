//! The dynamics kernels: `cargo bench --bench dynamics`. Times are for 4096 samples of the ABB IRB 1600.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rand::RngExt;
use std::hint::black_box;
use tauscope::channels::Channels;
use tauscope::dynamics::{
    Chain, EquationsOfMotion, Lanes, Motion, forward_dynamics, inverse_dynamics_into, regressor_in,
};
use tauscope::random;
use tauscope::robot::{self, InertiaCheck, Robot};

const SAMPLES: usize = 4096;

fn arm() -> (Robot, Motion) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/irb1600_6_120.urdf");
    let robot = robot::load(path, InertiaCheck::Required).expect("the arm of the repository");
    let mut motion = Motion::zeros(robot.dof(), SAMPLES);
    let mut source = random::stream(1, "states", 0);
    for signals in [&mut motion.q, &mut motion.qd, &mut motion.qdd] {
        signals.as_mut_slice().fill_with(|| source.random_range(-2.0..2.0));
    }
    (robot, motion)
}

fn kernels(criterion: &mut Criterion) {
    let (robot, motion) = arm();
    let (chain, inertial) = (Chain::new(&robot), robot.inertial_parameters());
    let mut group = criterion.benchmark_group("inverse_dynamics");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    let mut torque = Channels::zeros(robot.dof(), SAMPLES);
    for lanes in Lanes::available() {
        group.bench_function(BenchmarkId::from_parameter(lanes.name()), |bencher| {
            bencher.iter(|| inverse_dynamics_into(lanes, &chain, &inertial, black_box(&motion), &mut torque));
        });
    }
    group.finish();
    let mut group = criterion.benchmark_group("regressor");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    for lanes in Lanes::available() {
        group.bench_function(BenchmarkId::from_parameter(lanes.name()), |bencher| {
            bencher.iter(|| regressor_in(lanes, &chain, black_box(&motion)));
        });
    }
    group.finish();
}

fn forward(criterion: &mut Criterion) {
    let (robot, motion) = arm();
    let (chain, inertial) = (Chain::new(&robot), robot.inertial_parameters());
    let armature: Vec<f64> = robot.joints.iter().map(|joint| joint.drive.armature).collect();
    let (q, qd, tau) = (motion.q.at(0), motion.qd.at(0), motion.qdd.at(0));
    criterion.bench_function("forward_dynamics of one state", |bencher| {
        let mut equations = EquationsOfMotion::new(&chain, &inertial, &armature, &q, &qd);
        bencher.iter(|| {
            equations.update(&chain, &inertial, &armature, black_box(&q), &qd);
            equations.accelerations(&tau)
        });
    });
    let mut group = criterion.benchmark_group("forward_dynamics");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    let mut qdd = Channels::zeros(robot.dof(), SAMPLES);
    let Motion { q, qd, qdd: tau } = &motion;
    for lanes in Lanes::available() {
        group.bench_function(BenchmarkId::from_parameter(lanes.name()), |bencher| {
            bencher.iter(|| {
                forward_dynamics(lanes, &chain, [&inertial, &armature], [black_box(q), qd, tau], &mut qdd);
            });
        });
    }
    group.finish();
}

criterion_group!(benches, kernels, forward);
criterion_main!(benches);
