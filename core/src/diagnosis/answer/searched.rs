//! The search with its result reduced to what matters, and the structure that stays unexplained.

use crate::diagnosis::Options;
use crate::diagnosis::criteria::Gate;
use crate::diagnosis::lack_of_fit::{Structure, mapped, unexplained};
use crate::diagnosis::model::{DataSet, Member, Session, Slot};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::relevance::{Minor, eliminate, hold_undetermined, with_scatter};
use crate::diagnosis::search::{Found, Selection, converged, members, select, settled};
use crate::diagnosis::variance::ResidualMap;
use crate::diagnosis::watch::Watch;
use crate::error::Result;

/// What was found in some logs.
#[derive(Debug)]
pub(super) struct Searched {
    /// The effects that matter, in the model.
    pub selection: Selection,
    /// Smaller ones, not in the model.
    pub minor: Vec<Minor>,
    /// Structure that no effect explains, and what was taken for none.
    pub structure: Structure,
    /// What the residual of the model follows in all logs.
    pub map: ResidualMap,
}

/// What the residual of the model with `members` follows in the logs of a data set, to which all columns of the model are fitted.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn map_on(session: &Session, data: &DataSet, members: &[Member], options: &Options) -> Result<ResidualMap> {
    let columns = session.model.columns(data, members)?;
    Ok(ResidualMap::new(data, &columns, &session.model.arm, &options.criteria, options.alpha, options.seed))
}

/// Structure that a model leaves, by tests of blocks and by the map of the residual, and that map. Where the search was ended, nothing but
/// the map looks for structure, and that of all logs decides alone.
fn left(session: &Session, selection: &Selection, options: &Options, ended: bool) -> Result<(Structure, ResidualMap)> {
    let members = members(&selection.found);
    let all = session.over_all_logs();
    let map = map_on(&all, &all.logs.train, &members, options)?;
    let mut structure = if ended { Structure::default() } else { unexplained(session, selection, options.alpha)? };
    let data_sets: &[&DataSet] = if ended { &[] } else { &[&session.logs.train, &session.logs.test] };
    let apart = || data_sets.iter().map(|data| map_on(session, data, &members, options)).collect();
    structure.merge(mapped(&map, &session.logs.cutoffs_hz, &options.criteria, options.alpha, apart)?);
    structure.leave_out_small(&map, &options.criteria);
    Ok((structure, map))
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
    let selection = select(session, options, watch)?;
    let (mut selection, minor) = those_that_matter(session, selection, &[])?;
    selection.ask_for_alternatives(session, watch)?;
    Ok((selection, minor))
}

/// Takes out of what was selected the effects that do not matter; on the joints of `any_size` the smallest matters.
fn those_that_matter(
    session: &mut Session,
    mut selection: Selection,
    any_size: &[usize],
) -> Result<(Selection, Vec<Minor>)> {
    let mut minor = Vec::new();
    loop {
        // What is out changes the estimates of what stays, which must pass with these.
        while take_out(session, &mut selection, &mut minor, any_size)? {}
        if !fit_to_the_end(session, &mut selection.found, &mut selection.whitener)? {
            return Ok((selection, minor));
        }
        selection.take_held_out(session)?;
        // So must the last fit: a parameter that is held at the end may leave a law that no machine has, or that is next to nothing.
        if !take_out(session, &mut selection, &mut minor, any_size)? {
            return Ok((selection, minor));
        }
    }
}

/// Moves the effects that do not matter by the present estimates to the `minor` ones and fits the others again; returns whether there were
/// any.
fn take_out(
    session: &mut Session,
    selection: &mut Selection,
    minor: &mut Vec<Minor>,
    any_size: &[usize],
) -> Result<bool> {
    let more = eliminate(session, &mut selection.found, &selection.whitener, &selection.multiplicity, any_size)?;
    if more.is_empty() {
        return Ok(false);
    }
    minor.extend(more);
    selection.settle(session)?;
    Ok(true)
}

/// The last fit of the effects in the model: until their sizes no longer change, with parameters that the logs do not determine held, and
/// with standard deviations that hold the scatter between blocks. `whitener` becomes the noise under it. Returns whether an estimate
/// changed.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn fit_to_the_end(session: &mut Session, found: &mut [Found], whitener: &mut Whitener) -> Result<bool> {
    let moved = converged(session, found, whitener)?;
    let has_moved = moved.is_some();
    if let Some(moved) = moved {
        *whitener = moved;
    }
    let is_held = hold_undetermined(session, found, whitener)?;
    if is_held {
        (*whitener, _) = settled(session, found)?;
        with_scatter(session, found, whitener)?;
    }
    Ok(has_moved || is_held)
}

impl Searched {
    /// Searches the logs of `session`.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn new(session: &mut Session, options: &Options, watch: &mut Watch) -> Result<Self> {
        let (selection, mut minor) = found_that_matter(session, options, watch)?;
        let ended = watch.is_over();
        let (structure, map) = left(session, &selection, options, ended)?;
        // An effect that is too small to matter is not, where without it structure is reported on its joint.
        let joints: Vec<usize> = structure.unexplained.iter().map(|left| left.joint).collect();
        let is_too_small = |minor: &mut Minor| {
            let own = minor.found.member.placed.joints();
            minor.failed.gate == Gate::Size && own.iter().any(|joint| joints.contains(joint))
        };
        let too_small: Vec<Minor> = minor.extract_if(.., is_too_small).collect();
        if ended || too_small.is_empty() {
            minor.extend(too_small);
            return Ok(Searched { selection, minor, structure, map });
        }
        let before: Vec<Slot> = selection.found.iter().map(|found| found.member.candidate.slot()).collect();
        let mut again = selection;
        again.found.extend(too_small.into_iter().map(|minor| minor.found));
        again.settle(session)?;
        let (mut selection, more) = those_that_matter(session, again, &joints)?;
        minor.extend(more);
        // Where all of them are out again the model is what it was, and so is what it leaves.
        let (structure, map) = match selection.found.iter().map(|found| found.member.candidate.slot()).eq(before) {
            true => (structure, map),
            false => {
                selection.ask_for_alternatives(session, watch)?;
                left(session, &selection, options, ended)?
            }
        };
        Ok(Searched { selection, minor, structure, map })
    }
}
