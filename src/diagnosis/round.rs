//! A round's view of the data: the noise, the fit so far, and the tests of all candidates against it.

use super::Options;
use super::candidates::{self, Candidate};
use super::contest::Scan;
use super::found::{Found, members};
use super::score::Projection;
use super::session::{Noise, Session};
use super::whitening::Whitener;
use crate::error::Result;

/// A round of a search.
#[derive(Debug)]
pub struct Round {
    /// The noise under what was found so far.
    pub whitener: Whitener,
    /// The fit of that.
    pub fit: Projection,
    /// All candidates.
    pub all: Vec<Candidate>,
    /// Their tests.
    pub scan: Scan,
}

impl Round {
    /// Fits what was `found` so far, with estimates written back, and tests all candidates against the fit.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn new(session: &mut Session, found: &mut [Found], options: &Options) -> Result<Self> {
        let mut members = members(found);
        let present = session.all_columns(&session.train, &members)?;
        let Noise { whitener, .. } = session.noise_under(&present);
        session.settle(&mut members, &whitener)?;
        found.iter_mut().zip(members.clone()).for_each(|(found, member)| found.member = member);
        let all = candidates::all(&session.arm, &session.train.rows, session.trust, &options.candidates)?;
        let columns = session.all_columns(&session.train, &members)?;
        let fit = whitener.fit(&columns, &session.train.torque);
        let scan = Scan::new(session, &all, &whitener, &fit);
        Ok(Round { whitener, fit, all, scan })
    }
}
