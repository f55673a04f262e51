//! Sums and recursions along signals, in lanes.

use crate::channels::Channels;
use crate::lane::{Kernel, Lane, Lanes};

/// Rows of lanes side by side, so that one sum does not wait for itself.
const TOGETHER: usize = 4;

/// Sum of the columns of a table `[column][row]`, each times its weight.
///
/// # Panics
/// If there is not one weight per column.
pub(crate) fn combined(table: &Channels, weights: &[f64]) -> Vec<f64> {
    combined_in(Lanes::best(), table, weights)
}

fn combined_in(lanes: Lanes, table: &Channels, weights: &[f64]) -> Vec<f64> {
    assert_eq!(weights.len(), table.channels(), "one weight per column is wanted");
    let mut out = vec![0.0; table.samples()];
    lanes.run(Combined { table: table.as_slice(), weights, out: &mut out });
    out
}

/// [`combined`] of a table as long as `out` in every column, written there.
///
/// # Panics
/// If the table has another size.
pub(crate) fn combine_into(table: &[f64], weights: &[f64], out: &mut [f64]) {
    assert_eq!(table.len(), weights.len() * out.len(), "one weight per column is wanted");
    Lanes::best().run(Combined { table, weights, out });
}

struct Combined<'a> {
    table: &'a [f64],
    weights: &'a [f64],
    out: &'a mut [f64],
}

impl Kernel for Combined<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let rows = self.out.len();
        let table = self.table;
        let mut row = 0;
        while row + TOGETHER * L::WIDTH <= rows {
            let mut sums = [L::splat(0.0); TOGETHER];
            for (column, &weight) in self.weights.iter().enumerate() {
                let part = &table[column * rows + row..][..TOGETHER * L::WIDTH];
                let weight = L::splat(weight);
                for (k, sum) in sums.iter_mut().enumerate() {
                    *sum = L::load(&part[k * L::WIDTH..]).mul_add(weight, *sum);
                }
            }
            for (k, sum) in sums.into_iter().enumerate() {
                sum.store(&mut self.out[row + k * L::WIDTH..]);
            }
            row += TOGETHER * L::WIDTH;
        }
        while row < rows {
            let end = rows.min(row + L::WIDTH);
            let mut sum = L::splat(0.0);
            for (column, &weight) in self.weights.iter().enumerate() {
                sum = L::load_part(&table[column * rows + row..column * rows + end]).mul_add(L::splat(weight), sum);
            }
            sum.store_part(&mut self.out[row..end]);
            row = end;
        }
    }
}

/// Sums of products of a signal with itself shifted by 0..=`most` samples.
pub(crate) fn lagged_products(signal: &[f64], most: usize) -> Vec<f64> {
    Lanes::best().run(Lagged { signal, most })
}

struct Lagged<'a> {
    signal: &'a [f64],
    most: usize,
}

impl Kernel for Lagged<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Vec<f64> {
        let mut out = vec![0.0; self.most + 1];
        for (lag, out) in out.iter_mut().enumerate() {
            let later = &self.signal[lag.min(self.signal.len())..];
            let count = later.len();
            let first = &self.signal[..count];
            let mut sums = [L::splat(0.0); TOGETHER];
            let mut t = 0;
            while t + TOGETHER * L::WIDTH <= count {
                for (k, sum) in sums.iter_mut().enumerate() {
                    let place = t + k * L::WIDTH;
                    *sum = L::load(&first[place..]).mul_add(L::load(&later[place..]), *sum);
                }
                t += TOGETHER * L::WIDTH;
            }
            while t < count {
                sums[0] = L::load_part(&first[t..]).mul_add(L::load_part(&later[t..]), sums[0]);
                t += L::WIDTH;
            }
            *out = ((sums[0] + sums[1]) + (sums[2] + sums[3])).sum();
        }
        out
    }
}

/// Runs y(t) = gain x(t) + sum_k coefficients_k y(t + k + 1) backward through every signal of a table, several signals side
/// by side.
pub(crate) fn recur_backward(table: &mut Channels, gain: f64, coefficients: &[f64]) {
    recur_backward_in(Lanes::best(), table, gain, coefficients);
}

fn recur_backward_in(lanes: Lanes, table: &mut Channels, gain: f64, coefficients: &[f64]) {
    let samples = table.samples();
    if samples > 0 {
        lanes.run(Recursion { table: table.as_mut_slice(), samples, gain, coefficients });
    }
}

