//! Which part of time a column holds, from its name.

use super::translated::translated;
use super::words::{without_tuple, without_unit, words};

/// What a column of time holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Time {
    /// The lower, the better: the time of the message before that of the logger.
    pub rank: u8,
    /// Seconds per unit, where the name gives it.
    pub factor: Option<f64>,
    /// Whole seconds, or the nanoseconds behind them, of which the other is in a column of its own.
    pub part: Part,
}

/// Which part of a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    /// All of it.
    Whole,
    /// Whole seconds.
    Seconds,
    /// Nanoseconds of the second.
    Nanoseconds,
}

/// Rank of `t` and `time`, which are in seconds.
pub(crate) const OWN_TIME: u8 = 0;
const OF_MESSAGE: u8 = 1;
const STAMP: u8 = 2;
const OF_LOGGER: u8 = 3;
/// Rank of a first column without a name, in which programs for tables put the index of the rows.
pub(crate) const INDEX: u8 = 9;

/// The meaning of a column's name as time.
pub(crate) fn time(column: &str, place: usize) -> Option<Time> {
    let column = &*without_tuple(column);
    let english = translated(column);
    let column = english.as_deref().unwrap_or(column);
    let time = |rank, factor, part| Some(Time { rank, factor, part });
    if column.eq_ignore_ascii_case("t") || column.eq_ignore_ascii_case("time") {
        return time(OWN_TIME, None, Part::Whole);
    }
    if place == 0 && (column.is_empty() || column.starts_with("Unnamed:") || column == "index") {
        return time(INDEX, None, Part::Whole);
    }
    let (bare, unit) = without_unit(column);
    let mut words = words(bare.trim_start_matches('%'));
    let factor_of = |unit: &str| match unit {
        "s" | "sec" | "secs" | "second" | "seconds" => Some(1.0),
        "ms" | "msec" | "millis" | "milliseconds" => Some(1e-3),
        "us" | "usec" | "µs" | "micros" | "microseconds" => Some(1e-6),
        "ns" | "nsec" | "nanos" | "nanoseconds" => Some(1e-9),
        "min" | "mins" | "minute" | "minutes" => Some(60.0),
        "h" | "hour" | "hours" => Some(3600.0),
        _ => None,
    };
    let whole = words.join("_");
    let stamped = whole.ends_with("stamp_sec")
        || whole.ends_with("stamp_secs")
        || matches!(&*whole, "sec" | "secs" | "zeit_in_sec" | "time_in_sec");
    if stamped {
        return time(OF_MESSAGE, None, Part::Seconds);
    }
    let behind = ["nanosec", "nanosecs", "nsec", "nsecs"];
    let in_nanoseconds = matches!(&*whole, "zeit_in_nano_sec" | "time_in_nano_sec");
    if in_nanoseconds || behind.iter().any(|word| whole.ends_with(&format!("stamp_{word}")) || whole == *word) {
        return time(OF_MESSAGE, None, Part::Nanoseconds);
    }
    let mut factor = unit.and_then(|unit| factor_of(&unit.to_lowercase()));
    if factor.is_none() && words.len() > 1 {
        factor = words.last().and_then(|word| factor_of(word));
        if factor.is_some() {
            words.pop();
        }
    }
    let rank = match &*words.join("_") {
        "millis" | "milliseconds" | "micros" | "microseconds" | "nanos" | "nanoseconds" | "seconds" | "ms" | "us"
        | "ns" => {
            factor = factor_of(&whole);
            STAMP
        }
        // The interpolation cycle of a KUKA controller, in ms, and the clock of LCM messages, in us.
        "ipoc" => {
            factor = Some(1e-3);
            STAMP
        }
        "utime" => {
            factor = Some(1e-6);
            STAMP
        }
        // The first column of LabVIEW's files.
        "x_value" if place == 0 => STAMP,
        "zeit" | "temps" | "tiempo" | "tempo" | "zeitstempel" | "horodatage" => STAMP,
        "t" | "time" if factor.is_some() && unit.is_none() => STAMP,
        "t" | "time" if column.starts_with(['_', '%']) => OF_LOGGER,
        "t" | "time" => STAMP,
        "header_stamp" | "field_header_stamp" | "joint_states_header_stamp" | "msg_header_stamp" => OF_MESSAGE,
        "timestamp" | "timestamps" | "time_stamp" | "stamp" | "times" | "robot_timestamp" | "timestamp_robot"
        | "elapsed" | "seconds_elapsed" | "rel_time" | "relative_time" | "simulation_time" | "elapsed_time"
        | "controller_time" | "robot_time" | "sim_time" | "state_time" | "time_from_start" | "ts" | "tick"
        | "ticks" | "epoch" | "epoch_time" | "unix_time" | "timestamp_utc" | "time_utc" => STAMP,
        "ros_time" | "rosbag_timestamp" | "log_time" | "recv_time" | "receive_time" | "publish_time" | "wall_time"
        | "sample_time" | "datetime" | "date_time" | "date" | "duration" | "clock" | "systime" | "system_time"
        | "local_time" => OF_LOGGER,
        _ => return None,
    };
    time(rank, factor, Part::Whole)
}

/// Whether two columns are called alike but for seconds and nanoseconds behind the same words: those of the second are behind the seconds.
pub(crate) fn are_seconds_and_rest(seconds: &str, rest: &str) -> bool {
    let (seconds, rest) = (words(seconds), words(rest));
    let ends = |words: &[String], own: &[&str]| words.last().is_some_and(|last| own.contains(&last.as_str()));
    seconds.len() > 1
        && ends(&seconds, &["s", "sec", "secs", "seconds"])
        && ends(&rest, &["nsec", "nsecs", "nanosec", "nanosecs", "nanoseconds"])
        && seconds[..seconds.len() - 1] == rest[..rest.len() - 1]
}
