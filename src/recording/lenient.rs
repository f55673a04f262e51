//! Logs as controllers write them: rows that cannot be used are left out and reported, the others are kept, and what has
//! one cause and one cure is corrected.

use super::Recording;
use super::columns::{self, Demand, Layout};
use super::sieve::Rows;
pub use super::sieve::{Cause, Rejected};
use super::source::{self, Source};
use super::{mend, rates, stamps};
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// Names of columns in a file, for those that are not called as [`super::csv`] expects; one per joint in the order of
/// the joints. Quantities left out are looked for under their usual names.
#[derive(Debug, Clone, PartialEq, Default, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnMap {
    /// The topic, of a log of ROS 2 with several.
    pub topic: Option<String>,
    /// The column of time.
    pub time: Option<String>,
    /// Rows per second, Hz, where there is no column of time; one that is there is not used then.
    pub rate_hz: Option<f64>,
    /// Columns of position.
    pub q: Option<Vec<String>>,
    /// Columns of velocity.
    pub qd: Option<Vec<String>>,
    /// Columns of acceleration.
    pub qdd: Option<Vec<String>>,
    /// Columns of torque, or of motor current.
    pub tau: Option<Vec<String>>,
    /// Seconds per unit of time, where it is known; else it is recognised from the column's name and the numbers.
    #[serde(skip)]
    pub time_factor: Option<f64>,
}

/// A log without its unusable rows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sieved {
    /// The accepted rows; there may be none. Time is in seconds, all else in the units of the file.
    pub recording: Recording,
    /// Line (CSV), row (Parquet) or message (ROS 2) of every sample, counted from 1.
    pub lines: Vec<usize>,
    /// The rows left out, in the order of the file.
    pub rejected: Vec<Rejected>,
    /// What the file has and the recording has not.
    pub notes: Vec<String>,
    /// How the file was understood and what was corrected.
    pub mended: Vec<String>,
    /// Joints whose position jumped by whole turns, which was undone: they may lie whole turns outside their limits.
    pub unwrapped: Vec<usize>,
    /// Torques are motor currents by their name.
    pub currents: bool,
    /// What is wrong with the whole of the rows, and what to do: the log cannot be used.
    pub spoilt: Option<String>,
}

/// The joints of which a log holds positions.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct JointNames {
    /// Names in the order of the file; empty where the joints are numbered alone.
    pub names: Vec<String>,
    /// Number of joints where they are numbered; 0 where they are named.
    pub numbered: usize,
}

/// The joints of which a log holds positions, from its header alone where the format has one.
///
/// # Errors
/// Those of [`load`] about the file and its header.
pub fn joint_names(path: impl AsRef<Path>, map: &ColumnMap) -> Result<JointNames> {
    if let Some(q) = &map.q {
        return Ok(JointNames { numbered: q.len(), ..JointNames::default() });
    }
    Ok(columns::joint_names(source::open(path.as_ref(), None, map)?.header()))
}

/// Reads a log and leaves out rows that are ragged or not numeric, not finite, absurd, or out of time. `joints` are the
/// joints that are wanted in order, of which the log may hold more; `map` renames columns. A joint without torque, or with
/// one that never changes, has NaN in its place.
///
/// # Errors
/// An unreadable file, one of a kind that is not read, a header without what is needed, no usable row at all.
pub fn load(path: impl AsRef<Path>, joints: Option<&[String]>, map: &ColumnMap) -> Result<Sieved> {
    load_together(&[path.as_ref().to_owned()], joints, map)
}

/// The same of a log whose columns are in several files: their rows are matched one by one where there are as many in each,
/// else by their times. Lines and messages are those of the first.
///
/// # Errors
/// Those of [`load`]; files of different length without time; no file at all.
pub fn load_together(paths: &[PathBuf], joints: Option<&[String]>, map: &ColumnMap) -> Result<Sieved> {
    read(paths, joints, map, false)
}

/// The motion of joints of which no torque is wanted, whose torques may be missing: those of a gripper, or of another arm.
///
/// # Errors
/// Those of [`load`], but for torques.
pub fn positions(path: impl AsRef<Path>, joints: &[String], map: &ColumnMap) -> Result<Sieved> {
    read(&[path.as_ref().to_owned()], Some(joints), map, true)
}

