//! Limits of the joints, and whether a motion keeps inside them.
//!
//! The motions of this module know their own peaks, so that one accepted here is inside the limits at all times. Any
//! other [`Reference`] is judged on samples, and the report says so.

use serde::{Deserialize, Serialize};

use super::Reference;
use super::primitives::{Extreme, Peaks, timing};
use crate::error::{Error, Result};
use crate::robot::JointKind;

/// The share of a limit by which rounding may pass it.
const ROUNDING: f64 = 1e-12;

/// Limits of one joint.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::excitation::random_sequence::random_sequence;
/// use tauscope::excitation::{JointLimits, Reference};
///
/// let limits = JointLimits { lower: -2.0, upper: 2.0, velocity: 3.0, acceleration: 20.0 };
/// limits.validate("elbow")?;
/// let motion = random_sequence(1, "motion", 0, 4, 6.0, &[limits])?;
/// assert!(limits.used(&motion.peaks(0).expect("the law gives bounds")) <= 1.0);
///
/// // Motions start at rest at zero, which limits must leave free.
/// assert!(JointLimits { lower: 0.5, ..limits }.validate("elbow").is_err());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointLimits {
    /// Lowest position, rad, not above zero.
    pub lower: f64,
    /// Highest position, rad, not below zero.
    pub upper: f64,
    /// Highest speed, rad/s.
    pub velocity: f64,
    /// Highest magnitude of the acceleration, rad/s^2.
    pub acceleration: f64,
}

impl JointLimits {
    /// Refuses limits that no motion from rest at zero can keep; infinite ones are allowed.
    ///
    /// # Errors
    /// Names `joint` and the limit at fault.
    pub fn validate(&self, joint: &str) -> Result<()> {
        for (name, value, fine, rule) in [
            ("lower limit", self.lower, self.lower <= 0.0, "at most zero, where motions start"),
            ("upper limit", self.upper, self.upper >= 0.0, "at least zero, where motions start"),
            ("velocity limit", self.velocity, self.velocity > 0.0, "above zero"),
            ("acceleration limit", self.acceleration, self.acceleration > 0.0, "above zero"),
        ] {
            if !fine {
                return Err(Error::request(joint, format!("the {name} must be {rule}, found {value}")));
            }
        }
        Ok(())
    }

    /// Every peak of a motion with the limit that it must keep.
    fn judge(&self, peaks: &Peaks) -> [Judged; 4] {
        [
            Judged { limit: "lower position", per: "", bound: self.lower, peak: peaks.lowest },
            Judged { limit: "upper position", per: "", bound: self.upper, peak: peaks.highest },
            Judged { limit: "velocity", per: "/s", bound: self.velocity, peak: peaks.velocity },
            Judged { limit: "acceleration", per: "/s^2", bound: self.acceleration, peak: peaks.acceleration },
        ]
    }

    /// The largest share of any limit that a motion takes up: 1 when it just touches one, above 1 when it passes one.
    pub fn used(&self, peaks: &Peaks) -> f64 {
        self.judge(peaks).iter().map(Judged::used).fold(0.0, f64::max)
    }
}

/// A peak held against its limit; position limits count on their own side of zero.
struct Judged {
    limit: &'static str,
    /// What stands behind rad or m in the unit.
    per: &'static str,
    bound: f64,
    peak: Extreme,
}

impl Judged {
    fn excess(&self) -> f64 {
        self.peak.value.abs() - self.bound.abs()
    }

    fn used(&self) -> f64 {
        if self.peak.value == 0.0 { 0.0 } else { self.peak.value.abs() / self.bound.abs() }
    }

    fn passed(&self) -> bool {
        // Written so that a peak that is not a number counts as passed.
        let kept = self.excess() <= ROUNDING * self.bound.abs();
        !kept
    }

    fn describe(&self, kind: JointKind) -> String {
        let Judged { limit, per, bound, peak: Extreme { value, time_s } } = self;
        let unit = if kind == JointKind::Revolute { format!("rad{per}") } else { format!("m{per}") };
        let degrees = |value: f64| {
            if kind == JointKind::Prismatic || *per == "/s^2" {
                String::new()
            } else {
                format!(" ({:.2} deg{per})", value.to_degrees())
            }
        };
        format!(
            "{value:.5} {unit}{} at t = {time_s:.4} s passes the {limit} limit {bound:.5} {unit}{} by {:.3e} {unit}{}",
            degrees(*value),
            degrees(*bound),
            self.excess(),
            degrees(self.excess()),
        )
    }
}

/// What a motion that keeps inside the limits asks of an arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// One entry per joint.
    pub joints: Vec<JointReport>,
}

