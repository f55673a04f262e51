//! From a vector in the box [-1, 1]^n to a motion inside given limits: what a search over motions works on.
//!
//! Every point of the box decodes to a motion inside the limits, so a search needs no constraints. The 1-3-5 sequences
//! are clipped via point by via point (see [`super::random_sequence`]); the other motions are linear in their unknowns,
//! so each joint is drawn on the natural scale of its limits and then scaled down until it fits.

use rand::RngExt;

use super::primitives::timing;
use super::trajectories::bspline::{Bspline, JointPoints};
use super::trajectories::fourier::{FourierSeries, Harmonics};
use super::trajectories::quintic::{JointSegments, QuinticSequence};
use super::{JointLimits, Motion, Reference};
use crate::error::{Error, Result};
use crate::random;

/// A map from the box [-1, 1]^n onto motions inside the limits it was made with.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::excitation::random_sequence::FreudensteinEncoding;
/// use tauscope::excitation::{Encoding, JointLimits, Reference};
///
/// // What a search works on: every point of a box is a motion inside the limits.
/// let limits = [JointLimits { lower: -2.0, upper: 2.0, velocity: 3.0, acceleration: 20.0 }; 2];
/// let encoding = FreudensteinEncoding::new(&limits, 4, 6.0)?;
/// assert_eq!(encoding.dimension(), 2 * (3 + 4));
///
/// let motion = encoding.decode(&[0.7; 14]);
/// let peaks = motion.peaks(0).expect("the law gives bounds");
/// assert!(limits[0].used(&peaks) <= 1.0);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub trait Encoding: Send + Sync {
    /// Number of unknowns n.
    fn dimension(&self) -> usize;

    /// The motion that `x` stands for; entries outside [-1, 1] count as the nearer end.
    ///
    /// # Panics
    /// When `x` does not have [`Encoding::dimension`] entries, or one is not a number.
    fn decode(&self, x: &[f64]) -> Motion;
}

/// A point drawn uniformly from the box of an encoding, from the stream `label` number `index` of `seed`.
pub fn random_point(encoding: &dyn Encoding, seed: u64, label: &str, index: u64) -> Vec<f64> {
    let mut stream = random::stream(seed, label, index);
    (0..encoding.dimension()).map(|_| stream.random_range(-1.0..=1.0)).collect()
}

/// The share of a limit that decoded motions use at most: below 1 by more than rounding can take.
pub(super) const FULL_USE: f64 = 1.0 - 1e-9;

/// Limits above this (rad, rad/s, rad/s^2) are no arm's and stand for none at all.
const LARGEST_LIMIT: f64 = 1e9;

/// Checks what every encoding is made from.
pub(super) fn require_usable(limits: &[JointLimits], duration_s: f64) -> Result<()> {
    timing::require_positive("duration_s", duration_s)?;
    if limits.is_empty() {
        return Err(Error::request("limits", "are empty; give those of at least one joint"));
    }
    for (j, joint) in limits.iter().enumerate() {
        let name = format!("joint {}", j + 1);
        joint.validate(&name)?;
        let values = [joint.lower, joint.upper, joint.velocity, joint.acceleration];
        if let Some(value) = values.iter().find(|value| value.abs() > LARGEST_LIMIT) {
            return Err(Error::request(
                name,
                format!("a motion cannot be scaled to the limit {value}; give a finite one"),
            ));
        }
    }
    Ok(())
}

/// Refuses a count below `least`.
pub(super) fn require_at_least(subject: &str, count: usize, least: usize) -> Result<()> {
    if count >= least {
        return Ok(());
    }
    Err(Error::request(subject, format!("must be at least {least}, found {count}")))
}

/// The unknowns joint by joint, brought into the box.
pub(super) fn per_joint(x: &[f64], dimension: usize, joints: usize) -> impl Iterator<Item = Vec<f64>> {
    assert_eq!(x.len(), dimension, "the encoding has {dimension} unknowns");
    assert!(x.iter().all(|value| !value.is_nan()), "an unknown is not a number");
    x.chunks(dimension / joints).map(|chunk| chunk.iter().map(|value| value.clamp(-1.0, 1.0)).collect())
}

/// The position that -1 (lower limit) to 1 (upper limit) stands for.
pub(super) fn position(limits: &JointLimits, x: f64) -> f64 {
    0.5 * (limits.lower + limits.upper) + 0.5 * (limits.upper - limits.lower) * x
}

/// Durations that add up to `duration_s`, in proportion to exp(1.2 x): the longest is at most 11 times the shortest.
pub(super) fn durations(x: &[f64], duration_s: f64) -> Vec<f64> {
    let weights: Vec<f64> = x.iter().map(|x| (1.2 * x).exp()).collect();
    let total: f64 = weights.iter().sum();
    weights.iter().map(|weight| duration_s * weight / total).collect()
}

