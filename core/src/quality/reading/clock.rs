//! Rows that were left out, and the clock.

use crate::quality::finding::{Finding, Kind, Severity};
use crate::recording::Recording;
use crate::recording::lenient::{Cause, Rejected, Sieved};
use crate::recording::resample::{Clock, IRREGULAR};

/// Fewer samples, or a shorter time, are too little to judge a log.
const FEWEST: usize = 50;
const SHORTEST_S: f64 = 0.5;

/// Share of the rows that are out of time beyond which the clock started again.
const RESTARTED: f64 = 0.1;

/// Lines that a finding lists.
const LISTED: usize = 5;

/// Rows out of time in runs of this length on average are those of a recording behind another; shorter ones are scattered.
const RUN: f64 = 20.0;

/// Why time goes back so often, and what to do.
fn cause_of_backward_time(rows: &[&Rejected]) -> &'static str {
    let runs = 1 + rows.windows(2).filter(|pair| pair[1].line > pair[0].line + 1).count();
    match rows.len() as f64 / runs as f64 > RUN {
        true => "the clock starts again: give each recording as a file of its own",
        false => {
            "the stamps of two sources are mixed: two programs write the joints' states, as two publishers on one topic do; stop one \
             of them, or give it a topic of its own, and record again"
        }
    }
}

/// Whether there are rows enough for a log, but over too short a time: its clock may run wrong.
pub(crate) fn seems_short(recording: &Recording) -> bool {
    recording.samples() >= FEWEST && recording.duration() < SHORTEST_S
}

/// Findings about rows and clock; a second of the clock lasts `factor` true ones.
pub(crate) fn findings(sieved: &Sieved, clock: &Clock, factor: f64) -> Vec<Finding> {
    let recording = &sieved.recording;
    let all = sieved.rejected.len() + recording.samples();
    let mut out = Vec::new();
    if let Some(spoilt) = &sieved.spoilt {
        out.push(Finding::new(Kind::TwoSources, Severity::Fatal, "rows", spoilt.as_str()));
        return out;
    }
    if !sieved.corrections.is_empty() {
        out.push(Finding::new(Kind::Corrected, Severity::Note, "log", sieved.corrections.join("; ")));
    }
    if let Some(column) = &sieved.of_controller {
        let text = format!(
            "{column} and its like are torques that the controller wanted or computed, by their name, and nothing measured is in the log: \
             identification gives the controller's model back, and friction or faults that it does not know are not in them; log \
             measured torques or motor currents"
        );
        out.push(Finding::new(Kind::ModelTorque, Severity::Warning, "tau", text));
    }
    let groups: [(Kind, &[Cause], &str); 3] = [
        (Kind::BadRows, &[Cause::Unreadable, Cause::NotFinite, Cause::Absurd], "cannot be used"),
        (Kind::DuplicateTime, &[Cause::DuplicateTime], "repeat the time of the row before"),
        (Kind::BackwardTime, &[Cause::BackwardTime], "are out of time"),
    ];
    for (kind, causes, what) in groups {
        let rows: Vec<_> = sieved.rejected.iter().filter(|row| causes.contains(&row.cause)).collect();
        let Some(first) = rows.first() else { continue };
        let mut lines = rows.iter().take(LISTED).map(|row| row.line.to_string()).collect::<Vec<_>>().join(", ");
        if rows.len() > LISTED {
            lines += &format!(" and {} more", rows.len() - LISTED);
        }
        let share = rows.len() as f64 / all as f64;
        let (severity, advice) = match share {
            s if s > RESTARTED && kind == Kind::BackwardTime => (Severity::Fatal, cause_of_backward_time(&rows)),
            s if s > 0.5 => (Severity::Fatal, "most of the log is lost; correct the export and try again"),
            s if s > 0.01 => (Severity::Warning, "they are left out and bridged; correct the export if you can"),
            _ => (Severity::Note, "they are left out and bridged"),
        };
        let text = format!("{} of {all} rows {what} ({}: {}); {advice}", rows.len(), first.column, first.problem);
        out.push(Finding::new(kind, severity, format!("line {lines}"), text));
    }
    if let Some(cut) = sieved.rejected.iter().find(|row| row.cause == Cause::CutOff) {
        let text =
            format!("the file is cut off ({}); the rows before are used; copy the log again if you can", cut.problem);
        out.push(Finding::new(Kind::CutOff, Severity::Warning, format!("line {}", cut.line), text));
    }
    if recording.samples() < FEWEST || recording.duration() * factor < SHORTEST_S {
        let text = format!(
            "{} samples over {:.3} s are too few to judge; at least {FEWEST} and {SHORTEST_S} s are needed",
            recording.samples(),
            recording.duration()
        );
        out.push(Finding::new(Kind::TooShort, Severity::Fatal, "rows", text));
        return out;
    }
    let jitter = clock.jitter_s * clock.rate_hz;
    if jitter > IRREGULAR {
        let text = format!(
            "the steps of time scatter by {:.3} ms rms about {:.3} ms ({:.0} %); the log is taken at even steps, but log \
             with the controller's clock if you can",
            1e3 * clock.jitter_s,
            1e3 / clock.rate_hz,
            100.0 * jitter
        );
        out.push(Finding::new(Kind::Jitter, Severity::Warning, "t", text));
    }
    if !clock.gaps.is_empty() {
        let missing: f64 =
            clock.gaps.iter().map(|&at| recording.time[at + 1] - recording.time[at] - 1.0 / clock.rate_hz).sum();
        let places: Vec<String> = clock
            .gaps
            .iter()
            .take(LISTED)
            .map(|&at| format!("{:.4} s (line {})", recording.time[at], sieved.lines[at]))
            .collect();
        let share = missing / recording.duration();
        let severity = if share > 0.01 { Severity::Warning } else { Severity::Note };
        let (rows, count) = ((missing * clock.rate_hz).round(), clock.gaps.len());
        let text = format!(
            "{count} gap{}, together {missing:.3} s ({rows:.0} rows lost); short ones are bridged, at long ones the log is cut \
             in pieces",
            if count == 1 { "" } else { "s" }
        );
        out.push(Finding::new(Kind::Gap, severity, places.join(", "), text));
    }
    if !sieved.notes.is_empty() {
        out.push(Finding::new(Kind::UnusedColumns, Severity::Note, "header", sieved.notes.join("; ")));
    }
    out
}
