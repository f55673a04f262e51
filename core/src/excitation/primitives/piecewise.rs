//! A piecewise polynomial: what both the quintic sequence and the B-spline are once their coefficients are known.

use super::batch::{Law, Sheet};
use super::peaks::Peaks;
use super::{polynomial, timing};
use crate::lane::Lane;

/// One joint's motion as polynomials between knots.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PiecewisePolynomial {
    /// Times between the segments, ascending, s.
    pub knots: Vec<f64>,
    /// Coefficients of each segment, ascending, in s = (t - start) / length.
    pub segments: Vec<Vec<f64>>,
}

impl PiecewisePolynomial {
    /// Position, velocity and acceleration at `t_s`.
    pub(crate) fn at(&self, t_s: f64) -> [f64; 3] {
        self.piece(timing::segment(&self.knots, t_s)).at(t_s)
    }

    /// Writes position, velocity and acceleration at many times.
    pub(crate) fn along(&self, sheet: &mut Sheet) {
        sheet.write_segments(&self.knots, |k| self.piece(k));
    }

    fn piece(&self, k: usize) -> Piece<'_> {
        Piece { coefficients: &self.segments[k], start: self.knots[k], length: self.length(k) }
    }

    fn length(&self, k: usize) -> f64 {
        self.knots[k + 1] - self.knots[k]
    }

    /// Exact peaks: extremes lie at knots or where the next derivative changes sign.
    pub(crate) fn peaks(&self) -> Peaks {
        let mut peaks = Peaks::default();
        for (k, coefficients) in self.segments.iter().enumerate() {
            let mut candidates = vec![0.0, 1.0];
            let mut derivative = polynomial::derivative(coefficients);
            for _ in 0..3 {
                candidates.extend(polynomial::sign_changes(&derivative));
                derivative = polynomial::derivative(&derivative);
            }
            for s in candidates {
                peaks.include(self.knots[k] + s * self.length(k), self.piece(k).on_share(s));
            }
        }
        peaks
    }
}

/// One polynomial.
struct Piece<'a> {
    coefficients: &'a [f64],
    start: f64,
    length: f64,
}

impl Piece<'_> {
    /// Horner's rule for the value and its first two derivatives at once.
    #[inline(always)]
    fn on_share<L: Lane>(&self, s: L) -> [L; 3] {
        let [mut value, mut first, mut half_second] = [L::splat(0.0); 3];
        for &c in self.coefficients.iter().rev() {
            half_second = half_second * s + first;
            first = first * s + value;
            value = value * s + L::splat(c);
        }
        let length = self.length;
        [value, first / L::splat(length), L::splat(2.0) * half_second / L::splat(length * length)]
    }
}

impl Law for Piece<'_> {
    #[inline(always)]
    fn at<L: Lane>(&self, t: L) -> [L; 3] {
        self.on_share((t - L::splat(self.start)) / L::splat(self.length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_of_a_hand_computed_cubic() {
        // q = 16 s^2 (1 - s) over 2 s: highest at s = 2/3 (64/27), fastest at s = 1 (-8), steepest at s = 1 (-16).
        let cubic = PiecewisePolynomial { knots: vec![0.0, 2.0], segments: vec![vec![0.0, 0.0, 16.0, -16.0]] };
        let peaks = cubic.peaks();
        assert!((peaks.highest.value - 64.0 / 27.0).abs() < 1e-14);
        assert!((peaks.highest.time_s - 4.0 / 3.0).abs() < 1e-7);
        assert_eq!((peaks.velocity.value, peaks.velocity.time_s), (-8.0, 2.0));
        assert_eq!((peaks.acceleration.value, peaks.acceleration.time_s), (-16.0, 2.0));
        assert_eq!(peaks.lowest.value, 0.0);
        assert_eq!(cubic.at(1.0), [2.0, 2.0, -4.0]);
    }
}
