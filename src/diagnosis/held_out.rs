//! What an effect takes away on rows that it was not fitted to, with its chance.

use super::column::Column;
use super::stretches::{STRETCH, best_stretch, row_by_row};
use super::whitening::Whitener;

/// Standard deviations by which a held-out gain must exceed zero: the level of false alarms is that of the test on the
/// training logs, and the held-out logs, often fewer, must not contradict it.
const SURELY: f64 = 1.0;

/// Factor on the chance that noise alone makes up to which nothing else need be in the residual.
const CALM: f64 = 1.5;

/// What is gained of the whitened sum of squares on the joints that an effect acts on.
///
/// With a the residual after and p what the effect predicts, the gain is the sum of p^2 + 2 a p. Only the second part is
/// chance: its scatter is taken over stretches of the rows, within which neither is independent of its past.
#[derive(Debug)]
pub struct Gains {
    /// Gain in each row of the logs.
    of_rows: Vec<f64>,
    /// Standard deviation of their sum.
    std: f64,
    /// The same were the residual after white.
    expected_std: f64,
    /// Sum of squares before.
    before: f64,
}

impl Gains {
    /// From residuals before and after over `rows` rows of the logs.
    pub fn new(unseen: &Whitener, before: &Column, after: &Column, joints: &[usize], rows: usize) -> Self {
        let [before, after] = [before, after].map(|residual| unseen.apply(&residual.only(joints)));
        let mut of_rows = vec![0.0; rows];
        let mut chance = vec![0.0; rows / STRETCH + 1];
        let mut predicted = 0.0;
        for (place, b, a) in row_by_row(unseen, &before, &after) {
            of_rows[place] += b * b - a * a;
            chance[place / STRETCH] += 2.0 * a * (b - a);
            predicted += (b - a).powi(2);
        }
        let std = chance.iter().map(|sum| sum * sum).sum::<f64>().sqrt();
        let expected_std = 2.0 * predicted.sqrt();
        Gains { of_rows, std, expected_std, before: before.dot(&before).max(f64::MIN_POSITIVE) }
    }

    /// The share of the sum of squares that is gained.
    pub fn share(&self) -> f64 {
        self.of_rows.iter().sum::<f64>() / self.before
    }

    /// Lower bound, by one standard deviation (84 %), of the share of the sum of squares that is gained.
    pub fn lower_bound(&self) -> f64 {
        self.share() - SURELY * self.std / self.before
    }

    /// Whether the chance in the gain is that of the noise: the residual holds little else.
    pub fn is_calm(&self) -> bool {
        self.std < CALM * self.expected_std
    }

    /// The share that is gained outside the stretch that gains most.
    pub fn without_best_stretch(&self) -> f64 {
        let best: f64 = self.of_rows[best_stretch(&self.of_rows, STRETCH)].iter().sum();
        self.share() - best / self.before
    }
}
