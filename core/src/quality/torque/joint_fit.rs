//! A joint's own linear model, fitted to its torque alone.

use crate::channels::Channels;
use crate::linear::{OrthonormalBasis, length};
use crate::quality::motion::Constant;

/// A column of a model is left out where no more than this share of it is orthogonal to the others: it would fit noise.
const WEAK: f64 = 3e-5;

/// Fewest rows per column.
const ROWS_PER_COLUMN: usize = 4;

/// The column space of a joint's model over the samples at which its direction is certain.
pub(super) struct JointFit {
    rows: Vec<usize>,
    /// The basis of the columns.
    basis: OrthonormalBasis,
}

impl JointFit {
    /// The fit of the rows at samples that are `wanted`.
    pub(super) fn new(
        columns: &Channels,
        rows: &[usize],
        velocity: &[f64],
        band: f64,
        wanted: impl Fn(usize) -> bool,
    ) -> Option<JointFit> {
        let kept = (0..rows.len()).filter(|&row| velocity[row].abs() > band && wanted(rows[row]));
        let kept: Vec<usize> = kept.collect();
        if kept.len() < ROWS_PER_COLUMN * columns.channels() {
            return None;
        }
        let table: Vec<Vec<f64>> = columns.iter().map(|column| kept.iter().map(|&row| column[row]).collect()).collect();
        let basis = OrthonormalBasis::new(&table.iter().map(Vec::as_slice).collect::<Vec<_>>(), WEAK);
        Some(JointFit { rows: kept.iter().map(|&row| rows[row]).collect(), basis })
    }

    /// A torque at the samples, `lag` samples later.
    fn torque(&self, tau: &[f64], lag: isize) -> Vec<f64> {
        self.rows.iter().map(|&row| tau[row.saturating_add_signed(lag)]).collect()
    }

    /// Residual share of a torque, `lag` samples later, root mean square over root mean square.
    pub(super) fn unexplained(&self, tau: &[f64], lag: isize) -> f64 {
        let torque = self.torque(tau, lag);
        length(&self.basis.residual(&torque)) / length(&torque).max(f64::MIN_POSITIVE)
    }

    /// The constant that explains most of the residual of a torque; None where the model has one.
    pub(super) fn constant(&self, tau: &[f64]) -> Option<Constant> {
        let torque = self.torque(tau, 0);
        let own = self.basis.residual(&vec![1.0; torque.len()]);
        let square: f64 = own.iter().map(|own| own * own).sum();
        if square < WEAK * torque.len() as f64 {
            return None;
        }
        let left = self.basis.residual(&torque);
        let constant = left.iter().zip(&own).map(|(left, own)| left * own).sum::<f64>() / square;
        let beyond: Vec<f64> = left.iter().zip(&own).map(|(left, own)| left - constant * own).collect();
        Some(Constant { torque: constant, unexplained: length(&beyond) / length(&torque).max(f64::MIN_POSITIVE) })
    }
}
