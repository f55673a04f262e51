//! Errors in variables: the torque that errors of the positions give every joint, as nuisance regressors of the tests.

use super::roles::{is_level, is_shift};
use crate::diagnosis::logs::{Log, Rows};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection};
use crate::effects::{Nature, Placed};
use crate::error::Result;
use crate::identification::effect_model::Arm;
use crate::signal::ZeroPhaseLowPass;
use std::f64::consts::TAU;

/// Standard deviation of the torque constant of a drive over what is taken for it: catalogues give motors' torque constants to 10 %, and
/// gears lose as much more.
const GAIN_SPREAD: f64 = 0.15;

/// Columns of the errors of one data set, for the arm as found. None before anything was fitted.
#[derive(Debug, Clone, Default)]
pub(crate) struct ErrorsInVariables {
    /// The error of the smoothing, on each joint: what smoothing once more does, as seen through the first ("twicing", Tukey 1977).
    pub smoothing: Vec<Column>,
    /// What the positions hold above the cut-off, on each joint; none where they are smoothed no more than their noise requires.
    pub beyond: Vec<Column>,
    /// The second derivative of the torque, on each joint: what shifts or spreads torque in time holds it, and the noise of the
    /// encoders is in it always the same way as in the torque (errors in variables: Fuller, Measurement Error Models, 1987).
    pub bend: Vec<Column>,
    /// The torque of loads that were found, on each joint: drives show it with gains of their own, so that one load leaves a share of
    /// its torque on every joint.
    pub loads: Vec<Column>,
    /// Torque of errors of the fitted parameters that change what the model predicts here by more than the noise: training logs that excite
    /// a direction too little leave it open, and held-out logs show it.
    pub parameters: Nuisances,
    /// Standard deviation of the factor of `bend`, s2: noise near the lowest cut-off of the positions is in the torque and, more by the
    /// square of the angular frequency, in its second derivative.
    bend_spread: f64,
}

/// Nuisance regressors, with the prior standard deviation of their factors about zero; infinite where nothing is known.
#[derive(Debug, Clone, Default)]
pub(crate) struct Nuisances {
    columns: Vec<Column>,
    spread: Vec<f64>,
}

impl ErrorsInVariables {
    /// Along the motion of `rows`, of an arm that carries loads with the torque `loads`; `parameters` are errors of the fit that matter
    /// there.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn new(arm: &Arm, rows: &Rows, loads: Column, parameters: Nuisances) -> Result<Self> {
        let along = arm.along(rows);
        let cutoffs_hz = rows.logs.iter().flat_map(|log| &log.low_pass).map(ZeroPhaseLowPass::cutoff_hz);
        let lowest_hz = cutoffs_hz.fold(f64::INFINITY, f64::min);
        let is_smoother = rows.logs.iter().any(|log| log.whole.is_some());
        let whole = |_, log: &Log| Ok(log.whole.as_ref().unwrap_or(&log.motion).clone());
        Ok(ErrorsInVariables {
            smoothing: of_joints(arm.departure(rows, &along, |_, log| log.smoothed_again())?),
            beyond: if is_smoother { of_joints(arm.departure(rows, &along, whole)?) } else { Vec::new() },
            bend: of_joints(arm.bend(rows)?),
            loads: of_joints(loads),
            parameters,
            bend_spread: (TAU * lowest_hz).powi(-2),
        })
    }

    /// All of them, their factors free.
    pub(crate) fn all(&self) -> Nuisances {
        let mut all = Nuisances::default();
        [&self.smoothing, &self.beyond, &self.bend].into_iter().for_each(|columns| all.add(columns, f64::INFINITY));
        all.extend(&self.parameters);
        all
    }

    /// Those that a test of an effect along `rows` is adjusted for: none for torque saturation, since the smoothing errs there too; not the
    /// second derivative of the torque for an elastic gear, whose column that is; for friction that builds up after reversals also what is
    /// the same at each of them, since a sticking joint looks like it through smoothed positions.
    ///
    /// The smoothing errs about as much as smoothing once more does, and what is not smooth is at most all there, so that where these are
    /// small they take nothing of what is tested. For an effect that shifts torque in time their factors are free: its column holds the
    /// noise of the encoders itself.
    pub(crate) fn of_effect(&self, placed: &Placed, rows: &Rows) -> Nuisances {
        let mut nuisances = Nuisances::default();
        if is_level(placed.effect) {
            return nuisances;
        }
        let (error, bend) =
            if is_shift(placed.effect) { (f64::INFINITY, f64::INFINITY) } else { (1.0, self.bend_spread) };
        nuisances.add(&self.smoothing, error);
        nuisances.add(&self.beyond, error);
        nuisances.extend(&self.parameters);
        if !placed.effect.is_load() {
            nuisances.add(&self.loads, GAIN_SPREAD);
        }
        if placed.effect.gear(&placed.parameters).is_none() {
            nuisances.add(&self.bend, bend);
        }
        if placed.effect.about().nature == Nature::AfterReversals {
            nuisances.add(&at_reversals(rows, placed.joint), f64::INFINITY);
        }
        nuisances
    }
}

