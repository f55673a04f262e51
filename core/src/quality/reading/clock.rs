//! Rows that were left out, and the clock.

use crate::quality::finding::{Finding, Kind, Severity};
use crate::recording::Recording;
use crate::recording::lenient::{Cause, Rejected, Sieved};
use crate::recording::resample::{Clock, IRREGULAR, TORN};

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

/// Less than this part of a row is the rounding of a gap's length.
const PART_OF_ROW: f64 = 0.5;

/// A gap of a log, in which rows were lost that the file does not have.
pub(crate) struct Lost {
    /// Sample before it.
    at: usize,
    /// Rows of the file in it that were left out, which are reported by themselves.
    left_out: usize,
    /// Rows that are not in the file.
    rows: f64,
}

/// The gaps in which the file lacks rows, and those that rows left out made and that are too long to be bridged. The time that the reader
/// puts between two recordings of a file is none.
pub(crate) fn lost(sieved: &Sieved, clock: &Clock) -> Vec<Lost> {
    let (time, lines) = (&sieved.recording.time, &sieved.lines);
    let of = |&at: &usize| {
        let (Some(&before), Some(&behind)) = (lines.get(at), lines.get(at + 1)) else { return None };
        if sieved.begins.iter().any(|line| (before + 1..=behind).contains(line)) {
            return None;
        }
        let within = |row: &&Rejected| (before + 1..behind).contains(&row.line) && row.cause != Cause::DuplicateTime;
        let left_out = sieved.rejected.iter().filter(within).count();
        let steps = (time[at + 1] - time[at]) * clock.rate_hz;
        let rows = (steps - 1.0 - left_out as f64).max(0.0);
        (rows > PART_OF_ROW || steps > TORN).then_some(Lost { at, left_out, rows })
    };
    clock.gaps.iter().filter_map(of).collect()
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
    let groups: [(Kind, &[Cause], &str); 4] = [
        (Kind::TwoSources, &[Cause::Blank], "are those of a second source"),
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
            _ if kind == Kind::TwoSources => (
                Severity::Warning,
                "they are left out: two programs write the joints' states, as two publishers on one topic do, and one of them knows no \
                 torque; stop it, or give it a topic of its own",
            ),
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
    out.extend(gaps(sieved, clock, &lost(sieved, clock)));
    out
}

/// The finding about gaps.
fn gaps(sieved: &Sieved, clock: &Clock, lost: &[Lost]) -> Option<Finding> {
    let recording = &sieved.recording;
    let place = |gap: &Lost| format!("{:.4} s (line {})", recording.time[gap.at], sieved.lines[gap.at]);
    let places: Vec<String> = lost.iter().take(LISTED).map(place).collect();
    let rows: f64 = lost.iter().map(|gap| gap.rows).sum::<f64>().round();
    let left_out: usize = lost.iter().map(|gap| gap.left_out).sum();
    let missing = (rows + left_out as f64) / clock.rate_hz;
    let severity = if missing / recording.duration() > 0.01 { Severity::Warning } else { Severity::Note };
    let of_rows = match (rows > 0.0, left_out) {
        (_, 0) => format!("{rows:.0} rows lost"),
        (true, _) => format!("{rows:.0} rows lost, {left_out} left out"),
        (false, _) => format!("{left_out} rows left out"),
    };
    let text = format!(
        "{} gap{}, together {missing:.3} s ({of_rows}); short ones are bridged, at long ones the log is cut in pieces",
        lost.len(),
        if lost.len() == 1 { "" } else { "s" }
    );
    (!lost.is_empty()).then(|| Finding::new(Kind::Gap, severity, places.join(", "), text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;

    /// 400 rows at 100 Hz, of which some are not in the log.
    fn without(missing: &[usize]) -> Sieved {
        let kept: Vec<usize> = (0..400).filter(|row| !missing.contains(row)).collect();
        let signal =
            || Channels::from_vectors(&[kept.iter().map(|&row| (0.05 * row as f64).sin()).collect::<Vec<f64>>()]);
        let time = kept.iter().map(|&row| 0.01 * row as f64).collect();
        let recording = Recording { time, q: signal(), tau: signal(), ..Recording::default() };
        Sieved { lines: kept.iter().map(|row| row + 2).collect(), recording, ..Sieved::default() }
    }

    fn of_gaps(sieved: &Sieved) -> Option<Finding> {
        findings(sieved, &Clock::new(&sieved.recording), 1.0).into_iter().find(|finding| finding.kind == Kind::Gap)
    }

    fn left_out(row: usize, cause: Cause) -> Rejected {
        Rejected { line: row + 2, column: "tau1".into(), cause, problem: "no number".into() }
    }

    #[test]
    fn rows_left_out_are_no_rows_that_were_lost() {
        let mut sieved = without(&[50, 90, 91, 200]);
        let text = of_gaps(&sieved).unwrap().text;
        assert!(text.starts_with("3 gaps") && text.contains("(4 rows lost)"), "{text}");
        sieved.rejected = [50, 90, 91].map(|row| left_out(row, Cause::NotFinite)).into();
        let text = of_gaps(&sieved).unwrap().text;
        assert!(text.starts_with("1 gap,") && text.contains("(1 rows lost)"), "{text}");
        sieved.rejected.push(left_out(200, Cause::NotFinite));
        assert_eq!(of_gaps(&sieved), None);
        // A row with the time of another leaves no gap by itself.
        sieved.rejected[3].cause = Cause::DuplicateTime;
        assert!(of_gaps(&sieved).unwrap().place.contains("line 201"));
    }

    #[test]
    fn so_many_rows_left_out_that_the_log_is_cut_are_a_gap() {
        let missing: Vec<usize> = (100..130).collect();
        let mut sieved = without(&missing);
        sieved.rejected = missing.iter().map(|&row| left_out(row, Cause::NotFinite)).collect();
        let text = of_gaps(&sieved).unwrap().text;
        assert!(text.contains("(30 rows left out)") && !text.contains("lost"), "{text}");
    }

    #[test]
    fn the_time_between_two_recordings_of_a_file_is_no_gap() {
        let mut sieved = without(&[]);
        sieved.recording.time[200..].iter_mut().for_each(|time| *time += 10.0);
        assert!(of_gaps(&sieved).is_some());
        sieved.begins = vec![202];
        assert_eq!(of_gaps(&sieved), None);
    }
}
