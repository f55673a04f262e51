//! Weighted sums over a sliding window, in lanes: neighbouring outputs are computed side by side.
//!
//! Weights are those of the window's centre and of the samples after it; before the centre they are the same, or negated
//! (odd). The sums run in the same order for every output, wherever a row of lanes begins.

use crate::lane::{Kernel, Lane, Lanes};

/// Rows of lanes that are summed together, so that one addition does not wait for another.
const TOGETHER: usize = 4;
const TOGETHER_OF_THREE: usize = 3;

/// The sums at every place whose whole window lies in `input`.
///
/// # Panics
/// If there are not as many outputs as such places.
pub(super) fn interior(lanes: Lanes, weights: &[f64], odd: bool, input: &[f64], output: &mut [f64]) {
    check(weights, input, output);
    match odd {
        true => lanes.run(One::<true> { weights, input, output }),
        false => lanes.run(One::<false> { weights, input, output }),
    }
}

/// [`interior`] for three rows of weights at once, of which only the middle one is odd: a signal and two derivatives.
///
/// # Panics
/// As [`interior`].
pub(super) fn interior_of_three(lanes: Lanes, weights: [&[f64]; 3], input: &[f64], output: [&mut [f64]; 3]) {
    for (weights, output) in weights.iter().zip(&output) {
        check(weights, input, output);
    }
    lanes.run(Three { weights, input, output });
}

/// The sums of `weights` (first sample of the window to last) over the windows that begin at `first`, `first + step`, ...
///
/// # Panics
/// If a window reaches beyond the input.
pub(super) fn every(lanes: Lanes, weights: &[f64], input: &[f64], first: usize, step: usize, output: &mut [f64]) {
    lanes.run(Every { weights, input, first, step, output });
}

fn check(weights: &[f64], input: &[f64], output: &[f64]) {
    assert_eq!(output.len() + 2 * (weights.len() - 1), input.len(), "one output per full window is wanted");
}

struct One<'a, const ODD: bool> {
    weights: &'a [f64],
    input: &'a [f64],
    output: &'a mut [f64],
}

impl<const ODD: bool> Kernel for One<'_, ODD> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let (half, count) = (self.weights.len() - 1, self.output.len());
        let mut start = 0;
        while start + TOGETHER * L::WIDTH <= count {
            let input = &self.input[start..start + TOGETHER * L::WIDTH + 2 * half];
            let mut sums = [L::splat(0.0); TOGETHER];
            for (k, sum) in sums.iter_mut().enumerate() {
                *sum = L::load(&input[half + k * L::WIDTH..]) * L::splat(self.weights[0]);
            }
            for (i, &w) in self.weights.iter().enumerate().skip(1) {
                let w = L::splat(w);
                let (before, after) = (&input[half - i..], &input[half + i..]);
                for (k, sum) in sums.iter_mut().enumerate() {
                    let (b, a) = (L::load(&before[k * L::WIDTH..]), L::load(&after[k * L::WIDTH..]));
                    *sum = (if ODD { a - b } else { a + b }).mul_add(w, *sum);
                }
            }
            for (k, sum) in sums.into_iter().enumerate() {
                sum.store(&mut self.output[start + k * L::WIDTH..]);
            }
            start += TOGETHER * L::WIDTH;
        }
        while start < count {
            let end = count.min(start + L::WIDTH);
            let input = &self.input[start..end + 2 * half];
            let mut sum = L::load_part(&input[half..][..end - start]) * L::splat(self.weights[0]);
            for (i, &w) in self.weights.iter().enumerate().skip(1) {
                let before = L::load_part(&input[half - i..][..end - start]);
                let after = L::load_part(&input[half + i..][..end - start]);
                sum = (if ODD { after - before } else { after + before }).mul_add(L::splat(w), sum);
            }
            sum.store_part(&mut self.output[start..end]);
            start = end;
        }
    }
}

