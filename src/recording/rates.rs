//! Signals that come at different rates: rows of two sources, with blanks where one of them has no value, and values that are
//! repeated until the next one comes.

mod digits;
mod whole;

pub use whole::without_whole;

use super::columns::{ABSENT, Layout};
use super::resample::interpolate;

/// A column that lacks a smaller share of the rows has gaps, and no rate of its own.
const BLANK: f64 = 0.05;

/// Columns whose blanks differ in a smaller share of their rows are of one source.
const ALIKE: f64 = 0.05;

/// Blanks of a source of a slower rate come in runs of no more than this many of its mean steps, most of them.
const LONGEST_RUN: f64 = 4.0;
const IN_SHORT_RUNS: f64 = 0.8;

/// Values are not brought across longer gaps than this many median steps of their own.
const BRIDGED: f64 = 4.0;

/// A source with fewer rows shows no rate.
const FEWEST: usize = 100;

/// Repeated values come at a rate where this share of the steps between two changes is the median step, or one row from it:
/// a channel of few digits changes at uneven steps.
const REGULAR: f64 = 0.95;

/// The other signals go on between two changes: they change as often there as elsewhere, up to this share.
const GOES_ON: f64 = 0.5;

/// Slowest rate, Hz, to which a log is brought because of repeated values: below, diagnosis sees too little.
const SLOWEST_HZ: f64 = 50.0;

/// Of rows with blanks, those of the slower of positions and torques are kept, and the other signals are brought to their times.
/// Nothing is done where the blanks are gaps. Returns what was done.
pub fn without_blanks(layout: &Layout, columns: &mut [Vec<f64>], lines: &mut Vec<usize>) -> Option<String> {
    let count = lines.len();
    let held: Vec<usize> = columns.iter().map(|values| values.iter().filter(|v| v.is_finite()).count()).collect();
    let of = |table: &[usize]| -> Vec<usize> {
        table.iter().copied().filter(|&column| column != ABSENT && held[column] >= FEWEST).collect()
    };
    let (positions, torques) = (of(layout.positions()), of(layout.torques()));
    // Before the first value of the one and behind the last of the other nothing was recorded: these rows are no blanks.
    let signals = || positions.iter().chain(&torques).copied();
    let first = signals().filter_map(|column| columns[column].iter().position(|v| v.is_finite())).max()?;
    let last = signals().filter_map(|column| columns[column].iter().rposition(|v| v.is_finite())).min()?;
    let shared = first..last.max(first);
    let blank = |column: usize| {
        let missing = columns[column][shared.clone()].iter().filter(|value| !value.is_finite()).count();
        missing as f64 > BLANK * shared.len() as f64
    };
    if !signals().any(blank) {
        return None;
    }
    let of_positions = majority(columns, &positions)?;
    let of_torques = majority(columns, &torques).filter(|&torque| !alike(columns, torque, of_positions));
    if of_torques.is_none() && !torques.is_empty() && majority(columns, &torques).is_none() {
        return None;
    }
    let slower = of_torques.filter(|&torque| held[torque] <= held[of_positions]);
    let base = slower.unwrap_or(of_positions);
    let kept: Vec<usize> = (0..count).filter(|&row| columns[base][row].is_finite()).collect();
    if !at_a_rate(&kept) {
        return None;
    }
    let time = clock(layout, columns, count);
    for column in positions.iter().chain(&torques).copied().chain(layout.derivatives()).collect::<Vec<_>>() {
        let missing = kept.iter().filter(|&&row| !columns[column][row].is_finite()).count() as f64;
        if missing > BLANK * kept.len() as f64 {
            columns[column] = brought(&time, &columns[column], &kept);
        }
    }
    let note = match of_torques {
        Some(torque) => format!(
            "of {count} rows {} hold positions and {} torques: they come from two sources at rates of their own; the log is taken \
             at the rows of the {}, and the other signals are brought to their times; log both in one loop if you can",
            held[of_positions],
            held[torque],
            if slower.is_some() { "torques" } else { "positions" }
        ),
        None if kept.len() < count => format!(
            "{} of {count} rows hold nothing of these joints: they are those of another source, and are left out",
            count - kept.len()
        ),
        None => return None,
    };
    keep(&kept, columns, lines);
    Some(note)
}

