//! The report of a diagnosis that faults of the data have stopped: what is wrong with which log, and the log itself.

use super::provenance::file_name;
use super::{Block, Page, Provenance, Section, Tone};
use crate::diagnosis::{Consequence, DataFault};
use crate::internal::diagnosis::remedy;
use crate::quality::with_logs;
use crate::recording::Recording;
use crate::report::svg::Color;
use crate::report::svg::chart::{Chart, Mark, Trace};
use crate::report::viewer::{joined, joined_time, offsets};
use crate::robot::Robot;

/// The report of a diagnosis of `logs`, training logs first, that `faults` have stopped.
pub(crate) fn page(robot: &Robot, logs: &[&Recording], faults: &[DataFault], provenance: Provenance) -> Page {
    let stops: Vec<&DataFault> = faults.iter().filter(|fault| fault.consequence == Consequence::Stops).collect();
    let next = remedy(faults);
    let next = next[..1].to_uppercase() + &next[1..] + ".";
    Page {
        kind: format!("Diagnosis of {}", robot.name),
        verdict: "The logs cannot be diagnosed: a cause named from them would be wrong.".into(),
        tone: Tone::Bad,
        lead: stops.iter().map(|fault| format!("{}: {}", fault.place, fault.text)).collect(),
        next: Some(next),
        sections: vec![faulty(faults), signals(robot, logs), lengths(logs)],
        provenance,
    }
}

fn faulty(faults: &[DataFault]) -> Section {
    let each =
        faults.iter().map(|fault| (file_name(&fault.log), (fault.consequence, &fault.place[..], &fault.text[..])));
    let rows = with_logs(each).into_iter().map(|(logs, (consequence, place, text))| {
        let consequence = match consequence {
            Consequence::Stops => "stops the diagnosis",
            Consequence::Doubts => "puts the answer in doubt",
            Consequence::LeftOut => "left out",
            Consequence::Noted => "worth knowing",
            Consequence::Corrected => "corrected",
        };
        vec![logs.join(", "), place.to_owned(), text.to_owned(), consequence.to_owned()]
    });
    Section::new("What is wrong", vec![Block::table(["log", "place", "what is wrong", "consequence"], rows.collect())])
}

/// Torque and position of every joint, log after log.
fn signals(robot: &Robot, logs: &[&Recording]) -> Section {
    let offsets = offsets(logs.iter().map(|log| [log.time[0], log.time[log.samples() - 1]]));
    let starts: Vec<(f64, &[f64])> = offsets.into_iter().zip(logs.iter().map(|log| &log.time[..])).collect();
    let time = joined_time(&starts);
    let charts = |what: &str, pick: &dyn Fn(&Recording, usize) -> Vec<f64>, unit: &dyn Fn(usize) -> &'static str| {
        let chart = |joint: usize| {
            let each: Vec<Vec<f64>> = logs.iter().map(|log| pick(log, joint)).collect();
            let y = joined(&each.iter().map(Vec::as_slice).collect::<Vec<_>>());
            let trace = Trace { mark: Mark::Line(1.2), color: Color::Blue, x: time.clone(), y };
            Chart {
                title: format!("{}, {}", robot.joints[joint].name, unit(joint)),
                note: what.to_owned(),
                x_label: "time (s)".into(),
                traces: vec![trace],
                log_y: false,
            }
        };
        let legend = vec![(format!("measured {what}"), Color::Blue, Mark::Line(2.0))];
        Block::Charts { legend, charts: (0..robot.dof()).map(chart).collect() }
    };
    let torque = |log: &Recording, joint: usize| log.tau.channel(joint).to_vec();
    let position = |log: &Recording, joint: usize| log.q.channel(joint).to_vec();
    Section::new(
        "The logs as they came",
        vec![
            Block::text("One log after the other. Gaps are samples that cannot be used."),
            charts("torque", &torque, &|joint| robot.joints[joint].effort_unit()),
            charts("position", &position, &|joint| robot.joints[joint].position_unit()),
        ],
    )
}

fn lengths(logs: &[&Recording]) -> Section {
    let rows = logs.iter().enumerate().map(|(k, log)| {
        let cells = [log.samples().to_string(), format!("{:.1} s", log.duration()), format!("{:.0} Hz", log.rate_hz())];
        [(k + 1).to_string()].into_iter().chain(cells).collect()
    });
    Section::new("Data quality", vec![Block::table(["piece of a log", "samples", "length", "rate"], rows.collect())])
}
