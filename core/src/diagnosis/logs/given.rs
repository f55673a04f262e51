//! Logs as they are given to a diagnosis: by reference or by value, with a name or without.

use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use std::borrow::Cow;
use std::path::Path;

/// A log given to a diagnosis. It converts from a [`Recording`] or a [`Sieved`] log, by reference or by value, and from a
/// pair of a file's name and either: faults and errors name the log by it.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::GivenLog;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
///
/// // A log with the name that faults and errors call it by, or without one.
/// let (name, sieved) = GivenLog::from(("monday.csv", &train)).into_named(|| unreachable!());
/// assert_eq!((&name[..], sieved.recording.samples()), ("monday.csv", 1000));
/// assert_eq!(GivenLog::from(test).into_named(|| "test log 1".to_owned()).0, "test log 1");
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct GivenLog<'a> {
    name: Option<String>,
    data: Data<'a>,
}

#[derive(Debug, Clone)]
enum Data<'a> {
    Recording(Box<Cow<'a, Recording>>),
    Sieved(Box<Cow<'a, Sieved>>),
}

impl GivenLog<'_> {
    /// The log to be screened with its name, `otherwise` where it has none. Samples of a plain recording count from 1 in the
    /// place of a file's lines.
    pub fn into_named(self, otherwise: impl FnOnce() -> String) -> (String, Sieved) {
        let sieved = match self.data {
            Data::Sieved(sieved) => (*sieved).into_owned(),
            Data::Recording(recording) => {
                let lines = (1..=recording.samples()).collect();
                Sieved { recording: (*recording).into_owned(), lines, ..Sieved::default() }
            }
        };
        (self.name.unwrap_or_else(otherwise), sieved)
    }
}

impl<'a> From<&'a Recording> for GivenLog<'a> {
    fn from(recording: &'a Recording) -> Self {
        GivenLog { name: None, data: Data::Recording(Box::new(Cow::Borrowed(recording))) }
    }
}

impl From<Recording> for GivenLog<'_> {
    fn from(recording: Recording) -> Self {
        GivenLog { name: None, data: Data::Recording(Box::new(Cow::Owned(recording))) }
    }
}

impl<'a> From<&'a Sieved> for GivenLog<'a> {
    fn from(sieved: &'a Sieved) -> Self {
        GivenLog { name: None, data: Data::Sieved(Box::new(Cow::Borrowed(sieved))) }
    }
}

impl From<Sieved> for GivenLog<'_> {
    fn from(sieved: Sieved) -> Self {
        GivenLog { name: None, data: Data::Sieved(Box::new(Cow::Owned(sieved))) }
    }
}

impl<'a, N: AsRef<Path>, L: Into<GivenLog<'a>>> From<(N, L)> for GivenLog<'a> {
    fn from((name, log): (N, L)) -> Self {
        GivenLog { name: Some(name.as_ref().display().to_string()), ..log.into() }
    }
}