/// Of values that are repeated while the other signals go on, the rows of new ones are kept. Time is in seconds. Nothing is done
/// where they do not come at a rate, or at a slow one. Returns what was done.
pub fn without_repeats(layout: &Layout, columns: &mut [Vec<f64>], lines: &mut Vec<usize>) -> Option<String> {
    let changes = |table: &[usize]| -> Vec<bool> {
        let used: Vec<&[f64]> =
            table.iter().filter(|column| **column != ABSENT).map(|column| columns[*column].as_slice()).collect();
        let differs = |values: &&[f64], row: usize| values[row] != values[row - 1];
        (0..lines.len()).map(|row| row > 0 && used.iter().any(|values| differs(values, row))).collect()
    };
    let (position, torque) = (changes(layout.positions()), changes(layout.torques()));
    let (of, own, other) = if repeats(&torque, &position) {
        ("torques", torque, "positions")
    } else if repeats(&position, &torque) {
        ("positions", position, "torques")
    } else {
        return None;
    };
    let new: Vec<usize> = (0..own.len()).filter(|&row| own[row]).collect();
    let signals = if of == "torques" { layout.torques() } else { layout.positions() };
    let signals: Vec<usize> = signals.iter().copied().filter(|column| *column != ABSENT).collect();
    if digits::may_be_why(columns, &signals, &new) {
        return None;
    }
    let usual = median_step(&new)?;
    // While nothing changes, as at rest, rows are kept at the same rate.
    let rest =
        |pair: &[usize]| (pair[0]..pair[1]).step_by(usual).filter(|row| pair[1] - row > usual / 2).collect::<Vec<_>>();
    let mut kept: Vec<usize> = new.windows(2).flat_map(rest).collect();
    kept.extend(new.last());
    let time = &columns[layout.time()];
    let rate = (kept.len() - 1) as f64 / (time[*kept.last()?] - time[kept[0]]);
    if rate.is_nan() || rate < SLOWEST_HZ {
        return None;
    }
    let share = 100.0 * (1.0 - kept.len() as f64 / own.len() as f64);
    keep(&kept, columns, lines);
    Some(format!(
        "the {of} of all joints change at {rate:.1} Hz and are repeated between, while the {other} go on: they come from two sources \
         at rates of their own; the {share:.0} % of the rows that repeat are left out, and the log is taken at that rate"
    ))
}

/// A column of the source to which more than half of the columns belong: those whose blanks are in the same rows.
fn majority(columns: &[Vec<f64>], of: &[usize]) -> Option<usize> {
    let members = |&&column: &&usize| of.iter().filter(|&&other| alike(columns, column, other)).count();
    of.iter().find(|column| 2 * members(column) > of.len()).copied()
}

/// Whether two columns have their blanks in the same rows, but for a few.
fn alike(columns: &[Vec<f64>], a: usize, b: usize) -> bool {
    let (mut either, mut one) = (0, 0);
    for (x, y) in columns[a].iter().zip(&columns[b]) {
        either += usize::from(x.is_finite() || y.is_finite());
        one += usize::from(x.is_finite() != y.is_finite());
    }
    one as f64 <= ALIKE * either as f64
}

/// Whether rows are those of a source with a rate, and not what gaps leave.
fn at_a_rate(rows: &[usize]) -> bool {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return false };
    let mean = (last - first) as f64 / (rows.len().max(2) - 1) as f64;
    let (mut all, mut short) = (0, 0);
    for pair in rows.windows(2) {
        let blanks = pair[1] - pair[0] - 1;
        all += blanks;
        short += if (blanks as f64) <= LONGEST_RUN * mean { blanks } else { 0 };
    }
    rows.len() >= FEWEST && short as f64 >= IN_SHORT_RUNS * all as f64
}

