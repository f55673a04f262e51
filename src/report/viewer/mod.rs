//! `recording.rrd`: a run as the rerun viewer shows it. The arm moves, its signals are plotted, findings are marked in
//! time, and the verdict stands next to it.
//!
//! What there is to show is a [`Film`], made by [`scenario`], [`fit`] or [`diagnosis`]; the feature `viewer` writes it.
//! Several logs follow each other on the one timeline `time` (s), [`PAUSE_S`] apart; the first keeps its own times.

pub mod diagnosis;
mod film;
pub mod fit;
pub mod scenario;

#[cfg(feature = "viewer")]
mod arm;
#[cfg(feature = "viewer")]
mod blueprint;
#[cfg(feature = "viewer")]
mod layout;
#[cfg(feature = "viewer")]
mod rrd;
#[cfg(feature = "viewer")]
mod write;

pub use film::{Film, Look, Marker, PAUSE_S, Quantity, Signal, Track, joined, joined_time, offsets, part};
#[cfg(feature = "viewer")]
pub use write::write;

use crate::error::Result;
use crate::output::ResultFolder;

/// Name of the recording in a results folder.
pub const FILE: &str = "recording.rrd";

/// Version of the viewer that reads it.
pub const VIEWER_VERSION: &str = "0.36.3";

/// Writes the film to [`FILE`] in the results folder; without the feature `viewer`, nothing.
///
/// # Errors
/// Those of `film`, or if the file cannot be written.
pub fn add<'a>(folder: &ResultFolder, film: impl FnOnce() -> Result<Film<'a>>) -> Result<()> {
    #[cfg(feature = "viewer")]
    folder.write_with(FILE, |path| write(path, &film()?))?;
    #[cfg(not(feature = "viewer"))]
    let _ = (folder, film);
    Ok(())
}
