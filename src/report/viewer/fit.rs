//! The film of a fit: the held-out logs with what the fits without and with effects leave of them.

use super::{Film, Look, Marker, Quantity, Track, joined, joined_time, offsets};
use crate::channels::Channels;
use crate::diagnosis::Followed;
use crate::identification::fit::{Fitted, Logs};
use crate::recording::Recording;
use crate::report::console::significant;
use crate::robot::Robot;

/// What is shown of a fit.
///
/// ```
/// use tauscope::report::viewer::fit::{Shown, film, shown_logs};
/// # use tauscope::identification::effect_model::{Preparation, Trust};
/// # use tauscope::identification::fit::{Logs, fit_effects};
/// # use tauscope::identification::model::Model;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("tests/reference/payload/before.csv", None)?;
/// # let logs = Logs { train: &[&log], test: &[] };
/// # let fitted = fit_effects(&Model::new(&robot), Trust::Structure, logs, Preparation::usual(&log), Vec::new())?;
///
/// // No log is held out, so that the training log is shown.
/// assert_eq!(shown_logs(logs).len(), 1);
/// let film = film(&robot, logs, Shown { plain: &fitted, extended: None, replayed: None });
/// assert!((film.span()[1] - log.duration()).abs() < 0.1);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Shown<'a> {
    /// The fit without effects.
    pub plain: &'a Fitted,
    /// The fit with effects.
    pub extended: Option<&'a Fitted>,
    /// The arm of `identified.urdf` in the simulator along the logs that are shown, sample by sample.
    pub replayed: Option<&'a [Followed]>,
}

/// Samples of the logs together that are shown: longer ones are thinned, or the recording would be larger than they are.
const MOST_SHOWN: usize = 200_000;

/// The logs that are shown: the held-out ones, or the training logs where there are no others.
pub fn shown_logs<'a>(logs: Logs<'a>) -> &'a [&'a Recording] {
    if logs.test.is_empty() { logs.train } else { logs.test }
}

