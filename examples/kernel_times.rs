//! CPU time of the dynamics kernels, in ns a sample of the ABB IRB 1600, as JSON on the standard output: what
//! `benches/peers/dynamics.py` runs between its own rounds. Unix only, as CPU time is.

use rand::RngExt;
use std::collections::BTreeMap;
use std::hint::black_box;
use tauscope::dynamics::{Chain, EquationsOfMotion, Lanes, Motion, inverse_dynamics_in, regressor_in};
use tauscope::identification::gram::{BLOCK, Gram};
use tauscope::random;
use tauscope::robot::{self, InertiaCheck};

/// Samples of a batch, as the users of the kernels stream them.
const SAMPLES: usize = BLOCK;
const BATCHES: usize = 400;

/// CPU time of this thread so far, ns.
fn cpu_ns() -> f64 {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    stat.split_whitespace().next().and_then(|field| field.parse().ok()).unwrap_or(f64::NAN)
}

fn time(mut run: impl FnMut()) -> f64 {
    run();
    let start = cpu_ns();
    (0..BATCHES).for_each(|_| run());
    (cpu_ns() - start) / (BATCHES * SAMPLES) as f64
}

fn main() -> tauscope::error::Result<()> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/irb1600_6_120.urdf");
    let robot = robot::load(path, InertiaCheck::Required)?;
    let (chain, inertial) = (Chain::new(&robot), robot.inertial_parameters());
    let mut motion = Motion::zeros(robot.dof(), SAMPLES);
    let mut source = random::stream(1, "states", 0);
    for signals in [&mut motion.q, &mut motion.qd, &mut motion.qdd] {
        signals.as_mut_slice().fill_with(|| source.random_range(-2.0..2.0));
    }
    let mut times = BTreeMap::new();
    for lanes in Lanes::available() {
        let name = lanes.name();
        let own = time(|| drop(black_box(regressor_in(lanes, &chain, black_box(&motion)))));
        times.insert(format!("regressor in {name}"), own);
        let own = time(|| drop(black_box(inverse_dynamics_in(lanes, &chain, &inertial, black_box(&motion)))));
        times.insert(format!("inverse dynamics in {name}"), own);
        let (columns, mut gram) = (42, Gram::new_in(lanes, 42));
        let table: Vec<f64> = (0..columns * SAMPLES).map(|_| source.random_range(-1.0..1.0)).collect();
        times.insert(format!("Gram of 42 columns in {name}"), time(|| gram.add(black_box(&table), SAMPLES)));
    }
    let armature: Vec<f64> = robot.joints.iter().map(|joint| joint.drive.armature).collect();
    let (q, qd, tau) = (motion.q.at(0), motion.qd.at(0), motion.qdd.at(0));
    let forward = time(|| {
        for _ in 0..SAMPLES {
            let equations = EquationsOfMotion::new(&chain, &inertial, &armature, black_box(&q), &qd);
            black_box(equations.accelerations(&tau));
        }
    });
    times.insert("forward dynamics, one state".to_owned(), forward);
    println!("{}", serde_json::to_string(&times).unwrap_or_default());
    Ok(())
}