fn read(paths: &[PathBuf], joints: Option<&[String]>, map: &ColumnMap, positions_alone: bool) -> Result<Sieved> {
    let Some(path) = paths.first() else { return Err(Error::request("files", "name at least one file")) };
    // Joints under other names are found by their columns, not by the arm's names.
    let wanted = joints.filter(|_| map.q.is_none());
    let mut sources = paths.iter().map(|path| source::open(path, wanted, map)).collect::<Result<Vec<Source>>>()?;
    if let ([source], None, Some(problem)) = (sources.as_slice(), &map.tau, sources[0].without_effort(wanted))
        && !positions_alone
    {
        return Err(Error::input(path, source.line(), "effort", problem));
    }
    let header = sources.iter().flat_map(Source::header).cloned().collect();
    let mut header = map.rename(path, header)?;
    let by_time = source::hide_times(&sources, &mut header);
    let own = sources[0].own_joints();
    let demand = Demand { lenient: true, timeless: map.rate_hz.is_some(), positions_alone };
    let mut layout = Layout::search(path, sources[0].line(), &header, joints.or(own.as_deref()), demand)?;
    let (mut columns, mut lines, unreadable) = source::rows(paths, &mut sources, &header, &layout.used(), &by_time)?;

    let empty = mend::empty_columns(&layout, &columns);
    if let Err(joint) = layout.leave_out(&empty, joints.is_some()) {
        let name = &layout.joints()[joint];
        let problem = "holds no position in any row; log it, or choose joints that were logged";
        return Err(Error::input(path, None, name.as_str(), problem));
    }
    layout.understood.extend(rates::without_blanks(&layout, &mut columns, &mut lines));
    layout.leave_out_derivatives(&mend::derivatives_with_gaps(&layout, &columns), "has gaps");
    layout.leave_out_torques(&mend::torques_with_gaps(&layout, &columns));
    if !positions_alone && layout.torques().iter().all(|column| *column == columns::ABSENT) {
        let problem = "the torques of all joints are empty or not a number: the driver did not report them; log them, or motor \
                       currents";
        return Err(Error::input(path, None, "torque", problem));
    }
    let mut mended = std::mem::take(&mut layout.understood);
    let clock = stamps::clock(path, &sources[0], &mut layout, &mut columns, &mut header, lines.len(), map)?;
    mended.extend(clock.mended);
    mended.extend(rates::without_whole(&layout, &mut columns, &mut lines));
    mended.extend(rates::without_repeats(&layout, &mut columns, &mut lines));
    let mut rows = Rows { header, lines, columns };
    let rejected = rows.sieve(&layout, unreadable);
    let notes = std::mem::take(&mut layout.notes).into_iter().chain(sources.iter().flat_map(Source::notes)).collect();
    let currents = layout.currents;
    let mut recording = layout.recording(rows.columns);
    sources[0].describe(&mut recording);
    mended.extend(mend::constant_torques(&mut recording));
    let (unwrapped, note) = mend::unwrap(&mut recording);
    mended.extend(note);
    let sieved =
        Sieved { recording, lines: rows.lines, rejected, notes, mended, unwrapped, currents, spoilt: clock.spoilt };
    match sieved.rejected.first() {
        Some(first) if sieved.lines.is_empty() => {
            let problem = format!("none of the {} rows can be used: {}", sieved.rejected.len(), first.problem);
            Err(Error::input(path, Some(first.line), &first.column, problem))
        }
        _ => Ok(sieved),
    }
}

impl ColumnMap {
    /// The header with the mapped columns under the names that the reader looks for.
    fn rename(&self, path: &Path, header: Vec<String>) -> Result<Vec<String>> {
        let groups = [("q", &self.q), ("qd", &self.qd), ("qdd", &self.qdd), ("tau", &self.tau)];
        let mut wanted: Vec<(String, &String)> = self.time.iter().map(|name| ("t".to_owned(), name)).collect();
        for (prefix, names) in groups {
            let names = names.iter().flatten().enumerate();
            wanted.extend(names.map(|(joint, name)| (format!("{prefix}{}", joint + 1), name)));
        }
        let mut renamed = header.clone();
        for (name, original) in &renamed_over(self, &header) {
            renamed[*name] = format!("({original})");
        }
        for (target, name) in wanted {
            let Some(column) = header.iter().position(|own| own == name) else {
                let problem = format!("there is no such column; the file has {}", header.join(", "));
                return Err(Error::input(path, None, name.as_str(), problem));
            };
            renamed[column] = target;
        }
        Ok(renamed)
    }
}

