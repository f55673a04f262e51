//! The rows of a log whose columns are in several files.

use super::source::{Content, Source};
use crate::error::{Error, Result};
use crate::recording::cleaning::Rejected;
use crate::recording::columns::names;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Rows of all files together.
#[derive(Default)]
pub(super) struct Joined {
    /// Indexed as the header of all files.
    pub columns: Vec<Vec<f64>>,
    /// Lines of the first file.
    pub lines: Vec<usize>,
    /// Rows that cannot be read.
    pub rejected: Vec<Rejected>,
    /// What was left out.
    pub notes: Vec<String>,
}

/// The columns of time of the files.
pub(super) struct Times {
    /// That of each file.
    pub of_files: Vec<Option<OwnTime>>,
    /// Columns that are hidden, since the first file has the time.
    pub hidden: Vec<usize>,
}

/// The column of time of a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct OwnTime {
    /// Its place in the header of all files.
    column: usize,
    /// Seconds per unit, where its name gives it.
    factor: Option<f64>,
}

/// Hides the times of all files but the first that has one.
pub(super) fn hide_times(sources: &[Source], header: &mut [String]) -> Times {
    let mut start = 0;
    let mut known = false;
    let mut out = Times { of_files: Vec::new(), hidden: Vec::new() };
    for source in sources {
        let own = start..start + source.header().len();
        let ranked = own.clone().filter_map(|column| {
            let time = names::time(&header[column], column - own.start)?;
            (time.rank < names::INDEX).then_some((time.rank, OwnTime { column, factor: time.factor }))
        });
        let time = ranked.min_by_key(|(rank, time)| (*rank, time.column)).map(|(_, time)| time);
        if known && sources.len() > 1 {
            for column in own.clone() {
                if names::time(&header[column], column - own.start).is_some() {
                    header[column] = format!("({})", header[column]);
                    out.hidden.push(column);
                }
            }
        }
        known |= time.is_some();
        out.of_files.push(time);
        start = own.end;
    }
    out
}

/// Gives columns that are called for their joints alone the quantity for which their file is called: `joint_1` of `torques.csv` is
/// `tau_joint_1`.
pub(super) fn name_by_files(paths: &[PathBuf], sources: &[Source], header: &mut [String]) {
    let mut start = 0;
    for (path, source) in paths.iter().zip(sources) {
        let own = start..start + source.header().len();
        start = own.end;
        let stem = path.file_stem().and_then(|stem| stem.to_str());
        let Some(prefix) = stem.and_then(names::prefix_of).filter(|_| paths.len() > 1) else { continue };
        for column in own.clone() {
            let has_meaning = !names::meanings(&header[column]).is_empty();
            if !has_meaning && names::time(&header[column], column - own.start).is_none() {
                header[column] = format!("{prefix}_{}", header[column]);
            }
        }
    }
}

/// Gives columns that are called for a quantity alone the joint for which their file is called: `position` of `joint_2.csv` is `q_2`. Files
/// of one name in several folders are called for these.
pub(super) fn name_by_joints(paths: &[PathBuf], sources: &[Source], header: &mut [String]) {
    let name = |path: &PathBuf| {
        let stem = path.file_stem()?.to_str()?;
        let alike = paths.iter().all(|other| other.file_name() == path.file_name());
        Some(if alike { path.parent()?.file_name()?.to_str()? } else { stem }.to_owned())
    };
    let Some(names) = paths.iter().map(name).collect::<Option<Vec<String>>>().filter(|_| paths.len() > 1) else {
        return;
    };
    let joints = numbers_apart(&names).unwrap_or(names);
    let mut start = 0;
    for (source, joint) in sources.iter().zip(joints) {
        let own = start..start + source.header().len();
        start = own.end;
        for column in &mut header[own] {
            *column = names::with_joint(column, &joint).unwrap_or_else(|| std::mem::take(column));
        }
    }
}

