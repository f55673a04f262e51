//! The film of a diagnosis: the held-out logs with the residual of each model and the places of the findings.

use super::{Film, Look, Marker, Quantity, Track, joined, joined_time, offsets};
use crate::channels::Channels;
use crate::diagnosis::Diagnosis;
use crate::recording::Recording;
use crate::report::diagnosis as report;
use crate::robot::Robot;

/// Marks of one finding at most, and the time between two of them at least, s.
const MARKS: usize = 5;
const APART_S: f64 = 1.0;

/// The film of a diagnosis of the held-out `logs`; `answer` is the answer in lines, `simulated` are the positions of the same motions in a
/// simulation of the extended model, where there is one.
pub fn film<'a>(
    robot: &'a Robot,
    logs: &[&Recording],
    diagnosis: &Diagnosis,
    answer: &str,
    simulated: Option<&[Channels]>,
) -> Film<'a> {
    let offsets = offsets(logs.iter().map(|log| [log.time[0], log.time[log.samples() - 1]]));
    let starts: Vec<(f64, &[f64])> = offsets.iter().copied().zip(logs.iter().map(|log| &log.time[..])).collect();
    let time = joined_time(&starts);
    let evidence = &diagnosis.evidence;
    // Rows of the diagnosis are means over 20 ms, with times of their own.
    let bounds: Vec<(usize, usize)> = evidence.starts.windows(2).map(|pair| (pair[0], pair[1])).collect();
    let row_starts: Vec<(f64, &[f64])> =
        offsets.iter().copied().zip(bounds.iter().map(|&(from, to)| &evidence.time[from..to])).collect();
    let row_time = joined_time(&row_starts);
    let rows = |values: &[f64]| -> Vec<f64> {
        joined(&bounds.iter().map(|&(from, to)| &values[from..to]).collect::<Vec<_>>())
    };
    let raw = |of: &dyn Fn(&Recording) -> Vec<f64>| -> Vec<f64> {
        let each: Vec<Vec<f64>> = logs.iter().map(|log| of(log)).collect();
        joined(&each.iter().map(Vec::as_slice).collect::<Vec<_>>())
    };
    let track = |name, ghost, tables: Vec<&Channels>| -> Track {
        let q: Vec<Vec<f64>> = (0..robot.dof())
            .map(|joint| {
                let mut last = 0.0;
                let joint: Vec<&[f64]> = tables.iter().map(|table| table.channel(joint)).collect();
                // Between two logs the arm stands where the first ended.
                joined(&joint)
                    .into_iter()
                    .map(|q| {
                        last = if q.is_nan() { last } else { q };
                        last
                    })
                    .collect()
            })
            .collect();
        Track { name, ghost, time: time.clone(), q: Channels::from_vectors(&q) }
    };
    let mut tracks = vec![track("measured", false, logs.iter().map(|log| &log.q).collect())];
    tracks.extend(simulated.map(|tables| track("simulated", true, tables.iter().collect())));
    let mut film = Film {
        title: format!("diagnosis of {}", robot.name),
        robot,
        text: text(robot, answer, simulated.is_some()),
        tracks,
        signals: Vec::new(),
        markers: markers(robot, diagnosis, &row_time, &rows, &offsets, logs),
    };
    film.add(Quantity::Torque, "measured", Look::Measured, |j| (time.clone(), raw(&|log| log.tau.channel(j).to_vec())));
    film.add(Quantity::Position, "measured", Look::Measured, |j| (time.clone(), raw(&|log| log.q.channel(j).to_vec())));
    film.add(Quantity::Velocity, "smoothed", Look::Measured, |j| (row_time.clone(), rows(&evidence.qd[j])));
    if let Some(tables) = simulated {
        film.add(Quantity::Position, "simulated", Look::Simulated, |j| {
            (time.clone(), joined(&tables.iter().map(|table| table.channel(j)).collect::<Vec<_>>()))
        });
    }
    let model = |j: usize, residual: &[Vec<f64>]| -> (Vec<f64>, Vec<f64>) {
        let torque: Vec<f64> = evidence.torque[j].iter().zip(&residual[j]).map(|(tau, left)| tau - left).collect();
        (row_time.clone(), rows(&torque))
    };
    film.add(Quantity::Torque, "re-identified", Look::Simulated, |j| model(j, &evidence.baseline));
    film.add(Quantity::Torque, "with findings", Look::Extended, |j| model(j, &evidence.extended));
    // Rows near reversals are not used, so they leave a gap.
    let counted = |j: usize, residual: &[Vec<f64>]| -> (Vec<f64>, Vec<f64>) {
        let valid = residual[j].iter().zip(&evidence.valid[j]);
        let values: Vec<f64> = valid.map(|(&left, &ok)| if ok { left } else { f64::NAN }).collect();
        (row_time.clone(), rows(&values))
    };
    film.add(Quantity::Residual, "as described", Look::Measured, |j| counted(j, &evidence.described));
    film.add(Quantity::Residual, "re-identified", Look::Simulated, |j| counted(j, &evidence.baseline));
    film.add(Quantity::Residual, "with findings", Look::Extended, |j| counted(j, &evidence.extended));
    film.add_noise(&diagnosis.errors.noise_floor);
    film
}