/// Columns that carry a usual name of a quantity that the map takes from elsewhere, with that name.
fn renamed_over<'a>(map: &ColumnMap, header: &'a [String]) -> Vec<(usize, &'a str)> {
    let taken = |name: &str| {
        let is = |prefixes: &[&str]| {
            prefixes.iter().any(|prefix| {
                name.strip_prefix(prefix).is_some_and(|rest| rest.starts_with(|c: char| c == '_' || c.is_ascii_digit()))
            })
        };
        let ends = |suffixes: &[&str]| suffixes.iter().any(|suffix| name.ends_with(suffix));
        (map.time.is_some() && (name.eq_ignore_ascii_case("t") || name.eq_ignore_ascii_case("time")))
            || (map.q.is_some() && (is(&["q"]) || ends(&["_position"])))
            || (map.qd.is_some() && (is(&["qd", "dq"]) || ends(&["_velocity"])))
            || (map.qdd.is_some() && (is(&["qdd", "ddq"]) || ends(&["_acceleration"])))
            || (map.tau.is_some() && (is(&["tau"]) || ends(&["_effort", "_torque"])))
    };
    header.iter().enumerate().filter(|(_, name)| taken(name)).map(|(column, name)| (column, name.as_str())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, map: &ColumnMap) -> Result<Sieved> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        std::fs::write(&path, text).unwrap();
        load(&path, None, map)
    }

    #[test]
    fn bad_rows_are_left_out_and_named_by_their_line() {
        let text = "t,q1,tau1\n0,1,2\n1,x,2\n2,nan,2\n3,1,2\n\n4,1\n5,1,1e7\n5.5,1,2,9\n6,1,inf\n7,1,2\n7,1,2\n6.5,1,2\n8,1,2\n9,1,2\n";
        let sieved = read(text, &ColumnMap::default()).unwrap();
        let expected = [
            (3, "q1", Cause::Unreadable),
            (4, "q1", Cause::NotFinite),
            (7, "column 2", Cause::Unreadable),
            (8, "tau1", Cause::Absurd),
            (9, "column 3", Cause::Unreadable),
            (10, "tau1", Cause::NotFinite),
            (12, "t", Cause::DuplicateTime),
            (13, "t", Cause::BackwardTime),
        ];
        let found: Vec<_> = sieved.rejected.iter().map(|r| (r.line, r.column.as_str(), r.cause)).collect();
        assert_eq!(found, expected);
        assert_eq!(sieved.recording.time, [0.0, 3.0, 7.0, 8.0, 9.0]);
        assert_eq!(sieved.lines, [2, 5, 11, 14, 15]);
        assert_eq!(sieved.recording.q.channel(0), [1.0; 5]);
    }

    #[test]
    fn a_quote_that_is_not_closed_costs_its_line_only() {
        let text =
            "t,note,q1,tau1\n0,\"a, b\",1,2\n1,c,\"1,2\n2,\"d,1,2\n3,e,1,2\n4,\"f\",\"1\",2\n5,g,1,\"2\n6,,1,2\n";
        let sieved = read(text, &ColumnMap::default()).unwrap();
        let found: Vec<_> = sieved.rejected.iter().map(|r| (r.line, r.column.as_str(), r.cause)).collect();
        assert_eq!(found, [(3, "q1", Cause::Unreadable), (7, "tau1", Cause::Unreadable)]);
        assert_eq!(sieved.recording.time, [0.0, 2.0, 3.0, 4.0, 6.0]);
    }

    #[test]
    fn a_time_that_jumps_ahead_costs_one_row() {
        let sieved = read("t,q1,tau1\n0,1,2\n1,1,2\n900,1,2\n3,1,2\n4,1,2\n", &ColumnMap::default()).unwrap();
        assert_eq!(sieved.recording.time, [0.0, 1.0, 3.0, 4.0]);
        assert_eq!(sieved.rejected[0].line, 4);
    }

    #[test]
    fn a_file_without_a_usable_row_is_refused() {
        let error = read("t,q1,tau1\n0,x,1\n1,y,1\n", &ColumnMap::default()).unwrap_err().to_string();
        assert!(error.contains("log.csv:2: q1: none of the 2 rows"), "{error}");
    }

    /// Torques of two joints, of which the second ends early.
    fn read_torque_with_gaps() -> Sieved {
        let row = |k: usize| format!("{},{},{},{},{}", 0.01 * k as f64, k, k, k, if k < 60 { "1" } else { "" });
        let rows: Vec<String> = (0..200).map(row).collect();
        read(&format!("t,q1,q2,tau1,tau2\n{}\n", rows.join("\n")), &ColumnMap::default()).unwrap()
    }

    #[test]
    fn missing_velocities_cost_their_joint_or_their_rows() {
        let log = |header: &str, row: &dyn Fn(usize, f64) -> String| {
            let rows = (0..200).map(|row_index| {
                let t = 0.01 * row_index as f64;
                format!("{t:.2},{},{},{},{},{}", t.sin(), t.cos(), t, -t, row(row_index, t))
            });
            let rows: Vec<String> = rows.collect();
            read(&format!("t,q1,q2,tau1,tau2,{header}\n{}\n", rows.join("\n")), &ColumnMap::default()).unwrap()
        };
        // No column, no value, gaps: joint 1 keeps its velocity and all its rows.
        for (header, row, word) in [
            ("qd1", Box::new(|_, t: f64| t.cos().to_string()) as Box<dyn Fn(usize, f64) -> String>, "has no velocity"),
            ("qd1,qd2", Box::new(|_, t| format!("{},nan", t.cos())), "holds no value"),
            ("qd1,qd2", Box::new(|k, t| format!("{},{}", t.cos(), if k % 3 == 0 { "" } else { "1" })), "has gaps"),
        ] {
            let sieved = log(header, &row);
            assert_eq!((sieved.recording.samples(), sieved.rejected.len()), (200, 0), "{word}");
            assert_eq!([0, 1].map(|joint| sieved.recording.has_velocity(joint)), [true, false], "{word}");
            assert!((sieved.recording.qd.unwrap().channel(0)[100] - 1f64.cos()).abs() < 1e-12);
            assert!(
                sieved.mended.iter().any(|note| note.contains(word) && note.contains("joint_2")),
                "{:?}",
                sieved.mended
            );
        }
        let few = log("qd1,qd2", &|k, t| format!("{},{}", t.cos(), if k == 7 { "" } else { "1" }));
        assert_eq!(few.rejected.iter().map(|row| row.line).collect::<Vec<_>>(), [9]);
        assert_eq!([0, 1].map(|joint| few.recording.has_velocity(joint)), [true, true]);
        let torque = read_torque_with_gaps();
        assert_eq!((torque.recording.samples(), torque.rejected.len()), (200, 0));
        assert_eq!([0, 1].map(|joint| torque.recording.has_torque(joint)), [true, false], "{:?}", torque.mended);
        let none = log("qd1,qd2", &|k, _| if k % 3 == 0 { ",".to_owned() } else { "1,1".to_owned() });
        assert_eq!((none.recording.samples(), none.recording.qd), (200, None));
    }

    #[test]
    fn columns_under_other_names() {
        let text = "stamp,q1,angle,tau1,amps,qd1\n0,1,2,3,4,5\n1,1,2,3,4,5\n";
        let list = |name: &str| Some(vec![name.to_owned()]);
        let map = ColumnMap { time: Some("stamp".into()), q: list("angle"), tau: list("amps"), ..ColumnMap::default() };
        let sieved = read(text, &map).unwrap();
        assert_eq!(sieved.recording.q.channel(0), [2.0, 2.0]);
        assert_eq!(sieved.recording.tau.channel(0), [4.0, 4.0]);
        assert_eq!(sieved.recording.qd.unwrap().channel(0), [5.0, 5.0]);
        assert_eq!(sieved.notes, ["columns not used: (q1), (tau1)"]);
        let error = read(text, &ColumnMap { q: list("winkel"), ..map }).unwrap_err().to_string();
        assert!(error.contains("winkel") && error.contains("angle"), "{error}");
    }

    #[test]
    fn empty_cells_of_a_parquet_file_cost_their_rows() {
        use ::parquet::arrow::ArrowWriter;
        use arrow::array::{ArrayRef, Float64Array, RecordBatch};
        use std::sync::Arc;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.parquet");
        let column = |values: Vec<Option<f64>>| -> ArrayRef { Arc::new(Float64Array::from(values)) };
        let batch = RecordBatch::try_from_iter([
            ("t", column(vec![Some(0.0), Some(1.0), Some(2.0)])),
            ("q1", column(vec![Some(0.0), None, Some(2.0)])),
            ("tau1", column(vec![Some(5.0), Some(6.0), Some(7.0)])),
        ])
        .unwrap();
        let mut writer = ArrowWriter::try_new(std::fs::File::create(&path).unwrap(), batch.schema(), None).unwrap();
        writer.write(&batch).unwrap();
        writer.close().unwrap();
        let sieved = load(&path, None, &ColumnMap::default()).unwrap();
        assert_eq!(sieved.recording.tau.channel(0), [5.0, 7.0]);
        assert_eq!((sieved.rejected[0].line, sieved.rejected[0].column.as_str()), (2, "q1"));
    }
}
