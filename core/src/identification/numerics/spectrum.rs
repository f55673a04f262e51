//! Eigenvalues of a small symmetric matrix, without its eigenvectors: a search for excitations asks for those of thousands.
//!
//! Householder reflections bring the matrix to tridiagonal form in lanes; how many eigenvalues lie below a number is then the
//! number of negative pivots of the form shifted by it (G. H. Golub and C. F. Van Loan, Matrix Computations, 4th edition, Johns
//! Hopkins 2013, sections 8.3.1 and 8.4.1), and bisection at several places at once finds the ends.

use crate::lane::{Aligned, Kernel, Lane, Lanes, WIDEST};
use nalgebra::DMatrix;

/// Places at which eigenvalues are counted at once, so that one division does not wait for another.
const PLACES: usize = 8;

/// Passes after which an interval is as small as rounding allows: (1 + PLACES)^17 > 2^53.
const PASSES: usize = 17;

/// The tridiagonal form of a symmetric matrix.
#[derive(Debug, Clone)]
pub(crate) struct Spectrum {
    diagonal: Vec<f64>,
    /// Squares of the entries next to the diagonal; the first is zero.
    squares: Vec<f64>,
    /// The smallest size of a pivot, in place of zero.
    tiny: f64,
    /// An interval that holds all eigenvalues.
    bounds: [f64; 2],
}

impl Spectrum {
    /// The tridiagonal form of a symmetric matrix, of which the lower triangle is read.
    ///
    /// # Panics
    /// If the matrix is not square.
    pub(crate) fn of(matrix: &DMatrix<f64>) -> Self {
        Self::with(Lanes::best(), matrix)
    }

    fn with(lanes: Lanes, matrix: &DMatrix<f64>) -> Self {
        assert!(matrix.is_square(), "a symmetric matrix is wanted");
        let size = matrix.nrows();
        // Rows are filled up with zeros to whole lanes, which change nothing.
        let stride = size.next_multiple_of(WIDEST);
        let mut rows = Aligned::zeros(size * stride);
        for c in 0..size {
            for r in c..size {
                (rows[r * stride + c], rows[c * stride + r]) = (matrix[(r, c)], matrix[(r, c)]);
            }
        }
        let (diagonal, off_diagonal) = lanes.run(Reduction { rows: &mut rows, size, stride });
        let reach = |k: usize| off_diagonal[k].abs() + off_diagonal.get(k + 1).map_or(0.0, |next| next.abs());
        let bounds = diagonal.iter().enumerate().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (k, d)| {
            [low.min(d - reach(k)), high.max(d + reach(k))]
        });
        let squares: Vec<f64> = off_diagonal.iter().map(|e| e * e).collect();
        let tiny = f64::MIN_POSITIVE * squares.iter().fold(1.0, |most: f64, e| most.max(*e));
        Spectrum { diagonal, squares, tiny, bounds }
    }

    /// The smallest and the largest eigenvalue, to rounding of the larger in size; no numbers of a matrix that is empty or
    /// holds what is not a number.
    pub(crate) fn ends(&self) -> [f64; 2] {
        if self.diagonal.is_empty() || !self.diagonal.iter().chain(&self.squares).all(|value| value.is_finite()) {
            return [f64::NAN; 2];
        }
        [self.nth(0), self.nth(self.diagonal.len() - 1)]
    }

    /// Number of eigenvalues below `value`.
    pub(crate) fn below(&self, value: f64) -> usize {
        self.count([value; PLACES])[0]
    }

    /// ln det; not a number where the matrix is not positive definite.
    pub(crate) fn log_determinant(&self) -> f64 {
        let mut pivot = 1.0;
        let mut sum = 0.0;
        for (d, e) in self.diagonal.iter().zip(&self.squares) {
            pivot = d - e / pivot;
            sum += pivot.ln();
        }
        sum
    }

    /// Eigenvalue number `n` in ascending order.
    fn nth(&self, n: usize) -> f64 {
        let [mut low, mut high] = self.bounds;
        for _ in 0..PASSES {
            let step = (high - low) / (PLACES + 1) as f64;
            let places: [f64; PLACES] = std::array::from_fn(|k| low + step * (k + 1) as f64);
            let counts = self.count(places);
            let above = counts.iter().position(|&count| count > n);
            (low, high) = match above {
                Some(0) => (low, places[0]),
                Some(k) => (places[k - 1], places[k]),
                None => (places[PLACES - 1], high),
            };
        }
        0.5 * (low + high)
    }

    /// Numbers of eigenvalues below each of several values.
    fn count(&self, values: [f64; PLACES]) -> [usize; PLACES] {
        let mut pivots = [1.0; PLACES];
        let mut negative = [0; PLACES];
        for (&d, &e) in self.diagonal.iter().zip(&self.squares) {
            for ((pivot, count), value) in pivots.iter_mut().zip(&mut negative).zip(values) {
                let next: f64 = (d - value) - e / *pivot;
                *pivot = if next.abs() < self.tiny { -self.tiny } else { next };
                *count += usize::from(*pivot < 0.0);
            }
        }
        negative
    }
}

/// Householder's reduction of a symmetric matrix, all of whose entries are there.
struct Reduction<'a> {
    rows: &'a mut [f64],
    size: usize,
    stride: usize,
}

