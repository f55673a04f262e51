//! A film as an .rrd file.

use super::rrd::{Archetype, Index, RrdFile, Store, StoreKind, numbers, texts, tuples};
use super::{Film, Look, Signal, arm, layout};
use crate::error::{Error, Result};
use crate::robot::visuals;
use arrow_array::types::{Float32Type, Float64Type, UInt8Type, UInt32Type};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

const DOCUMENT: Archetype = Archetype("archetypes.TextDocument");
const LINES: Archetype = Archetype("archetypes.SeriesLines");
const SCALARS: Archetype = Archetype("archetypes.Scalars");
const TEXT_LOG: Archetype = Archetype("archetypes.TextLog");
const VIEW_COORDINATES: Archetype = Archetype("archetypes.ViewCoordinates");

/// Right, forward, up along x, y, z, in the viewer's numbers.
const RIGHT_HAND_Z_UP: [u8; 3] = [3, 5, 1];

/// Writes `film` to `path`.
///
/// # Errors
/// If the file cannot be written.
pub fn write(path: &Path, film: &Film) -> Result<()> {
    let written = File::create(path).and_then(|file| record(BufWriter::new(file), film));
    written.map_err(|error| Error::io(path, "write the recording for the viewer", error))
}

fn record(to: impl Write, film: &Film) -> io::Result<()> {
    let mut file = RrdFile::new(to)?;
    let recording = file.store(StoreKind::Recording, Some(&film.title))?;
    layout::send(&mut file, film)?;

    let visuals = visuals::load(film.robot);
    let axes = tuples::<UInt8Type, 3>([RIGHT_HAND_Z_UP]);
    file.log(&recording, "/arm", &[], &[VIEW_COORDINATES.component("xyz", "components.ViewCoordinates", axes)])?;
    for track in &film.tracks {
        arm::log(&mut file, &recording, film.robot, &visuals, track)?;
    }
    if let Some(first) = visuals.notes.first() {
        let others = match visuals.notes.len() - 1 {
            0 => String::new(),
            others => format!(", and {others} more like it (the viewer's page lists them)"),
        };
        tracing::warn!("{}: not drawn: {first}{others}", film.robot.name);
    }
    let notes: String = visuals.notes.iter().map(|note| format!("\n- not shown as the URDF has it: {note}")).collect();
    let verdict = [
        DOCUMENT.component("text", "components.Text", texts([format!("{}\n{notes}", film.text)])),
        DOCUMENT.component("media_type", "components.MediaType", texts(["text/markdown"])),
    ];
    file.log(&recording, "/verdict", &[], &verdict)?;
    for signal in &film.signals {
        log_signal(&mut file, &recording, &format!("/{}", film.path(signal)), signal)?;
    }
    let levels = film.markers.iter().map(|marker| if marker.finding { "WARN" } else { "INFO" });
    let findings = [
        TEXT_LOG.component("text", "components.Text", texts(film.markers.iter().map(|marker| &marker.text))),
        TEXT_LOG.component("level", "components.TextLogLevel", texts(levels)),
    ];
    let times = Index::seconds("time", film.markers.iter().map(|marker| marker.time));
    file.log(&recording, "/findings", &[times], &findings)?;
    file.finish()
}

fn log_signal(file: &mut RrdFile<impl Write>, recording: &Store, path: &str, signal: &Signal) -> io::Result<()> {
    let ([r, g, b], width) = stroke(signal.look);
    let color = numbers::<UInt32Type>([u32::from_be_bytes([r, g, b, 255])]);
    let lines = [
        LINES.component("colors", "components.Color", color),
        LINES.component("widths", "components.StrokeWidth", numbers::<Float32Type>([width])),
        LINES.component("names", "components.Name", texts([signal.name])),
    ];
    file.log(recording, path, &[], &lines)?;
    let values = numbers::<Float64Type>(signal.values.iter().copied());
    let times = Index::seconds("time", signal.time.iter().copied());
    file.log(recording, path, &[times], &[SCALARS.component("scalars", "components.Scalar", values)])
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
