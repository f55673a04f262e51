//! CPU time of the product's kernels and tasks, as JSON on the standard output: what `benches/peers/compare.py` runs between
//! the rounds of the peers. Unix only, as CPU time is.

use rand::RngExt;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use tauscope::channels::Channels;
use tauscope::design::criterion::Criterion;
use tauscope::design::information::Experiment;
use tauscope::dynamics::{Chain, Entries, Motion, block_row, forward_dynamics, inverse_dynamics_into};
use tauscope::error::{Error, Result};
use tauscope::excitation::Reference;
use tauscope::identification::fused::{self, Log};
use tauscope::identification::least_squares::weighted_least_squares;
use tauscope::identification::model::Model;
use tauscope::identification::prepare::{self, Smoothing};
use tauscope::identification::tsqr::Triangle;
use tauscope::lane::Lanes;
use tauscope::random;
use tauscope::robot::{self, InertiaCheck, Robot};
use tauscope::scenario::{Setup, sensed, simulate_with};
use tauscope::signal::{Edge, SavitzkyGolay};
use tauscope::simulation::engine::EngineKind;

/// The allocator of the command, so that times are those of the product.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Samples in a batch of the kernels: regressor and columns stay in the cache, as where the product streams them.
const BATCH: usize = 120;

/// Samples of the long identification.
const LONG: usize = 60_000;

/// CPU time of this process so far, ns.
fn cpu_ns() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the pointer is to a timespec of our own.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    time.tv_sec as f64 * 1e9 + time.tv_nsec as f64
}