/// Time of every row in any unit, for bringing signals to the times of others.
fn clock(layout: &Layout, columns: &[Vec<f64>], count: usize) -> Vec<f64> {
    match (layout.time(), layout.nanoseconds()) {
        (ABSENT, _) => (0..count).map(|row| row as f64).collect(),
        (seconds, None) => columns[seconds].clone(),
        (seconds, Some(nanoseconds)) => {
            let start = columns[seconds].iter().copied().find(|second| second.is_finite()).unwrap_or(0.0);
            columns[seconds].iter().zip(&columns[nanoseconds]).map(|(s, ns)| (s - start) + 1e-9 * ns).collect()
        }
    }
}

/// A signal with the values that it lacks at the rows `kept`, from those before and behind.
fn brought(time: &[f64], values: &[f64], kept: &[usize]) -> Vec<f64> {
    let mut points: Vec<(f64, f64)> =
        time.iter().copied().zip(values.iter().copied()).filter(|(t, v)| t.is_finite() && v.is_finite()).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.dedup_by(|a, b| a.0 == b.0);
    let (times, values_there): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let longest = BRIDGED * steps.get(steps.len() / 2).copied().unwrap_or(0.0);
    let mut out = values.to_vec();
    for &row in kept.iter().filter(|&&row| !values[row].is_finite()) {
        let next = times.partition_point(|&t| t <= time[row]);
        if next > 0 && next < times.len() && times[next] - times[next - 1] <= longest {
            out[row] = interpolate(&times, &values_there, next - 1, time[row], longest);
        }
    }
    out
}

/// Whether a signal changes at a rate below that of the rows, between which the other one goes on.
fn repeats(own: &[bool], other: &[bool]) -> bool {
    let new: Vec<usize> = (0..own.len()).filter(|&row| own[row]).collect();
    let Some(usual) = median_step(&new).filter(|&usual| usual > 1 && new.len() >= FEWEST) else { return false };
    let near = new.windows(2).filter(|pair| (pair[1] - pair[0]).abs_diff(usual) <= 1).count() as f64;
    let share = |wanted: bool| {
        let rows = || (0..own.len()).filter(|&row| own[row] == wanted);
        rows().filter(|&row| other[row]).count() as f64 / rows().count().max(1) as f64
    };
    near >= REGULAR * (new.len() - 1) as f64 && share(true) > GOES_ON && share(false) > GOES_ON * share(true)
}

fn median_step(rows: &[usize]) -> Option<usize> {
    let mut steps: Vec<usize> = rows.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable();
    steps.get(steps.len() / 2).copied()
}

