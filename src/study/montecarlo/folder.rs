//! The folder of a study in the making: finished chunks survive whatever ends the program.

use super::files::{SHARD, STUDY_SCHEMA, TRIALS, identity_of};
use super::join::{self, Report, Source, summarise};
use super::plan::Identity;
use super::shard::Shard;
use super::study::Study;
use super::summary::Summary;
use super::table::{self, Timings, Writer};
use super::trial::Row;
use crate::error::{Error, Result};
use crate::output::{self, ResultFolder};
use rayon::prelude::*;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Where chunks are kept until the study is finished.
const UNFINISHED: &str = "unfinished";

/// How far a study is.
///
/// ```
/// use tauscope::study::montecarlo::{Progress, Shard, StudyFolder};
/// # use tauscope::scenario::Setup;
/// # use tauscope::study::montecarlo::{Overrides, Plan, Study};
/// # let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// # let (estimators, windows) = (Some(vec!["wls".to_owned()]), Some(vec![0, 61]));
/// # let overrides = Overrides { trials: Some(4), estimators, windows, ..Overrides::default() };
/// # let study = Study::new(setup.clone(), Plan::new(&setup, overrides)?)?;
/// # let folder = tempfile::tempdir().unwrap();
/// # let (stop, path) = (std::sync::atomic::AtomicBool::new(false), folder.path().join("study"));
///
/// // Hears of every chunk of trials.
/// let done = std::sync::atomic::AtomicUsize::new(0);
/// let count = |trials| drop(done.fetch_add(trials, std::sync::atomic::Ordering::Relaxed));
/// let progress = Progress { done: &count, stop: &stop };
/// StudyFolder::open(&path, &study, Shard::WHOLE, false)?.run(&study, &progress, &|_, _| String::new())?;
/// assert_eq!(done.into_inner(), 4);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct Progress<'a> {
    /// Told the trials of each chunk as it is finished, or found finished.
    pub done: &'a (dyn Fn(usize) + Sync),
    /// Raised to stop after the trials that are being computed.
    pub stop: &'a AtomicBool,
}

/// The folder of a study, or of one of its shards.
///
/// ```
/// use tauscope::study::montecarlo::{Progress, Shard, StudyFolder};
/// # use tauscope::scenario::Setup;
/// # use tauscope::study::montecarlo::{Overrides, Plan, Study};
/// # let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// # let (estimators, windows) = (Some(vec!["wls".to_owned()]), Some(vec![0, 61]));
/// # let overrides = Overrides { trials: Some(4), estimators, windows, ..Overrides::default() };
/// # let study = Study::new(setup.clone(), Plan::new(&setup, overrides)?)?;
/// # let folder = tempfile::tempdir().unwrap();
/// # let (stop, path) = (std::sync::atomic::AtomicBool::new(false), folder.path().join("study"));
///
/// // All trials of a study, with their table and summary in the folder.
/// let opened = StudyFolder::open(&path, &study, Shard::WHOLE, false)?;
/// assert_eq!(opened.trials(&study), 4);
/// let finished = opened.run(&study, &Progress { done: &|_| (), stop: &stop }, &|_, _| String::new())?;
/// assert!(finished.is_some() && path.join("summary.json").is_file());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct StudyFolder {
    path: PathBuf,
    identity: Identity,
    shard: Shard,
    finished: bool,
}

impl StudyFolder {
    /// Opens the folder for a study: `path` itself, or a folder of the shard's own inside it.
    ///
    /// # Errors
    /// If it cannot be written, or holds chunks of another study, or of this one without `resume`.
    pub fn open(path: &Path, study: &Study, shard: Shard, resume: bool) -> Result<Self> {
        let identity = study.plan.identity(&study.setup, &study.parameters())?;
        let path = match shard {
            Shard::WHOLE => path.to_owned(),
            Shard { index, count } => path.join(format!("{SHARD}{index:04}_of_{count:04}")),
        };
        drop(ResultFolder::create(&path)?);
        let pending = path.join(UNFINISHED);
        let begun = identity_of(&pending)?;
        let mut finished = false;
        match (&begun, resume) {
            (Some(known), true) if *known != identity => {
                let problem =
                    "holds chunks of another study (scenario, seed or plan differ); choose another --out or remove it";
                return Err(Error::request(pending.display().to_string(), problem));
            }
            (Some(_), false) => {
                let problem = "holds chunks of a study that was not finished; continue with --resume, choose another --out or \
                               remove it";
                return Err(Error::request(pending.display().to_string(), problem));
            }
            (None, true) => finished = identity_of(&path)?.as_ref() == Some(&identity) && path.join(TRIALS).exists(),
            _ => {}
        }
        let folder = StudyFolder { path, identity, shard, finished };
        if !finished && begun.is_none() {
            let failed = |source| Error::io(&pending, "create the folder", source);
            fs::create_dir_all(&pending).map_err(failed)?;
            let file = folder.place("study.json");
            write_whole(&file, |path| {
                let target = File::create(path).map_err(|e| Error::io(path, "write the study", e))?;
                output::json(target, STUDY_SCHEMA, &folder.identity).map_err(|e| Error::io(path, "write the study", e))
            })?;
        }
        Ok(folder)
    }

