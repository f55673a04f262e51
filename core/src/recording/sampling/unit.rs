//! The unit of a clock: that of its column's name, of numbers from 1970, or the one in which the steps are those of a log.

use crate::recording::columns::{ABSENT, Layout};

/// A clock beyond this did not start with the log, s.
const LONG_AGO_S: f64 = 1e6;

/// Units other than seconds: least number that is a time from 1970, seconds per unit, name.
const UNITS: [(f64, f64, &str); 3] = [(1e11, 1e-3, "ms"), (1e14, 1e-6, "us"), (1e17, 1e-9, "ns")];

/// Seconds of a day, in which spreadsheets and MATLAB count time.
const DAY_S: f64 = 86_400.0;

/// Median step from which on a column called `t` or `time` is not in seconds, if the arm moves: a log at 1 Hz shows no dynamics.
const NO_SECONDS: f64 = 1.0;

/// The same of a column whose name does not give the unit, as `timestamp` does: no convention makes it seconds.
const NO_SECONDS_OPEN: f64 = 0.5;

/// Fewest rows whose steps can contradict the name of their column.
const FEWEST: usize = 20;

/// Rates at which arms are logged, Hz.
const USUAL_HZ: [f64; 2] = [10.0, 10_000.0];

/// Rates that velocities may still confirm, Hz.
const POSSIBLE_HZ: [f64; 2] = [2.0, 20_000.0];

/// A median step scatters by this share.
const SCATTER: f64 = 0.02;

/// Velocities decide for a unit that they agree with up to this factor; units are a thousand apart.
const AGREES: f64 = 5.0;

/// They confirm it where they agree up to this factor; beyond, the clock may count something else.
const CONFIRMS: f64 = 1.25;

/// What was assumed of a clock.
pub(super) struct Assumed {
    /// In words.
    pub said: String,
    /// The column may count the cycles of a controller, whose length is not known.
    pub may_count: bool,
}

/// Converts time to seconds, and returns what was assumed. A unit that is not given is that of the column's name, or the one in which
/// the numbers are a time from 1970, or steps of a log.
pub(super) fn in_seconds(columns: &mut [Vec<f64>], layout: &Layout, given: Option<f64>) -> Option<Assumed> {
    let column = layout.time();
    if let Some(factor) = given {
        columns[column].iter_mut().for_each(|t| *t *= factor);
        return None;
    }
    let first = columns[column].iter().copied().find(|t| t.is_finite())?;
    let (factor, unit, doubt, may_count) = match layout.time_factor() {
        Some(factor) => (factor, "the unit of its name", None, false),
        None => of_numbers(columns, layout, first)?,
    };
    // Numbers from 1970 on have no digits for what is between two rows.
    let start = if first.abs() * factor > LONG_AGO_S { first } else { 0.0 };
    if factor == 1.0 && start == 0.0 {
        return None;
    }
    columns[column].iter_mut().for_each(|t| *t = (*t - start) * factor);
    let from = if start == 0.0 { "" } else { "; it is taken from the first row on" };
    let said = match layout.time_factor() {
        Some(_) => format!("time is in {unit}{from}"),
        None => {
            let doubt = doubt.unwrap_or_default();
            format!("time is taken to be in {unit}{doubt}{from} (set another with [units] time in a dataset)")
        }
    };
    Some(Assumed { said, may_count })
}

