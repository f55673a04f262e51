//! probe
use tauscope::design::*;
use tauscope::design::families::Family;
use tauscope::excitation::*;
use std::time::Instant;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let setup = tauscope::scenario::Setup::load("scenarios/irb1600.toml", None).unwrap();
    let noise: Vec<f64> = setup.sensors.iter().map(|s| s.torque_noise).collect();
    let experiment = Experiment::new(&setup.plant, &noise, 500.0).unwrap();
    let ws = Workspace { floor_m: 0.0, column_radius_m: 0.35, column_top_m: 0.7 };
    let envelope = Envelope::new(&setup.plant, &setup.limits, Some(ws)).unwrap();
    let w = std::env::var("W").map_or(0.15, |x| x.parse().unwrap());
    let crit = Criterion::named(a.get(4).map_or("compromise", |x| x), w).unwrap();
    let grid = std::env::var("GRID").map_or(50.0, |x| x.parse().unwrap());
    let p = Problem::new(experiment, envelope, crit, grid, 0.03).unwrap();
    for (g, b) in p.experiment.model().base().groupings().iter().zip(p.experiment.beta()) { if a.len() == 1 { println!("{b:10.4} {}", g.name); } }
    let size: usize = a.get(2).map_or(6, |x| x.parse().unwrap());
    let fam = Family::named(a.get(1).map_or("freudenstein", |x| x)).unwrap();
    let enc = fam.encoding(&setup.limits, 10.0, size).unwrap();
    let mut ks = vec![]; let mut ds = vec![]; let mut infos = vec![]; let mut ok = 0; let mut tried = 0;
    let t = Instant::now();
    for k in 0..400 {
        let m = enc.decode(&encoding::random_point(&*enc, 1, "held", k));
        let (i, v) = p.observe(&m); tried += 1;
        if k < 40 { ks.push(criterion::condition_number(&i)); ds.push(criterion::log_determinant(&i)); }
        if v.is_none() { ok += 1; }
        if infos.len() < 40 { infos.push(i); }
    }
    println!("{tried} random in {:.3} ms each, {ok} feasible", t.elapsed().as_secs_f64() * 1e3 / 400.0);
    let t = Instant::now(); for i in &infos { std::hint::black_box(Criterion::default().value(i, p.sizes())); } println!("compromise {:.3} ms", t.elapsed().as_secs_f64() * 1e3 / 40.0);
    let t = Instant::now(); for i in &infos { std::hint::black_box(criterion::log_determinant(i)); } println!("D {:.3} ms", t.elapsed().as_secs_f64() * 1e3 / 40.0);
    let med = |v: &mut Vec<f64>| { v.sort_by(f64::total_cmp); v[v.len()/2] };
    println!("random median kappa {:.2} D {:.3}", med(&mut ks), med(&mut ds));
    let ho = |i: &Information| { let mut e: Vec<f64> = infos.iter().map(|o| i.prediction_error(o)).collect(); med(&mut e) };
    let mut hos: Vec<f64> = infos.iter().map(ho).collect(); println!("random HO median {:.4}", med(&mut hos));
    let evals: usize = a.get(3).map_or(3000, |x| x.parse().unwrap());
    let plan = search::Plan { seed: a.get(5).map_or(1, |x| x.parse().unwrap()), label: "x".into(), starts: 1, evaluations: evals, from: None };
    let t = Instant::now();
    let mut last = 0;
    let found = search::minimise(&*enc, &|m: &Motion| { let (i, v) = p.observe(m); p.worth(&i, v) }, &plan, &mut |pr, _| { if pr.evaluations / 2000 > last { last = pr.evaluations/2000; println!("  {} {:?} {:.1}s", pr.evaluations, pr.best, t.elapsed().as_secs_f64()); } true });
    let best = match found.best { Some(b) => b, None => { println!("none {:?}", found.least_violation); return; } };
    let i = p.experiment.information(&best.motion, 500.0);
    println!("{} {size} {:?}: value {:.4} kappa {:.3} D {:.3} had {:.3} worst {:.3}% median {:.4}% HO {:.4} check {:?} in {:.1} s", fam.name(), crit.name(), best.worth.value, criterion::condition_number(&i), criterion::log_determinant(&i), criterion::hadamard(&i), 100.0*Criterion::WorstDeviation.value(&i, p.sizes()), 100.0*med(&mut criterion::relative_deviations(&i, p.sizes())), ho(&i), p.envelope.check(&best.motion), t.elapsed().as_secs_f64());
}
