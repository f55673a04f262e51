//! What a measured log is worth: every fault found in it, where it is, and what to do about it.
//!
//! Checks of single channels need nothing but the log. Those of torque fit a model to every joint: with a URDF the base
//! parameters that act there, without one gravity, rotor and friction of the joint alone.

mod channels;
mod clock;
pub mod descriptions;
mod motion;
mod torque;
mod velocity;

pub use channels::{clipping, motor_off};
pub use motion::JointSummary;

use crate::channels::Channels;
use crate::error::Result;
use crate::recording::Recording;
use crate::recording::lenient::{self, ColumnMap, Rejected, Sieved};
use crate::recording::resample::{self, Clock};
use crate::robot::Robot;
use crate::signal::{Edge, NoiseGains, SavitzkyGolay, Slow};
use descriptions::Verdict;
use std::borrow::Cow;
use std::path::Path;

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Results will be wrong or poor unless something is done.
    Warning,
    /// The log cannot be used.
    Fatal,
}

/// What kind of fault it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "the names say it; the text of a finding explains")]
pub enum Kind {
    TooShort,
    CutOff,
    BadRows,
    DuplicateTime,
    BackwardTime,
    Jitter,
    Gap,
    NoMotion,
    NoTorque,
    Frozen,
    HeldSamples,
    Clipped,
    Spike,
    Wrapped,
    UnsignedTorque,
    TorqueSign,
    TorqueUnit,
    VelocitySign,
    VelocityUnit,
    VelocityMismatch,
    VelocityDelay,
    PositionUnit,
    OutsideLimits,
    Swapped,
    DeadTime,
    HardlyMoves,
    PoorExcitation,
    TwoSources,
    Mended,
    UnusedColumns,
    PositionSign,
    Mounting,
    GravityCompensated,
    ClockFactor,
    MotorOff,
    ModelTorque,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Finding {
    /// What kind of fault.
    pub kind: Kind,
    /// The column, joint, line or time.
    #[serde(rename = "where")]
    pub place: String,
    /// How bad.
    pub severity: Severity,
    /// What is wrong and what to do.
    pub text: String,
}

impl Finding {
    fn new(kind: Kind, severity: Severity, place: impl Into<String>, text: impl Into<String>) -> Self {
        Finding { kind, place: place.into(), severity, text: text.into() }
    }
}

/// Units of a log that are not those of its description.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct UnitChanges {
    /// True seconds per second of the clock.
    pub time_factor: Option<f64>,
    /// Whether positions are in degrees.
    pub degrees: bool,
}

/// Everything found in a log.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Report {
    /// Rows that can be used.
    pub rows: usize,
    /// Rows that were left out.
    pub rejected: Vec<Rejected>,
    /// Time from the first to the last sample, s.
    pub duration_s: f64,
    /// Rate and jitter.
    pub clock: Clock,
    /// Range, speed and torque of every joint.
    pub joints: Vec<JointSummary>,
    /// Condition number of the base parameters' regressor with columns of equal length; with a URDF only.
    pub condition_number: Option<f64>,
    /// What is wrong with the description of the log.
    #[serde(skip)]
    pub description: Option<Verdict>,
    /// Units that are not those of the description.
    #[serde(skip)]
    pub units: UnitChanges,
    /// What is wrong, the worst first.
    pub findings: Vec<Finding>,
    /// Whether the log can be used at all.
    pub usable: bool,
}

impl Report {
    /// The first reason why the log cannot be used.
    pub fn fatal(&self) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.severity == Severity::Fatal)
    }
}

/// Reads a log leniently and examines it; with the arm's joints in order and their limits where `robot` is known.
///
/// # Errors
/// Those of [`lenient::load`]: the file cannot be read as a log at all.
pub fn inspect(path: &Path, robot: Option<&Robot>) -> Result<Report> {
    let names = robot.map(Robot::joint_names);
    examine(&lenient::load(path, names.as_deref(), &ColumnMap::default())?, robot)
}

/// Examines a log. `robot` gives limits and geometry; its inertias are used where they are possible.
///
/// # Errors
/// None on a log of any content; those of the filters are passed on.
pub fn examine(sieved: &Sieved, robot: Option<&Robot>) -> Result<Report> {
    let mut together = examine_together(&[sieved], robot)?;
    Ok(together.reports.remove(0))
}