impl Nuisances {
    /// Adds columns of one spread.
    pub(crate) fn add(&mut self, columns: &[Column], spread: f64) {
        self.columns.extend_from_slice(columns);
        self.spread.resize(self.columns.len(), spread);
    }

    /// Adds all of another's.
    pub(crate) fn extend(&mut self, others: &Nuisances) {
        self.columns.extend_from_slice(&others.columns);
        self.spread.extend_from_slice(&others.spread);
    }

    /// The columns alone.
    pub(crate) fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Their prior standard deviations.
    pub(crate) fn spread(&self) -> &[f64] {
        &self.spread
    }

    /// The same on some joints only.
    pub(crate) fn only(&self, joints: &[usize]) -> Self {
        let columns = self.columns.iter().map(|column| column.only(joints));
        Nuisances { columns: columns.collect(), spread: self.spread.clone() }
    }

    /// A fit in the units of `whitener`, adjusted for these.
    pub(crate) fn adjust(&self, fit: &Projection, whitener: &Whitener) -> Projection {
        fit.with_prior(&whitener.apply_all(&self.columns), &self.spread)
    }
}

/// For every row near a reversal, within the smear of the smoothing, a column that is one there after each reversal upwards and minus one
/// after each downwards.
fn at_reversals(rows: &Rows, joint: usize) -> Vec<Column> {
    let smear = rows.smear[joint];
    let mut columns = vec![vec![0.0; rows.len()]; 2 * smear + 1];
    for (log, ends) in rows.logs.iter().zip(rows.starts.windows(2)) {
        let speed = log.motion.qd.channel(joint);
        let turns = speed.windows(2).enumerate().filter(|(_, pair)| pair[0].signum() != pair[1].signum());
        for (sample, pair) in turns {
            let row = ends[0] + sample / log.block;
            for (lag, column) in columns.iter_mut().enumerate() {
                if let Some(at) = (row + lag).checked_sub(smear).filter(|at| (ends[0]..ends[1]).contains(at)) {
                    column[at] += pair[1].signum();
                }
            }
        }
    }
    columns.into_iter().map(|column| Column::on(joint, column)).collect()
}

fn of_joints(column: Column) -> Vec<Column> {
    column.parts.into_iter().map(|(joint, signal)| Column::on(joint, signal)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::diagnosis::logs::FEWEST_ROWS;
    use crate::effects::find;
    use crate::recording::Recording;

    fn swinging() -> Rows {
        let time: Vec<f64> = (0..10_000).map(|k| f64::from(k) / 500.0).collect();
        let swing = |t: &f64| (std::f64::consts::TAU * 0.4 * t).sin();
        let q = Channels::from_vectors(&[time.iter().map(swing).collect()]);
        let tau = Channels::zeros(1, time.len());
        let log = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        Rows::new(&[&log], 5.0, FEWEST_ROWS).unwrap()
    }

    #[test]
    fn gains_of_drives_are_nuisances_of_all_effects_but_loads() {
        let errors = ErrorsInVariables { loads: vec![Column::on(0, vec![1.0])], ..Default::default() };
        let of = |name: &str| errors.of_effect(&Placed::typical(find(name).unwrap(), 0), &swinging());
        assert_eq!(of("joint_spring").spread(), [GAIN_SPREAD]);
        assert!(of("payload").spread().is_empty());
    }

    #[test]
    fn reversals_are_counted_by_their_direction() {
        let columns = at_reversals(&swinging(), 0);
        // Half a period of 5 Hz is five rows of 20 ms to either side. It turns downwards at 0.625 s and upwards at 1.875 s.
        let at = |lag: usize, row: usize| columns[lag].part(0).unwrap()[row];
        assert_eq!(columns.len(), 11);
        assert_eq!([at(5, 31), at(0, 26), at(10, 36), at(5, 93), at(5, 60)], [-1.0, -1.0, -1.0, 1.0, 0.0]);
    }
}
