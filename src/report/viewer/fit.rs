//! The film of a fit: the held-out logs with what the fits without and with effects leave of them.

use super::{Film, Look, Marker, Quantity, Track, joined, joined_time, offsets};
use crate::channels::Channels;
use crate::identification::fit::{Fitted, Logs};
use crate::recording::Recording;
use crate::report::console::significant;
use crate::robot::Robot;

/// Samples of the logs together that are shown: longer ones are thinned, or the recording would be larger than they are.
const MOST_SHOWN: usize = 200_000;

/// The film of a fit on its held-out logs; on the training logs, without residuals, where there are no others.
pub fn film<'a>(robot: &'a Robot, logs: Logs, plain: &Fitted, extended: Option<&Fitted>) -> Film<'a> {
    let (whole, held_out) = if logs.test.is_empty() { (logs.train, false) } else { (logs.test, true) };
    let step = whole.iter().map(|log| log.samples()).sum::<usize>().div_ceil(MOST_SHOWN).max(1);
    let thin: Vec<Recording> = if step == 1 { Vec::new() } else { whole.iter().map(|log| every(log, step)).collect() };
    let shown: Vec<&Recording> = if step == 1 { whole.to_vec() } else { thin.iter().collect() };
    let offsets = offsets(shown.iter().map(|log| [log.time[0], log.time[log.samples() - 1]]));
    let starts: Vec<(f64, &[f64])> = offsets.iter().copied().zip(shown.iter().map(|log| &log.time[..])).collect();
    let time = joined_time(&starts);
    let standing: Vec<Vec<f64>> = (0..robot.dof())
        .map(|joint| {
            let mut last = 0.0;
            let mut all = joined(&shown.iter().map(|log| log.q.channel(joint)).collect::<Vec<_>>());
            // Between two logs the arm stands where the first ended.
            for q in &mut all {
                last = if q.is_nan() { last } else { *q };
                *q = last;
            }
            all
        })
        .collect();
    let kind = if held_out { "held-out" } else { "training" };
    let mut film = Film {
        title: format!("identification of {}", robot.name),
        robot,
        text: text(robot, plain, extended),
        tracks: vec![Track {
            name: "measured",
            ghost: false,
            time: time.clone(),
            q: Channels::from_vectors(&standing),
        }],
        signals: Vec::new(),
        markers: offsets
            .iter()
            .zip(&shown)
            .enumerate()
            .map(|(k, (offset, log))| Marker {
                time: offset + log.time[0],
                text: format!("{kind} log {} starts", k + 1),
                finding: false,
            })
            .collect(),
    };
    let raw = |table: &dyn Fn(usize) -> Vec<f64>| -> (Vec<f64>, Vec<f64>) {
        let each: Vec<Vec<f64>> = (0..shown.len()).map(table).collect();
        (time.clone(), joined(&each.iter().map(Vec::as_slice).collect::<Vec<_>>()))
    };
    film.add(Quantity::Torque, "measured", Look::Measured, |j| raw(&|k| shown[k].tau.channel(j).to_vec()));
    film.add(Quantity::Position, "measured", Look::Measured, |j| raw(&|k| shown[k].q.channel(j).to_vec()));
    if shown.iter().all(|log| log.qd.is_some()) {
        film.add(Quantity::Velocity, "measured", Look::Measured, |j| {
            raw(&|k| shown[k].qd.as_ref().map_or_else(Vec::new, |qd| qd.channel(j).to_vec()))
        });
    }
    if held_out {
        let fits = [(plain, "identified", "identified", Look::Simulated)];
        let with = extended.map(|fitted| (fitted, "with effects", "with effects", Look::Extended));
        for (fitted, torque, residual, look) in fits.into_iter().chain(with) {
            film.add(Quantity::Torque, torque, look, |j| {
                let left = fitted.test_residual[j].iter();
                let predicted: Vec<f64> =
                    fitted.test_torque[j].iter().zip(left).map(|(tau, r)| r.map_or(f64::NAN, |r| tau - r)).collect();
                rows(fitted, &offsets, &predicted)
            });
            film.add(Quantity::Residual, residual, look, |j| {
                let left: Vec<f64> = fitted.test_residual[j].iter().map(|r| r.unwrap_or(f64::NAN)).collect();
                rows(fitted, &offsets, &left)
            });
        }
    }
    film
}

/// Every n-th sample of a log.
fn every(log: &Recording, step: usize) -> Recording {
    let thin = |table: &Channels| table.map(|_, signal| signal.iter().copied().step_by(step).collect());
    Recording {
        joints: log.joints.clone(),
        time: log.time.iter().copied().step_by(step).collect(),
        q: thin(&log.q),
        qd: log.qd.as_ref().map(thin),
        tau: thin(&log.tau),
        ..Recording::default()
    }
}

/// Times on the timeline and values of a fit's rows, those that only separate logs left out but for one.
fn rows(fitted: &Fitted, offsets: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut logs: Vec<(f64, &[f64])> = Vec::new();
    let mut parts: Vec<&[f64]> = Vec::new();
    let mut start = 0;
    for log in fitted.test_time.split(|t| t.is_nan()) {
        let own = start..start + log.len();
        start = own.end + 1;
        if let (false, Some(offset)) = (log.is_empty(), offsets.get(logs.len())) {
            logs.push((*offset, log));
            parts.push(&values[own]);
        }
    }
    (joined_time(&logs), joined(&parts))
}

fn text(robot: &Robot, plain: &Fitted, extended: Option<&Fitted>) -> String {
    let mut rows = String::new();
    for (joint, about) in robot.joints.iter().enumerate() {
        let cell = |rms: Option<&f64>| {
            rms.map_or("-".to_owned(), |&rms| format!("{} {}", significant(rms), about.effort_unit()))
        };
        let after = extended.and_then(|fitted| fitted.test_rms.get(joint));
        let (train, test) = (cell(plain.train_rms.get(joint)), cell(plain.test_rms.get(joint)));
        rows += &format!("| {} | {train} | {test} | {} |\n", about.name, cell(after));
    }
    format!(
        "# {}\n\nResidual, root mean square:\n\n| joint | training | held out | held out, with effects |\n|---|---|---|---|\n\
         {rows}\nTorque: measured grey, identified blue, with effects orange. Gaps are reversals.\n",
        robot.name
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_log_keeps_its_times() {
        let table = |scale: f64| Channels::from_vectors(&[(0..10).map(|i| scale * f64::from(i)).collect::<Vec<_>>()]);
        let time: Vec<f64> = (0..10).map(f64::from).collect();
        let log = Recording { time, q: table(2.0), tau: table(3.0), ..Recording::default() };
        let thin = every(&log, 4);
        assert_eq!((thin.time, thin.qd), (vec![0.0, 4.0, 8.0], None));
        assert_eq!((thin.q.channel(0), thin.tau.channel(0)), (&[0.0, 8.0, 16.0][..], &[0.0, 12.0, 24.0][..]));
    }
}
