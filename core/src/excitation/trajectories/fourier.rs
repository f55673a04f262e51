//! Finite Fourier series.
//!
//! With the base frequency w = 2 pi / period, the velocity of a joint is a finite Fourier series of N harmonics:
//!
//! ```text
//! q'  = sum_l   a_l cos(l w t) + b_l sin(l w t)
//! q   = q_0 + sum_l   a_l / (l w) sin(l w t) - b_l / (l w) cos(l w t)
//! q'' = sum_l   -a_l l w sin(l w t) + b_l l w cos(l w t)
//! ```
//!
//! A series is at rest at zero at both ends of its period when q_0 = sum b_l / (l w), sum a_l = 0 and sum l b_l = 0. Any
//! coefficients may be given: the nearest ones (least squares) that meet the two sums are used, and q_0 follows. The
//! motion so stays periodic, unlike one corrected by a polynomial: its periods can be averaged, and its spectrum ends
//! at the harmonic N.
//!
//! J. Swevers, C. Ganseman, D. B. Tuekel, J. De Schutter and H. Van Brussel, Optimal robot excitation and
//! identification, IEEE Transactions on Robotics and Automation 13(5), 1997.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::channels::Channels;
use crate::error::{Error, Result};
use crate::excitation::primitives::{Law, Peaks, Reference, fill, fill_along, timing};
use crate::lane::{Lane, Lanes};

/// Samples per period of the highest harmonic from which peaks are bounded; the bounds are then 1e-4 too wide at most.
const SAMPLES_PER_HARMONIC: usize = 256;

/// Coefficients of one joint's velocity, harmonics 1 to N, at least two of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Harmonics {
    /// Cosine coefficients of the velocity a_l, rad/s.
    pub a: Vec<f64>,
    /// Sine coefficients of the velocity b_l, rad/s.
    pub b: Vec<f64>,
}

impl Harmonics {
    /// The nearest coefficients with sum a_l = 0 and sum l b_l = 0.
    fn at_rest_at_ends(&self) -> Harmonics {
        let order = |l: usize| (l + 1) as f64;
        let mean = self.a.iter().sum::<f64>() / self.a.len() as f64;
        let moment: f64 = self.b.iter().enumerate().map(|(l, b)| order(l) * b).sum();
        let norm: f64 = (0..self.b.len()).map(|l| order(l) * order(l)).sum();
        Harmonics {
            a: self.a.iter().map(|a| a - mean).collect(),
            b: self.b.iter().enumerate().map(|(l, b)| b - order(l) * moment / norm).collect(),
        }
    }
}

/// A finite Fourier series per joint, over one or more periods.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::excitation::{Motion, MotionFile, Reference};
/// # let file = |data: &str| {
/// #     let head = "schema = \"tauscope.motion/1\"\nrobot = \"bench\"\njoints = [\"pan\"]\nkind = \"fourier\"\n";
/// #     MotionFile::parse("motion.toml", &format!("{head}data = {data}"))
/// # };
///
///
/// // What a file with `kind = "fourier"` holds: two periods of 10 s with two harmonics of the velocity.
/// let file = file("{ period_s = 10.0, periods = 2, joints = [{ a = [0.3, -0.3], b = [0.2, -0.1] }] }")?;
/// let Motion::Fourier(series) = file.motion else { unreachable!() };
/// assert_eq!(series.duration_s(), 20.0);
///
/// // Periodic, and at rest at zero at both ends.
/// let (mut q, mut qd, mut qdd) = ([1.0], [1.0], [1.0]);
/// series.at(10.0, &mut q, &mut qd, &mut qdd);
/// assert!(q[0].abs() < 1e-12 && qd[0].abs() < 1e-12 && qdd[0].abs() < 1e-12);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Data", into = "Data")]
pub struct FourierSeries {
    data: Data,
    /// The coefficients that meet the constraints, per joint.
    constrained: Vec<Harmonics>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Data {
    period_s: f64,
    periods: u32,
    joints: Vec<Harmonics>,
}

impl FourierSeries {
    /// A series with a base period of `period_s`, run through `periods` times, from the coefficients of every joint.
    ///
    /// # Errors
    /// Names the joint with fewer than two harmonics, unequal numbers of coefficients, or one that is not finite.
    pub fn new(period_s: f64, periods: u32, joints: Vec<Harmonics>) -> Result<Self> {
        timing::require_positive("period_s", period_s)?;
        timing::require_positive("periods", f64::from(periods))?;
        if joints.is_empty() {
            return Err(Error::request("joints", "is empty; give the coefficients of at least one joint"));
        }
        for (j, Harmonics { a, b }) in joints.iter().enumerate() {
            let name = format!("joint {}", j + 1);
            if a.len() < 2 || a.len() != b.len() {
                return Err(Error::request(
                    name,
                    format!("has {} a and {} b; give as many of each, and at least two harmonics", a.len(), b.len()),
                ));
            }
            timing::require_finite(&format!("{name}: a"), a)?;
            timing::require_finite(&format!("{name}: b"), b)?;
        }
        let constrained = joints.iter().map(Harmonics::at_rest_at_ends).collect();
        Ok(FourierSeries { data: Data { period_s, periods, joints }, constrained })
    }