/// Scales the data of every joint down to its limits: `scale(joint data, factor)`, then `build` again.
fn fitted<D: Clone, M: Reference>(
    limits: &[JointLimits],
    joints: Vec<D>,
    build: impl Fn(Vec<D>) -> Result<M>,
    scale: impl Fn(&mut D, f64),
) -> M {
    const FINITE: &str = "finite limits give finite data";
    let drawn = build(joints.clone()).expect(FINITE);
    let mut joints = joints;
    for (j, data) in joints.iter_mut().enumerate() {
        let used = drawn.peaks(j).map_or(0.0, |peaks| limits[j].used(&peaks));
        if used > FULL_USE {
            scale(data, FULL_USE / used);
        }
    }
    build(joints).expect(FINITE)
}

fn multiply(values: &mut [f64], factor: f64) {
    for value in values {
        *value *= factor;
    }
}

/// Finite Fourier series; the unknowns of a joint are a_1 .. a_N, b_1 .. b_N in units of its velocity limit.
#[derive(Clone, Debug)]
pub struct FourierEncoding {
    limits: Vec<JointLimits>,
    harmonics: usize,
    period_s: f64,
    periods: u32,
}

impl FourierEncoding {
    /// Series of `harmonics` (at least 2) harmonics with a base period of `period_s`, run through `periods` times.
    ///
    /// # Errors
    /// Names the joint whose limits are infinite or leave out zero, or the argument at fault.
    pub fn new(limits: &[JointLimits], harmonics: usize, period_s: f64, periods: u32) -> Result<Self> {
        require_usable(limits, period_s)?;
        require_at_least("harmonics", harmonics, 2)?;
        require_at_least("periods", periods as usize, 1)?;
        Ok(FourierEncoding { limits: limits.to_vec(), harmonics, period_s, periods })
    }
}

impl Encoding for FourierEncoding {
    fn dimension(&self) -> usize {
        2 * self.harmonics * self.limits.len()
    }

    fn decode(&self, x: &[f64]) -> Motion {
        let joints = per_joint(x, self.dimension(), self.limits.len())
            .zip(&self.limits)
            .map(|(mut x, limits)| {
                multiply(&mut x, limits.velocity);
                let b = x.split_off(self.harmonics);
                Harmonics { a: x, b }
            })
            .collect();
        let build = |joints| FourierSeries::new(self.period_s, self.periods, joints);
        Motion::Fourier(fitted(&self.limits, joints, build, |joint: &mut Harmonics, factor| {
            multiply(&mut joint.a, factor);
            multiply(&mut joint.b, factor);
        }))
    }
}

/// Quintic segments; the unknowns of a joint are its via positions across its range, via velocities and accelerations in
/// units of their limits, and the shares of the durations.
#[derive(Clone, Debug)]
pub(crate) struct QuinticEncoding {
    limits: Vec<JointLimits>,
    segments: usize,
    duration_s: f64,
    free_acceleration: bool,
}

impl QuinticEncoding {
    /// Sequences of `segments` (at least 2) that last `duration_s`; via accelerations are unknowns when
    /// `free_acceleration`, else zero.
    ///
    /// # Errors
    /// Names the joint whose limits are infinite or leave out zero, or the argument at fault.
    pub(crate) fn new(
        limits: &[JointLimits],
        segments: usize,
        duration_s: f64,
        free_acceleration: bool,
    ) -> Result<Self> {
        require_usable(limits, duration_s)?;
        require_at_least("segments", segments, 2)?;
        Ok(QuinticEncoding { limits: limits.to_vec(), segments, duration_s, free_acceleration })
    }
}

impl Encoding for QuinticEncoding {
    fn dimension(&self) -> usize {
        let states = if self.free_acceleration { 3 } else { 2 };
        (states * (self.segments - 1) + self.segments) * self.limits.len()
    }

    fn decode(&self, x: &[f64]) -> Motion {
        let vias = self.segments - 1;
        let joints = per_joint(x, self.dimension(), self.limits.len())
            .zip(&self.limits)
            .map(|(x, limits)| {
                let (shares, states) = x.split_at(self.segments);
                let (positions, rates) = states.split_at(vias);
                let (velocities, accelerations) = rates.split_at(vias);
                JointSegments {
                    duration_s: durations(shares, self.duration_s),
                    position: positions.iter().map(|x| position(limits, *x)).collect(),
                    velocity: velocities.iter().map(|x| x * limits.velocity).collect(),
                    acceleration: accelerations.iter().map(|x| x * limits.acceleration).collect(),
                }
            })
            .collect();
        let build = |joints| QuinticSequence::new(self.duration_s, joints);
        Motion::Quintic(fitted(&self.limits, joints, build, |joint: &mut JointSegments, factor| {
            multiply(&mut joint.position, factor);
            multiply(&mut joint.velocity, factor);
            multiply(&mut joint.acceleration, factor);
        }))
    }
}

