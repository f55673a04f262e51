//! The file format of the rerun viewer, as far as recordings need it.
//!
//! Rerun's SDK writes the same, but it also talks to viewers over the network, and needs as many crates as all the rest
//! of tauscope. An .rrd file is a header and messages: `file` frames them, `message` encodes them as protocol buffers,
//! `chunk` puts rows of an entity into an Arrow record batch, `component` gives the columns the names and types that the
//! viewer knows. `tests/viewer/check.sh` reads the files with rerun's own tools.

mod chunk;
mod component;
mod file;
mod ids;
mod message;

pub(super) use chunk::{Index, nanoseconds};
pub(super) use component::{Archetype, Component, blob, flag, interval, numbers, texts, tuples};
pub(super) use file::RrdFile;
pub(super) use ids::uuid;
pub(super) use message::{Store, StoreKind};
