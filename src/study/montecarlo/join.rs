//! Chunks of a study put together, from one machine or many, in the order of the trials.

use super::files::{
    INPUTS, REPORT, STUDY, STUDY_SCHEMA, SUMMARY, SUMMARY_SCHEMA, TIMINGS, TRIALS, identity_of, shards_in,
};
use super::plan::Identity;
use super::summary::{Summary, Sums};
use super::table::{self, Timings, Writer};
use crate::error::{Error, Result};
use crate::output::ResultFolder;
use arrow_array::RecordBatch;
use std::path::{Path, PathBuf};

/// Makes the report page of a study.
pub type Report<'a> = &'a dyn Fn(&Summary, &Timings) -> String;

/// Where the rows of a chunk are.
#[derive(Debug, Clone)]
pub(super) struct Source {
    pub trials: PathBuf,
    pub timings: PathBuf,
    pub group: usize,
}

/// Writes the chunks of `sources`, in order, and their summary to `folder`.
pub(super) fn join(
    folder: &ResultFolder,
    identity: &Identity,
    sources: &[Source],
    report: Report,
) -> Result<(Summary, Timings)> {
    let mut sums = Sums::new(identity);
    let mut times = Timings::default();
    folder.write_with(TRIALS, |path| {
        let mut writer = Writer::new(path, identity)?;
        for source in sources {
            let batch = table::read(&source.trials, source.group)?;
            sums.add(&source.trials, &batch)?;
            writer.write(&batch)?;
        }
        writer.finish()
    })?;
    folder.write_with(TIMINGS, |path| {
        let mut writer = Writer::new(path, identity)?;
        for source in sources {
            let batch = table::read(&source.timings, source.group)?;
            times.add(&source.timings, &batch)?;
            writer.write(&batch)?;
        }
        writer.finish()
    })?;
    let summary = sums.summary();
    folder.write_json(SUMMARY, SUMMARY_SCHEMA, &summary)?;
    folder.write_json(STUDY, STUDY_SCHEMA, identity)?;
    folder.write_text(REPORT, &report(&summary, &times))?;
    Ok((summary, times))
}

/// Summary and times of a finished folder, from its rows.
pub(super) fn summarise(folder: &Path, identity: &Identity) -> Result<(Summary, Timings)> {
    let (trials, timings) = (folder.join(TRIALS), folder.join(TIMINGS));
    let mut sums = Sums::new(identity);
    let mut times = Timings::default();
    for group in 0..table::groups(&trials)? {
        sums.add(&trials, &table::read(&trials, group)?)?;
        times.add(&timings, &table::read(&timings, group)?)?;
    }
    Ok((sums.summary(), times))
}

/// Which chunk of a study a batch is.
fn chunk_of(path: &Path, identity: &Identity, batch: &RecordBatch) -> Result<usize> {
    let trials = table::whole(path, batch, "trial")?.values();
    let chunk = trials[0] as usize / identity.chunk_trials;
    let first = chunk * identity.chunk_trials;
    let end = (first + identity.chunk_trials).min(identity.montecarlo.trials);
    let cells = identity.cells();
    let expected = (first..end).flat_map(|trial| std::iter::repeat_n(trial as u32, cells));
    if !expected.eq(trials.iter().copied()) {
        let problem = format!("rows of the trials from {first} on are not the {cells} each that the study has");
        return Err(Error::input(path, None, "trial", problem));
    }
    Ok(chunk)
}

/// Puts the shards of a study together as one machine would have written it. `folders` are those of the shards, or folders
/// with shards in them.
///
/// # Errors
/// If a folder holds no finished shard or one of another study, and for trials that are missing or double (named).
pub fn merge(folders: &[PathBuf], out: &Path, report: Report) -> Result<(Summary, Timings, PathBuf)> {
    let shards = expand(folders)?;
    let mut study: Option<(&Path, Identity)> = None;
    let mut sources: Vec<Option<Source>> = Vec::new();
    for shard in &shards {
        let identity = identity_of(shard)?.ok_or_else(|| {
            Error::request(shard.display().to_string(), "holds no finished shard of a study (no study.json)")
        })?;
        match &study {
            None => {
                sources = vec![None; identity.chunks()];
                study = Some((shard, identity));
            }
            Some((first, known)) if *known != identity => {
                let problem = format!("is of another study than {}: scenario, seed or plan differ", first.display());
                return Err(Error::request(shard.display().to_string(), problem));
            }
            Some(_) => {}
        }
        let Some((_, identity)) = &study else { continue };
        let trials = shard.join(TRIALS);
        for group in 0..table::groups(&trials)? {
            let chunk = chunk_of(&trials, identity, &table::read(&trials, group)?)?;
            let source = Source { trials: trials.clone(), timings: shard.join(TIMINGS), group };
            if let Some(known) = sources[chunk].replace(source) {
                let range = trial_range(identity, chunk);
                let problem = format!("{range}: here and in {}; merge each shard once", known.trials.display());
                return Err(Error::input(&trials, None, "trial", problem));
            }
        }
    }
    let Some((first, identity)) = study else {
        return Err(Error::request("merge", "no shards are given; name their folders"));
    };
    let missing: Vec<String> = (0..sources.len())
        .filter(|&chunk| sources[chunk].is_none())
        .map(|chunk| trial_range(&identity, chunk))
        .collect();
    if !missing.is_empty() {
        const MOST: usize = 5;
        let more = missing.len().saturating_sub(MOST);
        let more = if more > 0 { format!(" and {more} more chunks") } else { String::new() };
        let problem =
            format!("missing: {}{more}; run the shards that have them", missing[..missing.len().min(MOST)].join(", "));
        return Err(Error::request("merge", problem));
    }
    let folder = ResultFolder::create(out)?;
    let sources: Vec<Source> = sources.into_iter().flatten().collect();
    let (summary, times) = join(&folder, &identity, &sources, report)?;
    for name in INPUTS {
        if let Ok(text) = std::fs::read_to_string(first.join(name)) {
            folder.write_text(name, &text)?;
        }
    }
    Ok((summary, times, folder.finish()?))
}

fn trial_range(identity: &Identity, chunk: usize) -> String {
    let first = chunk * identity.chunk_trials;
    let last = (first + identity.chunk_trials).min(identity.montecarlo.trials) - 1;
    if first == last { format!("trial {first}") } else { format!("trials {first} to {last}") }
}

/// The folders themselves, or the shards inside those that are no shards.
fn expand(folders: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut shards = Vec::new();
    for folder in folders {
        let inside = shards_in(folder)?;
        if inside.is_empty() { shards.push(folder.clone()) } else { shards.extend(inside) }
    }
    Ok(shards)
}
