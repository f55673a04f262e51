//! Differences of torque from that before a change, at equal states.
//!
//! Where the logs after the change pass states that the reference logs pass too, residuals of the arm as fitted to the reference logs
//! are subtracted at these. What the model lacks in both, and what friction or cables do at a place, cancels; what the states differ by
//! is in the model. The differences have no baseline: they are the change, noise, and the little of the lacking model by which
//! states differ. Their noise is that of two rows.

use crate::diagnosis::logs::Rows;
use crate::diagnosis::model::{DataSet, Nuisances, PreparedLogs, Session};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::Column;
use crate::error::Result;
use crate::identification::equal_states::{EqualState, matched};
use std::ops::Range;

/// Some logs after a change, and some before it.
struct Pair<'a> {
    after: (&'a DataSet, Range<usize>),
    before: (&'a DataSet, Range<usize>),
    /// Rows of equal states, for every log after the change.
    equal: Vec<Vec<EqualState>>,
}

impl Session<'_> {
    /// Takes differences at equal states in place of torque, where enough rows of the training and of the held-out logs have an
    /// equal state in the reference logs. `whitener` holds the noise of the training logs.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn take_differences(&mut self, whitener: &Whitener) -> Result<()> {
        let train = &self.logs.train;
        let (before, all, tested) = (train.rows.before, train.rows.logs.len(), self.logs.test.rows.logs.len());
        if before == 0 {
            return Ok(());
        }
        // Reference logs of their own keep the noise of training and held-out differences independent.
        let apart = [0..before.div_ceil(2), before.div_ceil(2)..before];
        let choices = [apart, [0..before, 0..before]];
        // With fewer the differences see only a part of the motion.
        let most = self.criteria.levels.most;
        let pairs =
            choices.into_iter().filter(|choice| choice.iter().all(|logs| !logs.is_empty())).find_map(|[own, other]| {
                let train_pair = Pair::new((train, before..all), (train, own));
                let test_pair = Pair::new((&self.logs.test, 0..tested), (train, other));
                let shares = [train_pair.share(), test_pair.share()];
                tracing::debug!(?shares, "rows of equal states");
                shares.iter().all(|share| *share >= most).then_some(([train_pair, test_pair], shares))
            });
        let Some((pairs, shares)) = pairs else { return Ok(()) };
        let arm = self.baseline_before(whitener);
        let [mut train, mut test] = pairs.map(|pair| pair.differences(&arm));
        [train.rows.equal_states, test.rows.equal_states] = shares.map(Some);
        let (apart, passband, cutoffs_hz) = (self.logs.apart, self.logs.passband, self.logs.cutoffs_hz.clone());
        self.go_on_with(PreparedLogs { train, test, bands: 0..0, apart, cutoffs_hz, passband });
        // Without a baseline no parameters of it are open.
        self.renew_errors(&[], Nuisances::default())
    }
}

impl<'a> Pair<'a> {
    fn new(after: (&'a DataSet, Range<usize>), before: (&'a DataSet, Range<usize>)) -> Self {
        let states =
            |(set, logs): &(&DataSet, Range<usize>)| logs.clone().map(|log| set.rows.states(log)).collect::<Vec<_>>();
        let (now, then) = (states(&after), states(&before));
        let equal = matched(&then.iter().collect::<Vec<_>>(), &now.iter().collect::<Vec<_>>());
        Pair { after, before, equal }
    }

    /// Rows after the change, counted in their data set, with those before it of equal state.
    fn rows(&self) -> impl Iterator<Item = (usize, Option<usize>)> + '_ {
        let ((after, logs), (before, reference)) = (&self.after, &self.before);
        let first = after.rows.starts[logs.start];
        self.equal.iter().flatten().enumerate().map(move |(row, equal)| {
            let there = equal.map(|(log, row)| before.rows.starts[reference.start + log] + row);
            (first + row, there)
        })
    }

    /// Whether both rows count on a joint.
    fn counts(&self, joint: usize, (row, there): (usize, Option<usize>)) -> bool {
        self.after.0.rows.valid[joint][row] && there.is_some_and(|there| self.before.0.rows.valid[joint][there])
    }

    /// Share of the rows after the change that count and have an equal state before it.
    fn share(&self) -> f64 {
        let (mut with, mut all) = (0usize, 0usize);
        for joint in 0..self.after.0.rows.dof() {
            for (row, there) in self.rows() {
                all += usize::from(self.after.0.rows.valid[joint][row]);
                with += usize::from(self.counts(joint, (row, there)));
            }
        }
        with as f64 / all.max(1) as f64
    }

    /// Residuals of the baseline with the values of `arm`, less those before the change.
    fn differences(&self, arm: &[f64]) -> DataSet {
        let ((after, logs), (before, _)) = (&self.after, &self.before);
        let [now, then] = [after, before].map(|set| set.residual(&set.baseline, arm));
        let mut rows: Rows = after.rows.of_logs(logs.clone());
        let range = after.rows.starts[logs.start]..after.rows.starts[logs.end];
        let difference = |joint: usize| {
            let (now, then) = (now.part(joint)?, then.part(joint)?);
            let at = |(row, there): (usize, Option<usize>)| there.map_or(0.0, |there| now[row] - then[there]);
            Some((joint, self.rows().map(at).collect()))
        };
        let torque = Column::of((0..rows.dof()).filter_map(difference).collect());
        for joint in 0..rows.dof() {
            rows.valid[joint] = self.rows().map(|row| self.counts(joint, row)).collect();
        }
        let bands = after.bands.iter().map(|band| band.rows(range.clone())).collect();
        DataSet {
            rows,
            torque,
            bands,
            baseline: Vec::new(),
            known: 0,
            training: after.training,
            effects: Default::default(),
        }
    }
}
