//! How much of the gap between the residual of one model and the noise another one closes, with its uncertainty.

use crate::diagnosis::regression::Column;
use crate::random;
use rand::RngExt;

/// Rows in a block that is drawn as a whole (one second): residuals further apart count as independent.
const BLOCK: usize = 50;

/// Draws of the bootstrap.
const DRAWS: u64 = 1000;

/// Mean square, in units of the noise, by which a model must change the torque of a joint to count there. It chooses the joints of this
/// figure; no finding depends on it.
const CHANGES: f64 = 0.1;

/// A share with its 95 % interval.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // The ripple closes the gap between the baseline and the noise on the held-out log.
/// let share = diagnosis.errors.gap_closed;
/// assert!(share.interval[0] <= share.value && share.value <= share.interval[1]);
/// assert!(share.value > 0.95);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Share {
    /// The estimate.
    pub value: f64,
    /// The interval that holds it in 95 % of cases.
    pub interval: [f64; 2],
}

/// Sums of squares of blocks of the rows, in units of the noise, before and after, with the number of rows in them.
struct Blocks(Vec<[f64; 3]>);

impl Blocks {
    fn new(values: impl Iterator<Item = (usize, f64, f64)>) -> Self {
        let mut sums: Vec<[f64; 3]> = Vec::new();
        for (row, before, after) in values {
            let block = row / BLOCK;
            sums.resize(sums.len().max(block + 1), [0.0; 3]);
            let sum = &mut sums[block];
            sum[0] += before * before;
            sum[1] += after * after;
            sum[2] += 1.0;
        }
        sums.retain(|sum| sum[2] > 0.0);
        Blocks(sums)
    }

    /// A statistic of the sums of all blocks, with the percentiles of its bootstrap.
    fn share(&self, seed: u64, of: impl Fn([f64; 3]) -> f64) -> Share {
        let total = |places: &mut dyn Iterator<Item = usize>| {
            places.fold([0.0; 3], |sum, k| std::array::from_fn(|i| sum[i] + self.0[k][i]))
        };
        let count = self.0.len();
        let value = of(total(&mut (0..count)));
        if count < 2 {
            return Share { value, interval: [value, value] };
        }
        let mut draws: Vec<f64> = (0..DRAWS)
            .map(|draw| {
                let mut source = random::stream(seed, "stretches of a gap", draw);
                of(total(&mut (0..count).map(|_| source.random_range(0..count))))
            })
            .collect();
        draws.sort_by(f64::total_cmp);
        let at = |share: f64| draws[((DRAWS - 1) as f64 * share).round() as usize];
        Share { value, interval: [at(0.025), at(0.975)] }
    }
}

/// Residuals of the held-out rows before and after, `valid` where they count (`[joint][row]`), and the noise of each joint.
#[derive(Debug, Clone, Copy)]
pub(in crate::diagnosis::answer) struct Residuals<'a> {
    /// Residual of the one model.
    pub before: &'a Column,
    /// Residual of the other one.
    pub after: &'a Column,
    /// Valid rows.
    pub valid: &'a [Vec<bool>],
    /// Standard deviation of the noise, N m.
    pub noise: &'a [f64],
}

impl Residuals<'_> {
    /// Values of a joint over its noise: row, before, after.
    fn of(&self, joint: usize) -> Vec<(usize, f64, f64)> {
        let value = |column: &Column, row: usize| column.part(joint).map_or(0.0, |part| part[row] / self.noise[joint]);
        let valid = &self.valid[joint];
        let rows = (0..valid.len()).filter(|&row| valid[row]);
        rows.map(|row| (row, value(self.before, row), value(self.after, row))).collect()
    }

    /// Share of the excess over the noise that is closed: 1 - (after - noise) / (before - noise) in sums of squares, over the
    /// joints in `amiss` and those on which the models differ; zero where there is no excess.
    pub(crate) fn gap_closed(&self, amiss: &[usize], seed: u64) -> Share {
        let mut sums = Blocks(Vec::new());
        for joint in 0..self.valid.len() {
            let rows = self.of(joint);
            let changed: f64 = rows.iter().map(|(_, before, after)| (before - after).powi(2)).sum();
            // The scatter of the noise of joints that have nothing to do with it would drown a small gap.
            if changed > CHANGES * rows.len() as f64 || amiss.contains(&joint) {
                sums.0.extend(Blocks::new(rows.into_iter()).0);
            }
        }
        sums.share(
            seed,
            |[before, after, rows]| {
                if before <= rows { 0.0 } else { (1.0 - (after - rows) / (before - rows)).clamp(-1.0, 1.0) }
            },
        )
    }

    /// Share of the sum of squares that is gained, the joints weighted by their noise: 1 - after / before.
    pub(crate) fn gain(&self, seed: u64) -> Share {
        let joints = 0..self.valid.len();
        let sums = Blocks(joints.flat_map(|joint| Blocks::new(self.of(joint).into_iter()).0).collect());
        sums.share(seed, |[before, after, _]| if before > 0.0 { 1.0 - after / before } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    /// Noise on two joints with waves of sizes on the first.
    fn column(noise: &[f64], size: f64) -> Column {
        let wave = |k: usize| size * (0.01 * k as f64).sin();
        let first = noise.iter().enumerate().map(|(k, n)| n + wave(k)).collect();
        Column::new([first, noise.to_vec()])
    }

    fn noise() -> Vec<f64> {
        let mut source = random::stream(1, "gap", 0);
        (0..5000).map(|_| 2.0 * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut source)).collect()
    }

    #[test]
    fn half_the_excess_is_half_the_gap() {
        let noise = noise();
        let valid = vec![vec![true; 5000]; 2];
        let closed = |after: f64, amiss: &[usize]| {
            let (before, after) = (column(&noise, 10.0), column(&noise, after));
            let residuals = Residuals { before: &before, after: &after, valid: &valid, noise: &[2.0, 2.0] };
            residuals.gap_closed(amiss, 3)
        };
        // Excess in squares: 50 before, 25 after.
        let half = closed(50f64.sqrt(), &[]);
        assert!((half.value - 0.5).abs() < 0.03, "{half:?}");
        assert!(half.interval[0] < 0.5 && half.interval[1] > 0.5 && half.interval[1] - half.interval[0] < 0.1);
        assert!(closed(0.0, &[]).value > 0.97);
    }

    #[test]
    fn a_joint_counts_where_models_differ_or_something_is_left() {
        let noise = noise();
        let valid = vec![vec![true; 5000]; 2];
        let (before, after) = (column(&noise, 10.0), column(&noise, 0.0));
        // The noise of the second joint is taken for half of what it is: four times its variance is an excess.
        let residuals = Residuals { before: &before, after: &after, valid: &valid, noise: &[2.0, 1.0] };
        assert!(residuals.gap_closed(&[], 3).value > 0.97);
        let with_second = 1.0 - 3.0 / (12.5 + 3.0);
        assert!((residuals.gap_closed(&[1], 3).value - with_second).abs() < 0.03);
    }

    #[test]
    fn the_gain_is_the_share_of_the_sum_of_squares() {
        let noise = noise();
        let valid = [vec![true; 5000], vec![false; 5000]];
        let (before, after) = (column(&noise, 10.0), column(&noise, 0.0));
        let all = Residuals { before: &before, after: &after, valid: &valid, noise: &[2.0, 2.0] }.gain(3);
        assert!((all.value - (1.0 - 4.0 / 54.0)).abs() < 0.02, "{all:?}");
    }
}
