//! Clamped uniform B-splines.
//!
//! The curve of a clamped spline starts in its first control point, and its first r derivatives there depend only on
//! the first r + 1 of them; likewise at the end. With the first three and the last three control points at zero, the
//! motion starts and ends at zero position, velocity and acceleration. The control points between are free.
//!
//! W. Rackl, R. Lampariello and G. Hirzinger, Robot excitation trajectories for dynamic parameter estimation using
//! optimized B-splines, IEEE ICRA 2012; L. Piegl and W. Tiller, The NURBS Book, 2nd edition, Springer 1997, chapter 3.

use serde::{Deserialize, Serialize};

use crate::channels::Channels;
use crate::error::{Error, Result};
use crate::excitation::primitives::{Peaks, PiecewisePolynomial, Reference, fill, fill_along, timing};

/// Degree that motions have unless another is asked for: continuous up to the fourth derivative.
pub(crate) const DEGREE: usize = 5;

/// Degrees allowed: 3 is the least with a continuous acceleration.
const DEGREES: std::ops::RangeInclusive<usize> = 3..=7;

/// Control points held at zero at each end.
const ZERO_POINTS: usize = 3;

/// The free control points of one joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointPoints {
    /// Control points between the three zeros at each end, rad.
    pub control_points: Vec<f64>,
}

/// A clamped uniform B-spline per joint.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::excitation::{Motion, MotionFile, Reference};
/// # let file = |data: &str| {
/// #     let head = "schema = \"tauscope.motion/1\"\nrobot = \"bench\"\njoints = [\"pan\"]\nkind = \"bspline\"\n";
/// #     MotionFile::parse("motion.toml", &format!("{head}data = {data}"))
/// # };
///
///
/// // What a file with `kind = "bspline"` holds. A spline stays within its control points.
/// let file = file("{ duration_s = 4.0, degree = 5, joints = [{ control_points = [0.4, 0.8, -0.6, 0.3] }] }")?;
/// let Motion::Bspline(spline) = file.motion else { unreachable!() };
/// let peaks = spline.peaks(0).expect("the law gives bounds");
/// assert!(peaks.highest.value < 0.8 && peaks.lowest.value > -0.6);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Data", into = "Data")]
pub struct Bspline {
    data: Data,
    curves: Vec<PiecewisePolynomial>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Data {
    duration_s: f64,
    degree: usize,
    joints: Vec<JointPoints>,
}

impl Bspline {
    /// A spline that lasts `duration_s`, from the free control points of every joint.
    ///
    /// # Errors
    /// Names the joint with too few control points or one that is not finite; refuses degrees outside 3 to 7.
    pub fn new(duration_s: f64, degree: usize, joints: Vec<JointPoints>) -> Result<Self> {
        timing::require_positive("duration_s", duration_s)?;
        if !DEGREES.contains(&degree) {
            return Err(Error::request(
                "degree",
                format!("must be {} to {}, found {degree}", DEGREES.start(), DEGREES.end()),
            ));
        }
        if joints.is_empty() {
            return Err(Error::request("joints", "is empty; give the control points of at least one joint"));
        }
        let fewest = (degree + 1).saturating_sub(2 * ZERO_POINTS).max(1);
        for (j, JointPoints { control_points: free }) in joints.iter().enumerate() {
            let subject = format!("joint {}: control_points", j + 1);
            if free.len() < fewest {
                return Err(Error::request(
                    subject,
                    format!("has {} entries; a spline of degree {degree} needs at least {fewest}", free.len()),
                ));
            }
            timing::require_finite(&subject, free)?;
        }
        let curves = joints.iter().map(|joint| spans(duration_s, degree, &joint.control_points)).collect();
        Ok(Bspline { data: Data { duration_s, degree, joints }, curves })
    }
}

/// The polynomial of every span: its Taylor coefficients at the start of the span, in units of the span.
fn spans(duration_s: f64, degree: usize, free: &[f64]) -> PiecewisePolynomial {
    let zeros = [0.0; ZERO_POINTS];
    let control = [&zeros[..], free, &zeros[..]].concat();
    let count = control.len() - degree;
    let knots: Vec<f64> = (0..control.len() + degree + 1).map(|i| i.saturating_sub(degree).min(count) as f64).collect();
    let mut segments = vec![Vec::with_capacity(degree + 1); count];
    let mut control = control;
    let mut factorial = 1.0;
    for order in 0..=degree {
        // The derivative of this order is a spline of a lower degree on the same knots without `order` at each end.
        let lower = degree - order;
        let inner = &knots[order..knots.len() - order];
        for (k, segment) in segments.iter_mut().enumerate() {
            segment.push(de_boor(&control, inner, lower, lower + k) / factorial);
        }
        factorial *= (order + 1) as f64;
        if lower > 0 {
            control = (0..control.len() - 1)
                .map(|i| lower as f64 * (control[i + 1] - control[i]) / (inner[i + lower + 1] - inner[i + 1]))
                .collect();
        }
    }
    let knots = (0..=count).map(|k| duration_s * k as f64 / count as f64).collect();
    PiecewisePolynomial { knots, segments }
}

/// Value of a spline at its knot number `span`, the start of the span in question (de Boor's algorithm).
fn de_boor(control: &[f64], knots: &[f64], degree: usize, span: usize) -> f64 {
    let at = knots[span];
    let mut points = control[span - degree..=span].to_vec();
    for level in 1..=degree {
        for i in (level..=degree).rev() {
            let first = knots[span - degree + i];
            let weight = (at - first) / (knots[span + 1 + i - level] - first);
            points[i] = (1.0 - weight) * points[i - 1] + weight * points[i];
        }
    }
    points[degree]
}

impl Reference for Bspline {
    fn joints(&self) -> usize {
        self.curves.len()
    }

