//! An .rrd file: a header, messages with their kinds and lengths, and an end.

use super::chunk::{Index, chunk};
use super::component::{Archetype, Component, numbers, texts};
use super::ids::Ids;
use super::message::{self, Message, Store, StoreKind};
use arrow_array::types::Int64Type;
use arrow_ipc::writer::StreamWriter;
use arrow_schema::ArrowError;
use std::io::{self, Write};

/// Version of the viewer whose types are written: [`super::super::VIEWER_VERSION`].
const VERSION: [u8; 4] = [0, 36, 3, 0];

const INFO: Archetype = Archetype("archetypes.RecordingInfo");

/// Kinds of messages.
const END: u64 = 0;
const STORE: u64 = 1;
const ARROW: u64 = 2;
const ACTIVATION: u64 = 3;

/// A file that is being written.
#[derive(Debug)]
pub(crate) struct RrdFile<W> {
    to: W,
    ids: Ids,
}

impl<W: Write> RrdFile<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// Those of writing.
    pub(crate) fn new(mut to: W) -> io::Result<Self> {
        /// LZ4 compression, protocol buffers, nothing else.
        const OPTIONS: [u8; 4] = [1, 2, 0, 0];
        to.write_all(b"RRF2")?;
        to.write_all(&VERSION)?;
        to.write_all(&OPTIONS)?;
        Ok(RrdFile { to, ids: Ids::new() })
    }

    /// Identities of what is in the file.
    pub(crate) fn ids(&mut self) -> &mut Ids {
        &mut self.ids
    }

    /// Begins a store; the viewer lists recordings by `name` and time.
    ///
    /// # Errors
    /// Those of writing.
    pub(crate) fn store(&mut self, kind: StoreKind, name: Option<&str>) -> io::Result<Store> {
        let store = Store { kind, id: format!("rec_{:032x}", self.ids.other()) };
        let info = message::store_info(self.ids.row(), &store, VERSION);
        self.message(STORE, &info)?;
        let start = numbers::<Int64Type>([self.ids.start()]);
        let mut properties = vec![INFO.component("start_time", "components.Timestamp", start)];
        properties.extend(name.map(|name| INFO.component("name", "components.Name", texts([name]))));
        self.log(&store, "/__properties", &[], &properties)?;
        Ok(store)
    }

    /// Adds rows of an entity, as of [`chunk`]; where there are none, nothing.
    ///
    /// # Errors
    /// Those of writing.
    pub(crate) fn log(
        &mut self,
        store: &Store,
        entity: &str,
        at: &[Index],
        components: &[Component],
    ) -> io::Result<()> {
        let (id, batch) = chunk(&mut self.ids, entity, at, components).map_err(into_io)?;
        if batch.num_rows() == 0 {
            return Ok(());
        }
        let mut stream = StreamWriter::try_new(Vec::new(), batch.schema_ref()).map_err(into_io)?;
        stream.write(&batch).map_err(into_io)?;
        let stream = stream.into_inner().map_err(into_io)?;
        let lz4 = lz4_flex::block::compress(&stream);
        self.message(ARROW, &message::arrow(store, id, at.is_empty(), stream.len(), &lz4))
    }

    /// Makes a blueprint the layout of the viewer.
    ///
    /// # Errors
    /// Those of writing.
    pub(crate) fn activate(&mut self, blueprint: &Store) -> io::Result<()> {
        self.message(ACTIVATION, &message::activation(blueprint))
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Those of writing.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        // There is no index of the chunks, so the viewer reads the whole file.
        self.message(END, &Message::default())?;
        self.to.flush()
    }

    fn message(&mut self, kind: u64, message: &Message) -> io::Result<()> {
        let bytes = message.bytes();
        self.to.write_all(&kind.to_le_bytes())?;
        self.to.write_all(&(bytes.len() as u64).to_le_bytes())?;
        self.to.write_all(bytes)
    }
}

/// Memory is written to, so it is never the device that fails.
fn into_io(error: ArrowError) -> io::Error {
    io::Error::other(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_that_of_the_viewer() {
        let [major, minor, patch, _] = VERSION;
        assert_eq!(format!("{major}.{minor}.{patch}"), crate::report::viewer::VIEWER_VERSION);
    }

    #[test]
    fn a_file_has_a_header_messages_and_an_end() {
        let mut bytes = Vec::new();
        let mut file = RrdFile::new(&mut bytes).unwrap();
        let store = file.store(StoreKind::Blueprint, None).unwrap();
        file.activate(&store).unwrap();
        file.finish().unwrap();
        assert_eq!(&bytes[..12], b"RRF2\x00\x24\x03\x00\x01\x02\x00\x00");
        let (mut at, mut kinds) = (12, Vec::new());
        while at < bytes.len() {
            let number = |from: usize| u64::from_le_bytes(bytes[from..from + 8].try_into().unwrap());
            kinds.push(number(at));
            at += 16 + number(at + 8) as usize;
        }
        assert_eq!((at, kinds), (bytes.len(), vec![STORE, ARROW, ACTIVATION, END]));
    }
}