/// Starts of the logs, and for every finding the moments at which it acts most.
fn markers(
    robot: &Robot,
    diagnosis: &Diagnosis,
    time: &[f64],
    rows: &dyn Fn(&[f64]) -> Vec<f64>,
    offsets: &[f64],
    logs: &[&Recording],
) -> Vec<Marker> {
    let starts = offsets.iter().zip(logs).enumerate().map(|(index, (offset, log))| Marker {
        time: offset + log.time[0],
        text: format!("held-out log {} starts", index + 1),
        finding: false,
    });
    let mut markers: Vec<Marker> = starts.collect();
    for (found, torque) in diagnosis.found.iter().zip(&diagnosis.evidence.effects) {
        let name = report::place(robot, found.member.candidate.family());
        for (row, joint, value) in strongest(diagnosis, torque, time, rows) {
            let (about, noise) = (&robot.joints[joint], diagnosis.errors.noise_floor[joint]);
            let text = format!(
                "{name}: {value:.2} {} on {}, {:.1} times the noise",
                about.effort_unit(),
                about.name,
                value.abs() / noise
            );
            markers.push(Marker { time: time[row], text, finding: true });
        }
    }
    markers.sort_by(|a, b| a.time.total_cmp(&b.time));
    markers
}

/// Rows at which an effect is largest over the noise, with its joint and torque there.
fn strongest(
    diagnosis: &Diagnosis,
    torque: &[Vec<f64>],
    time: &[f64],
    rows: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Vec<(usize, usize, f64)> {
    let mut all: Vec<(usize, usize, f64)> = Vec::new();
    for (joint, values) in torque.iter().enumerate() {
        let counted = values.iter().zip(&diagnosis.evidence.valid[joint]);
        let counted: Vec<f64> = counted.map(|(&value, &ok)| if ok { value } else { 0.0 }).collect();
        let values = rows(&counted).into_iter().enumerate();
        all.extend(values.filter(|(_, v)| v.is_finite() && *v != 0.0).map(|(row, value)| (row, joint, value)));
    }
    let size = |(_, joint, value): &(usize, usize, f64)| value.abs() / diagnosis.errors.noise_floor[*joint];
    all.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let mut chosen: Vec<(usize, usize, f64)> = Vec::new();
    for candidate in all {
        if chosen.len() == MARKS {
            break;
        }
        if chosen.iter().all(|other| (time[other.0] - time[candidate.0]).abs() >= APART_S) {
            chosen.push(candidate);
        }
    }
    chosen
}

fn text(robot: &Robot, answer: &str, simulated: bool) -> String {
    // The table of residuals is too wide here; the plots show it.
    let parts = answer.split("\n\n").filter(|part| !part.starts_with(" held-out rms"));
    let lines = parts.map(|part| part.lines().map(str::trim_start).collect::<Vec<_>>().join("\n\n"));
    format!(
        "# {}\n\n{}\n\nResiduals: arm as described grey, re-identified blue, with the findings orange, noise floor purple. \
         Gaps are reversals. Solid arm: as measured.{}\n",
        robot.name,
        lines.collect::<Vec<_>>().join("\n\n"),
        if simulated { " Outline: the extended model in the simulator." } else { "" }
    )
}