/// Leaves these rows alone.
fn keep(rows: &[usize], columns: &mut [Vec<f64>], lines: &mut Vec<usize>) {
    *lines = rows.iter().map(|&row| lines[row]).collect();
    for column in columns.iter_mut().filter(|column| !column.is_empty()) {
        *column = rows.iter().map(|&row| column[row]).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::super::lenient::{ColumnMap, Sieved, load};

    const COUNT: usize = 4000;

    fn angle(t: f64, joint: usize) -> f64 {
        (1.0 + 0.3 * joint as f64) * (2.0 * t + joint as f64).sin()
    }

    fn torque(t: f64, joint: usize) -> f64 {
        5.0 * (3.0 * t + joint as f64).cos()
    }

    /// A log of two joints at 500 Hz; `cells` makes a row from time, positions and torques.
    fn read(cells: &dyn Fn(usize, f64, [f64; 2], [f64; 2]) -> Vec<String>) -> Sieved {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut text = "t,q1,q2,tau1,tau2\n".to_owned();
        for row in 0..COUNT {
            let t = 0.002 * row as f64;
            for line in cells(row, t, [0, 1].map(|joint| angle(t, joint)), [0, 1].map(|joint| torque(t, joint))) {
                text += &(line + "\n");
            }
        }
        std::fs::write(&path, text).unwrap();
        load(&path, None, &ColumnMap::default()).unwrap()
    }

    #[track_caller]
    fn assert_read(sieved: &Sieved, rate: f64, words: &[&str]) {
        let log = &sieved.recording;
        assert!((log.rate_hz() / rate - 1.0).abs() < 0.01, "{}", log.rate_hz());
        assert!((log.duration() - 8.0).abs() < 0.05 && sieved.rejected.len() < 10, "{:?}", sieved.rejected);
        for (row, &t) in log.time.iter().enumerate() {
            for joint in 0..2 {
                assert!((log.q.channel(joint)[row] - angle(t, joint)).abs() < 1e-5, "{t}");
                assert!((log.tau.channel(joint)[row] - torque(t, joint)).abs() < 1e-9, "{t}");
            }
        }
        let said = sieved.mended.join("; ");
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
    }

    #[test]
    fn torques_in_every_fourth_row() {
        let blank = read(&|row, t, q, tau| {
            let torques = if row % 4 == 1 { format!("{},{}", tau[0], tau[1]) } else { ",".into() };
            vec![format!("{t},{},{},{torques}", q[0], q[1])]
        });
        assert_read(&blank, 125.0, &["4000 hold positions and 1000 torques", "rows of the torques"]);
        let repeated = read(&|row, t, q, _| {
            // The last new one came in the row before this that is one more than a multiple of four.
            let then = 0.002 * row.saturating_sub((row + 3) % 4) as f64;
            vec![format!("{t},{},{},{},{}", q[0], q[1], torque(then, 0), torque(then, 1))]
        });
        assert!(repeated.mended.iter().any(|note| note.contains("change at 125.0 Hz")), "{:?}", repeated.mended);
        assert!((repeated.recording.rate_hz() - 125.0).abs() < 0.1);
        let late =
            |row: usize| (repeated.recording.tau.channel(0)[row] - torque(repeated.recording.time[row], 0)).abs();
        assert!((10..900).all(|row| late(row) < 1e-9));
    }

    #[test]
    fn rows_of_two_publishers() {
        // Torques 1 ms behind every fourth position.
        let alternating = read(&|row, t, q, _| {
            let mut lines = vec![format!("{t},{},{},,", q[0], q[1])];
            if row % 4 == 0 {
                let t = t + 0.001;
                lines.push(format!("{t},,,{},{}", torque(t, 0), torque(t, 1)));
            }
            lines
        });
        assert_read(&alternating, 125.0, &["4000 hold positions and 1000 torques", "two sources"]);
        let slow_positions = read(&|row, t, q, tau| {
            let mut lines = vec![format!("{t},,,{},{}", tau[0], tau[1])];
            if row % 2 == 0 {
                lines.push(format!("{t},{},{},,", q[0], q[1]));
            }
            lines
        });
        assert_read(&slow_positions, 250.0, &["rows of the positions"]);
        // A gripper in rows of its own.
        let gripper = read(&|_, t, q, tau| {
            vec![format!("{t},{},{},{},{}", q[0], q[1], tau[0], tau[1]), format!("{},,,,", t + 0.0013)]
        });
        assert_read(&gripper, 500.0, &["4000 of 8000 rows hold nothing of these joints"]);
    }

    #[test]
    fn gaps_and_torques_of_few_digits_are_no_rate() {
        let broken = read(&|row, t, q, tau| {
            let torques = if (1000..1600).contains(&row) { ",".into() } else { format!("{},{}", tau[0], tau[1]) };
            vec![format!("{t},{},{},{torques}", q[0], q[1])]
        });
        assert_eq!((broken.rejected.len(), broken.recording.samples()), (600, 3400));
        let coarse = read(&|_, t, q, tau| vec![format!("{t},{},{},{:.1},{:.1}", q[0], q[1], tau[0], tau[1])]);
        assert_eq!((coarse.recording.samples(), coarse.mended.len()), (COUNT, 0), "{:?}", coarse.mended);
        // A constant speed changes a coarse position at even steps.
        let ramp = read(&|row, t, _, tau| {
            let position = 0.01 * (row as f64 / 2.67).floor();
            vec![format!("{t},{position:.2},{:.2},{},{}", 2.0 * position, tau[0], tau[1])]
        });
        assert_eq!((ramp.recording.samples(), ramp.mended.len()), (COUNT, 0), "{:?}", ramp.mended);
    }
}