impl Kernel for Reduction<'_> {
    /// The diagonal, and the entries before it.
    type Output = (Vec<f64>, Vec<f64>);

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let Reduction { rows, size, stride } = self;
        let (mut diagonal, mut off_diagonal) = (vec![0.0; size], vec![0.0; size]);
        let (mut v, mut p) = (Aligned::zeros(stride), Aligned::zeros(stride));
        for k in 0..size {
            diagonal[k] = rows[k * stride + k];
            if k + 1 == size {
                break;
            }
            // The reflection along v = x - alpha e_1 turns the rest of row k, x, into alpha e_1.
            v[..=k].fill(0.0);
            v[k + 1..].copy_from_slice(&rows[k * stride + k + 1..][..stride - k - 1]);
            let below: f64 = v[k + 2..].iter().map(|x| x * x).sum();
            let first = v[k + 1];
            if below == 0.0 {
                off_diagonal[k + 1] = first;
                continue;
            }
            let alpha = -(first * first + below).sqrt().copysign(first);
            off_diagonal[k + 1] = alpha;
            v[k + 1] = first - alpha;
            let beta = 1.0 / (alpha * alpha - first * alpha);
            // Everything before this column is done with; lanes start where one of them does.
            let start = (k + 1) / L::WIDTH * L::WIDTH;
            multiply::<L>(rows, stride, k + 1..size, start, &v, &mut p);
            let half = 0.5 * beta * v.iter().zip(p.iter()).skip(k + 1).map(|(v, p)| v * p).sum::<f64>();
            for (p, v) in p.iter_mut().zip(v.iter()).skip(start) {
                *p = beta * (*p - half * v);
            }
            p[start..=k].fill(0.0);
            for r in k + 1..size {
                let (a, b) = (L::splat(v[r]), L::splat(p[r]));
                let row = &mut rows[r * stride..][..stride];
                let mut place = start;
                while place < stride {
                    let entry = L::load(&row[place..]);
                    let less = a.mul_sub_from(L::load(&p[place..]), entry);
                    b.mul_sub_from(L::load(&v[place..]), less).store(&mut row[place..]);
                    place += L::WIDTH;
                }
            }
        }
        (diagonal, off_diagonal)
    }
}

/// p = A v from column `start` on, over the rows in which v is not zero.
#[inline(always)]
fn multiply<L: Lane>(
    rows: &[f64],
    stride: usize,
    range: std::ops::Range<usize>,
    start: usize,
    v: &[f64],
    p: &mut [f64],
) {
    p.fill(0.0);
    let mut r = range.start;
    while r < range.end {
        // Four rows at a time, so that sums are not read and written for each.
        let mut place = start;
        let last = range.end - 1;
        let mut weights = [L::splat(0.0); 4];
        for (k, weight) in weights.iter_mut().enumerate() {
            *weight = L::splat(if r + k <= last { v[r + k] } else { 0.0 });
        }
        while place < stride {
            let mut sum = L::load(&p[place..]);
            for (k, weight) in weights.iter().enumerate() {
                sum = weight.mul_add(L::load(&rows[last.min(r + k) * stride + place..]), sum);
            }
            sum.store(&mut p[place..]);
            place += L::WIDTH;
        }
        r += 4;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A random symmetric matrix with eigenvalues of both signs.
    fn matrix(size: usize, seed: u64) -> DMatrix<f64> {
        use rand::RngExt;
        let mut source = crate::random::stream(seed, "symmetric", 0);
        let square = DMatrix::from_fn(size, size, |_, _| source.random_range(-1.0..1.0));
        &square + square.transpose()
    }

    proptest! {
        #[test]
        fn ends_counts_and_determinant_are_those_of_a_full_decomposition(size in 1usize..40, seed in 0u64..1000) {
            let matrix = matrix(size, seed);
            let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
            values.sort_by(f64::total_cmp);
            let scale = matrix.norm();
            let definite = &matrix + DMatrix::identity(size, size) * (scale + 1.0);
            let expected: f64 = values.iter().map(|value| (value + scale + 1.0).ln()).sum();
            for lanes in Lanes::available() {
                let spectrum = Spectrum::with(lanes, &matrix);
                let [low, high] = spectrum.ends();
                prop_assert!((low - values[0]).abs() < 1e-13 * scale, "{low} {}", values[0]);
                prop_assert!((high - values[size - 1]).abs() < 1e-13 * scale);
                prop_assert_eq!(spectrum.below(0.3), values.iter().filter(|&&value| value < 0.3).count());
                let own = Spectrum::with(lanes, &definite).log_determinant();
                prop_assert!((own - expected).abs() < 1e-11 * (1.0 + expected.abs()), "{own} {expected}");
            }
        }
    }

    #[test]
    fn matrices_without_a_spectrum_and_with_zeros() {
        assert!(Spectrum::of(&DMatrix::zeros(0, 0)).ends()[0].is_nan());
        assert!(Spectrum::of(&DMatrix::from_element(3, 3, f64::NAN)).ends()[1].is_nan());
        let [low, high] = Spectrum::of(&DMatrix::zeros(5, 5)).ends();
        assert!(low.abs() < 1e-300 && high.abs() < 1e-300, "{low} {high}");
        let diagonal = DMatrix::from_diagonal(&nalgebra::DVector::from_vec(vec![3.0, 0.0, 1.0, 2.0]));
        let [low, high] = Spectrum::of(&diagonal).ends();
        assert!(low.abs() < 1e-15 && (high - 3.0).abs() < 1e-15, "{low} {high}");
        assert_eq!(Spectrum::of(&diagonal).below(1.5), 2);
    }
}