    fn duration_s(&self) -> f64 {
        self.data.duration_s
    }

    fn at(&self, t_s: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        fill(self, t_s, [q, qd, qdd], |joint, t| self.curves[joint].at(t));
    }

    fn along(&self, times_s: &[f64], signals: [&mut Channels; 3]) {
        fill_along(self, times_s, signals, |joint, sheet| self.curves[joint].along(sheet));
    }

    /// Exact, from the roots of the derivatives.
    fn peaks(&self, joint: usize) -> Option<Peaks> {
        Some(self.curves[joint].peaks())
    }
}

impl TryFrom<Data> for Bspline {
    type Error = Error;

    fn try_from(data: Data) -> Result<Self> {
        Self::new(data.duration_s, data.degree, data.joints)
    }
}

impl From<Bspline> for Data {
    fn from(spline: Bspline) -> Self {
        spline.data
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::testing::{assert_derivatives, assert_peaks_tight, assert_zero_ends, state};
    use proptest::prelude::*;

    fn spline(duration_s: f64, degree: usize, points: Vec<Vec<f64>>) -> Result<Bspline> {
        let joints = points.into_iter().map(|control_points| JointPoints { control_points }).collect();
        Bspline::new(duration_s, degree, joints)
    }

    fn any_points() -> impl Strategy<Value = Vec<Vec<f64>>> {
        prop::collection::vec(prop::collection::vec(-2.0_f64..2.0, 2..9), 1..4)
    }

    #[test]
    fn matches_scipy() {
        // scipy.interpolate.BSpline, made by tests/reference/excitation_bspline.py.
        let reference = include_str!("../../../../tests/reference/excitation_bspline.csv");
        let points = vec![1.0, -2.0, 0.5, 1.5, -0.7];
        let mut rows = 0;
        for line in reference.lines().skip(1) {
            let row: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            let curve = spline(7.0, row[0] as usize, vec![points.clone()]).unwrap();
            for (actual, expected) in state(&curve, row[1]).concat().iter().zip(&row[2..]) {
                assert!((actual - expected).abs() < 1e-12, "{line}: {actual}");
            }
            rows += 1;
        }
        assert_eq!(rows, 5 * 40);
    }

    proptest! {
        #[test]
        fn velocity_and_acceleration_are_derivatives(
            points in any_points(),
            degree in 3usize..=7,
            t in 0.0_f64..5.0,
        ) {
            assert_derivatives(&spline(5.0, degree, points).unwrap(), t);
        }

        #[test]
        fn ends_are_zero_and_spans_join_smoothly(points in any_points(), degree in 3usize..=7) {
            let curve = spline(5.0, degree, points).unwrap();
            assert_zero_ends(&curve, 1e-11, |joint, t| curve.curves[joint].at(t));
            for (joint, spans) in curve.curves.iter().enumerate() {
                for knot in &spans.knots[1..spans.knots.len() - 1] {
                    for order in 0..3 {
                        let (before, after) = (state(&curve, knot - 1e-13), state(&curve, *knot));
                        prop_assert!((before[order][joint] - after[order][joint]).abs() < 1e-9);
                    }
                }
            }
        }

        #[test]
        fn peaks_are_exact(points in prop::collection::vec(-2.0_f64..2.0, 2..9), degree in 3usize..=7) {
            assert_peaks_tight(&spline(5.0, degree, vec![points]).unwrap(), 1e-3);
        }
    }

    #[test]
    fn wrong_data_is_refused() {
        assert!(spline(5.0, 2, vec![vec![1.0]]).unwrap_err().to_string().contains("degree"));
        assert!(spline(5.0, 5, vec![vec![1.0], vec![]]).unwrap_err().to_string().contains("joint 2"));
        assert!(spline(5.0, 7, vec![vec![1.0]]).unwrap_err().to_string().contains("at least 2"));
        assert!(spline(5.0, 5, vec![vec![f64::NAN]]).unwrap_err().to_string().contains("finite"));
        assert!(spline(0.0, 5, vec![vec![1.0]]).is_err());
    }
}