/// Seconds per unit, its name, what else it could be, and whether the column may count cycles.
fn of_numbers(columns: &[Vec<f64>], layout: &Layout, first: f64) -> Option<(f64, &'static str, Option<String>, bool)> {
    let (median, mean) = (median_step(&columns[layout.time()])?, mean_step(&columns[layout.time()]));
    let step = median.min(mean);
    let rate_of = |step: f64, factor: f64, [least, most]: [f64; 2]| {
        let rate = 1.0 / (step * factor);
        (least * (1.0 - SCATTER)..=most * (1.0 + SCATTER)).contains(&rate)
    };
    let rate_in = |factor: f64, rates: [f64; 2]| rate_of(step, factor, rates);
    // A clock that counts from the start of a computer reaches these numbers too, in a smaller unit.
    let of_1970 = UNITS.iter().rev().find(|(least, ..)| first.abs() >= *least);
    // Rows that come in bursts have the rate of a log on average.
    let is_rate = |factor: f64| [median, mean].into_iter().any(|step| rate_of(step, factor, POSSIBLE_HZ));
    if let Some(&(_, factor, unit)) = of_1970.filter(|(_, factor, _)| is_rate(*factor)) {
        return Some((factor, unit, None, false));
    }
    // No log has rows as fast as parts of a day are in seconds.
    if 1.0 / step > POSSIBLE_HZ[1] && is_rate(DAY_S) {
        return Some((DAY_S, "days, as spreadsheets count them", None, false));
    }
    let least = if layout.open_unit { NO_SECONDS_OPEN } else { NO_SECONDS };
    let shows = || columns[layout.time()].len() >= FEWEST && moves(columns, layout);
    if step < least || layout.time_is_index || !(layout.open_unit || shows()) {
        return None;
    }
    let possible: Vec<_> = UNITS.into_iter().filter(|(_, factor, _)| rate_in(*factor, POSSIBLE_HZ)).collect();
    let implied = seconds_per_unit(columns, layout);
    let within =
        |factor: f64, most: f64| implied.is_some_and(|implied| (1.0 / most..most).contains(&(implied / factor)));
    let agrees = |factor: f64| within(factor, AGREES);
    let usual = |(_, factor, _): &&(f64, f64, &str)| rate_in(*factor, USUAL_HZ);
    let of_velocity = possible.iter().find(|(_, factor, _)| agrees(*factor));
    let &(_, factor, unit) = of_velocity.or(possible.iter().find(usual)).or(possible.first())?;
    let digits = |value: f64| {
        let scale = 10f64.powi(3 - value.log10().floor() as i32);
        (value * scale).round() / scale
    };
    let step_said = digits(step);
    let hz = |factor: f64| format!("{} Hz", digits(1.0 / (step * factor)));
    let other = possible
        .iter()
        .filter(usual)
        .find(|other| other.1 != factor && of_velocity.is_none() && usual(&&(0.0, factor, unit)));
    let doubt = match (of_velocity, other) {
        (_, Some((_, other, name))) => {
            format!(", {}, though steps of {step_said} could be {name} at {} as well", hz(factor), hz(*other))
        }
        (Some(_), _) if within(factor, CONFIRMS) => {
            format!(": steps of {step_said} are {} then, as the velocities confirm", hz(factor))
        }
        // A controller may count its own cycles.
        _ if step == 1.0 => format!(
            ": steps of 1 are {} then; if the column counts cycles of the controller, give their length as [units] time_factor",
            hz(factor)
        ),
        _ => format!(": steps of {step_said} are {} then", hz(factor)),
    };
    Some((factor, unit, Some(doubt), step == 1.0 && !within(factor, CONFIRMS)))
}

/// Mean time between rows: that of a clock whose stamps several rows share. Where it steps back it begins anew.
fn mean_step(time: &[f64]) -> f64 {
    let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step >= 0.0).collect();
    steps.iter().sum::<f64>() / steps.len().max(1) as f64
}

fn median_step(time: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied()
}

/// Whether any position changes.
fn moves(columns: &[Vec<f64>], layout: &Layout) -> bool {
    let changes = |column: &usize| {
        let mut values = columns[*column].iter().filter(|value| value.is_finite());
        let first = values.next();
        first.is_some_and(|first| values.any(|value| value != first))
    };
    layout.positions().iter().any(changes)
}

/// Seconds per unit of time in which the positions change as the velocities imply: sum of the sizes of the changes over the sum of
/// the sizes of velocity times step.
fn seconds_per_unit(columns: &[Vec<f64>], layout: &Layout) -> Option<f64> {
    let time = &columns[layout.time()];
    let (mut path, mut of_velocity) = (0.0, 0.0);
    for (&position, &velocity) in layout.positions().iter().zip(layout.velocities()?) {
        if velocity == ABSENT {
            continue;
        }
        let (q, qd) = (&columns[position], &columns[velocity]);
        for row in 1..time.len() {
            let (change, step) = ((q[row] - q[row - 1]).abs(), time[row] - time[row - 1]);
            let by_velocity = 0.5 * (qd[row] + qd[row - 1]).abs() * step;
            if change.is_finite() && by_velocity.is_finite() && step > 0.0 {
                path += change;
                of_velocity += by_velocity;
            }
        }
    }
    (path > 0.0 && of_velocity > 0.0).then(|| path / of_velocity)
}

/// Time of which whole seconds and nanoseconds stand apart, counted from the first second so that no digit is lost.
pub(super) fn joined(seconds: &[f64], nanoseconds: &[f64]) -> Vec<f64> {
    let start = seconds.iter().copied().find(|second| second.is_finite()).unwrap_or(0.0);
    seconds.iter().zip(nanoseconds).map(|(s, ns)| (s - start) + 1e-9 * ns).collect()
}

#[cfg(test)]
mod tests {
    use crate::recording::lenient::{ColumnMap, load};

