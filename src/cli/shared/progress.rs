//! Progress bars with the time left, each on one line: on a terminal only, never under `--quiet` or `--json`.

use super::global::Global;
use indicatif::style::ProgressTracker;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::time::{Duration, Instant};

/// Time between two looks at the clock.
const TICK: Duration = Duration::from_millis(200);

/// A bar over `steps`, with what is being done in front and the time left behind.
pub(crate) fn bar(global: &Global, what: &str, steps: usize) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(
        Some(steps as u64),
        if global.quiet || global.json { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() },
    );
    let style = ProgressStyle::with_template("[{bar:20}] {percent:>3} %{left}  {wide_msg}").expect("a valid template");
    bar.set_style(style.progress_chars("=> ").with_key("left", TimeLeft::default()));
    bar.set_message(what.to_owned());
    bar.enable_steady_tick(TICK);
    bar
}

/// A bar over stages that take known shares of the whole.
pub(crate) struct Stages {
    bar: ProgressBar,
    /// Shares of the stages to come, the next one last.
    shares: Vec<u64>,
    /// Share of the present stage.
    present: u64,
}

impl Stages {
    /// Stages that take `shares` of the time, in any unit.
    pub(crate) fn new(global: &Global, shares: &[u64]) -> Self {
        let bar = bar(global, "", shares.iter().sum::<u64>() as usize);
        Stages { bar, shares: shares.iter().rev().copied().collect(), present: 0 }
    }

    /// The next stage begins.
    pub(crate) fn begin(&mut self, what: &str) {
        self.bar.inc(self.present);
        self.present = self.shares.pop().unwrap_or(0);
        self.bar.set_message(what.to_owned());
    }

    /// All is done.
    pub(crate) fn finish(self) {
        self.bar.finish_and_clear();
    }
}

/// The time left, as the mean over what is done so far has it; counts down between two steps.
#[derive(Debug, Clone, Default)]
struct TimeLeft {
    /// Steps done, and when the last of them was.
    done: u64,
    since: Duration,
}

impl TimeLeft {
    /// Time left at `elapsed`, of `steps` in all; None while there is nothing to go by.
    fn at(&self, elapsed: Duration, steps: u64) -> Option<Duration> {
        if self.done == 0 {
            return None;
        }
        let expected = self.since.mul_f64(steps.saturating_sub(self.done) as f64 / self.done as f64);
        let waited = elapsed.saturating_sub(self.since);
        Some(expected.saturating_sub(waited).max(Duration::from_secs(1)))
    }
}

impl ProgressTracker for TimeLeft {
    fn clone_box(&self) -> Box<dyn ProgressTracker> {
        Box::new(self.clone())
    }

    fn tick(&mut self, state: &ProgressState, _now: Instant) {
        if state.pos() != self.done {
            (self.done, self.since) = (state.pos(), state.elapsed());
        }
    }

    fn reset(&mut self, _state: &ProgressState, _now: Instant) {
        *self = TimeLeft::default();
    }

    fn write(&self, state: &ProgressState, out: &mut dyn std::fmt::Write) {
        let left = self.at(state.elapsed(), state.len().unwrap_or(0));
        // A bar without room for its end is still a bar.
        let _ = match left {
            Some(left) => write!(out, ", about {} left", spoken(left)),
            None => write!(out, ", {} so far", spoken(state.elapsed())),
        };
    }
}

/// A time in the two largest units that it has.
fn spoken(time: Duration) -> String {
    let seconds = time.as_secs();
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, m, s) => format!("{m} min {s} s"),
        (h, m, _) => format!("{h} h {m} min"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_counts_down() {
        let seconds = Duration::from_secs;
        let left = TimeLeft { done: 2, since: seconds(10) };
        assert_eq!(left.at(seconds(10), 5), Some(seconds(15)));
        assert_eq!(left.at(seconds(14), 5), Some(seconds(11)));
        assert_eq!(left.at(seconds(60), 5), Some(seconds(1)));
        assert_eq!(TimeLeft::default().at(seconds(3), 5), None);
    }

    #[test]
    fn times_are_told_in_two_units() {
        assert_eq!(spoken(Duration::from_millis(2700)), "2 s");
        assert_eq!(spoken(Duration::from_secs(61)), "1 min 1 s");
        assert_eq!(spoken(Duration::from_secs(7_320)), "2 h 2 min");
    }
}
