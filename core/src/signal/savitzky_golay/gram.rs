//! Gram (discrete Legendre) polynomials: the weights of a least-squares polynomial fit without solving a system.
//!
//! Reference: P. A. Gorry, "General least-squares smoothing and differentiation by the convolution (Savitzky-Golay)
//! method", Analytical Chemistry 62 (1990) 570-573.

/// The monic Gram polynomials up to an order, orthogonal over the points i / half for i = -half..=half.
pub(super) struct Gram {
    /// Points on either side of the centre.
    half: usize,
    /// Their values at the points and the sums of their squares, from order zero up.
    polynomials: Vec<(Vec<f64>, f64)>,
}

impl Gram {
    /// Up to `order`, over `half` points on either side of the centre.
    pub(super) fn new(half: usize, order: usize) -> Self {
        let points = 2 * half + 1;
        let mut gram = Gram { half, polynomials: Vec::with_capacity(order + 1) };
        let (mut at, mut at_before) = (vec![1.0; points], vec![0.0; points]);
        let mut norm = points as f64;
        for k in 0..=order {
            let next = at.iter().zip(&at_before).enumerate();
            let next = next.map(|(i, (p, before))| (i as f64 - half as f64) / gram.scale() * p - gram.beta(k) * before);
            let next = next.collect();
            at_before = std::mem::replace(&mut at, next);
            gram.polynomials.push((at_before.clone(), norm));
            norm *= gram.beta(k + 1);
        }
        gram
    }

    /// A window of one sample has its only point at zero; any scale will do.
    fn scale(&self) -> f64 {
        self.half.max(1) as f64
    }

    /// Weight of each sample in the `derivative`-th derivative (in samples) of the fitted polynomial at `position`
    /// (in samples from the centre): sum over k of p_k(x_i) p_k^(derivative)(x) / |p_k|^2.
    pub(super) fn weights(&self, position: f64, derivative: usize) -> Vec<f64> {
        let x = position / self.scale();
        // The derivatives 0..=derivative of p_k and p_{k-1} at the position.
        let (mut here, mut here_before) = (vec![0.0; derivative + 1], vec![0.0; derivative + 1]);
        here[0] = 1.0;
        let mut weights = vec![0.0; 2 * self.half + 1];
        for (k, (at, norm)) in self.polynomials.iter().enumerate() {
            let factor = here[derivative] / norm;
            for (weight, p) in weights.iter_mut().zip(at) {
                *weight += factor * p;
            }
            // p_{k+1} = x p_k - beta_k p_{k-1}, differentiated d times by Leibniz' rule.
            for d in (0..=derivative).rev() {
                let lower = if d > 0 { d as f64 * here[d - 1] } else { 0.0 };
                here_before[d] = x * here[d] + lower - self.beta(k) * here_before[d];
            }
            std::mem::swap(&mut here, &mut here_before);
        }
        let per_sample = self.scale().powi(-(derivative as i32));
        weights.iter_mut().for_each(|w| *w *= per_sample);
        weights
    }

    /// Recurrence coefficient |p_k|^2 / |p_{k-1}|^2 = k^2 (N^2 - k^2) / (4 (4 k^2 - 1)), on the scaled points.
    fn beta(&self, k: usize) -> f64 {
        let (k2, points) = ((k * k) as f64, (2 * self.half + 1) as f64);
        k2 * (points * points - k2) / (4.0 * (4.0 * k2 - 1.0)) / (self.scale() * self.scale())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_through_three_points() {
        // Value and slope at the first of three points fitted by a line: (5, 2, -1) / 6 and (-1, 0, 1) / 2.
        let line = Gram::new(1, 1);
        for (derivative, want) in [(0, [5.0 / 6.0, 2.0 / 6.0, -1.0 / 6.0]), (1, [-0.5, 0.0, 0.5])] {
            for (got, want) in line.weights(-1.0, derivative).into_iter().zip(want) {
                assert!((got - want).abs() < 1e-15, "derivative {derivative}");
            }
        }
    }

    #[test]
    fn weights_at_any_position_reproduce_the_powers() {
        let cubic = Gram::new(6, 3);
        for position in [-6.0, -2.5, 0.0, 4.0] {
            for (derivative, wanted) in
                [(0, position * position * position), (1, 3.0 * position * position), (2, 6.0 * position), (3, 6.0)]
            {
                let got: f64 =
                    cubic.weights(position, derivative).iter().zip(-6..=6).map(|(w, i)| w * f64::from(i).powi(3)).sum();
                assert!((got - wanted).abs() < 1e-11, "position {position}, derivative {derivative}: {got}");
            }
        }
    }
}
