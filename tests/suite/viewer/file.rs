//! An .rrd file read back: frames, protocol buffers, and chunks, whose components must be of the types in `types.txt`.

use arrow_array::cast::AsArray;
use arrow_array::types::{ArrowPrimitiveType, DurationNanosecondType, Int64Type};
use arrow_array::{Array, ArrayRef, RecordBatch};
use arrow_ipc::reader::StreamReader;
use arrow_schema::DataType;
use std::collections::BTreeSet;
use std::path::Path;

/// Kinds of stores.
const RECORDING: u64 = 1;
const BLUEPRINT: u64 = 2;

/// Every component that recordings may have, as "archetype field type Arrow-type-of-a-value". It is what rerun's own SDK
/// 0.36.3 writes.
const TYPES: &str = include_str!("types.txt");

/// Rows of an entity.
pub(super) struct Chunk(RecordBatch);

/// The chunks of a store.
#[derive(Default)]
pub(super) struct Store {
    id: String,
    chunks: Vec<Chunk>,
}

/// The recording and the layout in a file.
pub(super) struct Stores {
    pub recording: Store,
    pub layout: Store,
}

impl Chunk {
    /// Path of the entity.
    fn entity(&self) -> &str {
        &self.0.schema_ref().metadata()["rerun:entity_path"]
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.0.num_rows()
    }

    /// Times of the rows, ns.
    pub(super) fn times(&self) -> Option<&[i64]> {
        Some(self.0.column_by_name("time")?.as_primitive::<DurationNanosecondType>().values())
    }

    /// Values of a component in all rows, one after the other.
    pub(super) fn component(&self, name: &str) -> Option<&ArrayRef> {
        Some(self.0.column_by_name(name)?.as_list::<i32>().values())
    }
}

impl Store {
    /// Paths of its entities, sorted.
    pub(super) fn entities(&self) -> Vec<String> {
        let paths: BTreeSet<&str> = self.chunks.iter().map(Chunk::entity).collect();
        paths.into_iter().map(str::to_owned).collect()
    }

    /// Chunks of an entity.
    pub(super) fn of<'a>(&'a self, path: &str) -> impl Iterator<Item = &'a Chunk> {
        self.chunks.iter().filter(move |chunk| chunk.entity() == path)
    }

    /// Values of a component in the only row that an entity has of it.
    pub(super) fn values(&self, path: &str, component: &str) -> &ArrayRef {
        let mut found = self.of(path).filter_map(|chunk| Some((chunk.rows(), chunk.component(component)?)));
        let (rows, values) = found.next().unwrap_or_else(|| panic!("{path} has no {component}"));
        assert_eq!((rows, found.count()), (1, 0), "rows of {path} {component}");
        values
    }

    /// Such values as numbers; vectors one after the other.
    pub(super) fn numbers<T: ArrowPrimitiveType>(&self, path: &str, component: &str) -> Vec<T::Native> {
        let values = self.values(path, component);
        let flat = values.as_fixed_size_list_opt().map_or(values, |tuples| tuples.values());
        flat.as_primitive::<T>().values().to_vec()
    }

    /// Such values as texts.
    pub(super) fn texts(&self, path: &str, component: &str) -> Vec<String> {
        let texts = self.values(path, component).as_string::<i32>();
        texts.iter().map(|text| text.unwrap().to_owned()).collect()
    }
}

/// Reads a file and checks it: the stores are announced, the layout is the active one, and every chunk is [`checked`].
pub(super) fn read(path: &Path) -> Stores {
    let bytes = std::fs::read(path).unwrap();
    assert_eq!(&bytes[..12], b"RRF2\x00\x24\x03\x00\x01\x02\x00\x00", "0.36.3, LZ4, protocol buffers");
    let (mut recording, mut layout) = (Store::default(), Store::default());
    let (mut active, mut ids) = (None, BTreeSet::new());
    let mut rest = &bytes[12..];
    loop {
        let number = |at: usize| u64::from_le_bytes(rest[at..at + 8].try_into().unwrap());
        let (kind, length) = (number(0), number(8) as usize);
        let message = &rest[16..16 + length];
        rest = &rest[16 + length..];
        match kind {
            0 => break,
            1 => {
                let (kind, id) = store_id(block(block(message, 2), 2));
                let store = if kind == RECORDING { &mut recording } else { &mut layout };
                assert_eq!(store.id, "", "a second store of kind {kind}");
                store.id = id;
            }
            2 => {
                let (kind, id) = store_id(block(message, 1));
                let store = if kind == RECORDING { &mut recording } else { &mut layout };
                assert_eq!(store.id, id, "rows of a store that was not announced");
                let size = number_of(message, 3) as usize;
                let stream = lz4_flex::block::decompress(block(message, 5), size).unwrap();
                let mut batches = StreamReader::try_new(&stream[..], None).unwrap();
                let batch = batches.next().unwrap().unwrap();
                assert!(batches.next().is_none());
                checked(&batch, kind, number_of(message, 7) == 1, &mut ids);
                store.chunks.push(Chunk(batch));
            }
            3 => active = Some((store_id(block(message, 1)), number_of(message, 2), number_of(message, 3))),
            other => panic!("message of kind {other}"),
        }
    }
    assert!(rest.is_empty(), "{} bytes after the end", rest.len());
    assert_eq!(active, Some(((BLUEPRINT, layout.id.clone()), 1, 1)));
    assert_ne!(recording.id, layout.id);
    Stores { recording, layout }
}

