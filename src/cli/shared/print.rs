//! Writing to standard output, which may be a pipe that nobody reads any longer. Only a terminal gets colours.

use super::global::Global;
use crate::error::{Error, Result};
use crate::output;
use anstyle::Style;
use serde::Serialize;
use std::io::{ErrorKind, Write};

/// Prints what a command found: to the program that runs it, if there is one; else nothing under `--quiet`, `value` under `--json`, else
/// the text for people. A closed pipe (`tauscope | head`) is not an error: the reader has had enough.
///
/// # Errors
/// If standard output cannot be written, as on a full disk.
pub(crate) fn result(
    global: &Global,
    schema: &str,
    value: &impl Serialize,
    text: impl FnOnce() -> String,
) -> Result<()> {
    if let Some(host) = &global.host {
        return host.print(schema, value, text());
    }
    let mut bytes = Vec::new();
    let made = match (global.quiet, global.json) {
        (true, _) => return Ok(()),
        (false, true) => output::json(&mut bytes, schema, value),
        (false, false) => writeln!(bytes, "{}", decorated(&text())),
    };
    // Takes the colours out again where nobody sees them: in a pipe, under NO_COLOR.
    let mut out = anstream::stdout().lock();
    match made.and_then(|()| out.write_all(&bytes)).and_then(|()| out.flush()) {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => {
            Err(Error::io("standard output", "print the result", source))
        }
        _ => Ok(()),
    }
}

/// Text for people with its landmarks set off: the verdict bold, where the results are in the background.
fn decorated(text: &str) -> String {
    let (bold, soft) = (Style::new().bold(), Style::new().dimmed());
    let lines = text.lines().map(|line| match line {
        verdict if verdict.starts_with("Verdict:") => format!("{bold}{verdict}{bold:#}"),
        place if place.starts_with("Results in ") || place.starts_with("Recordings in ") => {
            format!("{soft}{place}{soft:#}")
        }
        _ => line.to_owned(),
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn landmarks_are_set_off_and_nothing_is_lost() {
        let text = "Verdict: none\n\n a table\nResults in x";
        let colored = decorated(text);
        assert!(colored.starts_with("\u{1b}[1mVerdict"), "{colored:?}");
        assert_eq!(anstream::adapter::strip_str(&colored).to_string(), text);
    }
}
