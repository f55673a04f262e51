//! Who follows a diagnosis: hears how far it has come, and may end the search.

use super::variance::ResidualMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How far a diagnosis has come.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Diagnosis, Progress};
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
///
/// // A first answer comes before the search for laws: what the residual follows.
/// let (mut screened, mut mapped, mut found) = (false, false, 0);
/// let watch = |progress| match progress {
///     Progress::Screened => screened = true,
///     Progress::Map(map) => mapped = map.joints.len() == 1,
///     Progress::Found(count) => found = count,
/// };
/// Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).progress(watch).run()?;
/// assert!(screened && mapped && found > 0);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Progress {
    /// The logs are screened; the arm is fitted to them.
    Screened,
    /// A first answer: what the residual of the fitted arm follows. The search for laws begins.
    Map(ResidualMap),
    /// A step of the search ended with so many effects found.
    Found(usize),
}

/// Hears how far a diagnosis has come, and ends the search when its time is over or it is stopped.
pub(super) struct Watch<'a> {
    progress: Box<dyn FnMut(Progress) + 'a>,
    budget: Option<Duration>,
    stop: Option<Arc<AtomicBool>>,
    deadline: Option<Instant>,
    ended: bool,
}

impl<'a> Watch<'a> {
    /// Reports nothing and never ends.
    pub(super) fn idle() -> Self {
        Watch { progress: Box::new(|_| ()), budget: None, stop: None, deadline: None, ended: false }
    }

    /// Reports to `progress`.
    pub(super) fn report_to(&mut self, progress: impl FnMut(Progress) + 'a) {
        self.progress = Box::new(progress);
    }

    /// Ends the search so long after [`Watch::start`].
    pub(super) fn end_after(&mut self, budget: Duration) {
        self.budget = Some(budget);
    }

    /// Ends the search once `stop` is raised.
    pub(super) fn end_on(&mut self, stop: Arc<AtomicBool>) {
        self.stop = Some(stop);
    }

    /// The time begins.
    pub(super) fn start(&mut self) {
        self.deadline = self.budget.and_then(|budget| Instant::now().checked_add(budget));
    }

    /// Reports how far it has come.
    pub(super) fn tell(&mut self, progress: Progress) {
        (self.progress)(progress);
    }

    /// Whether the search is to end now.
    pub(super) fn is_over(&mut self) -> bool {
        let late = self.deadline.is_some_and(|deadline| Instant::now() >= deadline);
        self.ended |= late || self.stop.as_ref().is_some_and(|stop| stop.load(Ordering::Relaxed));
        self.ended
    }

    /// Whether the search was ended before it was done.
    pub(super) fn has_ended(&self) -> bool {
        self.ended
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_ends_in_time_or_when_stopped() {
        let mut watch = Watch::idle();
        watch.start();
        assert!(!watch.is_over());
        watch.end_after(Duration::from_secs(3600));
        watch.start();
        assert!(!watch.is_over() && !watch.has_ended());
        watch.end_after(Duration::ZERO);
        watch.start();
        assert!(watch.is_over() && watch.has_ended());

        let stop = Arc::new(AtomicBool::new(false));
        let mut watch = Watch::idle();
        watch.end_on(Arc::clone(&stop));
        assert!(!watch.is_over());
        stop.store(true, Ordering::Relaxed);
        assert!(watch.is_over());
    }
}
