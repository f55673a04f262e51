//! How far a joint is from its last reversal, where its friction builds up.

use crate::quality::view::View;

/// Distances after a reversal over which friction may build up, as shares of the range of a joint: what it does there is no dead time.
const BUILDS_UP: [f64; 3] = [0.002, 0.01, 0.05];

/// Share of the range of a joint behind a reversal over which its friction may still build up, as presliding does over some mrad: torques
/// whose friction comes late look late. A lag of the signals also shows beyond it.
const BUILT_UP: f64 = 0.05;

/// How far a joint has moved since its last reversal.
pub(super) struct SinceReversal {
    /// The distance at every sample, as a share of the joint's range.
    share: Vec<f64>,
    /// The direction of motion.
    direction: Vec<f64>,
}

impl SinceReversal {
    /// Of a joint of a log.
    pub(super) fn of(view: &View, joint: usize) -> SinceReversal {
        let (q, qd) = (view.q.channel(joint), view.qd.channel(joint));
        let [least, most] = q.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &q| [a.min(q), b.max(q)]);
        let range = (most - least).max(f64::MIN_POSITIVE);
        let mut reversal = q[0];
        let since = |sample: usize| {
            if sample > 0 && (qd[sample] > 0.0) != (qd[sample - 1] > 0.0) {
                reversal = q[sample];
            }
            (q[sample] - reversal).abs() / range
        };
        SinceReversal { share: (0..q.len()).map(since).collect(), direction: qd.iter().map(|v| v.signum()).collect() }
    }

    /// Whether friction is built up at a sample: so far from the last reversal that a lag there is none of it.
    pub(super) fn is_built_up(&self, sample: usize) -> bool {
        self.share[sample] > BUILT_UP
    }

    /// Direction of motion, decaying with the distance, at some samples: one column for each of [`BUILDS_UP`]. Friction that builds up
    /// after reversals, and gears that yield to it, are spanned by these.
    pub(super) fn decaying(&self, rows: &[usize]) -> Vec<Vec<f64>> {
        let at = |row: usize, over: f64| self.direction[row] * (-self.share[row] / over).exp();
        BUILDS_UP.map(|over| rows.iter().map(|&row| at(row, over)).collect()).into()
    }
}
