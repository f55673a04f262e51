//! Numbers and objects as all texts and files have them.

mod numbers;

pub use numbers::{measured, significant};

use serde::Serialize;
use std::io::{self, BufWriter, ErrorKind, Write};

/// A JSON object with the name of its layout in front.
#[derive(Serialize)]
struct Tagged<'a, T> {
    schema: &'a str,
    #[serde(flatten)]
    value: &'a T,
}

/// Writes `value` as a JSON object with `schema` as its first field, and a line end.
///
/// # Errors
/// If `writer` fails, or `value` is not an object or has a field `schema` of its own.
pub fn json(writer: impl Write, schema: &str, value: &impl Serialize) -> io::Result<()> {
    let plain = serde_json::to_value(value)?;
    let object = plain.as_object().ok_or_else(|| io::Error::new(ErrorKind::InvalidInput, "it is not a JSON object"))?;
    if object.contains_key("schema") {
        return Err(io::Error::new(ErrorKind::InvalidInput, "the object has a field 'schema' of its own"));
    }
    // Not `plain`, which has lost the order of the fields.
    pretty(writer, &Tagged { schema, value })
}

/// Writes `value` as indented JSON with a line end.
///
/// # Errors
/// If `writer` fails, or `value` has no form in JSON.
pub fn pretty(writer: impl Write, value: &impl Serialize) -> io::Result<()> {
    let mut writer = BufWriter::new(writer);
    serde_json::to_writer_pretty(&mut writer, value)?;
    writer.write_all(b"\n")?;
    writer.flush()
}