/// What a motion asks of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointReport {
    /// Name of the joint.
    pub name: String,
    /// Extremes of the motion.
    pub peaks: Peaks,
    /// Whether the peaks hold at all times; false when they come from samples.
    pub at_all_times: bool,
    /// The largest share of any limit taken up, 0 to 1.
    pub used: f64,
}

/// [`check_kinds`] for an arm whose joints all turn.
///
/// # Errors
/// Those of [`check_kinds`].
pub(crate) fn check<S: AsRef<str>>(
    reference: &dyn Reference,
    limits: &[JointLimits],
    rate_hz: f64,
    joint_names: &[S],
) -> Result<Report> {
    check_kinds(reference, limits, rate_hz, joint_names, &vec![JointKind::Revolute; joint_names.len()])
}

/// Checks that `reference` keeps inside `limits` (one entry per joint), at all times where its law gives bounds, else on samples
/// at `rate_hz`.
///
/// # Errors
/// Names the joint that passes a limit by the largest factor, the time, the limit and the excess, and lists the other
/// limits passed, in the units of `kinds`. Refuses limits, names or kinds for another number of joints, and a rate that is not above zero.
pub fn check_kinds<S: AsRef<str>>(
    reference: &dyn Reference,
    limits: &[JointLimits],
    rate_hz: f64,
    joint_names: &[S],
    kinds: &[JointKind],
) -> Result<Report> {
    let joints = reference.joints();
    for (what, count) in [("limits", limits.len()), ("joint names", joint_names.len()), ("kinds", kinds.len())] {
        if count != joints {
            return Err(Error::request(what, format!("the motion has {joints} joints, but there are {count} {what}")));
        }
    }
    timing::require_positive("rate_hz", rate_hz)?;
    let known: Option<Vec<Peaks>> = (0..joints).map(|joint| reference.peaks(joint)).collect();
    let at_all_times = known.is_some();
    let peaks = known.unwrap_or_else(|| sampled_peaks(reference, rate_hz));
    let mut report = Report { joints: Vec::with_capacity(joints) };
    let mut passed: Vec<(&str, JointKind, Judged)> = Vec::new();
    for (((limits, peaks), name), &kind) in limits.iter().zip(peaks).zip(joint_names).zip(kinds) {
        let name = name.as_ref();
        limits.validate(name)?;
        passed.extend(limits.judge(&peaks).into_iter().filter(Judged::passed).map(|judged| (name, kind, judged)));
        report.joints.push(JointReport { name: name.to_owned(), peaks, at_all_times, used: limits.used(&peaks) });
    }
    let Some((joint, kind, worst)) = passed.iter().max_by(|a, b| a.2.used().total_cmp(&b.2.used())) else {
        return Ok(report);
    };
    let mut problem = worst.describe(*kind);
    let others: Vec<String> = passed
        .iter()
        .filter(|(name, _, judged)| (name, judged.limit) != (joint, worst.limit))
        .map(|(name, _, judged)| format!("{name} {}", judged.limit))
        .collect();
    if !others.is_empty() {
        problem += &format!("; also passed: {}", others.join(", "));
    }
    Err(Error::request(*joint, format!("{problem}; slow the motion down or make it smaller")))
}