/// Median CPU time of a run, ns, after one that does not count.
fn cpu(runs: usize, mut run: impl FnMut()) -> f64 {
    run();
    let mut times: Vec<f64> = (0..runs)
        .map(|_| {
            let start = cpu_ns();
            run();
            cpu_ns() - start
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[runs / 2]
}

/// Random numbers between `-size` and `size`.
fn draw(table: &mut Channels, size: f64, label: &str) {
    let mut source = random::stream(1, label, 0);
    table.as_mut_slice().fill_with(|| source.random_range(-size..size));
}

fn states(robot: &Robot, samples: usize) -> Motion {
    let mut motion = Motion::zeros(robot.dof(), samples);
    draw(&mut motion.q, 2.0, "q");
    draw(&mut motion.qd, 2.0, "qd");
    draw(&mut motion.qdd, 2.0, "qdd");
    motion
}

type Times = BTreeMap<String, f64>;

fn kernels(robot: &Robot, times: &mut Times) {
    let (chain, inertial, dof) = (Chain::new(robot), robot.inertial_parameters(), robot.dof());
    let motion = states(robot, BATCH);
    let all = Entries::new(&chain, |link, joint| {
        std::array::from_fn(|p| Some(block_row(dof, link, p, joint)).filter(|_| joint <= link))
    });
    let mut table = vec![0.0; dof * 10 * dof * BATCH];
    let mut torque = Channels::zeros(dof, BATCH);
    let a_sample =
        |runs: usize, mut run: Box<dyn FnMut() + '_>| cpu(runs, || (0..20).for_each(|_| run())) / (20 * BATCH) as f64;
    for lanes in Lanes::available() {
        let name = lanes.name();
        let write = Box::new(|| all.write(lanes, &chain, black_box(&motion), 0..BATCH, &mut table));
        times.insert(format!("regressor, {name}, ns"), a_sample(15, write));
        let write = Box::new(|| inverse_dynamics_into(lanes, &chain, &inertial, black_box(&motion), &mut torque));
        times.insert(format!("inverse dynamics, {name}, ns"), a_sample(15, write));
        let mut accelerations = Channels::zeros(dof, BATCH);
        let armature: Vec<f64> = robot.joints.iter().map(|joint| joint.drive.armature).collect();
        let Motion { q, qd, qdd: tau } = &motion;
        let write = Box::new(|| {
            forward_dynamics(lanes, &chain, [&inertial, &armature], [black_box(q), qd, tau], &mut accelerations);
        });
        times.insert(format!("forward dynamics, {name}, ns"), a_sample(9, write));
    }
}

/// Threads of their own, so that no waiting of others is counted.
fn threads(count: usize) -> Result<rayon::ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
    pool.map_err(|e| Error::request("threads", e.to_string()))
}

fn identification(robot: &Robot, times: &mut Times) -> Result<()> {
    let model = Model::new(robot);
    let motion = states(robot, LONG);
    let mut torque = fused::predicted(&model, &motion, &model.base().values(&Model::standard_values(robot)));
    let mut noise = Channels::zeros(robot.dof(), LONG);
    draw(&mut noise, 1.0, "noise");
    torque.as_mut_slice().iter_mut().zip(noise.as_slice()).for_each(|(tau, e)| *tau += e);
    let log = Log { motion: &motion, torque: &torque, valid: None };
    let (one, two) = (threads(1)?, threads(2)?);
    let solve = || drop(black_box(fused::weighted_least_squares(&model, log)));
    times.insert("identify 60k, ms".to_owned(), one.install(|| cpu(7, solve)) / 1e6);
    let columns = model.base_columns();
    let mut table = vec![0.0; columns.places() * BATCH];
    let write = || {
        for _ in 0..100 {
            let here = 0..BATCH;
            columns.write(Lanes::best(), model.chain(), [black_box(&motion); 2], 0.0, here, &mut table);
        }
    };
    times.insert("base columns, ns".to_owned(), cpu(9, write) / (100 * BATCH) as f64);
    let sums = || drop(black_box(fused::joint_sums(Lanes::best(), &model, log)));
    times.insert("Gram matrices of 60k, ms".to_owned(), one.install(|| cpu(7, sums)) / 1e6);
    let triangles = || drop(black_box(fused::triangles(&model, log)));
    times.insert("structured TSQR of 60k, ms".to_owned(), one.install(|| cpu(5, triangles)) / 1e6);
    // Wall times in turns, so that both see the same machine.
    let mut walls = [f64::INFINITY; 2];
    for _ in 0..41 {
        for (wall, pool) in walls.iter_mut().zip([&one, &two]) {
            let start = Instant::now();
            pool.install(solve);
            *wall = wall.min(start.elapsed().as_secs_f64());
        }
    }
    times.insert("two threads, identify 60k, x".to_owned(), walls[0] / walls[1]);
    let mut wide = Channels::zeros(60, 6 * LONG);
    draw(&mut wide, 1.0, "wide");
    let tall = || {
        let mut triangle = Triangle::new(60);
        triangle.add(wide.as_slice(), 6 * LONG);
        drop(black_box(triangle.factor()));
    };
    times.insert("TSQR 360k x 60, ms".to_owned(), cpu(3, tall) / 1e6);
    Ok(())
}

fn smoothing(times: &mut Times) -> Result<()> {
    let mut signals = Channels::zeros(6, LONG);
    draw(&mut signals, 1.0, "signals");
    let filter = |derivative| SavitzkyGolay::new(31, 4, derivative, 1e-3, Edge::Polynomial);
    let filters = [filter(0)?, filter(1)?, filter(2)?];
    let mut out = [Channels::zeros(6, LONG), Channels::zeros(6, LONG), Channels::zeros(6, LONG)];
    let run = || {
        for joint in 0..6 {
            let output = out.each_mut().map(|channels| channels.channel_mut(joint));
            black_box(SavitzkyGolay::apply_three(filters.each_ref(), signals.channel(joint), output)).ok();
        }
    };
    times.insert("Savitzky-Golay, ms".to_owned(), cpu(15, run) / 1e6);
    Ok(())
}

/// A trial of a study: noise on a simulated run of 5 s at 1 kHz, smoothing, regression, estimate.
fn trial(times: &mut Times) -> Result<()> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/irb1600.toml");
    let mut setup = Setup::load(Path::new(path), None)?;
    setup.scenario.sensors.rate_hz = 1000.0;
    let motion = FirstPart(&setup.motion, 5.0);
    let truth = simulate_with(EngineKind::Recursive, &setup, &motion, &mut |_| ())?;
    let model = Model::new(&setup.known);
    let names: Vec<String> = model.base().groupings().iter().map(|grouping| grouping.name.clone()).collect();
    let runs = AtomicU64::new(0);
    let drawn = || sensed(&setup, &truth, runs.fetch_add(1, Ordering::Relaxed));
    let one = threads(1)?;
    let smoothing = Smoothing::SavitzkyGolay { window: 31, order: 4, decimation: 1 };
    let fast = || {
        let run = || -> Result<()> {
            let recording = drawn()?;
            let prepared = prepare::measured(&recording, &smoothing, 0.0)?;
            let log = Log { motion: &prepared.motion, torque: &prepared.torque, valid: None };
            black_box(fused::weighted_least_squares(&model, log)?);
            Ok(())
        };
        black_box(run()).ok();
    };
    times.insert("Monte Carlo trial, ms".to_owned(), one.install(|| cpu(31, fast)) / 1e6);
    times.insert("noise of a trial, ms".to_owned(), one.install(|| cpu(31, || drop(black_box(drawn())))) / 1e6);
    for decimation in [1, 2] {
        let smoothing = Smoothing::SavitzkyGolay { window: 31, order: 4, decimation };
        let run = || -> Result<()> {
            let rows = prepare::measured(&drawn()?, &smoothing, 0.03)?.regression(&model)?;
            black_box(weighted_least_squares(&rows, &names)?);
            Ok(())
        };
        let name = format!("Monte Carlo trial, filtered columns, coloured noise, every {decimation}, ms");
        times.insert(name, one.install(|| cpu(7, || drop(black_box(run())))) / 1e6);
    }
    Ok(())
}

