//! The film of a scenario: both motions one after the other, as measured and as asked for.

use super::{Film, Look, Marker, Quantity, Track, joined, joined_time, offsets};
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::error::Result;
use crate::excitation::Reference;
use crate::identification::model::Model;
use crate::report::console::{self, significant};
use crate::scenario::Setup;
use crate::study::testbed::{Run, Runs, Scored};

/// The film of a scenario's runs; with the model and what was identified from the smoothed signals, its torques too.
///
/// # Errors
/// Those of preparing the signals.
pub fn film<'a>(setup: &'a Setup, runs: &Runs, identified: Option<(&Model, &Scored)>) -> Result<Film<'a>> {
    let both = [&runs.training, &runs.held_out];
    let offsets = offsets(both.map(|run| span(&run.truth.time)));
    let times: Vec<(f64, &[f64])> = offsets.iter().copied().zip(both.map(|run| &run.truth.time[..])).collect();
    let time = joined_time(&times);
    let all = |of: &dyn Fn(usize) -> Vec<f64>| -> Vec<f64> { joined(&[&of(0), &of(1)]) };
    let asked: Vec<Motion> =
        vec![along(&setup.motion, &runs.training.truth.time), along(&setup.held_out, &runs.held_out.truth.time)];

    let mut film = Film {
        title: format!("{}: {}", setup.scenario.name, setup.plant.name),
        robot: &setup.plant,
        text: text(setup, identified.map(|(_, scored)| scored)),
        tracks: vec![
            track("measured", false, &time, both.map(|run| &run.recording.q)),
            track("commanded", true, &time, [&asked[0].q, &asked[1].q]),
        ],
        signals: Vec::new(),
        markers: markers(&offsets, &both),
    };
    let line = |of: &dyn Fn(&Run) -> Option<Channels>, joint: usize| -> Vec<f64> {
        all(&|k| of(both[k]).map_or_else(Vec::new, |table| table.channel(joint).to_vec()))
    };
    film.add(Quantity::Torque, "measured", Look::Measured, |j| {
        (time.clone(), line(&|r| Some(r.recording.tau.clone()), j))
    });
    film.add(Quantity::Position, "measured", Look::Measured, |j| {
        (time.clone(), line(&|r| Some(r.recording.q.clone()), j))
    });
    film.add(Quantity::Velocity, "measured", Look::Measured, |j| (time.clone(), line(&|r| r.recording.qd.clone(), j)));
    film.add(Quantity::Velocity, "simulated", Look::Simulated, |j| {
        (time.clone(), line(&|r| Some(r.truth.signals.qd.clone()), j))
    });
    film.add(Quantity::Position, "commanded", Look::Reference, |j| {
        (time.clone(), all(&|k| asked[k].q.channel(j).to_vec()))
    });
    film.add(Quantity::Velocity, "commanded", Look::Reference, |j| {
        (time.clone(), all(&|k| asked[k].qd.channel(j).to_vec()))
    });
    film.add(Quantity::Torque, "simulated", Look::Simulated, |j| {
        (time.clone(), line(&|r| Some(r.truth.signals.tau.clone()), j))
    });
    let less = |k: usize, j: usize, model: &[f64]| -> Vec<f64> {
        both[k].recording.tau.channel(j).iter().zip(model).map(|(measured, model)| measured - model).collect()
    };
    if let Some((model, scored)) = identified {
        let seen = [scored.seen(setup, both[0])?, scored.seen(setup, both[1])?];
        // Where a joint hardly moves, the model does not know the direction of its friction.
        let moving = |k: usize, j: usize, values: Vec<f64>| -> Vec<f64> {
            values.into_iter().zip(seen[k].moving(j)).map(|(value, ok)| if ok { value } else { f64::NAN }).collect()
        };
        let found = seen.each_ref().map(|seen| seen.predict(model, &scored.estimate.beta));
        let nominal = model.base().values(&Model::standard_values(&setup.nominal));
        let nominal = seen.each_ref().map(|seen| seen.predict(model, &nominal));
        film.add(Quantity::Torque, "identified", Look::Extended, |j| {
            (time.clone(), all(&|k| moving(k, j, found[k].channel(j).to_vec())))
        });
        film.add(Quantity::Residual, "controller model", Look::Simulated, |j| {
            (time.clone(), all(&|k| moving(k, j, less(k, j, nominal[k].channel(j)))))
        });
        film.add(Quantity::Residual, "identified", Look::Extended, |j| {
            (time.clone(), all(&|k| moving(k, j, less(k, j, found[k].channel(j)))))
        });
    } else {
        film.add(Quantity::Residual, "measured less simulated", Look::Simulated, |j| {
            (time.clone(), all(&|k| less(k, j, both[k].truth.signals.tau.channel(j))))
        });
    }
    let noise: Vec<f64> = setup.sensors.iter().map(|sensor| sensor.torque_noise).collect();
    film.add_noise(&noise);
    Ok(film)
}

