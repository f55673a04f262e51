//! Logs as files: the extension of the name gives the format.

#[cfg(feature = "bags")]
use super::formats::bag;
use super::formats::{not_written, unknown_format};
#[cfg(feature = "parquet")]
use super::parquet;
use super::{Recording, csv};
use crate::error::{Error, Result};
use std::path::Path;

/// Reads a log; the extension of the name (`csv`, `parquet`; `mcap`, `db3` or the folder of a ROS 2 bag) gives the format.
/// What was read but not used is logged as a warning; [`csv::read`] and `parquet::read` return it.
///
/// With `joints` (the robot's joints in order) the log must have these joints; without, it names or numbers its own.
///
/// # Errors
/// An unreadable file, an unknown extension, or anything wrong with the content, with its line and column.
pub fn load(path: impl AsRef<Path>, joints: Option<&[String]>) -> Result<Recording> {
    let path = path.as_ref();
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let (recording, notes) = match extension.as_deref() {
        Some("csv") => csv::read(path, joints)?,
        #[cfg(feature = "parquet")]
        Some("parquet") => parquet::read(path, joints)?,
        #[cfg(feature = "bags")]
        _ if bag::is_bag(path) => bag::recording(path, joints)?,
        _ => match std::fs::metadata(path) {
            Ok(_) => return Err(unknown_format(path)),
            Err(source) => return Err(Error::io(path, "read the recording", source)),
        },
    };
    for note in notes {
        tracing::warn!("{}: {note}", path.display());
    }
    Ok(recording)
}

/// Writes a log in the format of the name's extension: `csv`, `parquet`, `mcap` or `db3`. Returns what the
/// format has no place for.
///
/// # Errors
/// An unknown extension, a file that cannot be written, or a time that the format cannot hold.
pub fn save(path: &Path, recording: &Recording) -> Result<Vec<&'static str>> {
    let mut lost = Vec::new();
    match Written::of(path)? {
        Written::Csv => {
            match recording.is_numbered() {
                true => csv::write(path, recording)?,
                false => csv::write_named(path, recording)?,
            }
            let has_source = !recording.provenance.is_empty() || !recording.robot.is_empty();
            lost.extend(has_source.then_some("where the log comes from"));
        }
        #[cfg(feature = "parquet")]
        Written::Parquet => match recording.is_numbered() {
            true => parquet::write(path, recording)?,
            false => parquet::write_named(path, recording)?,
        },
        #[cfg(feature = "bags")]
        Written::Bag(write) => {
            write(path, recording)?;
            let more = recording.qdd.is_some() || recording.truth.is_some();
            lost.extend(more.then_some("accelerations and truth"));
        }
    }
    Ok(lost)
}

/// A format in which logs are written.
enum Written {
    Csv,
    #[cfg(feature = "parquet")]
    Parquet,
    /// One of the formats of bags, by the function that writes it.
    #[cfg(feature = "bags")]
    Bag(fn(&Path, &Recording) -> Result<()>),
}

impl Written {
    /// The format that the extension of a name gives.
    fn of(path: &Path) -> Result<Written> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("csv") => Ok(Written::Csv),
            #[cfg(feature = "parquet")]
            Some("parquet") => Ok(Written::Parquet),
            #[cfg(feature = "bags")]
            Some("mcap") => Ok(Written::Bag(bag::write::mcap)),
            #[cfg(feature = "bags")]
            Some("db3") => Ok(Written::Bag(bag::write::sqlite)),
            _ => Err(not_written(path)),
        }
    }
}

/// Whether the extension of a name gives a format in which logs are written.
///
/// # Errors
/// Another extension, with those that there are.
pub fn writable(path: &Path) -> Result<()> {
    Written::of(path).map(|_| ())
}

#[cfg(test)]
#[cfg(feature = "parquet")]
mod tests {
    use super::*;
    use crate::recording::samples;

    #[test]
    fn load_chooses_by_extension() {
        let folder = tempfile::tempdir().unwrap();
        let recording = samples::full(2, 5);
        let joints = recording.joints.clone();
        csv::write(&folder.path().join("log.CSV"), &recording).unwrap();
        parquet::write(&folder.path().join("log.parquet"), &recording).unwrap();
        let from_csv = load(folder.path().join("log.CSV"), Some(&joints)).unwrap();
        assert_eq!(samples::bits(&from_csv), samples::bits(&recording));
        assert_eq!(load(folder.path().join("log.parquet"), None).unwrap(), recording);
        let other = folder.path().join("log.mat");
        std::fs::write(&other, "MATLAB").unwrap();
        let error = load(&other, None).unwrap_err().to_string();
        assert!(error.contains("log.mat") && error.contains(".parquet"), "{error}");
        let error = load("log.mat", None).unwrap_err().to_string();
        assert!(error.contains("log.mat") && error.contains("No such file"), "{error}");
        for name in ["log.npz", "log"] {
            let error = save(Path::new(name), &recording).unwrap_err().to_string();
            assert_eq!(error, writable(Path::new(name)).unwrap_err().to_string());
            assert!(error.starts_with(name) && error.contains("are written as .csv"), "{error}");
        }
        assert!(writable(Path::new("log.CSV")).is_ok());
        let error = load(folder.path().join("none.csv"), None).unwrap_err().to_string();
        assert!(error.contains("none.csv"), "{error}");
    }
}