struct Recursion<'a> {
    table: &'a mut [f64],
    samples: usize,
    gain: f64,
    coefficients: &'a [f64],
}

/// Samples between two changes from signals one after the other to signals side by side.
const SECTION: usize = 256;

impl Kernel for Recursion<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let (samples, order) = (self.samples, self.coefficients.len());
        // Side by side, `[sample][signal]`: a section, and behind it what came out of the section after it.
        let mut rows = vec![0.0; (SECTION + order) * L::WIDTH];
        for signals in self.table.chunks_mut(samples * L::WIDTH) {
            let count = signals.len() / samples;
            rows.fill(0.0);
            let mut end = samples;
            while end > 0 {
                let start = end.saturating_sub(SECTION);
                let length = end - start;
                for (k, signal) in signals.chunks_exact(samples).enumerate() {
                    for (row, &x) in signal[start..end].iter().enumerate() {
                        rows[row * L::WIDTH + k] = x;
                    }
                }
                for t in (0..length).rev() {
                    let mut even = L::load(&rows[t * L::WIDTH..]) * L::splat(self.gain);
                    let mut odd = L::splat(0.0);
                    for (k, &a) in self.coefficients.iter().enumerate() {
                        let later = L::load(&rows[(t + k + 1) * L::WIDTH..]);
                        if k % 2 == 0 {
                            even = later.mul_add(L::splat(a), even);
                        } else {
                            odd = later.mul_add(L::splat(a), odd);
                        }
                    }
                    (even + odd).store(&mut rows[t * L::WIDTH..]);
                }
                for k in 0..count {
                    for (row, y) in signals[k * samples + start..k * samples + end].iter_mut().enumerate() {
                        *y = rows[row * L::WIDTH + k];
                    }
                }
                // The next section is a full one or the first of the signal; what it needs follows it at once.
                let next = start.min(SECTION);
                rows.copy_within(0..order * L::WIDTH, next * L::WIDTH);
                end = start;
            }
        }
    }
}

/// y(t) = gain x(t) + sum_k coefficients_k y(t - k - 1), one law for every signal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Law<'a> {
    /// Factor of what comes in.
    pub gain: f64,
    /// Factors of what came out before, the latest first.
    pub coefficients: &'a [f64],
}

/// Runs every signal of a table forward through its law, several signals side by side.
///
/// # Panics
/// If there is not one law per signal.
pub(crate) fn recur_forward(table: &mut Channels, laws: &[Law]) {
    recur_forward_in(Lanes::best(), table, laws);
}

fn recur_forward_in(lanes: Lanes, table: &mut Channels, laws: &[Law]) {
    assert_eq!(laws.len(), table.channels(), "one law per signal is wanted");
    let samples = table.samples();
    if samples > 0 {
        lanes.run(Forward { table: table.as_mut_slice(), samples, laws });
    }
}

struct Forward<'a> {
    table: &'a mut [f64],
    samples: usize,
    laws: &'a [Law<'a>],
}

