//! The search with its result reduced to what matters, and the structure that stays unexplained.

use crate::diagnosis::Options;
use crate::diagnosis::lack_of_fit::{Unexplained, unexplained};
use crate::diagnosis::model::Session;
use crate::diagnosis::relevance::{Minor, eliminate, hold_undetermined, with_scatter};
use crate::diagnosis::search::{Selection, select};
use crate::diagnosis::watch::Watch;
use crate::error::Result;

/// What was found in some logs.
#[derive(Debug)]
pub(super) struct Searched {
    /// The effects that matter, in the model.
    pub selection: Selection,
    /// Smaller ones, not in the model.
    pub minor: Vec<Minor>,
    /// Structure that no effect explains.
    pub unexplained: Vec<Unexplained>,
}

/// Searches for effects and takes out those that do not matter.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn found_that_matter(
    session: &mut Session,
    options: &Options,
    watch: &mut Watch,
) -> Result<(Selection, Vec<Minor>)> {
    let mut selection = select(session, options, watch)?;
    let mut minor = Vec::new();
    // What is out changes the estimates of what stays, which must pass with these.
    loop {
        let more = eliminate(session, &mut selection.found, &selection.whitener)?;
        if more.is_empty() {
            break;
        }
        minor.extend(more);
        selection.settle(session)?;
    }
    selection.converge(session)?;
    if hold_undetermined(session, &mut selection.found, &selection.whitener)? {
        selection.settle(session)?;
        with_scatter(session, &mut selection.found, &selection.whitener)?;
    }
    Ok((selection, minor))
}

impl Searched {
    /// Searches the logs of `session`.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn new(session: &mut Session, options: &Options, watch: &mut Watch) -> Result<Self> {
        let (selection, minor) = found_that_matter(session, options, watch)?;
        let unexplained = match watch.is_over() {
            true => Vec::new(),
            false => unexplained(session, &selection, options.alpha)?,
        };
        Ok(Searched { selection, minor, unexplained })
    }
}