/// What was found in several logs of one arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Together {
    /// One report per log.
    pub reports: Vec<Report>,
    /// What is wrong with the description of all of them.
    pub verdict: Option<Verdict>,
}

/// Examines several logs of one arm, whose description is judged on all of them together. Where they contradict each other,
/// each is judged by itself.
///
/// # Errors
/// Those of [`examine`].
pub fn examine_together(logs: &[&Sieved], robot: Option<&Robot>) -> Result<Together> {
    let (mut reports, mut torques) = (Vec::new(), Vec::new());
    for sieved in logs {
        let (report, usable) = examine_alone(sieved, robot)?;
        reports.push(report);
        torques.push(usable);
    }
    let with_torque: Vec<usize> = (0..logs.len()).filter(|&log| torques[log].is_some()).collect();
    let views: Vec<View> = torques.iter().flatten().map(|log| View::new(log, robot)).collect::<Result<_>>()?;
    let all: Vec<&View> = views.iter().collect();
    let verdict = descriptions::judge(&all, robot);
    for (&log, view) in with_torque.iter().zip(&views) {
        let own = match verdict {
            None if views.len() > 1 => descriptions::judge(&[view], robot),
            _ => verdict.clone(),
        };
        if let Some(own) = own {
            reports[log].findings.extend(descriptions::findings(&own, &view.log.joints));
            reports[log].description = Some(own);
            reports[log].findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
        }
    }
    // Where something else is wrong, that must be corrected first.
    let sound = reports.iter().flat_map(|report| &report.findings).all(|finding| finding.severity == Severity::Note);
    if sound && descriptions::is_modelled(&all, robot) {
        let text = "the torques are those of a rigid-body model without friction: they come from the controller's own model or a \
                    simulation and are no measurement; identification gives that model back";
        for &log in &with_torque {
            reports[log].findings.push(Finding::new(Kind::ModelTorque, Severity::Note, "tau", text));
        }
    }
    Ok(Together { reports, verdict })
}

/// Examines all of a log but its description, and returns it at even steps without long gaps where torques can be compared
/// with motion.
fn examine_alone(sieved: &Sieved, robot: Option<&Robot>) -> Result<(Report, Option<Recording>)> {
    let recording = &sieved.recording;
    let clock = Clock::new(recording);
    let mut findings = clock::findings(sieved, &clock);
    let mut summaries = Vec::new();
    let mut condition_number = None;
    let mut comparable = None;
    let mut units = UnitChanges::default();
    if findings.iter().all(|finding| finding.severity != Severity::Fatal) {
        let known = with_all_torques(recording);
        let recording: &Recording = &known;
        let even = if clock.is_irregular() { resample::evenly(recording) } else { recording.clone() };
        let view = View::new(&even, robot)?;
        summaries = motion::summaries(&view, robot);
        findings.extend(channels::findings(&view, &sieved.recording));
        let mut about_motion = motion::findings(&view, &summaries, robot);
        // A joint that went on turning may be whole turns outside its limits.
        let turned = |finding: &Finding| sieved.unwrapped.iter().any(|&joint| finding.place == view.place("q", joint));
        about_motion.retain(|finding| finding.kind != Kind::OutsideLimits || !turned(finding));
        let positions_doubtful = about_motion.iter().any(|f| f.kind == Kind::PositionUnit);
        findings.extend(about_motion);
        // Derivatives across a long gap are those of no motion.
        let longest = resample::longest_stretch(recording).map(|rows| resample::evenly(&recording.slice(rows)));
        let view = longest.as_ref().map_or(Ok(view), |log| View::new(log, robot))?;
        let (about_velocity, factor) = velocity::findings(&view);
        findings.extend(about_velocity);
        units.time_factor = factor;
        units.degrees = positions_doubtful && motion::in_degrees(&summaries, robot);
        let moves = findings.iter().all(|finding| finding.severity != Severity::Fatal);
        if moves && !positions_doubtful {
            let (found, condition) = torque::findings(&view, &mut summaries, robot);
            // Nothing is known of times where the clock is wrong.
            let clock_is_wrong = findings.iter().any(|finding| finding.kind == Kind::ClockFactor);
            findings.extend(found.into_iter().filter(|finding| finding.kind != Kind::DeadTime || !clock_is_wrong));
            condition_number = condition;
            let unsigned = channels::without_sign(&view, &findings);
            let mut log = longest.unwrap_or(even);
            unsigned.iter().for_each(|&joint| log.tau.channel_mut(joint).fill(0.0));
            comparable = Some(log).filter(|_| unsigned.len() < recording.joints());
        }
    }
    findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    let report = Report {
        rows: recording.samples(),
        rejected: sieved.rejected.clone(),
        duration_s: recording.duration(),
        clock,
        joints: summaries,
        condition_number,
        description: None,
        units,
        usable: findings.iter().all(|finding| finding.severity != Severity::Fatal),
        findings,
    };
    Ok((report, comparable))
}