impl Kernel for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let Forward { table, samples, laws } = self;
        let order = laws.iter().map(|law| law.coefficients.len()).max().unwrap_or(0);
        // Side by side, `[sample][signal]`: what came out before a section, and behind it the section.
        let mut rows = vec![0.0; (order + SECTION) * L::WIDTH];
        let mut weights = vec![0.0; (order + 1) * L::WIDTH];
        for (signals, laws) in table.chunks_mut(samples * L::WIDTH).zip(laws.chunks(L::WIDTH)) {
            rows.fill(0.0);
            weights.fill(0.0);
            for (lane, law) in laws.iter().enumerate() {
                weights[lane] = law.gain;
                for (k, &a) in law.coefficients.iter().enumerate() {
                    weights[(k + 1) * L::WIDTH + lane] = a;
                }
            }
            let gain = L::load(&weights);
            let mut start = 0;
            while start < samples {
                let end = samples.min(start + SECTION);
                for (lane, signal) in signals.chunks_exact(samples).enumerate() {
                    for (row, &x) in signal[start..end].iter().enumerate() {
                        rows[(order + row) * L::WIDTH + lane] = x;
                    }
                }
                for t in order..order + end - start {
                    let mut even = L::load(&rows[t * L::WIDTH..]) * gain;
                    let mut odd = L::splat(0.0);
                    for k in 0..order {
                        let before = L::load(&rows[(t - k - 1) * L::WIDTH..]);
                        let weight = L::load(&weights[(k + 1) * L::WIDTH..]);
                        if k % 2 == 0 {
                            odd = before.mul_add(weight, odd);
                        } else {
                            even = before.mul_add(weight, even);
                        }
                    }
                    (even + odd).store(&mut rows[t * L::WIDTH..]);
                }
                for (lane, signal) in signals.chunks_exact_mut(samples).enumerate() {
                    for (row, y) in signal[start..end].iter_mut().enumerate() {
                        *y = rows[(order + row) * L::WIDTH + lane];
                    }
                }
                let done = end - start;
                rows.copy_within(done * L::WIDTH..(done + order) * L::WIDTH, 0);
                start = end;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    fn table(channels: usize, samples: usize) -> Channels {
        let mut source = random::stream(samples as u64, "table", channels as u64);
        let mut table = Channels::zeros(channels, samples);
        table.as_mut_slice().fill_with(|| source.random_range(-1.0..1.0));
        table
    }

    #[test]
    fn combinations_and_lags_are_plain_sums() {
        for (channels, samples) in [(0, 7), (1, 1), (3, 40), (17, 333), (46, 1001)] {
            let table = table(channels, samples);
            let weights: Vec<f64> = (0..channels).map(|k| (k as f64).cos()).collect();
            for lanes in Lanes::available() {
                for (t, value) in combined_in(lanes, &table, &weights).into_iter().enumerate() {
                    let plain: f64 = table.iter().zip(&weights).map(|(column, w)| w * column[t]).sum();
                    assert!((value - plain).abs() < 1e-12, "{lanes:?}: {value} {plain}");
                }
            }
            let signal = if channels > 0 { table.channel(0) } else { &[] };
            for (lag, value) in lagged_products(signal, 12).into_iter().enumerate() {
                let plain: f64 = signal.iter().zip(signal.iter().skip(lag)).map(|(a, b)| a * b).sum();
                assert!((value - plain).abs() < 1e-12, "lag {lag}: {value} {plain}");
            }
        }
    }

    #[test]
    fn forward_recursions_side_by_side_are_those_of_each_signal() {
        let coefficients = [0.5, -0.3, 0.2, 0.1, -0.05];
        for (channels, samples) in [(1, 1), (2, 3), (9, 255), (8, 256), (19, 257), (3, 1030)] {
            let given = table(channels, samples);
            let of = |k: usize| Law { gain: 1.0 + k as f64, coefficients: &coefficients[..k % 6] };
            let laws: Vec<Law> = (0..channels).map(of).collect();
            for lanes in Lanes::available() {
                let mut made = given.clone();
                recur_forward_in(lanes, &mut made, &laws);
                for ((x, y), law) in given.iter().zip(made.iter()).zip(&laws) {
                    let mut plain = vec![0.0; samples];
                    for t in 0..samples {
                        let before = |(k, a): (usize, &f64)| if k < t { a * plain[t - k - 1] } else { 0.0 };
                        plain[t] = law.gain * x[t] + law.coefficients.iter().enumerate().map(before).sum::<f64>();
                        assert!((plain[t] - y[t]).abs() < 1e-11, "{lanes:?}, {samples} samples: {} {}", plain[t], y[t]);
                    }
                }
            }
        }
    }

    #[test]
    fn recursions_side_by_side_are_those_of_each_signal() {
        let coefficients = [0.5, -0.3, 0.2, 0.1, -0.05];
        for order in 0..=coefficients.len() {
            let coefficients = &coefficients[..order];
            for (channels, samples) in [(1, 1), (2, 3), (9, 255), (8, 256), (19, 257), (3, 1030)] {
                let given = table(channels, samples);
                for lanes in Lanes::available() {
                    let mut made = given.clone();
                    recur_backward_in(lanes, &mut made, 1.7, coefficients);
                    for (x, y) in given.iter().zip(made.iter()) {
                        let mut plain = vec![0.0; samples];
                        for t in (0..samples).rev() {
                            let later = |(k, a): (usize, &f64)| a * plain.get(t + k + 1).copied().unwrap_or(0.0);
                            plain[t] = 1.7 * x[t] + coefficients.iter().enumerate().map(later).sum::<f64>();
                        }
                        let off = y.iter().zip(&plain).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                        assert!(off < 1e-11, "{lanes:?}, {channels} x {samples}, order {order}: {off:e}");
                    }
                }
            }
        }
    }
}
