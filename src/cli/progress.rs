//! Progress bars: on a terminal only, never under `--quiet` or `--json`.

use super::Global;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar over `steps`, with what is being done in front and the time left behind.
pub fn bar(global: &Global, what: &str, steps: usize) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(
        Some(steps as u64),
        if global.quiet || global.json { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() },
    );
    let style = ProgressStyle::with_template("{msg} [{bar:40}] {percent:>3} %  {eta} left").expect("a valid template");
    bar.set_style(style.progress_chars("=> "));
    bar.set_message(what.to_owned());
    bar
}