/// Checks the metadata and types of a chunk: identities that are new and rise, timelines of its kind of store unless it is
/// static, and components that the viewer knows.
fn checked(batch: &RecordBatch, kind: u64, is_static: bool, ids: &mut BTreeSet<u128>) {
    let schema = batch.schema();
    let entity = schema.metadata()["rerun:entity_path"].as_str();
    assert!(batch.num_rows() > 0 && entity.starts_with('/'), "{entity}");
    assert_eq!(schema.metadata()["sorbet:version"], "0.1.3");
    let id = schema.metadata()["rerun:id"].strip_prefix("chunk_").expect("a name of a chunk");
    assert!(ids.insert(u128::from_str_radix(id, 16).unwrap()), "{id} twice");
    let (mut timelines, mut last) = (Vec::new(), None);
    for (field, column) in schema.fields().iter().zip(batch.columns()) {
        let at = format!("{} of {entity}", field.name());
        assert_eq!(column.null_count(), 0, "{at}");
        let metadata = |key: &str| field.metadata().get(key).map_or("", String::as_str);
        match metadata("rerun:kind") {
            "control" => {
                assert_eq!(metadata("ARROW:extension:name"), "rerun.datatypes.TUID");
                assert_eq!(field.data_type(), &DataType::FixedSizeBinary(16));
                for row in column.as_fixed_size_binary().iter() {
                    let row = u128::from_be_bytes(row.unwrap().try_into().unwrap());
                    assert!(last < Some(row) && ids.insert(row), "{at}: {row:032x}");
                    last = Some(row);
                }
            }
            "index" => {
                assert_eq!(metadata("rerun:index_name"), field.name());
                if let Some(times) = column.as_primitive_opt::<DurationNanosecondType>() {
                    assert_eq!(metadata("rerun:is_sorted") == "true", times.values().is_sorted(), "{at}");
                } else if let Some(numbers) = column.as_primitive_opt::<Int64Type>() {
                    assert_eq!(numbers.values().to_vec(), [0], "{at}");
                }
                timelines.push((field.name().as_str(), field.data_type().to_string()));
            }
            kind => {
                assert_eq!((kind, metadata("rerun:component")), ("data", field.name().as_str()), "{at}");
                let (archetype, kind) = (metadata("rerun:archetype"), metadata("rerun:component_type"));
                let (short, name) = field.name().split_once(':').unwrap();
                assert_eq!(archetype.rsplit('.').next(), Some(short), "{at}");
                let DataType::List(item) = field.data_type() else { panic!("{at}: {}", field.data_type()) };
                assert!(item.is_nullable() && field.is_nullable(), "{at}");
                let line = format!("{archetype} {name} {kind} {}", item.data_type());
                assert!(TYPES.lines().any(|known| known == line), "the viewer does not know {line}");
            }
        }
    }
    let expected: &[(&str, String)] = match kind {
        _ if is_static => &[],
        RECORDING => &[("time", "Duration(ns)".to_owned())],
        _ => &[("blueprint", "Int64".to_owned()), ("log_time", "Timestamp(ns)".to_owned())],
    };
    assert_eq!(timelines, expected, "{entity}");
    assert!(last.is_some(), "{entity} has no identities of rows");
}

/// Kind and name of a store, which must be one of tauscope's.
fn store_id(message: &[u8]) -> (u64, String) {
    assert_eq!(block(block(message, 3), 1), b"tauscope");
    (number_of(message, 1), String::from_utf8(block(message, 2).to_vec()).unwrap())
}

enum Value<'a> {
    Number(u64),
    Block(&'a [u8]),
}

/// Fields of a protocol buffer.
fn fields(mut message: &[u8]) -> Vec<(u64, Value<'_>)> {
    fn varint(message: &mut &[u8]) -> u64 {
        let length = message.iter().position(|byte| byte & 0x80 == 0).unwrap() + 1;
        let (bytes, rest) = message.split_at(length);
        *message = rest;
        bytes.iter().rev().fold(0, |value, byte| value << 7 | u64::from(byte & 0x7f))
    }
    let mut fields = Vec::new();
    while !message.is_empty() {
        let key = varint(&mut message);
        let value = match key & 7 {
            0 => Value::Number(varint(&mut message)),
            wire => {
                let length = if wire == 2 { varint(&mut message) as usize } else { 8 };
                let (bytes, rest) = message.split_at(length);
                message = rest;
                Value::Block(bytes)
            }
        };
        fields.push((key >> 3, value));
    }
    fields
}

fn block(message: &[u8], field: u64) -> &[u8] {
    let found = fields(message).into_iter().find(|(number, _)| *number == field);
    let Some((_, Value::Block(bytes))) = found else { panic!("no bytes in field {field}") };
    bytes
}

fn number_of(message: &[u8], field: u64) -> u64 {
    let found = fields(message).into_iter().find(|(number, _)| *number == field);
    let Some((_, Value::Number(value))) = found else { panic!("no number in field {field}") };
    value
}