/// The log with zeros where a joint has no torque, which the checks of motion do not look at.
fn with_all_torques(recording: &Recording) -> Cow<'_, Recording> {
    let without: Vec<usize> = (0..recording.joints()).filter(|joint| !recording.has_torque(*joint)).collect();
    if without.is_empty() {
        return Cow::Borrowed(recording);
    }
    let mut log = recording.clone();
    without.into_iter().for_each(|joint| log.tau.channel_mut(joint).fill(0.0));
    Cow::Owned(log)
}

/// Time over which positions are smoothed for the checks, s.
const SMOOTHING_S: f64 = 0.08;

/// A log at even steps with what all checks need of it.
struct View<'a> {
    log: &'a Recording,
    period: f64,
    /// Savitzky-Golay of positions and torques.
    q: Channels,
    qd: Channels,
    qdd: Channels,
    tau: Channels,
    /// Speed above which each joint surely moves, rad/s or m/s; none reaches it where the joint hardly moves at all.
    band: Vec<f64>,
}

impl<'a> View<'a> {
    fn new(log: &'a Recording, robot: Option<&Robot>) -> Result<Self> {
        let period = 1.0 / log.rate_hz();
        let window = ((SMOOTHING_S / period).round() as usize | 1).clamp(7, 101).min((log.samples() - 1) | 1);
        let smooth = |signals: &Channels, degree| -> Result<Channels> {
            let smoother = SavitzkyGolay::new(window, 4, degree, period, Edge::Polynomial)?;
            let mut out = Channels::zeros(signals.channels(), signals.samples());
            for joint in 0..signals.channels() {
                smoother.apply(signals.channel(joint), out.channel_mut(joint))?;
            }
            Ok(out)
        };
        let (q, qd) = (smooth(&log.q, 0)?, smooth(&log.q, 1)?);
        let gains = NoiseGains::new(log.samples(), |impulse| {
            let impulse = Channels::from_vectors(&[impulse.to_vec()]);
            Ok([smooth(&impulse, 0)?, smooth(&impulse, 1)?].map(|passed| passed.channel(0).to_vec()))
        })?;
        let band = (0..log.joints()).map(|joint| {
            let (own, velocity) = (log.q.channel(joint), qd.channel(joint));
            match motion::moves(own, velocity, robot.map(|robot| robot.joints[joint].kind)) {
                true => Slow::new(velocity, gains.velocity_noise(own, q.channel(joint))).sure,
                false => f64::INFINITY,
            }
        });
        Ok(View { log, period, band: band.collect(), q, qd, qdd: smooth(&log.q, 2)?, tau: smooth(&log.tau, 0)? })
    }

    fn dof(&self) -> usize {
        self.log.joints()
    }

    /// A column as the file may call it, with the joint.
    fn place(&self, quantity: &str, joint: usize) -> String {
        format!("{quantity}{} ({})", joint + 1, self.log.joints[joint])
    }
}

/// Correlation about zero of two signals; zero where one of them is.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let scale = (dot(a, a) * dot(b, b)).sqrt();
    if scale > 0.0 { dot(a, b) / scale } else { 0.0 }
}

/// The value below which a share of all sizes lies.
fn size_quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut sizes: Vec<f64> = values.map(f64::abs).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let place = ((sizes.len() - 1) as f64 * share) as usize;
    *sizes.select_nth_unstable_by(place, f64::total_cmp).1
}

#[cfg(test)]
mod every_kind;
#[cfg(test)]
mod tests;