    /// The coefficients in use, which meet the constraints at the ends.
    pub fn harmonics(&self) -> &[Harmonics] {
        &self.constrained
    }

    fn joint_state(&self, joint: usize, t_s: f64) -> [f64; 3] {
        self.series(joint).at(t_s)
    }

    fn series(&self, joint: usize) -> Series<'_> {
        Series { harmonics: &self.constrained[joint], base: TAU / self.data.period_s }
    }
}

/// The series of one joint with its base frequency, rad/s.
struct Series<'a> {
    harmonics: &'a Harmonics,
    base: f64,
}

impl Law for Series<'_> {
    #[inline(always)]
    fn at<L: Lane>(&self, t: L) -> [L; 3] {
        let (sin1, cos1) = (L::splat(self.base) * t).sin_cos();
        let (mut sin, mut cos) = (sin1, cos1);
        let mut state = [L::splat(0.0); 3];
        for (l, (&a, &b)) in self.harmonics.a.iter().zip(&self.harmonics.b).enumerate() {
            let (a, b) = (L::splat(a), L::splat(b));
            let frequency = L::splat((l + 1) as f64 * self.base);
            state[0] += (a * sin + b * (L::splat(1.0) - cos)) / frequency;
            state[1] += a * cos + b * sin;
            state[2] += (b * cos - a * sin) * frequency;
            (sin, cos) = (sin * cos1 + cos * sin1, cos * cos1 - sin * sin1);
        }
        state
    }
}

impl Reference for FourierSeries {
    fn joints(&self) -> usize {
        self.constrained.len()
    }

    fn duration_s(&self) -> f64 {
        self.data.period_s * f64::from(self.data.periods)
    }

    fn at(&self, t_s: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        fill(self, t_s, [q, qd, qdd], |joint, t| self.joint_state(joint, t));
    }

    fn along(&self, times_s: &[f64], signals: [&mut Channels; 3]) {
        let lanes = Lanes::best().for_angles_to(TAU * f64::from(self.data.periods));
        fill_along(self, times_s, signals, |joint, sheet| sheet.write(lanes, &self.series(joint)));
    }

    /// Bounds no more than 1e-4 of the peak too wide, from samples: near a peak P a trigonometric polynomial of degree N
    /// is at least P cos(N x) at the angle x from it, so M equidistant samples reach P cos(pi N / M) (H. Ehlich and
    /// K. Zeller, Schwankung von Polynomen zwischen Gitterpunkten, Mathematische Zeitschrift 86, 1964).
    fn peaks(&self, joint: usize) -> Option<Peaks> {
        let samples = SAMPLES_PER_HARMONIC * self.constrained[joint].a.len();
        let mut peaks = Peaks::default();
        for k in 0..samples {
            let t = self.data.period_s * k as f64 / samples as f64;
            peaks.include(t, self.joint_state(joint, t));
        }
        let widening = 1.0 / (PI / SAMPLES_PER_HARMONIC as f64).cos();
        let half_range = 0.5 * (peaks.highest.value - peaks.lowest.value);
        peaks.highest.value += half_range * (widening - 1.0);
        peaks.lowest.value -= half_range * (widening - 1.0);
        peaks.velocity.value *= widening;
        peaks.acceleration.value *= widening;
        Some(peaks)
    }
}