/// B-splines; the unknowns of a joint are its free control points across its range.
#[derive(Clone, Debug)]
pub(crate) struct BsplineEncoding {
    limits: Vec<JointLimits>,
    points: usize,
    degree: usize,
    duration_s: f64,
}

impl BsplineEncoding {
    /// Splines of `degree` with `points` free control points per joint that last `duration_s`.
    ///
    /// # Errors
    /// Names the joint whose limits are infinite or leave out zero, or the argument at fault.
    pub(crate) fn new(limits: &[JointLimits], points: usize, degree: usize, duration_s: f64) -> Result<Self> {
        require_usable(limits, duration_s)?;
        Bspline::new(duration_s, degree, vec![JointPoints { control_points: vec![0.0; points] }; limits.len()])?;
        Ok(BsplineEncoding { limits: limits.to_vec(), points, degree, duration_s })
    }
}

impl Encoding for BsplineEncoding {
    fn dimension(&self) -> usize {
        self.points * self.limits.len()
    }

    fn decode(&self, x: &[f64]) -> Motion {
        let joints = per_joint(x, self.dimension(), self.limits.len())
            .zip(&self.limits)
            .map(|(x, limits)| JointPoints { control_points: x.iter().map(|x| position(limits, *x)).collect() })
            .collect();
        let build = |joints| Bspline::new(self.duration_s, self.degree, joints);
        Motion::Bspline(fitted(&self.limits, joints, build, |joint: &mut JointPoints, factor| {
            multiply(&mut joint.control_points, factor)
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::limits::check;
    use crate::excitation::random_sequence::FreudensteinEncoding;
    use crate::excitation::testing::irb1600;

    fn all() -> Vec<Box<dyn Encoding>> {
        let limits = irb1600();
        vec![
            Box::new(FreudensteinEncoding::new(&limits, 6, 10.0).unwrap()),
            Box::new(FourierEncoding::new(&limits, 5, 10.0, 1).unwrap()),
            Box::new(QuinticEncoding::new(&limits, 6, 10.0, true).unwrap()),
            Box::new(QuinticEncoding::new(&limits, 6, 10.0, false).unwrap()),
            Box::new(BsplineEncoding::new(&limits, 11, 5, 10.0).unwrap()),
        ]
    }

    const NAMES: [&str; 6] = ["1", "2", "3", "4", "5", "6"];

    #[test]
    fn every_point_of_the_box_decodes_to_a_motion_inside_the_limits() {
        for encoding in all() {
            let kind = encoding.decode(&vec![0.5; encoding.dimension()]).kind();
            for index in 0..50 {
                let motion = encoding.decode(&random_point(&*encoding, 7, "encoding", index));
                assert_eq!(motion.duration_s(), 10.0);
                let report =
                    check(&motion, &irb1600(), 1000.0, &NAMES).unwrap_or_else(|error| panic!("{kind}: {error}"));
                for joint in report.joints {
                    assert!(joint.at_all_times && joint.used > 0.1, "{kind}: {joint:?}");
                }
            }
            for corner in [-1.0, 1.0, 30.0] {
                let motion = encoding.decode(&vec![corner; encoding.dimension()]);
                check(&motion, &irb1600(), 1000.0, &NAMES).unwrap_or_else(|error| panic!("{kind}: {error}"));
            }
        }
    }

    #[test]
    fn small_motions_are_not_scaled() {
        let limits = irb1600();
        let encoding = FourierEncoding::new(&limits, 2, 10.0, 1).unwrap();
        let mut x = vec![0.0; encoding.dimension()];
        (x[0], x[1]) = (0.01, -0.01);
        let Motion::Fourier(series) = encoding.decode(&x) else { panic!("another kind") };
        assert!((series.harmonics()[0].a[0] - 0.01 * limits[0].velocity).abs() < 1e-15);
    }

    #[test]
    fn unusable_arguments_are_refused() {
        let mut limits = irb1600();
        assert!(FourierEncoding::new(&limits, 1, 10.0, 1).is_err());
        assert!(FourierEncoding::new(&limits, 5, 10.0, 0).is_err());
        assert!(QuinticEncoding::new(&limits, 1, 10.0, true).is_err());
        assert!(BsplineEncoding::new(&limits, 0, 5, 10.0).is_err());
        assert!(BsplineEncoding::new(&[], 5, 5, 10.0).is_err());
        limits[3].upper = f64::INFINITY;
        let message = FourierEncoding::new(&limits, 5, 10.0, 1).unwrap_err().to_string();
        assert!(message.contains("joint 4") && message.contains("finite"), "{message}");
    }
}
