//! Logs made ready: which low-passes serve them best.

use super::passband;
use super::smoothing;
use crate::diagnosis::criteria::Criteria;
use crate::diagnosis::logs::{FEWEST_ROWS, FEWEST_TEST_ROWS, LowPass, Rows, cutoff, cutoffs_up_to, widest};
use crate::diagnosis::model::{DataSet, Known};
use crate::diagnosis::noise::{Whitener, rich};
use crate::diagnosis::regression::Column;
use crate::error::{Error, Result};
use crate::identification::effect_model::Arm;
use crate::identification::model::Model;
use crate::recording::Recording;

/// Steps from the cut-off that makes the torque likeliest to the one that is taken. Innovations hold noise and distortion alike,
/// but noise at high frequencies costs little once it is whitened, while a bent motion biases what is faint.
const RAISED: usize = 2;

/// What logs are made ready from.
#[derive(Debug)]
pub(super) struct Preparation<'a> {
    model: &'a Model,
    known: &'a Known<'a>,
    criteria: Criteria,
    /// Logs to identify from, those from before a change first.
    train: Vec<&'a Recording>,
    test: &'a [&'a Recording],
    /// Frequency above which the positions hold nothing but noise, Hz.
    whole_hz: f64,
}

/// Logs made ready.
#[derive(Debug)]
pub(super) struct Prepared {
    /// Training logs and held-out logs.
    pub data_sets: [DataSet; 2],
    /// Cut-off of the low-pass of all positions, Hz.
    pub cutoff_hz: f64,
    /// The low-pass that torque went through before it was logged, if any.
    pub passband: Option<LowPass>,
}

impl<'a> Preparation<'a> {
    /// The preparation of training logs, in addition to those from before a change that are `known`, and of held-out logs.
    ///
    /// # Errors
    /// If a log is too short.
    pub(super) fn new(
        model: &'a Model,
        known: &'a Known<'a>,
        train: &[&'a Recording],
        test: &'a [&'a Recording],
        criteria: Criteria,
    ) -> Result<Self> {
        let train: Vec<&Recording> = known.reference.iter().chain(train).copied().collect();
        let all: Vec<&Recording> = train.iter().chain(test).copied().collect();
        let whole_hz = cutoff(&all, criteria.levels.misfit)?;
        Ok(Preparation { model, known, criteria, whole_hz, train, test })
    }