struct Three<'a> {
    weights: [&'a [f64]; 3],
    input: &'a [f64],
    output: [&'a mut [f64]; 3],
}

impl Kernel for Three<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(mut self) {
        let (half, count) = (self.weights[0].len() - 1, self.output[0].len());
        let [smooth, rate, second] = self.weights.map(|weights| &weights[..half + 1]);
        let mut start = 0;
        while start + TOGETHER_OF_THREE * L::WIDTH <= count {
            let input = &self.input[start..start + TOGETHER_OF_THREE * L::WIDTH + 2 * half];
            let mut sums = [[L::splat(0.0); 3]; TOGETHER_OF_THREE];
            for (k, sums) in sums.iter_mut().enumerate() {
                let centre = L::load(&input[half + k * L::WIDTH..]);
                *sums = [centre * L::splat(smooth[0]), centre * L::splat(rate[0]), centre * L::splat(second[0])];
            }
            for i in 1..=half {
                let w = [L::splat(smooth[i]), L::splat(rate[i]), L::splat(second[i])];
                let (before, after) = (&input[half - i..], &input[half + i..]);
                for (k, sums) in sums.iter_mut().enumerate() {
                    let (b, a) = (L::load(&before[k * L::WIDTH..]), L::load(&after[k * L::WIDTH..]));
                    add_pair(sums, w, a, b);
                }
            }
            for (k, sums) in sums.iter().enumerate() {
                for (sum, output) in sums.iter().zip(self.output.iter_mut()) {
                    sum.store(&mut output[start + k * L::WIDTH..]);
                }
            }
            start += TOGETHER_OF_THREE * L::WIDTH;
        }
        while start < count {
            let end = count.min(start + L::WIDTH);
            let input = &self.input[start..end + 2 * half];
            let centre = L::load_part(&input[half..][..end - start]);
            let mut sums = [centre * L::splat(smooth[0]), centre * L::splat(rate[0]), centre * L::splat(second[0])];
            for i in 1..=half {
                let w = [L::splat(smooth[i]), L::splat(rate[i]), L::splat(second[i])];
                let before = L::load_part(&input[half - i..][..end - start]);
                add_pair(&mut sums, w, L::load_part(&input[half + i..][..end - start]), before);
            }
            for (sum, output) in sums.iter().zip(self.output.iter_mut()) {
                sum.store_part(&mut output[start..end]);
            }
            start = end;
        }
    }
}

#[inline(always)]
fn add_pair<L: Lane>(sums: &mut [L; 3], w: [L; 3], after: L, before: L) {
    let (even, odd) = (after + before, after - before);
    sums[0] = even.mul_add(w[0], sums[0]);
    sums[1] = odd.mul_add(w[1], sums[1]);
    sums[2] = even.mul_add(w[2], sums[2]);
}

struct Every<'a> {
    weights: &'a [f64],
    input: &'a [f64],
    first: usize,
    step: usize,
    output: &'a mut [f64],
}

impl Kernel for Every<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let window = self.weights.len();
        for (row, output) in self.output.iter_mut().enumerate() {
            let samples = &self.input[self.first + row * self.step..][..window];
            let mut sums = [L::splat(0.0); TOGETHER];
            let mut i = 0;
            while i + TOGETHER * L::WIDTH <= window {
                for (k, sum) in sums.iter_mut().enumerate() {
                    let place = i + k * L::WIDTH;
                    *sum = L::load(&self.weights[place..]).mul_add(L::load(&samples[place..]), *sum);
                }
                i += TOGETHER * L::WIDTH;
            }
            let mut k = 0;
            while i < window {
                sums[k] = L::load_part(&self.weights[i..]).mul_add(L::load_part(&samples[i..]), sums[k]);
                i += L::WIDTH;
                k += 1;
            }
            *output = ((sums[0] + sums[1]) + (sums[2] + sums[3])).sum();
        }
    }
}
