//! A piecewise polynomial: what both the quintic sequence and the B-spline are once their coefficients are known.

use super::peaks::Peaks;
use super::{polynomial, timing};

/// One joint's motion as polynomials between knots.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewisePolynomial {
    /// Times between the segments, ascending, s.
    pub knots: Vec<f64>,
    /// Coefficients of each segment, ascending, in s = (t - start) / length.
    pub segments: Vec<Vec<f64>>,
}

impl PiecewisePolynomial {
    /// Position, velocity and acceleration at `t_s`.
    pub fn at(&self, t_s: f64) -> [f64; 3] {
        let k = timing::segment(&self.knots, t_s);
        self.on_segment(k, (t_s - self.knots[k]) / self.length(k))
    }

    fn length(&self, k: usize) -> f64 {
        self.knots[k + 1] - self.knots[k]
    }

    /// Horner's rule for the value and its first two derivatives at once.
    fn on_segment(&self, k: usize, s: f64) -> [f64; 3] {
        let [mut value, mut first, mut half_second] = [0.0; 3];
        for c in self.segments[k].iter().rev() {
            half_second = half_second * s + first;
            first = first * s + value;
            value = value * s + c;
        }
        let length = self.length(k);
        [value, first / length, 2.0 * half_second / (length * length)]
    }

    /// Exact peaks: extremes lie at knots or where the next derivative changes sign.
    pub fn peaks(&self) -> Peaks {
        let mut peaks = Peaks::default();
        for (k, coefficients) in self.segments.iter().enumerate() {
            let mut candidates = vec![0.0, 1.0];
            let mut derivative = polynomial::derivative(coefficients);
            for _ in 0..3 {
                candidates.extend(polynomial::sign_changes(&derivative));
                derivative = polynomial::derivative(&derivative);
            }
            for s in candidates {
                peaks.include(self.knots[k] + s * self.length(k), self.on_segment(k, s));
            }
        }
        peaks
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