    /// The same logs with other things known.
    pub(super) fn knowing<'b>(&'b self, known: &'b Known<'b>) -> Preparation<'b> {
        let Preparation { model, criteria, ref train, test, whole_hz, .. } = *self;
        Preparation { model, known, criteria, train: train.clone(), test, whole_hz }
    }

    /// Whether no log is both identified from and judged by.
    pub(super) fn is_apart(&self) -> bool {
        !self.test.iter().any(|log| self.train.iter().any(|other| std::ptr::eq(*log, *other)))
    }

    /// One cut-off for every joint.
    pub(super) fn alike(&self, hz: f64) -> Vec<f64> {
        vec![hz; self.model.dof()]
    }

    /// A number for every joint that has an equation.
    fn on_equations(&self, rows: usize) -> Vec<Option<usize>> {
        (0..self.model.dof()).map(|joint| self.model.has_equation(joint).then_some(rows)).collect()
    }

    /// The logs with the low-passes under which the innovations of the torque are smallest.
    ///
    /// # Errors
    /// If a log is too short or a joint hardly moves.
    pub(super) fn prepared(&self) -> Result<Prepared> {
        let prepared = match self.best_of(None) {
            Some(best) => best,
            // With no cut-off there are enough rows; the error of the widest is the clearest.
            None => {
                let rates_hz = self.train.iter().chain(self.test).map(|log| log.rate_hz());
                let cutoff_hz = rates_hz.map(widest).fold(f64::INFINITY, f64::min);
                Prepared { data_sets: self.data_sets(None, &self.alike(cutoff_hz))?, cutoff_hz, passband: None }
            }
        };
        Ok(self.through_passband(prepared.cutoff_hz)?.unwrap_or(prepared))
    }

    /// The cut-off of each joint by itself, with the arm as estimated along rows of the training logs and the residual of its fit there.
    ///
    /// # Errors
    /// If a log is too short.
    pub(super) fn own_cutoffs(
        &self,
        along: (&Arm, &Rows),
        of_fit: (&Whitener, &Column),
        cutoff_hz: f64,
    ) -> Result<Vec<f64>> {
        let within = [cutoff_hz, self.whole_hz];
        smoothing::of_joints(along, of_fit, &self.train, within, self.criteria.criterion_gap())
    }

    /// The cut-off to take where this one makes the torque likeliest.
    pub(super) fn raised(&self, likeliest_hz: f64) -> f64 {
        cutoffs_up_to(self.whole_hz)
            .into_iter()
            .filter(|hz| *hz > likeliest_hz)
            .take(RAISED)
            .last()
            .unwrap_or(likeliest_hz)
    }

    /// Both kinds of logs, with a cut-off for each joint.
    ///
    /// # Errors
    /// If a log is too short or a joint hardly moves.
    pub(super) fn data_sets(&self, through: Option<LowPass>, cutoffs_hz: &[f64]) -> Result<[DataSet; 2]> {
        let fewest = self.on_equations(FEWEST_TEST_ROWS);
        let rows =
            Rows::logged_through(through, self.test, (cutoffs_hz, self.whole_hz), &fewest, &self.criteria.levels);
        let rows = rows.map_err(of_held_out)?;
        Ok([self.training(through, cutoffs_hz)?, DataSet::new(self.model, self.known, rows, false)?])
    }

    fn training(&self, through: Option<LowPass>, cutoffs_hz: &[f64]) -> Result<DataSet> {
        let fewest = self.on_equations(FEWEST_ROWS);
        let mut rows =
            Rows::logged_through(through, &self.train, (cutoffs_hz, self.whole_hz), &fewest, &self.criteria.levels)?;
        rows.before = self.known.reference.len();
        DataSet::new(self.model, self.known, rows, true)
    }

    /// The cut-off of all positions that serves best. The torque itself decides: too low distorts the accelerations, too high lets the
    /// encoder's noise into them. None where all leave too few rows.
    fn best_of(&self, passband: Option<LowPass>) -> Option<Prepared> {
        let mut best: Option<(f64, Prepared)> = None;
        for cutoff_hz in cutoffs_up_to(self.whole_hz) {
            let Ok(data_sets) = self.data_sets(passband, &self.alike(cutoff_hz)) else { continue };
            let [DataSet { rows, torque, baseline, .. }, _] = &data_sets;
            let unexpected = Whitener::new(rows, torque, baseline).mean_log_scale();
            tracing::debug!(cutoff_hz, unexpected, "cut-off");
            if best.as_ref().is_none_or(|(least, _)| unexpected < *least) {
                best = Some((unexpected, Prepared { data_sets, cutoff_hz, passband }));
            }
        }
        best.map(|(_, prepared)| prepared)
    }

    /// The logs as their torque went through a low-pass before it was logged, if they show one. `cutoff_hz` is that of the positions
    /// under which it is looked for.
    fn through_passband(&self, cutoff_hz: f64) -> Result<Option<Prepared>> {
        let all: Vec<&Recording> = self.train.iter().chain(self.test).copied().collect();
        let Some(edge_hz) = passband::edge(&all)? else { return Ok(None) };
        let narrow = LowPass { order: 1, hz: passband::lowest(edge_hz) };
        let cutoffs_hz = self.alike(cutoff_hz);
        let Ok(DataSet { rows: Rows { valid, .. }, .. }) = self.training(Some(narrow), &cutoffs_hz) else {
            return Ok(None);
        };
        let left = |through| {
            // All are seen on the same rows.
            let DataSet { mut rows, torque, baseline, .. } = self.training(through, &cutoffs_hz).ok()?;
            rows.valid.clone_from(&valid);
            let rich = (0..rows.dof())
                .flat_map(|joint| rich(&rows, joint).into_iter().map(move |signal| Column::on(joint, signal)));
            let columns: Vec<Column> = baseline.into_iter().chain(rich).collect();
            Some(passband::left(&rows, &torque, &columns))
        };
        let clearly = self.criteria.search.share_of_misfit;
        Ok(passband::best(edge_hz, clearly, left).and_then(|found| self.best_of(Some(found))))
    }
}

/// A problem of the held-out logs, reported as theirs.
fn of_held_out(problem: Error) -> Error {
    match problem {
        Error::Request { subject, problem } => Error::request(format!("{subject} of the held-out logs"), problem),
        other => other,
    }
}