/// The first seconds of a motion.
struct FirstPart<'a>(&'a dyn Reference, f64);

impl Reference for FirstPart<'_> {
    fn joints(&self) -> usize {
        self.0.joints()
    }

    fn duration_s(&self) -> f64 {
        self.1
    }

    fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        self.0.at(t, q, qd, qdd);
    }
}

/// The states that a motion passes, as the peers of the objective get them.
struct Passed {
    states: Motion,
    rate_hz: f64,
    duration_s: f64,
}

impl Passed {
    fn new(motion: &dyn Reference, rate_hz: f64) -> Self {
        let duration_s = motion.duration_s();
        let time: Vec<f64> = (0..=(duration_s * rate_hz + 1e-9) as usize).map(|k| k as f64 / rate_hz).collect();
        let mut states = Motion::zeros(motion.joints(), time.len());
        motion.along(&time, [&mut states.q, &mut states.qd, &mut states.qdd]);
        Passed { states, rate_hz, duration_s }
    }
}

impl Reference for Passed {
    fn joints(&self) -> usize {
        self.states.joints()
    }

    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let sample = (t * self.rate_hz).round() as usize;
        for (table, out) in [&self.states.q, &self.states.qd, &self.states.qdd].into_iter().zip([q, qd, qdd]) {
            out.copy_from_slice(&table.at(sample));
        }
    }

    fn along(&self, times: &[f64], signals: [&mut Channels; 3]) {
        let first = times.first().map_or(0, |t| (t * self.rate_hz).round() as usize);
        for (table, out) in [&self.states.q, &self.states.qd, &self.states.qdd].into_iter().zip(signals) {
            for joint in 0..self.joints() {
                out.channel_mut(joint).copy_from_slice(&table.channel(joint)[first..first + times.len()]);
            }
        }
    }
}

fn objective(robot: &Robot, times: &mut Times) -> Result<()> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/irb1600.toml");
    let setup = Setup::load(Path::new(path), None)?;
    let experiment = Experiment::new(robot, &[3.0, 4.0, 2.0, 0.45, 0.35, 0.18], 100.0)?;
    let passed = Passed::new(&setup.motion, 100.0);
    let each: [(&str, &dyn Reference); 2] = [("of given states", &passed), ("and the motion", &setup.motion)];
    for (name, motion) in each {
        let run = || {
            let information = experiment.information(motion, 100.0);
            black_box(Criterion::LogDeterminant.value(&information, &[]));
        };
        times.insert(format!("excitation objective {name}, ms"), cpu(21, run) / 1e6);
    }
    Ok(())
}

fn main() -> Result<()> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/irb1600_6_120.urdf");
    let robot = robot::load(path, InertiaCheck::Required)?;
    let mut times = Times::new();
    kernels(&robot, &mut times);
    smoothing(&mut times)?;
    objective(&robot, &mut times)?;
    trial(&mut times)?;
    identification(&robot, &mut times)?;
    println!("{}", serde_json::to_string_pretty(&times).unwrap_or_default());
    Ok(())
}
