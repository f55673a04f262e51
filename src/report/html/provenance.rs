//! How a report came to be: command, seed and versions, without the places on the machine that made it.

use maud::{Markup, html};
use std::path::Path;

/// Command, seed and versions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Provenance {
    command: String,
    seed: Option<u64>,
}

impl Provenance {
    /// The provenance of this process and the seed it used.
    pub(crate) fn here(seed: Option<u64>) -> Self {
        let arguments = std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned());
        Self::of(std::iter::once("tauscope".to_owned()).chain(arguments), seed)
    }

    /// The provenance of a command. Absolute paths are given relative to the present folder where they are inside, else by their name.
    pub(crate) fn of(command: impl IntoIterator<Item = impl Into<String>>, seed: Option<u64>) -> Self {
        let here = std::env::current_dir().unwrap_or_default();
        let words: Vec<String> = command.into_iter().map(|word| plain(&word.into(), &here)).collect();
        Provenance { command: words.join(" "), seed }
    }

    pub(super) fn render(&self) -> Markup {
        html! {
            h2 { "How this was made" }
            p { code { (self.command) } }
            p {
                @if let Some(seed) = self.seed { "Seed " (seed) ". " }
                "tauscope " (env!("CARGO_PKG_VERSION")) ", rapier3d " (rapier3d::VERSION) ". The same command, inputs and seed give the same numbers."
            }
        }
    }
}

/// The path of a log as one can send it to others.
pub(super) fn file_name(path: &str) -> String {
    plain(path, &std::env::current_dir().unwrap_or_default())
}

/// A word of a command as one can send it to others.
fn plain(word: &str, here: &Path) -> String {
    let (option, value) = match word.split_once('=') {
        Some((option, value)) if option.starts_with("--") => (format!("{option}="), value),
        _ => (String::new(), word),
    };
    let path = Path::new(value);
    let value = match (path.is_absolute(), path.strip_prefix(here)) {
        (false, _) => value.to_owned(),
        (true, Ok(inside)) => inside.display().to_string(),
        (true, Err(_)) => path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned()),
    };
    let quoted = value.is_empty() || value.contains([' ', '\'', '"', '$']);
    if quoted { format!("{option}'{value}'") } else { option + &value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_place_on_the_machine_is_told() {
        let here = Path::new("/home/somebody/project");
        assert_eq!(plain("/home/somebody/project/logs/a.csv", here), "logs/a.csv");
        assert_eq!(plain("--out=/srv/secret/results", here), "--out=results");
        assert_eq!(plain("logs/a b.csv", here), "'logs/a b.csv'");
        assert_eq!(plain("--seed", here), "--seed");
    }
}