/// The numbers in which names differ and in nothing else.
fn numbers_apart(names: &[String]) -> Option<Vec<String>> {
    let bytes: Vec<&[u8]> = names.iter().map(String::as_bytes).collect();
    let first = bytes[0];
    let is_shared = |at: usize| bytes.iter().all(|own| own.get(at) == first.get(at));
    let start = (0..first.len()).take_while(|at| is_shared(*at) && !first[*at].is_ascii_digit()).count();
    // Digits that all share may belong to a number that others go on with.
    let digits = (start..first.len()).take_while(|at| is_shared(*at)).count();
    let start =
        start + first[start..start + digits].iter().rposition(|byte| !byte.is_ascii_digit()).map_or(0, |at| at + 1);
    let number = |name: &&[u8]| name[start..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let rest = |name: &&[u8]| name[start + number(name)..].to_vec();
    let alike = bytes.iter().all(|name| number(name) > 0 && rest(name) == rest(&first));
    let of = |name: &&[u8]| String::from_utf8_lossy(&name[start..start + number(name)]).into_owned();
    alike.then(|| bytes.iter().map(of).collect())
}

/// The rows of all files together.
///
/// # Errors
/// Those of reading, and files whose rows cannot be matched.
pub(super) fn rows(
    paths: &[PathBuf],
    sources: &mut [Source],
    header: &[String],
    used: &[usize],
    times: &[Option<OwnTime>],
) -> Result<Joined> {
    let mut contents = Vec::new();
    let mut start = 0;
    for ((path, source), time) in paths.iter().zip(sources.iter_mut()).zip(times) {
        let own = start..start + source.header().len();
        let mut wanted: Vec<usize> =
            used.iter().filter(|column| own.contains(*column)).map(|column| column - own.start).collect();
        if paths.len() > 1 {
            wanted.extend(time.map(|time| time.column - own.start).filter(|time| !wanted.contains(time)));
            wanted.sort_unstable();
        }
        contents.push(source.content(path, &header[own.clone()], &wanted)?);
        start = own.end;
    }
    let Some(first) = contents.first() else { return Ok(Default::default()) };
    if contents.len() == 1 {
        let Content { columns, lines, rejected, .. } = contents.remove(0);
        return Ok(Joined { columns, lines, rejected, notes: Vec::new() });
    }
    let one_by_one = contents.iter().all(|content| content.all == first.all);
    if one_by_one { matched(contents) } else { by_time(paths, contents, times) }
}

/// Rows that are good in every file, matched by their place.
fn matched(contents: Vec<Content>) -> Result<Joined> {
    let mut seen: BTreeMap<usize, usize> = BTreeMap::new();
    contents.iter().flat_map(|content| &content.ordinals).for_each(|&ordinal| *seen.entry(ordinal).or_default() += 1);
    let good = |ordinal: &usize| seen.get(ordinal) == Some(&contents.len());
    let mut out = Joined::default();
    for (file, content) in contents.iter().enumerate() {
        let kept: Vec<usize> = (0..content.ordinals.len()).filter(|&row| good(&content.ordinals[row])).collect();
        out.columns.extend(content.columns.iter().map(|column| match column.is_empty() {
            true => Vec::new(),
            false => kept.iter().map(|&row| column[row]).collect(),
        }));
        if file == 0 {
            out.lines = kept.iter().map(|&row| content.lines[row]).collect();
        }
        out.rejected.extend(content.rejected.iter().cloned());
    }
    Ok(out)
}

/// The rows of the first file within the times of the others, and their values there.
fn by_time(paths: &[PathBuf], contents: Vec<Content>, times: &[Option<OwnTime>]) -> Result<Joined> {
    let mut start = 0;
    let mut clocks: Vec<Cow<[f64]>> = Vec::new();
    let of_first = times.first().copied().flatten().and_then(|time| time.factor);
    for ((content, time), path) in contents.iter().zip(times).zip(paths) {
        let Some(time) = time else {
            let counts: Vec<String> = contents.iter().map(|content| content.all.to_string()).collect();
            let problem = format!(
                "no column of time, and the files have {} rows, so that they cannot be matched; give each a time, or as many \
                 rows",
                counts.join(" and ")
            );
            return Err(Error::input(path, None, "t", problem));
        };
        let own = &content.columns[time.column - start];
        // In the unit of the first file, where the names give both.
        clocks.push(match (time.factor, of_first) {
            (Some(own_s), Some(first_s)) if own_s != first_s => own.iter().map(|t| t * (own_s / first_s)).collect(),
            _ => Cow::Borrowed(own.as_slice()),
        });
        start += content.columns.len();
    }
    let span = |clock: &[f64]| {
        let finite = clock.iter().copied().filter(|t| t.is_finite());
        finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], t| [low.min(t), high.max(t)])
    };
    let first = span(&clocks[0]);
    for (path, clock) in paths.iter().zip(&clocks).skip(1) {
        let own = span(clock);
        if own[1] < first[0] || own[0] > first[1] {
            let problem = format!(
                "its times, {} to {}, do not overlap those of {}, {} to {}; stamp both by one clock and in one unit",
                own[0],
                own[1],
                paths[0].display(),
                first[0],
                first[1]
            );
            return Err(Error::input(path, None, "t", problem));
        }
    }
    let mut out = Joined::default();
    let mut kept: Vec<usize> = (0..clocks[0].len()).collect();
    for (path, clock) in paths.iter().zip(&clocks).skip(1) {
        let [low, high] = span(clock);
        let is_outside = |row: &usize| clocks[0][*row] < low || clocks[0][*row] > high;
        let outside = (0..clocks[0].len()).filter(is_outside).count();
        kept.retain(|row| !is_outside(row));
        if outside > 0 {
            let (all, file) = (contents[0].all, path.display());
            out.notes.push(format!("{outside} of {all} rows lie outside the time of {file}: they are left out"));
        }
    }
    if kept.is_empty() {
        let problem =
            format!("no row is within the times of the other files ({}); log them together", out.notes.join("; "));
        return Err(Error::input(&paths[0], None, "t", problem));
    }
    let of_kept = |values: &[f64]| kept.iter().map(|&row| values[row]).collect::<Vec<f64>>();
    let wanted = of_kept(&clocks[0]);
    for (file, content) in contents.iter().enumerate() {
        out.columns.extend(content.columns.iter().map(|column| match (file, column.is_empty()) {
            (_, true) => Vec::new(),
            (0, _) => of_kept(column),
            _ => at_times(&clocks[file], column, &wanted),
        }));
        if file == 0 {
            out.lines = kept.iter().map(|&row| content.lines[row]).collect();
        }
        out.rejected.extend(content.rejected.iter().cloned());
    }
    Ok(out)
}

