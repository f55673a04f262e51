//! Scenario files read and checked.

use super::locate::Located;
use super::spec::Scenario;
use super::validate;
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

impl Scenario {
    /// Reads and checks a scenario file. Paths inside come back resolved against the file's folder.
    ///
    /// # Errors
    /// Names file, line and key for anything unreadable, unknown, missing or impossible.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(path, &read(path)?)
    }

    pub(super) fn parse(path: &Path, text: &str) -> Result<Self> {
        if let Some(problem) = of_another_kind(text) {
            return Err(Error::input(path, None, "the scenario", problem));
        }
        let mut scenario: Scenario = toml::from_str(text).map_err(|e| Error::toml(path, text, &e))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let resolve = |file: &mut PathBuf| *file = folder.join(&*file);
        resolve(&mut scenario.robot.urdf);
        for motion in [&mut scenario.motion, &mut scenario.held_out] {
            motion.file.iter_mut().for_each(resolve);
        }
        validate::validate(&scenario, &Located::new(path, text))?;
        Ok(scenario)
    }
}

/// What is said of a file that is no scenario and has another place in a command.
fn of_another_kind(text: &str) -> Option<&'static str> {
    let is_dataset = |line: &str| line.trim_start().starts_with("schema") && line.contains("tauscope.dataset/");
    match text.trim_start_matches('\u{feff}').trim_start() {
        text if text.starts_with('<') => Some(
            "this is an XML file, as the description of a robot, and no scenario: `inspect`, `identify` and `diagnose` take it with --robot, and a \
             scenario names it ([robot] urdf = \"...\")",
        ),
        text if text.lines().any(is_dataset) => {
            Some("this is a dataset, which describes measured logs, and no scenario: give it with --dataset")
        }
        _ => None,
    }
}

/// The text of a scenario file.
/// What `make` makes of the scenario in a file; `seed` replaces the scenario's seed where given.
///
/// # Errors
/// Those of reading the scenario, and of `make`.
pub(super) fn with_seed<T>(
    path: &Path,
    seed: Option<u64>,
    make: impl FnOnce(Scenario, &Located) -> Result<T>,
) -> Result<T> {
    let text = read(path)?;
    let mut scenario = Scenario::parse(path, &text)?;
    scenario.seed = seed.unwrap_or(scenario.seed);
    make(scenario, &Located::new(path, &text))
}

fn read(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).map_err(|e| Error::io(path, "read the scenario", e))
}
