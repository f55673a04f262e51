//! A film as an .rrd file.

use super::{Film, Look, Signal, arm, layout};
use crate::error::{Error, Result};
use crate::robot::visuals;
use rerun::{RecordingStream, RecordingStreamBuilder, RecordingStreamResult, TimeColumn};
use std::path::Path;

/// Writes `film` to `path`.
///
/// # Errors
/// If the file cannot be written.
pub fn write(path: &Path, film: &Film) -> Result<()> {
    let failed =
        |problem: String| Error::io(path, "write the recording for the viewer", std::io::Error::other(problem));
    let stream = record(path, film).map_err(|problem| failed(problem.to_string()))?;
    stream.flush_blocking().map_err(|problem| failed(problem.to_string()))
}

fn record(path: &Path, film: &Film) -> RecordingStreamResult<RecordingStream> {
    let stream = RecordingStreamBuilder::new("tauscope").recording_name(film.title.as_str()).save(path)?;
    stream.set_log_tick_enabled(false);
    stream.set_log_time_enabled(false);
    layout::send(&stream, film)?;

    let visuals = visuals::load(film.robot);
    stream.log_static("arm", &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;
    for track in &film.tracks {
        arm::log(&stream, film.robot, &visuals, track)?;
    }
    for note in &visuals.notes {
        tracing::warn!("{}: {note}; it is not drawn", film.robot.name);
    }
    let notes: String = visuals.notes.iter().map(|note| format!("\n- not shown as the URDF has it: {note}")).collect();
    stream.log_static("verdict", &rerun::TextDocument::from_markdown(format!("{}\n{notes}", film.text)))?;
    for signal in &film.signals {
        log_signal(&stream, &film.path(signal), signal)?;
    }
    for marker in &film.markers {
        stream.set_duration_secs("time", marker.time);
        let level = if marker.finding { rerun::TextLogLevel::WARN } else { rerun::TextLogLevel::INFO };
        stream.log("findings", &rerun::TextLog::new(marker.text.as_str()).with_level(level))?;
    }
    Ok(stream)
}

fn log_signal(stream: &RecordingStream, path: &str, signal: &Signal) -> RecordingStreamResult<()> {
    let ([r, g, b], width) = stroke(signal.look);
    let lines = rerun::SeriesLines::new()
        .with_names([signal.name])
        .with_colors([rerun::Color::from_rgb(r, g, b)])
        .with_widths([width]);
    stream.log_static(path, &lines)?;
    let time = TimeColumn::new_duration_secs("time", signal.time.iter().copied());
    let values = rerun::Scalars::new(signal.values.iter().copied()).columns_of_unit_batches()?;
    stream.send_columns(path, [time], values)
}

/// Colour and width of a line; the colours are distinct for readers who see few colours.
fn stroke(look: Look) -> ([u8; 3], f32) {
    match look {
        Look::Measured => ([163, 173, 184], 1.0),
        Look::Simulated => ([86, 180, 233], 1.5),
        Look::Extended => ([255, 140, 66], 1.5),
        Look::Reference => ([63, 207, 159], 1.0),
        Look::Noise => ([221, 154, 212], 1.0),
    }
}