/// Values at other times, in a line between samples; NaN outside.
fn at_times(time: &[f64], values: &[f64], wanted: &[f64]) -> Vec<f64> {
    let mut points: Vec<(f64, f64)> =
        time.iter().copied().zip(values.iter().copied()).filter(|(t, v)| t.is_finite() && v.is_finite()).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.dedup_by(|a, b| a.0 == b.0);
    let at = |&t: &f64| {
        let next = points.partition_point(|point| point.0 < t);
        match (next.checked_sub(1).map(|before| points[before]), points.get(next)) {
            (_, Some(&(t1, v1))) if t1 == t => v1,
            (Some((t0, v0)), Some(&(t1, v1))) => v0 + (v1 - v0) * (t - t0) / (t1 - t0),
            _ => f64::NAN,
        }
    };
    wanted.iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use crate::recording::columns::ColumnMap;
    use crate::recording::lenient::load_together;

    #[test]
    fn a_file_for_each_joint() {
        let read = |names: [&str; 2]| {
            let folder = tempfile::tempdir().unwrap();
            let paths = names.map(|name| folder.path().join(name));
            for (path, value) in paths.iter().zip([1.0, 2.0]) {
                std::fs::create_dir_all(path.parent().unwrap()).unwrap();
                let row = |k: i32| {
                    format!("{},{},{}\n", 0.01 * f64::from(k), value + 0.1 * f64::from(k), value * f64::from(k))
                };
                std::fs::write(
                    path,
                    (0..60).fold("time,position [rad],torque_Nm\n".to_owned(), |all, k| all + &row(k)),
                )
                .unwrap();
            }
            load_together(&paths, None, &ColumnMap::default()).map(|log| log.recording)
        };
        for names in [
            ["log_1.csv", "log_2.csv"],
            ["3_axis_1_raw.csv", "3_axis_2_raw.csv"],
            ["joint_1/log.csv", "joint_2/log.csv"],
        ] {
            let log = read(names).unwrap();
            assert_eq!((log.q.channel(0)[0], log.q.channel(1)[0], log.tau.channel(1)[2]), (1.0, 2.0, 4.0), "{names:?}");
        }
        assert_eq!(read(["elbow.csv", "wrist.csv"]).unwrap().joints, ["elbow", "wrist"]);
    }

    #[test]
    fn numbers_in_which_names_differ() {
        let of = |names: &str| super::numbers_apart(&names.split(',').map(str::to_owned).collect::<Vec<_>>());
        assert_eq!(of("joint1,joint10").unwrap(), ["1", "10"]);
        assert_eq!(of("2026-03-05_j10,2026-03-05_j12").unwrap(), ["10", "12"]);
        assert_eq!((of("elbow,wrist"), of("a1,b2")), (None, None));
    }

    #[test]
    fn clocks_of_several_files() {
        let folder = tempfile::tempdir().unwrap();
        let [q, tau] = ["q.csv", "tau.csv"].map(|name| folder.path().join(name));
        let rows = |header: &str, start: f64, step: f64, count: i32| {
            (0..count).fold(format!("{header}\n"), |all, k| all + &format!("{},{k}\n", start + step * f64::from(k)))
        };
        let read = |of_tau: String| {
            std::fs::write(&q, rows("time_ms,q1", 5000.0, 10.0, 50)).unwrap();
            std::fs::write(&tau, of_tau).unwrap();
            load_together(&[q.clone(), tau.clone()], None, &ColumnMap::default())
        };
        // Seconds and milliseconds of one clock, at other rates.
        let log = read(rows("time_s,tau1", 5.0, 0.02, 40)).unwrap().recording;
        assert!((log.tau.channel(0)[10] - 5.0).abs() < 1e-9);
        // Rows for which the other file has nothing are no rows with a broken cell.
        let late = read(rows("time_s,tau1", 5.025, 0.02, 15)).unwrap();
        assert_eq!((late.recording.samples(), late.lines[0], late.rejected.len()), (28, 5, 0));
        let said = "22 of 50 rows lie outside the time of ";
        assert!(
            late.corrections.iter().any(|note| note.starts_with(said) && note.contains("tau.csv")),
            "{:?}",
            late.corrections
        );
        let refused = read(rows("t,tau1", 0.0, 0.02, 40)).unwrap_err().to_string();
        assert!(refused.contains("tau.csv: t: its times, 0 to 0.78, do not overlap"), "{refused}");
    }

    #[test]
    fn columns_called_for_joints_alone_are_of_the_quantity_of_their_file() {
        let folder = tempfile::tempdir().unwrap();
        let read = |names: [&str; 2]| {
            let files = names.map(|name| folder.path().join(name));
            for (file, path) in files.iter().enumerate() {
                let rows =
                    (0..60).map(|row| format!("{},{},{}\n", 0.01 * f64::from(row), row * 2 + file as i32, row % 7));
                std::fs::write(path, format!("time,elbow,wrist\n{}", rows.collect::<String>())).unwrap();
            }
            load_together(&files, None, &ColumnMap::default())
        };
        let log = read(["positions.csv", "joint_torques.csv"]).unwrap().recording;
        assert_eq!(log.joints, ["elbow", "wrist"]);
        assert_eq!((log.q.channel(0)[3], log.tau.channel(0)[3]), (6.0, 7.0));
        assert!(read(["positions.csv", "currents.csv"]).unwrap().currents);
        assert!(read(["a.csv", "b.csv"]).is_err());
    }
}
