//! Which rows of a log can be used: finite, of a size that an arm can have, in the order of time.

use super::blank;
use crate::recording::columns::Layout;
use std::collections::BTreeMap;

/// A value this many times larger than nearly all others of its column (and than 1) is absurd.
const ABSURD_RATIO: f64 = 1e3;

/// No position, velocity or torque of an arm is larger than this in any unit.
const ABSURD: f64 = 1e12;

/// The same for time, which may be nanoseconds since 1970.
const ABSURD_TIME: f64 = 1e19;

/// Why a row was left out.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::recording::lenient::{self, Cause, ColumnMap};
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("log.csv");
///
/// let rows = ["t,q1,tau1", "0.00,0.1,1.0", "0.01,0.2,nan", "0.02,0.3,1.2", "0.03,x,1.1", "0.04,0.5,1.2"];
/// std::fs::write(&path, rows.join("\n") + "\n").unwrap();
/// let rejected = lenient::load(&path, None, &ColumnMap::default())?.rejected;
/// let causes: Vec<Cause> = rejected.iter().map(|row| row.cause).collect();
/// assert_eq!(causes, [Cause::NotFinite, Cause::Unreadable]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// A cell that is no number, or a row with too few or too many cells.
    Unreadable,
    /// NaN, infinite or empty.
    NotFinite,
    /// A number that no arm can have.
    Absurd,
    /// Zeros in place of all torques, between rows in which they are not zero: of a second source.
    Blank,
    /// The same time as the row before.
    DuplicateTime,
    /// A time before that of the row before, or far ahead of the rows behind.
    BackwardTime,
    /// The file ends here, in the middle of something.
    CutOff,
}

/// A row that was left out.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::recording::lenient::{self, Cause, ColumnMap};
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("log.csv");
///
/// std::fs::write(&path, "t,q1,tau1\n0.00,0.1,1.0\n0.01,0.2,nan\n0.02,0.3,1.2\n0.03,0.3,1.1\n").unwrap();
/// let rejected = lenient::load(&path, None, &ColumnMap::default())?.rejected;
/// assert_eq!((rejected[0].line, &rejected[0].column[..], rejected[0].cause), (3, "tau1", Cause::NotFinite));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Rejected {
    /// Line of the file (CSV) or number of the row (Parquet) or message (ROS 2), counted from 1.
    pub line: usize,
    /// The column at fault.
    pub column: String,
    /// Kind of fault.
    pub cause: Cause,
    /// What is wrong.
    pub problem: String,
}

/// The numbers of a file with the line of each row.
pub(crate) struct Rows {
    pub header: Vec<String>,
    pub lines: Vec<usize>,
    pub columns: Vec<Vec<f64>>,
}

impl Rows {
    /// Takes out the rows whose values cannot be used; returns them with those known before, in order.
    pub(crate) fn sieve(&mut self, layout: &Layout, mut rejected: Vec<Rejected>) -> Vec<Rejected> {
        let used = layout.used();
        let mut faults: BTreeMap<usize, (usize, Cause, String)> = BTreeMap::new();
        for &column in &used {
            let values = &self.columns[column];
            let largest = if column == layout.time() { ABSURD_TIME } else { absurd_above(values) };
            for (row, &value) in values.iter().enumerate() {
                let fault = if !value.is_finite() {
                    (column, Cause::NotFinite, format!("{value} is not a finite number"))
                } else if value.abs() > largest {
                    let problem = format!("{value:?} is far beyond all other values; a broken cell?");
                    (column, Cause::Absurd, problem)
                } else {
                    continue;
                };
                faults.entry(row).or_insert(fault);
            }
        }
        // A joint without torque has no column.
        let efforts: Vec<usize> =
            layout.torques().iter().copied().filter(|&column| column < self.columns.len()).collect();
        let torques: Vec<&[f64]> = efforts.iter().map(|&column| &self.columns[column][..]).collect();
        for row in blank::of_second_source(&torques) {
            let problem = "all torques are zero between rows in which they are not".to_owned();
            faults.entry(row).or_insert((efforts[0], Cause::Blank, problem));
        }
        let time = layout.time();
        let rows: Vec<usize> = (0..self.lines.len()).filter(|row| !faults.contains_key(row)).collect();
        for (row, cause, problem) in out_of_time(&self.columns[time], &rows) {
            faults.insert(row, (time, cause, problem));
        }
        if !faults.is_empty() {
            rejected.extend(faults.iter().map(|(&row, (column, cause, problem))| Rejected {
                line: self.lines[row],
                column: self.header[*column].clone(),
                cause: *cause,
                problem: problem.clone(),
            }));
            let mut index = 0..self.lines.len();
            self.lines.retain(|_| !faults.contains_key(&index.next().unwrap_or(0)));
            for &column in &used {
                let mut row = 0;
                self.columns[column].retain(|_| {
                    row += 1;
                    !faults.contains_key(&(row - 1))
                });
            }
        }
        rejected.sort_by_key(|fault| fault.line);
        rejected
    }
}

/// One in so many values, and one at least, may be absurd. A joint may rest for most of a log: what is usual is not a
/// median.
const RARE: usize = 500;

/// Size above which a value of a column is absurd.
fn absurd_above(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).map(f64::abs).collect();
    let rare = 1 + sizes.len() / RARE;
    if sizes.len() < 5 * rare {
        return ABSURD;
    }
    let place = sizes.len() - 1 - rare;
    let (_, &mut common, _) = sizes.select_nth_unstable_by(place, f64::total_cmp);
    (ABSURD_RATIO * common.max(1.0)).min(ABSURD)
}

/// The rows of `rows` whose time does not increase. Of two rows in the wrong order the one that stands alone goes: the
/// later one, unless the row behind it too is before the earlier one.
fn out_of_time(time: &[f64], rows: &[usize]) -> Vec<(usize, Cause, String)> {
    let mut out = Vec::new();
    let mut kept: Vec<usize> = Vec::new();
    for (index, &row) in rows.iter().enumerate() {
        let Some(&last) = kept.last() else {
            kept.push(row);
            continue;
        };
        if time[row] > time[last] {
            kept.push(row);
            continue;
        }
        let jumped = time[row] < time[last]
            && rows.get(index + 1).is_some_and(|&next| time[next] < time[last] && time[next] > time[row])
            && (kept.len() < 2 || time[row] > time[kept[kept.len() - 2]]);
        if jumped {
            let problem = format!("the time {:?} s is ahead of the rows behind it", time[last]);
            out.push((last, Cause::BackwardTime, problem));
            kept.pop();
            kept.push(row);
        } else if time[row] == time[last] {
            out.push((row, Cause::DuplicateTime, format!("the time {:?} s is that of a row before", time[row])));
        } else {
            let problem = format!("time goes back: {:?} s follows {:?} s", time[row], time[last]);
            out.push((row, Cause::BackwardTime, problem));
        }
    }
    out
}