    /// The chunks of this folder's shard.
    fn chunks(&self) -> Vec<usize> {
        (0..self.identity.chunks()).filter(|&chunk| self.shard.has(chunk)).collect()
    }

    /// Trials of this folder's shard.
    pub fn trials(&self, study: &Study) -> usize {
        self.chunks().into_iter().map(|chunk| study.plan.trials_of(chunk).len()).sum()
    }

    fn place(&self, name: &str) -> PathBuf {
        self.path.join(UNFINISHED).join(name)
    }

    fn source(&self, chunk: usize) -> Source {
        Source {
            trials: self.place(&format!("trials_{chunk:04}.parquet")),
            timings: self.place(&format!("timings_{chunk:04}.parquet")),
            group: 0,
        }
    }

    /// Computes the chunks that are not there yet, on all threads, and puts all together. None if it was stopped.
    ///
    /// # Errors
    /// If a file cannot be written, or there are fewer chunks than shards.
    pub fn run(
        &self,
        study: &Study,
        progress: &Progress,
        report: Report,
    ) -> Result<Option<(Summary, Timings, PathBuf)>> {
        let chunks = self.chunks();
        if chunks.is_empty() {
            let problem =
                format!("has no trials: {} chunks are fewer than the shards; take fewer", self.identity.chunks());
            return Err(Error::request(format!("shard {}", self.shard), problem));
        }
        if self.finished {
            (progress.done)(self.trials(study));
            let (summary, times) = summarise(&self.path, &self.identity)?;
            return Ok(Some((summary, times, self.path.clone())));
        }
        chunks.par_iter().try_for_each(|&chunk| self.chunk(study, chunk, progress))?;
        let sources: Vec<Source> = chunks.into_iter().map(|chunk| self.source(chunk)).collect();
        if sources.iter().any(|source| !source.trials.exists()) {
            return Ok(None);
        }
        let folder = ResultFolder::create(&self.path)?;
        let (summary, times) = join::join(&folder, &self.identity, &sources, report)?;
        folder.write_text("scenario.toml", &study.setup.merged()?)?;
        for (name, source) in study.setup.inputs() {
            let text =
                fs::read_to_string(source).map_err(|e| Error::io(source, "read what the scenario refers to", e))?;
            folder.write_text(name, &text)?;
        }
        let path = folder.finish()?;
        let pending = self.path.join(UNFINISHED);
        fs::remove_dir_all(&pending).map_err(|source| Error::io(&pending, "remove the chunks", source))?;
        Ok(Some((summary, times, path)))
    }

    /// Computes one chunk, unless it is there.
    fn chunk(&self, study: &Study, chunk: usize, progress: &Progress) -> Result<()> {
        let trials = study.plan.trials_of(chunk);
        let (count, source) = (trials.len(), self.source(chunk));
        if !source.trials.exists() {
            let rows: Option<Vec<Vec<Row>>> = trials
                .into_par_iter()
                .map(|trial| (!progress.stop.load(Ordering::Relaxed)).then(|| study.trial(trial)))
                .collect();
            let Some(rows) = rows else { return Ok(()) };
            let rows = rows.concat();
            // The trials come last: a chunk is there when they are.
            self.write(&source.timings, &table::timings(&rows)?)?;
            self.write(&source.trials, &table::trials(&self.identity, &rows)?)?;
        }
        (progress.done)(count);
        Ok(())
    }

    fn write(&self, path: &Path, batch: &arrow_array::RecordBatch) -> Result<()> {
        write_whole(path, |staged| {
            let mut writer = Writer::new(staged, &self.identity)?;
            writer.write(batch)?;
            writer.finish()
        })
    }
}

/// Writes a file under another name and moves it to its place, so that there is never half a file.
fn write_whole(path: &Path, write: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
    let staged = path.with_extension(format!("{}.tmp", std::process::id()));
    write(&staged)?;
    fs::rename(&staged, path).map_err(|source| Error::io(path, "write the trials", source))?;
    if let Some(folder) = path.parent().and_then(|folder| File::open(folder).ok()) {
        // Some file systems cannot; the file is whole in any case.
        let _ = folder.sync_all();
    }
    Ok(())
}
