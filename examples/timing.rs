//! timing
use tauscope::design::*;
use tauscope::design::families::Family;
use tauscope::excitation::*;
use std::time::Instant;
fn main() {
    let setup = tauscope::scenario::Setup::load("scenarios/irb1600.toml", None).unwrap();
    let noise: Vec<f64> = setup.sensors.iter().map(|s| s.torque_noise).collect();
    let experiment = Experiment::new(&setup.plant, &noise, 500.0).unwrap();
    let enc = Family::Freudenstein.encoding(&setup.limits, 10.0, 9).unwrap();
    let x = encoding::random_point(&*enc, 1, "held", 3);
    let reps = 300;
    let time = |name: &str, f: &mut dyn FnMut()| { let t = Instant::now(); for _ in 0..reps { f(); } println!("{name}: {:.3} ms", t.elapsed().as_secs_f64()*1e3/reps as f64); };
    let m = enc.decode(&x);
    time("decode", &mut || { std::hint::black_box(enc.decode(&x)); });
    let [mut q, mut qd, mut qdd] = [[0.0;6];3];
    time("at", &mut || { for k in 0..1000 { m.at(k as f64*0.01, &mut q, &mut qd, &mut qdd); std::hint::black_box(&q); }});
    time("frames", &mut || { for k in 0..1000 { std::hint::black_box(setup.plant.frames(std::hint::black_box(&q))); }});
    let mo = tauscope::dynamics::Motion::zeros(6, 64);
    let chain = tauscope::dynamics::Chain::new(&setup.plant);
    time("regressor", &mut || { for _ in 0..16 { std::hint::black_box(tauscope::dynamics::regressor(&chain, &mo)); }});
    time("information", &mut || { std::hint::black_box(experiment.information(&m, 100.0)); });
}