fn span(time: &[f64]) -> [f64; 2] {
    [time.first().copied().unwrap_or_default(), time.last().copied().unwrap_or_default()]
}

fn track(name: &'static str, ghost: bool, time: &[f64], logs: [&Channels; 2]) -> Track {
    // Between the logs the arm stands where the first ended.
    let q: Vec<Vec<f64>> = (0..logs[0].channels())
        .map(|joint| {
            let rest = logs[0].channel(joint).last().copied().unwrap_or_default();
            [logs[0].channel(joint), &[rest], logs[1].channel(joint)].concat()
        })
        .collect();
    Track { name, ghost, time: time.to_vec(), q: Channels::from_vectors(&q) }
}

/// What the controller was asked to follow.
fn along(reference: &dyn Reference, time: &[f64]) -> Motion {
    let dof = reference.joints();
    let mut motion = Motion::zeros(dof, time.len());
    let mut state = [vec![0.0; dof], vec![0.0; dof], vec![0.0; dof]];
    for (sample, &t) in time.iter().enumerate() {
        let [q, qd, qdd] = &mut state;
        reference.at(t, q, qd, qdd);
        motion.q.set(sample, q);
        motion.qd.set(sample, qd);
        motion.qdd.set(sample, qdd);
    }
    motion
}

fn markers(offsets: &[f64], runs: &[&Run]) -> Vec<Marker> {
    let names = ["training motion: identified from it", "held-out motion: judged on it"];
    let starts = offsets.iter().zip(runs).zip(names);
    starts
        .map(|((offset, run), name)| Marker {
            time: offset + span(&run.truth.time)[0],
            text: name.into(),
            finding: false,
        })
        .collect()
}

fn text(setup: &Setup, scored: Option<&Scored>) -> String {
    let legend = "Solid arm: as measured. Outline: as commanded. Torque: measured grey, simulated blue, identified \
                  orange. The held-out motion follows the training motion. Gaps: the joint hardly moves.";
    let Some(scored) = scored else {
        return format!("# {}\n\nSimulated and measured; nothing was identified.\n\n{legend}\n", setup.scenario.name);
    };
    let rows: String = setup
        .plant
        .joints
        .iter()
        .enumerate()
        .map(|(joint, about)| {
            let (error, noise) = (scored.score.torque_std_held_out_nm[joint], setup.sensors[joint].torque_noise);
            let unit = about.effort_unit();
            format!("| {} | {} {unit} | {} {unit} |\n", about.name, significant(error), significant(noise))
        })
        .collect();
    format!(
        "# {}\n\n{}\n\n{} base parameters identified from the training motion.\n\n| joint | torque error, held out | torque noise \
         |\n|---|---|---|\n{rows}\n{legend}\n",
        setup.scenario.name,
        console::verdict(setup, scored).1,
        scored.estimate.beta.len()
    )
}