/// Peaks of every joint over samples at `rate_hz` and at the end.
fn sampled_peaks(reference: &dyn Reference, rate_hz: f64) -> Vec<Peaks> {
    let joints = reference.joints();
    let end = reference.duration_s();
    let [mut q, mut qd, mut qdd] = [(); 3].map(|()| vec![0.0; joints]);
    let mut peaks = vec![Peaks::default(); joints];
    let steps = (end * rate_hz).floor() as u64;
    for t in (0..=steps).map(|k| k as f64 / rate_hz).chain([end]) {
        reference.at(t, &mut q, &mut qd, &mut qdd);
        for (joint, peaks) in peaks.iter_mut().enumerate() {
            peaks.include(t, [q[joint], qd[joint], qdd[joint]]);
        }
    }
    peaks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::trajectories::freudenstein::{FreudensteinSequence, JointMoves};

    /// One joint out to `to` and back, 1 s each way.
    fn out_and_back(to: f64) -> FreudensteinSequence {
        let still = JointMoves { duration_s: vec![2.0], via: vec![] };
        let joint = JointMoves { duration_s: vec![1.0, 1.0], via: vec![to] };
        FreudensteinSequence::new(2.0, vec![still, joint]).unwrap()
    }

    const WIDE: JointLimits = JointLimits { lower: -2.0, upper: 2.0, velocity: 4.0, acceleration: 10.0 };
    const NAMES: [&str; 2] = ["shoulder", "elbow"];

    fn refusal(to: f64, limits: JointLimits) -> String {
        check(&out_and_back(to), &[WIDE, limits], 100.0, &NAMES).unwrap_err().to_string()
    }

    #[test]
    fn limits_just_kept_are_accepted_and_reported() {
        let tight = JointLimits { upper: 1.0, velocity: 2.0, acceleration: 5.060_283_468_869_465, ..WIDE };
        let report = check(&out_and_back(1.0), &[WIDE, tight], 100.0, &NAMES).unwrap();
        assert_eq!(report.joints[1].name, "elbow");
        assert!(report.joints[1].at_all_times && (report.joints[1].used - 1.0).abs() < 1e-12);
        assert_eq!(report.joints[0].used, 0.0);
    }

    #[test]
    fn refusals_name_joint_time_limit_and_excess() {
        for (to, limits, words) in [
            (1.0, JointLimits { upper: 0.75, ..WIDE }, ["upper position", "1.0000 s", "2.500e-1 rad (14.32 deg)"]),
            (-1.0, JointLimits { lower: -0.75, ..WIDE }, ["lower position", "1.0000 s", "2.500e-1 rad"]),
            (1.0, JointLimits { velocity: 1.5, ..WIDE }, ["velocity", "0.5000 s", "5.000e-1 rad/s"]),
            (1.0, JointLimits { acceleration: 5.0, ..WIDE }, ["acceleration", "0.2500 s", "6.028e-2 rad/s^2"]),
        ] {
            let message = refusal(to, limits);
            assert!(message.starts_with("elbow: "), "{message}");
            for word in words {
                assert!(message.contains(word), "{message} lacks {word}");
            }
        }
    }

    #[test]
    fn sliding_joints_have_no_degrees() {
        let kinds = [JointKind::Revolute, JointKind::Prismatic];
        let limits = [WIDE, JointLimits { upper: 0.75, ..WIDE }];
        let message = check_kinds(&out_and_back(1.0), &limits, 100.0, &NAMES, &kinds).unwrap_err().to_string();
        assert!(message.contains("0.75000 m by 2.500e-1 m;") && !message.contains("deg"), "{message}");
    }

    #[test]
    fn other_limits_passed_are_listed() {
        let message = refusal(1.0, JointLimits { upper: 0.9, velocity: 0.5, ..WIDE });
        assert!(message.contains("passes the velocity limit"), "{message}");
        assert!(message.contains("also passed: elbow upper position"), "{message}");
    }

    #[test]
    fn a_peak_between_samples_is_seen() {
        // Samples at 1 Hz fall on the via points, where the arm stands still.
        let message =
            check(&out_and_back(1.0), &[WIDE, JointLimits { velocity: 1.9, ..WIDE }], 1.0, &NAMES).unwrap_err();
        assert!(message.to_string().contains("velocity"), "{message}");
    }

    /// A reference that does not know its peaks.
    struct Opaque(FreudensteinSequence);

    impl Reference for Opaque {
        fn joints(&self) -> usize {
            self.0.joints()
        }
        fn duration_s(&self) -> f64 {
            self.0.duration_s()
        }
        fn at(&self, t_s: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
            self.0.at(t_s, q, qd, qdd);
        }
    }

    #[test]
    fn a_reference_without_known_peaks_is_judged_on_samples() {
        let opaque = Opaque(out_and_back(1.0));
        let report = check(&opaque, &[WIDE, WIDE], 1000.0, &NAMES).unwrap();
        assert!(!report.joints[1].at_all_times);
        assert!((report.joints[1].peaks.velocity.value - 2.0).abs() < 1e-12);
        assert!(check(&opaque, &[WIDE, JointLimits { velocity: 1.9, ..WIDE }], 1000.0, &NAMES).is_err());
    }

    #[test]
    fn wrong_counts_and_limits_are_refused() {
        let motion = out_and_back(1.0);
        assert!(check(&motion, &[WIDE], 100.0, &NAMES).unwrap_err().to_string().contains("2 joints"));
        assert!(check(&motion, &[WIDE, WIDE], 100.0, &["one"]).unwrap_err().to_string().contains("joint names"));
        assert!(check(&motion, &[WIDE, WIDE], 0.0, &NAMES).is_err());
        let message = refusal(1.0, JointLimits { lower: 0.1, ..WIDE });
        assert!(message.contains("elbow") && message.contains("lower"), "{message}");
        assert!(refusal(1.0, JointLimits { velocity: f64::NAN, ..WIDE }).contains("velocity"));
    }
}