impl TryFrom<Data> for FourierSeries {
    type Error = Error;

    fn try_from(data: Data) -> Result<Self> {
        Self::new(data.period_s, data.periods, data.joints)
    }
}

impl From<FourierSeries> for Data {
    fn from(series: FourierSeries) -> Self {
        series.data
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::testing::{assert_derivatives, assert_peaks_tight, assert_zero_ends, state};
    use proptest::prelude::*;

    prop_compose! {
        fn any_joint()(harmonics in 2usize..7)(
            a in prop::collection::vec(-1.0_f64..1.0, harmonics),
            b in prop::collection::vec(-1.0_f64..1.0, harmonics),
        ) -> Harmonics {
            Harmonics { a, b }
        }
    }

    proptest! {
        #[test]
        fn velocity_and_acceleration_are_derivatives(
            joints in prop::collection::vec(any_joint(), 1..4),
            t in 0.0_f64..6.0,
        ) {
            assert_derivatives(&FourierSeries::new(3.0, 2, joints).unwrap(), t);
        }

        #[test]
        fn ends_are_zero_and_periods_repeat(
            joints in prop::collection::vec(any_joint(), 1..4),
            t in 0.01_f64..2.99,
        ) {
            let series = FourierSeries::new(3.0, 2, joints).unwrap();
            // The angle at the end of the second period carries the rounding of 4 pi.
            assert_zero_ends(&series, 1e-11, |joint, t| series.joint_state(joint, t));
            for (first, second) in state(&series, t).concat().iter().zip(state(&series, t + 3.0).concat()) {
                prop_assert!((first - second).abs() < 1e-10);
            }
        }

        #[test]
        fn constrained_coefficients_stay_and_others_move_least(joint in any_joint(), step in -0.3_f64..0.3) {
            let near = joint.at_rest_at_ends();
            let again = near.at_rest_at_ends();
            for (x, y) in near.a.iter().chain(&near.b).zip(again.a.iter().chain(&again.b)) {
                prop_assert!((x - y).abs() < 1e-14);
            }
            // Any other point of the constraint set is farther: here one shifted along a direction in the set.
            let distance = |p: &Harmonics| -> f64 {
                p.a.iter().chain(&p.b).zip(joint.a.iter().chain(&joint.b)).map(|(x, y)| (x - y).powi(2)).sum()
            };
            let mut other = near.clone();
            other.a[0] += step;
            other.a[1] -= step;
            other.b[0] += 2.0 * step;
            other.b[1] -= step;
            prop_assert!(distance(&other) + 1e-14 >= distance(&near));
        }

        #[test]
        fn peaks_bound_the_motion_closely(joint in any_joint()) {
            assert_peaks_tight(&FourierSeries::new(3.0, 1, vec![joint]).unwrap(), 2e-4);
        }
    }

    #[test]
    fn a_hand_computed_series() {
        // a = (1, -1), b = 0, period 2 pi: q = sin t - sin(2 t) / 2, q' = cos t - cos 2t, q'' = -sin t + 2 sin 2t.
        let joint = Harmonics { a: vec![1.0, -1.0], b: vec![0.0, 0.0] };
        let series = FourierSeries::new(TAU, 1, vec![joint]).unwrap();
        let expected = [1.0, 1.0, -1.0];
        for (actual, e) in state(&series, PI / 2.0).concat().iter().zip(expected) {
            assert!((actual - e).abs() < 1e-14);
        }
    }

    #[test]
    fn wrong_data_is_refused() {
        let new = |a: &[f64], b: &[f64], periods| {
            FourierSeries::new(3.0, periods, vec![Harmonics { a: a.to_vec(), b: b.to_vec() }])
        };
        assert!(new(&[1.0], &[1.0], 1).unwrap_err().to_string().contains("two harmonics"));
        assert!(new(&[1.0, 2.0], &[1.0], 1).unwrap_err().to_string().contains("joint 1"));
        assert!(new(&[1.0, 2.0], &[1.0, f64::NAN], 1).unwrap_err().to_string().contains("joint 1: b"));
        assert!(new(&[1.0, 2.0], &[1.0, 2.0], 0).unwrap_err().to_string().contains("periods"));
    }
}
