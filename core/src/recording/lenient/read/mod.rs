//! Reading of logs as controllers write them.

use super::join;
use super::plausible::DoubtfulUnit;
use super::source::{self, Source};
use super::units;
use crate::error::{Error, Result};
use crate::recording::Recording;
use crate::recording::cleaning::{Rejected, Rows, missing, sentinel, unwrap};
use crate::recording::columns::{self, ABSENT, ColumnMap, Demand, JointNames, Layout};
use crate::recording::sampling::{rates, reversed, stamps, unsorted};
use std::path::{Path, PathBuf};

/// A log without its unusable rows.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::recording::lenient::{self, ColumnMap};
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("log.csv");
///
/// // Angles in degrees by their name, and a row that cannot be used.
/// std::fs::write(&path, "t,q1_deg,tau1\n0.00,90,1.0\n0.01,90,x\n0.02,180,1.2\n").unwrap();
/// let read = lenient::load(&path, None, &ColumnMap::default())?;
/// assert_eq!((&read.lines[..], read.rejected.len()), (&[2, 4][..], 1));
/// assert!((read.recording.q.channel(0)[1] - std::f64::consts::PI).abs() < 1e-12);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sieved {
    /// The accepted rows; there may be none. Time is in seconds, all else in SI units where the names of the columns give units, else in
    /// the units of the file.
    pub recording: Recording,
    /// Line (CSV), row (Parquet) or message (ROS 2) of every sample, counted from 1.
    pub lines: Vec<usize>,
    /// The rows left out, in the order of the file.
    pub rejected: Vec<Rejected>,
    /// What the file has and the recording has not.
    pub notes: Vec<String>,
    /// Joints that columns which are not used name.
    pub unknown_joints: Vec<String>,
    /// How the file was understood and what was corrected.
    pub corrections: Vec<String>,
    /// Joints whose position jumped by whole turns, which was undone, each with the turn in the unit of the file: they may lie
    /// whole turns outside their limits.
    pub unwrapped: Vec<(usize, f64)>,
    /// Torques are motor currents by their name.
    pub currents: bool,
    /// Torques are percent of rated torques by their names: nothing is known of their size.
    pub of_rated: bool,
    /// Torques are called for the motors of the robot's file: they may be those before the gears.
    pub of_motors: bool,
    /// The first column of torque, where torques are those that a controller wanted or computed, by their names.
    pub of_controller: Option<String>,
    /// Time may be a count of a controller's cycles, whose length is not known and taken for 1 ms.
    pub may_count: bool,
    /// Lines with which further recordings of the file begin: the time before each was put there by the reader.
    pub begins: Vec<usize>,
    /// Columns that are called as others are and hold other values, each with what is used and how to choose.
    pub ambiguous: Vec<[String; 2]>,
    /// What is wrong with the whole of the rows, and what to do: the log cannot be used.
    pub spoilt: Option<String>,
    /// Units of names that the size of the values makes doubtful, and which were used.
    pub doubts: Vec<DoubtfulUnit>,
}