/// The film of a fit on [`shown_logs`]; without residuals where none are held out.
pub fn film<'a>(robot: &'a Robot, logs: Logs, fits: Shown) -> Film<'a> {
    let Shown { plain, extended, replayed } = fits;
    let (whole, held_out) = (shown_logs(logs), !logs.test.is_empty());
    let step = whole.iter().map(|log| log.samples()).sum::<usize>().div_ceil(MOST_SHOWN).max(1);
    let thin: Vec<Recording> = if step == 1 { Vec::new() } else { whole.iter().map(|log| every(log, step)).collect() };
    let shown: Vec<&Recording> = if step == 1 { whole.to_vec() } else { thin.iter().collect() };
    let offsets = offsets(shown.iter().map(|log| [log.time[0], log.time[log.samples() - 1]]));
    let starts: Vec<(f64, &[f64])> = offsets.iter().copied().zip(shown.iter().map(|log| &log.time[..])).collect();
    let time = joined_time(&starts);
    let thinned = |table: &Channels| table.map(|_, signal| signal.iter().copied().step_by(step).collect());
    let replayed: Option<Vec<Followed>> = replayed
        .map(|logs| logs.iter().map(|log| Followed { torque: thinned(&log.torque), q: thinned(&log.q) }).collect());
    let track = |name, ghost, tables: Vec<&Channels>| -> Track {
        let standing = |joint: usize| {
            let mut last = 0.0;
            let mut all = joined(&tables.iter().map(|table| table.channel(joint)).collect::<Vec<_>>());
            // Between two logs the arm stands where the first ended.
            for q in &mut all {
                last = if q.is_nan() { last } else { *q };
                *q = last;
            }
            all
        };
        let q = Channels::from_vectors(&(0..robot.dof()).map(standing).collect::<Vec<_>>());
        Track { name, ghost, time: time.clone(), q }
    };
    let mut tracks = vec![track("measured", false, shown.iter().map(|log| &log.q).collect())];
    tracks.extend(replayed.as_ref().map(|logs| track("simulated", true, logs.iter().map(|log| &log.q).collect())));
    let kind = if held_out { "held-out" } else { "training" };
    let mut film = Film {
        title: format!("identification of {}", robot.name),
        robot,
        text: text(robot, plain, extended, replayed.is_some()),
        tracks,
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
    } else if held_out {
        film.add(Quantity::Velocity, "smoothed", Look::Measured, |j| rows(plain, &offsets, &plain.test.qd[j]));
    }
    if let Some(logs) = &replayed {
        film.add(Quantity::Torque, "simulated", Look::Reference, |j| raw(&|k| logs[k].torque.channel(j).to_vec()));
        film.add(Quantity::Position, "simulated", Look::Reference, |j| raw(&|k| logs[k].q.channel(j).to_vec()));
    }
    if held_out {
        let fits = [(plain, "identified", "identified", Look::Simulated)];
        let with = extended.map(|fitted| (fitted, "with effects", "with effects", Look::Extended));
        for (fitted, torque, residual, look) in fits.into_iter().chain(with) {
            film.add(Quantity::Torque, torque, look, |j| {
                let left = fitted.test.residual[j].iter();
                let predicted: Vec<f64> =
                    fitted.test.torque[j].iter().zip(left).map(|(tau, r)| r.map_or(f64::NAN, |r| tau - r)).collect();
                rows(fitted, &offsets, &predicted)
            });
            film.add(Quantity::Residual, residual, look, |j| {
                let left: Vec<f64> = fitted.test.residual[j].iter().map(|r| r.unwrap_or(f64::NAN)).collect();
                rows(fitted, &offsets, &left)
            });
        }
        film.add_noise(&plain.test.noise);
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
    for log in fitted.test.time.split(|t| t.is_nan()) {
        let own = start..start + log.len();
        start = own.end + 1;
        if let (false, Some(offset)) = (log.is_empty(), offsets.get(logs.len())) {
            logs.push((*offset, log));
            parts.push(&values[own]);
        }
    }
    (joined_time(&logs), joined(&parts))
}

fn text(robot: &Robot, plain: &Fitted, extended: Option<&Fitted>, replayed: bool) -> String {
    let table = |header: &[&str], row: &dyn Fn(usize) -> Vec<Option<f64>>| {
        let mut text = format!("| joint | {} |\n|{}\n", header.join(" | "), "---|".repeat(header.len() + 1));
        for (joint, about) in robot.joints.iter().enumerate() {
            let cell = |value: Option<f64>| {
                value.map_or("-".to_owned(), |value| format!("{} {}", significant(value), about.effort_unit()))
            };
            let cells: Vec<String> = row(joint).into_iter().map(cell).collect();
            text += &format!("| {} | {} |\n", about.name, cells.join(" | "));
        }
        text
    };
    let at = |values: &[f64], joint: usize| values.get(joint).copied();
    let rms = match (plain.test_rms.is_empty(), extended) {
        (true, _) => table(&["training"], &|j| vec![at(&plain.train_rms, j)]),
        (false, None) => table(&["training", "held out", "noise floor"], &|j| {
            vec![at(&plain.train_rms, j), at(&plain.test_rms, j), at(&plain.test.noise, j)]
        }),
        (false, Some(with)) => table(&["training", "held out", "held out, with effects", "noise floor"], &|j| {
            vec![at(&plain.train_rms, j), at(&plain.test_rms, j), at(&with.test_rms, j), at(&plain.test.noise, j)]
        }),
    };
    let ghost = match replayed {
        true => {
            "Outline: the arm of identified.urdf in the simulator, following the smoothed motion; its torque is green. "
        }
        false => "",
    };
    format!(
        "# {}\n\nResidual, root mean square:\n\n{rms}\nTorque: measured grey, identified blue, with effects orange. Gaps are \
         reversals. The noise floor is the white noise of the torque after the filter. Solid arm: as measured. {ghost}\n",
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
