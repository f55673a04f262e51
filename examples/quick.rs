//! quick
use tauscope::*;
fn main() {
    let setup = scenario::Setup::load("scenarios/irb1600.toml", None).unwrap();
    let t = std::time::Instant::now();
    let runs = study::testbed::record(&setup, &mut |_| {}).unwrap();
    println!("simulated in {:?}", t.elapsed());
    let s = &runs.training.truth.signals;
    let chain = dynamics::Chain::new(&setup.plant);
    let m = dynamics::Motion { q: s.q.clone(), qd: s.qd.clone(), qdd: s.qdd.clone() };
    let id = dynamics::inverse_dynamics(&chain, &setup.plant.inertial_parameters(), &m);
    for j in 0..6 {
        let (mut worst, mut big, mut stuck) = (0.0f64, 0.0f64, 0);
        for k in 0..s.q.samples() {
            let d = &setup.plant.joints[j].drive;
            let v = s.qd.channel(j)[k];
            let f = if v == 0.0 { stuck += 1; runs.training.truth.friction.channel(j)[k] } else { d.viscous * v + d.coulomb * v.signum() };
            let need = id.channel(j)[k] + d.armature * s.qdd.channel(j)[k] + f;
            worst = worst.max((need - s.tau.channel(j)[k]).abs());
            big = big.max(s.tau.channel(j)[k].abs());
        }
        println!("joint {j}: id residual {:.2e} of {big:.1}, stuck {stuck}", worst / big);
    }
    let model = identification::model::Model::new(&setup.plant);
    for g in model.base().groupings() { println!("{}", g.name); }
    for v in study::testbed::Variant::ALL {
        let r = study::testbed::identify(&setup, &model, &runs, v).unwrap();
        println!("{v:?} d_beta {:.2e} cond {:.2} time {:.3}\n  train {:.3?}\n  held {:.3?}\n resid {:.3?}", r.score.d_beta, r.estimate.condition_number, r.seconds, r.score.torque_std_training_nm, r.score.torque_std_held_out_nm, r.residual_rms);
        println!("worst rel {:.2e}", r.score.relative_errors.iter().fold(0.0f64, |m, e| m.max(e.abs())));
        let truth = model.base().values(&identification::model::Model::standard_values(&setup.plant));
        let inside = truth.iter().zip(r.estimate.intervals()).filter(|(t, i)| **t >= i[0] && **t <= i[1]).count();
        println!("covered {inside} of {}", truth.len());
    }
}
