//! How much of the gap between what one model leaves and the noise another one closes, with its uncertainty.

use super::column::Column;
use crate::random;
use rand::RngExt;

/// Rows in a stretch that is drawn as a whole (one second): residuals further apart count as independent.
const STRETCH: usize = 50;

/// Draws of the bootstrap.
const DRAWS: u64 = 1000;

/// A share with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Share {
    /// The estimate.
    pub value: f64,
    /// The interval that holds it in 95 % of cases.
    pub interval: [f64; 2],
}

/// Sums of squares of stretches of the rows, in units of the noise, before and after, with the number of rows in them.
struct Stretches(Vec<[f64; 3]>);

impl Stretches {
    fn new(before: &Column, after: &Column, valid: &[Vec<bool>], noise: &[f64]) -> Self {
        let rows = valid.first().map_or(0, Vec::len);
        let mut sums = vec![[0.0; 3]; rows.div_ceil(STRETCH)];
        for (joint, valid) in valid.iter().enumerate() {
            let value = |column: &Column, row: usize| column.part(joint).map_or(0.0, |part| part[row] / noise[joint]);
            for row in (0..rows).filter(|&row| valid[row]) {
                let sum = &mut sums[row / STRETCH];
                sum[0] += value(before, row).powi(2);
                sum[1] += value(after, row).powi(2);
                sum[2] += 1.0;
            }
        }
        sums.retain(|sum| sum[2] > 0.0);
        Stretches(sums)
    }

    /// A statistic of the sums of all stretches, with the percentiles of its bootstrap.
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

/// Share of the excess over the noise that is closed: 1 - (after - noise) / (before - noise) in sums of squares, the joints
/// weighted by their noise; zero where there is no excess.
pub fn gap_closed(before: &Column, after: &Column, valid: &[Vec<bool>], noise: &[f64], seed: u64) -> Share {
    Stretches::new(before, after, valid, noise).share(seed, |[before, after, rows]| {
        if before <= rows { 0.0 } else { (1.0 - (after - rows) / (before - rows)).clamp(-1.0, 1.0) }
    })
}

/// Share of the sum of squares that is gained: 1 - after / before.
pub fn gain(before: &Column, after: &Column, valid: &[Vec<bool>], noise: &[f64], seed: u64) -> Share {
    Stretches::new(before, after, valid, noise)
        .share(seed, |[before, after, _]| if before > 0.0 { 1.0 - after / before } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn half_the_excess_is_half_the_gap() {
        let mut source = random::stream(1, "gap", 0);
        let noise: Vec<f64> = (0..5000)
            .map(|_| 2.0 * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut source))
            .collect();
        let with = |size: f64| {
            let wave = |k: usize| size * (0.01 * k as f64).sin();
            Column::on(0, noise.iter().enumerate().map(|(k, n)| n + wave(k)).collect())
        };
        let valid = [vec![true; 5000]];
        // Excess in squares: 50 before, 25 after.
        let closed = gap_closed(&with(10.0), &with(50f64.sqrt()), &valid, &[2.0], 3);
        assert!((closed.value - 0.5).abs() < 0.03, "{closed:?}");
        assert!(closed.interval[0] < 0.5 && closed.interval[1] > 0.5 && closed.interval[1] - closed.interval[0] < 0.1);
        assert!(gap_closed(&with(10.0), &with(0.0), &valid, &[2.0], 3).value > 0.97);
        let all = gain(&with(10.0), &with(0.0), &valid, &[2.0], 3);
        assert!((all.value - (1.0 - 4.0 / 54.0)).abs() < 0.02, "{all:?}");
    }
}