/// The joints of which a log holds positions, from its header alone where the format has one: those of the robot, `known`, that it names in
/// whatever way, else as it names them. Of several topics in a bag it is the one with most joints of the robot.
///
/// # Errors
/// Those of [`load`] about the file and its header.
pub fn joint_names(path: impl AsRef<Path>, known: &[String], map: &ColumnMap) -> Result<JointNames> {
    if let Some(q) = &map.q {
        return Ok(JointNames { numbered: q.len(), ..JointNames::default() });
    }
    let source = source::open(path.as_ref(), Some(known), map)?;
    Ok(columns::joint_names(&columns::placed(source.header(), &map.addresses).header, known))
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
pub(crate) fn load_together(paths: &[PathBuf], joints: Option<&[String]>, map: &ColumnMap) -> Result<Sieved> {
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
    let placed = columns::placed(&map.rename(path, header)?, &map.addresses);
    let mut header = placed.header;
    join::name_by_files(paths, &sources, &mut header);
    join::name_by_joints(paths, &sources, &mut header);
    let times = join::hide_times(&sources, &mut header);
    let own = sources[0].own_joints();
    let hidden = [times.hidden, placed.others].concat();
    let demand = Demand {
        lenient: true,
        timeless: map.rate_hz.is_some(),
        positions_alone,
        constants: map.torque_constants,
        hidden: &hidden,
        motors: &map.motors,
    };
    let mut layout = Layout::search(path, sources[0].line(), &header, joints.or(own.as_deref()), demand)?;
    let join::Joined { mut columns, mut lines, rejected: unreadable, notes: joined } =
        join::rows(paths, &mut sources, &header, &layout.used(), &times.of_files)?;
    layout.understood.extend(placed.note);
    let (alike, ambiguous) = called_alike(&layout, &sources[0], &header);
    layout.understood.extend(alike);
    layout.understood.extend(joined);
    layout.understood.extend(sentinel::removed(&layout, &header, &mut columns));
    let empty = missing::empty_columns(&layout, &columns);
    if let Err(joint) = layout.leave_out(&empty, joints.is_some()) {
        let name = &layout.joints()[joint];
        let problem = "holds no position in any row; log it, or choose joints that were logged";
        return Err(Error::input(path, None, name.as_str(), problem));
    }
    layout.understood.extend(rates::without_unfilled(&layout, &mut columns, &mut lines));
    layout.understood.extend(rates::without_blanks(&layout, &mut columns, &mut lines));
    layout.leave_out_derivatives(&missing::derivatives_with_gaps(&layout, &columns), "has gaps");
    layout.leave_out_torques(&missing::torques_with_gaps(&layout, &columns));
    if !positions_alone && layout.torques().iter().all(|column| *column == ABSENT) {
        let problem = "the torques of all joints are empty or not a number: the driver did not report them; log them, or motor \
                       currents";
        return Err(Error::input(path, None, "torque", problem));
    }
    layout.understood.extend(reversed::undo(&layout, &mut columns, &mut lines));
    layout.understood.extend(unsorted::sort(&layout, &mut columns, &mut lines));
    let mut corrections = std::mem::take(&mut layout.understood);
    let clock = stamps::clock(path, sources[0].text(), &mut layout, &mut columns, &mut header, lines.len(), map)?;
    corrections.extend(clock.corrections);
    let begins = clock.begins.iter().filter_map(|&row| lines.get(row).copied()).collect();
    corrections.extend(rates::without_whole(&layout, &mut columns, &mut lines));
    corrections.extend(rates::without_repeats(&layout, &mut columns, &mut lines));
    let mut rows = Rows { header, lines, columns };
    let rejected = rows.sieve(&layout, unreadable);
    let notes = std::mem::take(&mut layout.notes).into_iter().chain(sources.iter().flat_map(Source::notes)).collect();
    let unknown_joints = std::mem::take(&mut layout.unknown_joints);
    let (currents, of_motors, of_controller) =
        (layout.currents, layout.of_motors || placed.of_motors, layout.of_controller.take());
    let of_rated = layout.of_rated;
    let of_names = layout.units();
    let mut recording = layout.recording(rows.columns);
    let (converted, doubts) = units::in_si(&mut recording, of_names, map.known_units);
    corrections.extend(converted);
    sources[0].describe(&mut recording);
    corrections.extend(missing::constant_torques(&mut recording));
    let (unwrapped, note) = unwrap(&mut recording);
    corrections.extend(note);
    corrections.extend(missing::constant_velocities(&mut recording));
    let (lines, spoilt) = (rows.lines, clock.spoilt);
    let sieved = Sieved {
        recording,
        lines,
        rejected,
        notes,
        unknown_joints,
        corrections,
        unwrapped,
        currents,
        of_rated,
        of_motors,
        of_controller,
        may_count: clock.may_count,
        begins,
        ambiguous,
        spoilt,
        doubts,
    };
    match sieved.rejected.first() {
        Some(first) if sieved.lines.is_empty() => {
            let problem = format!("none of the {} rows can be used: {}", sieved.rejected.len(), first.problem);
            Err(Error::input(path, Some(first.line), &first.column, problem))
        }
        _ => Ok(sieved),
    }
}

/// What is said of columns in use of whose name there is another: notes where both hold the same, and each column of which they do not with
/// what to do.
fn called_alike(layout: &Layout, source: &Source, header: &[String]) -> (Vec<String>, Vec<[String; 2]>) {
    let (mut notes, mut ambiguous) = (Vec::new(), Vec::new());
    for &[first, second] in layout.twice() {
        let name = &header[first];
        let text = source.text().filter(|_| second < source.header().len());
        if text.is_some_and(|text| text.cells(first) == text.cells(second)) {
            notes.push(format!("{name} stands twice in the header, with the same values: the first is used"));
            continue;
        }
        let choice = layout.other_choice([first, second]).unwrap_or_else(|| "[columns]".to_owned());
        let text = format!(
            "it stands twice in the header, with other values: column {} is used; a dataset takes column {} instead, by the numbers of the \
             columns: {choice}",
            first + 1,
            second + 1
        );
        ambiguous.push([name.clone(), text]);
    }
    (notes, ambiguous)
}

#[cfg(test)]
mod tests;
