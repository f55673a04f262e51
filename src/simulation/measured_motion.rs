//! A motion that was measured as something an arm can be asked to follow.

use crate::dynamics::Motion;
use crate::excitation::Reference;

/// Quintic pieces between samples that meet position, velocity and acceleration at every sample.
pub(crate) struct MeasuredMotion<'a> {
    motion: &'a Motion,
    start: f64,
    period: f64,
}

impl<'a> MeasuredMotion<'a> {
    /// A motion of at least two samples, the first at `start`, `period` seconds apart.
    pub(crate) fn new(motion: &'a Motion, start: f64, period: f64) -> Self {
        MeasuredMotion { motion, start, period }
    }
}

impl Reference for MeasuredMotion<'_> {
    fn joints(&self) -> usize {
        self.motion.joints()
    }

    fn duration_s(&self) -> f64 {
        self.start + (self.motion.samples().max(1) - 1) as f64 * self.period
    }

    fn at(&self, t_s: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let last = self.motion.samples() - 1;
        let place = ((t_s - self.start) / self.period).clamp(0.0, last as f64);
        let start = (place as usize).min(last.saturating_sub(1));
        let (h, s) = (self.period, place - start as f64);
        let (s2, s3) = (s * s, s * s * s);
        for joint in 0..self.motion.joints() {
            let at = |table: &crate::channels::Channels, k: usize| table.channel(joint)[(start + k).min(last)];
            let Motion { q: position, qd: velocity, qdd: acceleration } = self.motion;
            let (p0, p1) = (at(position, 0), at(position, 1));
            let (v0, v1) = (h * at(velocity, 0), h * at(velocity, 1));
            let (a0, a1) = (h * h * at(acceleration, 0), h * h * at(acceleration, 1));
            // x = p0 + v0 s + a0 s2 / 2 + c3 s3 + c4 s4 + c5 s5 with the other end met.
            let (dp, dv, da) = (p1 - p0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0);
            let (c3, c4, c5) =
                (10.0 * dp - 4.0 * dv + 0.5 * da, -15.0 * dp + 7.0 * dv - da, 6.0 * dp - 3.0 * dv + 0.5 * da);
            q[joint] = p0 + v0 * s + 0.5 * a0 * s2 + s3 * (c3 + s * (c4 + s * c5));
            qd[joint] = (v0 + a0 * s + s2 * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5))) / h;
            qdd[joint] = (a0 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / (h * h);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;

    #[test]
    fn a_quintic_is_followed_exactly() {
        let x = |t: f64| 0.3 - t + 2.0 * t * t - 0.7 * t.powi(5);
        let v = |t: f64| -1.0 + 4.0 * t - 3.5 * t.powi(4);
        let a = |t: f64| 4.0 - 14.0 * t.powi(3);
        let sampled =
            |f: &dyn Fn(f64) -> f64| Channels::from_vectors(&[(0..5).map(|k| f(0.25 * f64::from(k))).collect()]);
        let motion = Motion { q: sampled(&x), qd: sampled(&v), qdd: sampled(&a) };
        let reference = MeasuredMotion::new(&motion, 3.0, 0.25);
        let (mut q, mut qd, mut qdd) = ([0.0], [0.0], [0.0]);
        for t in [0.0, 0.1, 0.25, 0.6, 1.0] {
            reference.at(3.0 + t, &mut q, &mut qd, &mut qdd);
            assert!(
                (q[0] - x(t)).abs() < 1e-12 && (qd[0] - v(t)).abs() < 1e-11 && (qdd[0] - a(t)).abs() < 1e-10,
                "{t}"
            );
        }
        reference.at(9.0, &mut q, &mut qd, &mut qdd);
        assert!((q[0] - x(1.0)).abs() < 1e-12);
    }
}
