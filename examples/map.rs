use std::path::PathBuf;
use tauscope::diagnosis::*;
use tauscope::identification::effect_model::Trust;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let trust = if args.iter().any(|a| a == "--nominal") { Trust::Nominal } else { Trust::Structure };
    let names: Vec<PathBuf> = args[1..].iter().filter(|a| !a.starts_with("--")).map(Into::into).collect();
    let robot_file = &names[0];
    let logs = &names[1..];
    let t = std::time::Instant::now();
    let mut arm = tauscope::dataset::arm::LoggedArm::open(robot_file, &Default::default(), trust, None, logs).unwrap();
    let read = tauscope::dataset::read_all(logs, &arm.robot).unwrap();
    let mut all = [read, vec![], vec![]];
    arm.settle(None, &mut all).unwrap();
    let robot = arm.robot;
    let [read, ..] = all;
    let named = read.into_iter().map(|(path, sieved)| (path.display().to_string(), sieved)).collect();
    let screened: Vec<Screened> = screen_all(named, &robot).unwrap().into_iter().collect::<Result<_, _>>().unwrap();
    let recs: Vec<&tauscope::recording::Recording> = screened.iter().flat_map(|s| &s.pieces).collect();
    let input = Input { train: recs, ..Default::default() };
    let Observed { model, .. } = observed(&robot, &input, &[]).unwrap();
    let options = Options { trust, ..Default::default() };
    eprintln!("read {:.1} s", t.elapsed().as_secs_f64());
    let map = first_look(&model, &input, &options).unwrap();
    eprintln!("map {:.1} s", t.elapsed().as_secs_f64());
    for j in &map.joints {
        print!("{}: torque {:.3}; residual {:.3}; noise {:.3} (rho {:.2}, sensor {:.3});", j.joint + 1, j.torque, j.residual, j.noise, j.correlation, j.sensor_noise);
        for p in &j.parts {
            if p.significant || p.rms > 0.25 * j.noise { print!(" {}{} {:.3} (p {:.4})", if p.significant { "**" } else { "" }, p.follows.title(), p.rms, p.family_wise_p); }
        }
        for l in &j.lines { print!(" LINE {:.2} Hz {:.3} p {:.1e}", l.hz, l.rms, l.p); }
        println!();
    }
}
