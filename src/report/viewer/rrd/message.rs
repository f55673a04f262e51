//! Messages of an .rrd file, encoded as protocol buffers (`rerun.log_msg.v1alpha1`).

/// Under this name the viewer keeps what belongs together: recordings and their layout.
const APPLICATION: &str = "tauscope";

/// What a store holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StoreKind {
    /// Data.
    Recording = 1,
    /// A layout of the viewer.
    Blueprint = 2,
}

/// A store that a message is about.
#[derive(Debug, Clone)]
pub(crate) struct Store {
    /// What it holds.
    pub kind: StoreKind,
    /// Its identity.
    pub id: String,
}

/// Fields of a message, encoded.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Message(Vec<u8>);

impl Message {
    /// The bytes of the message.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }

    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }

    fn number(mut self, field: u64, value: u64) -> Self {
        self.varint(field << 3);
        self.varint(value);
        self
    }

    fn fixed(mut self, field: u64, value: u64) -> Self {
        self.varint(field << 3 | 1);
        self.0.extend(value.to_le_bytes());
        self
    }

    fn block(mut self, field: u64, bytes: &[u8]) -> Self {
        self.varint(field << 3 | 2);
        self.varint(bytes.len() as u64);
        self.0.extend(bytes);
        self
    }
}

/// Announces a store; `version` is that of the file's header.
pub(super) fn store_info(row: u128, store: &Store, version: [u8; 4]) -> Message {
    /// A writer that is none of rerun's own.
    const OTHER: u64 = 6;
    let writer = Message::default().block(1, concat!("tauscope ", env!("CARGO_PKG_VERSION")).as_bytes());
    let source = Message::default().number(1, OTHER).block(2, &writer.0);
    let version = Message::default().number(1, u32::from_le_bytes(version).into());
    let info = Message::default().block(2, &store_id(store).0).block(5, &source.0).block(6, &version.0);
    Message::default().block(1, &tuid(row).0).block(2, &info.0)
}

/// A chunk of a store: its Arrow stream of `size` bytes, compressed to `lz4`.
pub(super) fn arrow(store: &Store, chunk: u128, is_static: bool, size: usize, lz4: &[u8]) -> Message {
    const LZ4: u64 = 2;
    const ARROW_STREAM: u64 = 1;
    Message::default()
        .block(1, &store_id(store).0)
        .number(2, LZ4)
        .number(3, size as u64)
        .number(4, ARROW_STREAM)
        .block(5, lz4)
        .block(6, &tuid(chunk).0)
        .number(7, is_static.into())
}

/// Makes the layout in `store` the one that is shown, now and whenever the viewer is reset.
pub(super) fn activation(store: &Store) -> Message {
    Message::default().block(1, &store_id(store).0).number(2, 1).number(3, 1)
}

fn store_id(store: &Store) -> Message {
    let application = Message::default().block(1, APPLICATION.as_bytes());
    Message::default().number(1, store.kind as u64).block(2, store.id.as_bytes()).block(3, &application.0)
}

fn tuid(id: u128) -> Message {
    Message::default().fixed(1, (id >> 64) as u64).fixed(2, id as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_take_seven_bits_a_byte() {
        assert_eq!(Message::default().number(1, 127).bytes(), [0x08, 127]);
        assert_eq!(Message::default().number(1, 128).bytes(), [0x08, 0x80, 1]);
        // The example of the documentation of protocol buffers.
        assert_eq!(Message::default().number(1, 150).bytes(), [0x08, 0x96, 0x01]);
        assert_eq!(Message::default().block(2, b"testing").bytes(), b"\x12\x07testing");
    }

    #[test]
    fn an_activation_as_the_sdk_writes_it() {
        let store = Store { kind: StoreKind::Blueprint, id: "rec_46cb01a2b5ae42ed8baa358ee84ae301".into() };
        let sdk =
            b"\x0a\x34\x08\x02\x12\x24rec_46cb01a2b5ae42ed8baa358ee84ae301\x1a\x0a\x0a\x08tauscope\x10\x01\x18\x01";
        assert_eq!(activation(&store).bytes(), sdk);
    }

    #[test]
    fn identities_are_two_numbers_of_eight_bytes() {
        let sdk = b"\x09\x08a\x1a\xafE^\xeb\x18\x11+r}\n\x1f\x99\xcdL";
        assert_eq!(tuid(0x18EB_5E45_AF1A_6108_4CCD_991F_0A7D_722B).bytes(), sdk);
    }
}