    /// Rate of a log of 1000 rows whose clock has these steps, and what was said of it.
    fn read(name: &str, start: f64, step: f64, velocity: Option<f64>, moving: bool) -> (f64, String) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut text = format!("{name},q1,tau1{}\n", if velocity.is_some() { ",qd1" } else { "" });
        for row in 0..1000 {
            let phase = 0.01 * f64::from(row);
            let q = if moving { phase.sin() } else { 0.5 };
            text += &format!("{},{q},{}", start + step * f64::from(row), phase.cos());
            // Radians per row, by the rows per second.
            text += &velocity.map_or(String::new(), |hz| format!(",{}", 0.01 * hz * phase.cos()));
            text.push('\n');
        }
        std::fs::write(&path, text).unwrap();
        let sieved = load(&path, None, &ColumnMap::default()).unwrap();
        (sieved.recording.rate_hz(), sieved.corrections.join("; "))
    }

    #[test]
    fn a_clock_that_begins_anew_has_the_steps_of_both_parts() {
        let time: Vec<f64> = (0..1000).map(|row| 5.0 * f64::from(row % 500)).collect();
        assert_eq!((super::mean_step(&time), super::median_step(&time)), (5.0, Some(5.0)));
        // Two rows share each stamp.
        let bursts: Vec<f64> = (0..1000).map(|row| f64::from(row / 2)).collect();
        assert!((super::mean_step(&bursts) - 0.5).abs() < 1e-3);
    }

    #[test]
    fn a_clock_that_counts_from_zero() {
        for name in ["t", "time", "timestamp"] {
            for (step, velocity, hz, word) in [
                (1.0, None, 1000.0, "in ms"),
                (4.0, None, 250.0, "in ms"),
                (20.0, None, 50.0, "in ms"),
                (1000.0, None, 1000.0, "in us"),
                (4000.0, None, 250.0, "in us"),
                (2e6, None, 500.0, "in ns"),
                (100.0, Some(10.0), 10.0, "in ms: steps of 100 are 10 Hz then, as the velocities confirm"),
                (100.0, Some(10_000.0), 10_000.0, "in us: steps"),
                (100.0, None, 10.0, "though steps of 100 could be us at 10000 Hz as well"),
                (200.0, Some(5.0), 5.0, "in ms"),
            ] {
                let (rate, said) = read(name, 0.0, step, velocity, true);
                assert!((rate / hz - 1.0).abs() < 1e-9, "{name}, {step}: {rate} {said}");
                assert!(said.contains(word) && said.contains("[units] time"), "{name}, {step}: {said}");
            }
        }
    }

    #[test]
    fn days_of_spreadsheets() {
        for start in [0.5, 45_000.5, 738_000.25] {
            let (rate, said) = read("Date", start, 0.004 / 86_400.0, None, true);
            // Days from 1900 on have seven digits for what is between two rows.
            assert!((rate / 250.0 - 1.0).abs() < 0.05 && said.contains("in days"), "{start}: {rate} {said}");
        }
    }

    #[test]
    fn seconds_stay_seconds() {
        for (start, step, moving) in [(0.0, 0.004, true), (0.0, 0.5, true), (1.7e9, 0.01, true), (0.0, 2.0, false)] {
            let (rate, said) = read("t", start, step, None, moving);
            assert!((rate * step - 1.0).abs() < 1e-3, "{step}: {rate}");
            assert_eq!(said, "", "{step}");
        }
    }

    #[test]
    fn a_clock_since_the_start_of_a_computer() {
        // Two hours in ns and a fortnight in us are no ms from 1970.
        for (start, step, hz) in
            [(7.2e12, 2e6, 500.0), (1.2e12, 4000.0, 250.0), (1.7e12, 4.0, 250.0), (1.7e18, 1e7, 100.0)]
        {
            for name in ["time", "stamp"] {
                let (rate, said) = read(name, start, step, None, true);
                assert!((rate / hz - 1.0).abs() < 1e-3, "{name} {start}: {rate} {said}");
            }
        }
    }

    #[test]
    fn steps_of_one_may_be_cycles_of_a_controller() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        // By velocities of motion at 1000 Hz, without velocities, and in steps of two.
        for (velocity, step, may_count) in [(true, 1, false), (false, 1, true), (false, 2, false)] {
            let mut text = format!("Tick,q1,tau1{}\n", if velocity { ",qd1" } else { "" });
            for row in 0..1000 {
                let phase = 0.01 * f64::from(row);
                text += &format!("{},{},{}", step * row, phase.sin(), phase.cos());
                text += &if velocity { format!(",{}\n", 10.0 * phase.cos()) } else { "\n".into() };
            }
            std::fs::write(&path, text).unwrap();
            let sieved = load(&path, None, &ColumnMap::default()).unwrap();
            assert_eq!(sieved.may_count, may_count, "{velocity}, {step}: {:?}", sieved.corrections);
        }
    }
}
