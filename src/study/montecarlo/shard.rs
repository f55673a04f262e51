//! One machine's part of a study, as the schedulers of array jobs number it.

use crate::error::{Error, Result};
use std::fmt;
use std::str::FromStr;

/// Part `index` of `count`, from 0.
///
/// ```
/// use tauscope::study::montecarlo::Shard;
///
/// // The third of four parts of a study has every fourth chunk.
/// let third: Shard = "2/4".parse()?;
/// assert_eq!((third.index, third.count), (2, 4));
/// let chunks: Vec<usize> = (0..10).filter(|&chunk| third.has(chunk)).collect();
/// assert_eq!(chunks, [2, 6]);
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 0.
    pub index: usize,
    /// Number of parts.
    pub count: usize,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Shard = Shard { index: 0, count: 1 };

    /// Whether a chunk belongs to this part.
    pub fn has(self, chunk: usize) -> bool {
        chunk % self.count == self.index
    }

    /// The part that the environment of an array job names: a Slurm array (SLURM_ARRAY_TASK_ID, _MIN, _STEP and _COUNT) or
    /// a Kubernetes indexed job (JOB_COMPLETION_INDEX, which comes without the number of parts). `count` replaces the
    /// scheduler's number of parts: needed where only some tasks of an array are submitted again. None outside such jobs.
    ///
    /// # Errors
    /// If a variable is not a number, the number of parts is not known, or it is given outside such a job.
    pub fn from_environment(variable: impl Fn(&str) -> Option<String>, count: Option<usize>) -> Result<Option<Self>> {
        let number = |name: &str| -> Result<Option<usize>> {
            let read = |text: String| {
                text.trim()
                    .parse()
                    .map_err(|_| Error::request(name, format!("`{text}` in the environment is no number")))
            };
            variable(name).map(read).transpose()
        };
        let (index, count) = if let Some(id) = number("SLURM_ARRAY_TASK_ID")? {
            // Where parts are counted by hand, tasks are numbered by hand too: from 0.
            let first = if count.is_some() { 0 } else { number("SLURM_ARRAY_TASK_MIN")?.unwrap_or(0) };
            let step = number("SLURM_ARRAY_TASK_STEP")?.filter(|_| count.is_none()).unwrap_or(1).max(1);
            (id.saturating_sub(first) / step, count.or(number("SLURM_ARRAY_TASK_COUNT")?))
        } else if let Some(index) = number("JOB_COMPLETION_INDEX")? {
            (index, count)
        } else {
            // Computing all of it in every part of a job that does not number them would be a costly surprise.
            return match count {
                None => Ok(None),
                Some(_) => {
                    let problem = "the environment names no part of an array job; pass --shard I/N for one part, or neither for \
                                   the whole study";
                    Err(Error::request("--shards", problem))
                }
            };
        };
        let count = count.ok_or_else(|| {
            Error::request("--shards", "this is a part of an array job, but of how many? pass --shards N")
        })?;
        Self::checked(index, count).map(Some)
    }

    fn checked(index: usize, count: usize) -> Result<Self> {
        if index >= count {
            let problem =
                format!("there is no part {index} of {count}; parts are numbered from 0 to one below their number");
            return Err(Error::request("--shard", problem));
        }
        Ok(Shard { index, count })
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        let (index, count) = parts.ok_or_else(|| format!("`{text}` is not INDEX/COUNT, as in 0/8"))?;
        Shard::checked(index, count).map_err(|problem| problem.to_string())
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(variables: &[(&str, &str)], count: Option<usize>) -> Result<Option<Shard>> {
        let find = |name: &str| variables.iter().find(|(key, _)| *key == name).map(|(_, value)| value.to_string());
        Shard::from_environment(find, count)
    }

    #[test]
    fn slurm_arrays_from_any_number_and_step() {
        let array = |id, min, step, count| {
            let variables = [
                ("SLURM_ARRAY_TASK_ID", id),
                ("SLURM_ARRAY_TASK_MIN", min),
                ("SLURM_ARRAY_TASK_STEP", step),
                ("SLURM_ARRAY_TASK_COUNT", count),
            ];
            read(&variables, None).unwrap().unwrap()
        };
        assert_eq!(array("0", "0", "1", "4"), Shard { index: 0, count: 4 });
        assert_eq!(array("4", "1", "1", "4"), Shard { index: 3, count: 4 });
        assert_eq!(array("7", "1", "2", "4"), Shard { index: 3, count: 4 });
    }

    #[test]
    fn a_task_submitted_again_alone_needs_the_number_of_parts() {
        let alone = [("SLURM_ARRAY_TASK_ID", "2"), ("SLURM_ARRAY_TASK_MIN", "2"), ("SLURM_ARRAY_TASK_COUNT", "1")];
        assert_eq!(read(&alone, Some(4)).unwrap(), Some(Shard { index: 2, count: 4 }));
    }

    #[test]
    fn kubernetes_needs_the_number_of_parts() {
        let pod = [("JOB_COMPLETION_INDEX", "3")];
        assert_eq!(read(&pod, Some(4)).unwrap(), Some(Shard { index: 3, count: 4 }));
        assert!(read(&pod, None).unwrap_err().to_string().contains("--shards"));
        assert!(read(&pod, Some(3)).is_err());
        assert!(read(&[("JOB_COMPLETION_INDEX", "x")], Some(3)).is_err());
        assert_eq!(read(&[], None).unwrap(), None);
        assert!(read(&[], Some(3)).unwrap_err().to_string().contains("--shard I/N"));
    }

    #[test]
    fn parts_are_index_and_count() {
        assert_eq!("2/8".parse(), Ok(Shard { index: 2, count: 8 }));
        for bad in ["8/8", "1", "a/2", "0/0", "-1/2"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }
}
