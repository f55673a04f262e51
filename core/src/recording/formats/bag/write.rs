//! Writing recordings as logs of ROS 2: an `.mcap` or `.db3` file with one sensor_msgs/JointState per sample.
//!
//! Numbers keep their bits. Time is kept in whole nanoseconds, as a message has it; a log that was one of ROS 2 before gets
//! its topic and its start back. Accelerations, truth and names of the robot have no place in these messages.

use super::joint_state::JointState;
use crate::error::{Error, Result};
use crate::recording::Recording;
use mcap::records::MessageHeader;
use rusqlite::Connection;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// The type of the messages.
const TYPE: &str = "sensor_msgs/msg/JointState";

/// Topic of a recording that has none.
const TOPIC: &str = "/joint_states";

/// The definition of the type, which a reader without ROS needs.
const DEFINITION: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// Tables of a bag as rosbag2 makes them.
const TABLES: &str = "\
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL,
    offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
    encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
INSERT INTO schema VALUES (4, '');
";

/// Writes an MCAP file.
///
/// # Errors
/// If the file cannot be written, or a time is none that a message can have.
pub(crate) fn mcap(path: &Path, recording: &Recording) -> Result<()> {
    let messages = messages(path, recording)?;
    let failed = |error: mcap::McapError| Error::io(path, "write the recording", std::io::Error::other(error));
    let file = File::create(path).map_err(|source| Error::io(path, "write the recording", source))?;
    let options = mcap::WriteOptions::new().profile("ros2").library("tauscope");
    let mut writer = options.create(BufWriter::new(file)).map_err(failed)?;
    let schema = writer.add_schema(TYPE, "ros2msg", DEFINITION.as_bytes()).map_err(failed)?;
    let channel = writer.add_channel(schema, topic(recording), "cdr", &BTreeMap::new()).map_err(failed)?;
    for (number, message) in messages.enumerate() {
        let (log_time, sequence) = (message.stamp_ns as u64, number as u32);
        let header = MessageHeader { channel_id: channel, sequence, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, &message.encode()).map_err(failed)?;
    }
    writer.finish().map_err(failed)?;
    Ok(())
}

/// Writes the SQLite file of a bag.
///
/// # Errors
/// As [`mcap`].
pub(crate) fn sqlite(path: &Path, recording: &Recording) -> Result<()> {
    let messages = messages(path, recording)?;
    let failed = |error: rusqlite::Error| Error::io(path, "write the recording", std::io::Error::other(error));
    // An old file would be added to.
    File::create(path).map_err(|source| Error::io(path, "write the recording", source))?;
    let mut connection = Connection::open(path).map_err(failed)?;
    let transaction = connection.transaction().map_err(failed)?;
    transaction.execute_batch(TABLES).map_err(failed)?;
    transaction
        .execute("INSERT INTO topics VALUES (1, ?1, ?2, 'cdr', '', '')", [topic(recording), TYPE])
        .map_err(failed)?;
    let definition = "INSERT INTO message_definitions VALUES (1, ?1, 'ros2msg', ?2, '')";
    transaction.execute(definition, [TYPE, DEFINITION]).map_err(failed)?;
    {
        let insert = "INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?1, ?2)";
        let mut insert = transaction.prepare(insert).map_err(failed)?;
        for message in messages {
            insert.execute((message.stamp_ns, message.encode())).map_err(failed)?;
        }
    }
    transaction.commit().map_err(failed)
}

fn topic(recording: &Recording) -> &str {
    recording.provenance.get("topic").map_or(TOPIC, String::as_str)
}

/// One message per sample.
fn messages<'a>(path: &Path, recording: &'a Recording) -> Result<impl Iterator<Item = JointState> + 'a> {
    let start = recording.provenance.get("start_unix_ns").and_then(|text| text.parse::<i64>().ok()).unwrap_or(0);
    let stamp = move |t: f64| start.saturating_add((1e9 * t).round() as i64);
    let limit = i64::from(i32::MAX) * 1_000_000_000;
    for pair in recording.time.windows(2) {
        let [from, to] = [pair[0], pair[1]].map(stamp);
        if from < 0 || to <= from || to > limit {
            let problem = format!(
                "{:?} s and then {:?} s are no times of messages, which are whole nanoseconds from 1970 to 2038",
                pair[0], pair[1]
            );
            return Err(Error::input(path, None, "t", problem));
        }
    }
    let row = |table: &crate::channels::Channels, sample: usize| -> Vec<f64> {
        (0..table.channels()).map(|joint| table.channel(joint)[sample]).collect()
    };
    Ok((0..recording.samples()).map(move |sample| JointState {
        stamp_ns: stamp(recording.time[sample]),
        names: recording.joints.clone(),
        position: row(&recording.q, sample),
        velocity: recording.qd.as_ref().map_or_else(Vec::new, |qd| row(qd, sample)),
        effort: row(&recording.tau, sample),
    }))
}
