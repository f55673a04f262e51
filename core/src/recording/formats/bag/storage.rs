//! The two kinds of storage: MCAP and SQLite, whole or compressed with Zstandard.

use crate::error::{Error, Result};
use ::mcap::sans_io::LinearReaderOptions;
use rusqlite::{Connection, OpenFlags};
use std::borrow::Cow;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// How a Zstandard frame begins.
const ZSTANDARD: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];

/// Longest record of a small file when it is unpacked, bytes.
const LONGEST_RECORD: usize = 1 << 28;

/// Messages that a storage may hold.
const TYPES: [&str; 2] = ["sensor_msgs/msg/JointState", "sensor_msgs/JointState"];

/// The only encoding that is read.
const ENCODING: &str = "cdr";

/// A topic with what is sent on it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Topic {
    /// Name: "/joint_states".
    pub name: String,
    /// Type of its messages.
    pub kind: String,
    /// How they are encoded.
    pub encoding: String,
}

impl Topic {
    /// Whether its messages can be read.
    pub(super) fn is_joint_state(&self) -> bool {
        TYPES.contains(&self.kind.as_str()) && self.encoding == ENCODING
    }
}

/// Hears of every message on a topic that [`Topic::is_joint_state`]: topic, time at which it was logged (ns), content.
pub(super) type Hear<'a> = dyn FnMut(&str, i64, &[u8]) + 'a;

/// What a storage holds besides messages that were heard.
#[derive(Debug, Default)]
pub(super) struct Contents {
    /// All topics.
    pub topics: Vec<Topic>,
    /// Why reading ended before the end of the file.
    pub cut_off: Option<String>,
}

/// Reads an MCAP file; what comes before a damage is kept.
pub(super) fn mcap(path: &Path, hear: &mut Hear) -> Result<Contents> {
    let size = std::fs::metadata(path).map_or(0, |about| about.len()) as usize;
    // Checksums are verified before a chunk is used; a record that claims to be far longer than the file is damaged.
    let options = LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_validate_data_section_crc(true)
        .with_record_length_limit(size.max(LONGEST_RECORD));
    let mut reader = ::mcap::io::MessageReader::new_with_options(open(path)?, options);
    let mut contents = Contents::default();
    for message in reader.by_ref() {
        let message = match message {
            Ok(message) => message,
            Err(::mcap::McapError::BadMagic) if contents.topics.is_empty() => {
                return Err(Error::input(path, None, "MCAP", "this is not an MCAP file"));
            }
            Err(error @ ::mcap::McapError::BadDataCrc { .. }) => {
                let problem = format!("the file is damaged: bytes in it were changed ({error}); copy the log again");
                return Err(Error::input(path, None, "MCAP", problem));
            }
            Err(error) => {
                contents.cut_off = Some(error.to_string());
                break;
            }
        };
        let channel = &message.channel;
        let kind = channel.schema.as_ref().map_or("", |schema| &schema.name);
        let known = contents.topics.iter().find(|topic| topic.name == channel.topic && topic.kind == kind);
        let readable = known.map(Topic::is_joint_state).unwrap_or_else(|| {
            let topic = Topic {
                name: channel.topic.clone(),
                kind: kind.to_owned(),
                encoding: channel.message_encoding.clone(),
            };
            let readable = topic.is_joint_state();
            contents.topics.push(topic);
            readable
        });
        if readable {
            hear(&channel.topic, message.log_time as i64, &plain(&message.data));
        }
    }
    Ok(contents)
}

/// Reads the SQLite file of a bag; what comes before a damage is kept.
pub(super) fn sqlite(path: &Path, hear: &mut Hear) -> Result<Contents> {
    let unpacked;
    let mut file = path;
    if begins_with(path, &ZSTANDARD)? {
        // SQLite wants a file of its own.
        unpacked = tempfile::NamedTempFile::new().map_err(|source| Error::io(path, "unpack the bag", source))?;
        let mut target = unpacked.as_file();
        std::io::copy(&mut open(path)?, &mut target).map_err(|source| Error::io(path, "unpack the bag", source))?;
        file = unpacked.path();
    }
    let broken = |error: rusqlite::Error| {
        Error::input(path, None, "SQLite", format!("the file cannot be read as a ROS 2 bag: {error}"))
    };
    let connection = Connection::open_with_flags(file, OpenFlags::SQLITE_OPEN_READ_ONLY).map_err(broken)?;
    let mut contents = Contents::default();
    let mut topics = Vec::new();
    {
        let mut query =
            connection.prepare("SELECT id, name, type, serialization_format FROM topics").map_err(broken)?;
        let mut rows = query.query([]).map_err(broken)?;
        while let Some(row) = rows.next().map_err(broken)? {
            let text = |index| row.get::<_, String>(index).map_err(broken);
            let topic = Topic { name: text(1)?, kind: text(2)?, encoding: text(3)? };
            topics.push((row.get::<_, i64>(0).map_err(broken)?, topic));
        }
    }
    let mut query = connection.prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY id").map_err(broken)?;
    let mut rows = query.query([]).map_err(broken)?;
    loop {
        let row = match rows.next() {
            Ok(Some(row)) => row,
            Ok(None) => break,
            Err(error) => {
                contents.cut_off = Some(error.to_string());
                break;
            }
        };
        let id: i64 = row.get(0).map_err(broken)?;
        let Some((_, topic)) = topics.iter().find(|(own, topic)| *own == id && topic.is_joint_state()) else {
            continue;
        };
        let data = row.get_ref(2).map_err(broken)?;
        if let Ok(data) = data.as_blob() {
            hear(&topic.name, row.get(1).map_err(broken)?, &plain(data));
        }
    }
    contents.topics = topics.into_iter().map(|(_, topic)| topic).collect();
    Ok(contents)
}

/// The file behind its compression, where there is one.
fn open(path: &Path) -> Result<Box<dyn Read>> {
    let failed = |source| Error::io(path, "read the recording", source);
    let compressed = begins_with(path, &ZSTANDARD)?;
    let file = BufReader::with_capacity(1 << 20, File::open(path).map_err(failed)?);
    match compressed {
        true => Ok(Box::new(zstd::Decoder::with_buffer(file).map_err(failed)?)),
        false => Ok(Box::new(file)),
    }
}

/// Whether a file begins with these bytes.
pub(super) fn begins_with(path: &Path, magic: &[u8]) -> Result<bool> {
    let mut start = Vec::new();
    let failed = |source| Error::io(path, "read the recording", source);
    File::open(path).map_err(failed)?.take(magic.len() as u64).read_to_end(&mut start).map_err(failed)?;
    Ok(start == magic)
}

/// A message out of its own compression (`compression_mode: message`). No CDR begins as a Zstandard frame does.
fn plain(data: &[u8]) -> Cow<'_, [u8]> {
    if !data.starts_with(&ZSTANDARD) {
        return Cow::Borrowed(data);
    }
    zstd::decode_all(data).map_or(Cow::Borrowed(data), Cow::Owned)
}
