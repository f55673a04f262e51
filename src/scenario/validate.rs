//! Checks of a scenario on its own; what needs the arm or a motion is checked where those are loaded.

use super::locate::Located;
use super::montecarlo::MonteCarloSpec;
use super::spec::{MotionSpec, SCHEMA, Scenario};
use super::values::PerJoint;
use crate::error::Result;
use crate::robot::LARGEST;
use crate::signal::{Edge, SavitzkyGolay};

/// Smallest encoder step and time taken for a number; below, its inverse would leave double precision.
const SMALLEST: f64 = 1e-12;

/// Samples of one motion that are kept in memory (some gigabytes for six joints).
pub(super) const MOST_SAMPLES: usize = 1_000_000;

/// Plant steps of one motion (hours of computing).
const MOST_STEPS: f64 = 1e9;

/// Moves of a joint in a random motion.
const MOST_MOVES: usize = 10_000;

/// Longest smoothing window: its edge weights grow with the square.
const LONGEST_WINDOW: usize = 5001;

pub(super) fn validate(scenario: &Scenario, at: &Located) -> Result<()> {
    if scenario.schema != SCHEMA {
        return Err(at.error("schema", format!("`{}` is not `{SCHEMA}`", scenario.schema)));
    }
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if scenario.name.is_empty() || scenario.name.starts_with('.') || !scenario.name.chars().all(plain) {
        let problem = format!("`{}` names the results folder: use letters, digits, - and _", scenario.name);
        return Err(at.error("name", problem));
    }
    let plant = &scenario.plant;
    let sensors = &scenario.sensors;
    let controller = &scenario.controller;
    for (key, value) in [
        ("plant.step_s", plant.step_s),
        ("sensors.rate_hz", sensors.rate_hz),
        ("controller.bandwidth_hz", controller.bandwidth_hz),
        ("controller.damping_ratio", controller.damping_ratio),
    ] {
        if !(SMALLEST..=LARGEST).contains(&value) {
            return Err(
                at.error(key, format!("{value:?} must be a number above zero, from {SMALLEST:e} to {LARGEST:e}"))
            );
        }
    }
    if !(0.0..1.0).contains(&controller.model_error) {
        return Err(at.error("controller.model_error", format!("{} must lie in 0 .. 1", controller.model_error)));
    }
    let band = scenario.identification.reversal_band_rad_s;
    if !(0.0..=LARGEST).contains(&band) {
        let problem = format!("{band:?} must be a number from 0 to {LARGEST:e}");
        return Err(at.error("identification.reversal_band_rad_s", problem));
    }
    if let Some(cutoff) = scenario.identification.low_pass_hz
        && !(cutoff > 0.0 && cutoff < 0.5 * sensors.rate_hz)
    {
        let problem = format!("{cutoff} must lie between zero and half the rate, {}", 0.5 * sensors.rate_hz);
        return Err(at.error("identification.low_pass_hz", problem));
    }
    if scenario.identification.decimation == 0 {
        return Err(at.error("identification.decimation", "must be 1 or more"));
    }
    smoothing(scenario, at)?;
    check_step(scenario, at)?;
    if let Some(bad) = scenario.robot.gravity_m_s2.iter().flatten().find(|g| !(-LARGEST..=LARGEST).contains(*g)) {
        return Err(
            at.error("robot.gravity_m_s2", format!("{bad:?} must be a number between -{LARGEST:e} and {LARGEST:e}"))
        );
    }
    for (key, value) in scenario.per_joint() {
        per_joint(key, value, at)?;
    }
    if let Some((key, problem)) = scenario.montecarlo.as_ref().and_then(|spec| montecarlo_fault(spec, scenario)) {
        return Err(at.error(&format!("montecarlo.{key}"), problem));
    }
    motion("motion", &scenario.motion, at)?;
    motion("held_out", &scenario.held_out, at)
}

/// Refuses a plant step that does not divide the time between samples.
pub(super) fn check_step(scenario: &Scenario, at: &Located) -> Result<()> {
    let (plant, sensors) = (&scenario.plant, &scenario.sensors);
    let steps = 1.0 / (sensors.rate_hz * plant.step_s);
    if steps < 0.999 || (steps - steps.round()).abs() > 1e-6 {
        let problem = format!(
            "one sample takes {steps:.4} plant steps of {} s; choose a rate whose period is a whole number of steps",
            plant.step_s
        );
        return Err(at.error("sensors.rate_hz", problem));
    }
    Ok(())
}

fn per_joint(key: &str, value: &PerJoint, at: &Located) -> Result<()> {
    let values = match value {
        PerJoint::All(value) => std::slice::from_ref(value),
        PerJoint::Each(values) => values,
    };
    match values.iter().find(|&&v| v != 0.0 && !(SMALLEST..=LARGEST).contains(&v)) {
        Some(bad) => Err(at.error(key, format!("{bad:?} must be zero or a number from {SMALLEST:e} to {LARGEST:e}"))),
        None => Ok(()),
    }
}

fn smoothing(scenario: &Scenario, at: &Located) -> Result<()> {
    let spec = &scenario.identification;
    let (window, order) = ("identification.smoothing_window", "identification.smoothing_order");
    let samples = spec.fixed_window(scenario.sensors.rate_hz);
    if samples > LONGEST_WINDOW {
        let problem = format!("{samples} samples are too many; take at most {LONGEST_WINDOW}");
        return Err(at.error(window, problem));
    }
    // Acceleration is the highest derivative taken.
    let period = 1.0 / scenario.sensors.rate_hz;
    match SavitzkyGolay::new(samples, spec.smoothing_order, 2, period, Edge::Nearest) {
        Err(problem) if samples.is_multiple_of(2) => Err(at.wrap(window, &problem)),
        Err(problem) => Err(at.wrap(order, &problem)),
        Ok(_) => Ok(()),
    }
}

/// Refuses a motion under `key` that is too long to simulate or shorter than the smoothing window.
pub(super) fn length(scenario: &Scenario, key: &str, duration_s: f64, at: &Located) -> Result<()> {
    let samples = scenario.samples(duration_s);
    if samples > MOST_SAMPLES {
        let problem = format!(
            "{duration_s:?} s at {} Hz are {samples} samples, more than the {MOST_SAMPLES} that are kept in memory; take \
             a shorter motion or a lower sensors.rate_hz",
            scenario.sensors.rate_hz
        );
        return Err(at.error(key, problem));
    }
    let steps = duration_s / scenario.plant.step_s;
    if steps > MOST_STEPS {
        let problem =
            format!("{duration_s:?} s take {steps:.0} steps, more than {MOST_STEPS:e}; take a longer plant.step_s");
        return Err(at.error(key, problem));
    }
    let window = scenario.identification.fixed_window(scenario.sensors.rate_hz);
    if samples < window {
        let problem = format!(
            "{duration_s:?} s at {} Hz are {samples} samples, fewer than the {window} of identification.smoothing_window; \
             take a longer motion, a higher sensors.rate_hz or a shorter window",
            scenario.sensors.rate_hz
        );
        return Err(at.error(key, problem));
    }
    Ok(())
}

fn motion(key: &str, spec: &MotionSpec, at: &Located) -> Result<()> {
    match (&spec.file, &spec.random) {
        (Some(_), None) => Ok(()),
        (None, Some(random)) if random.moves < 2 => {
            Err(at.error(&format!("{key}.random.moves"), "a motion out and back to zero takes 2 moves or more"))
        }
        (None, Some(random)) if random.moves > MOST_MOVES => Err(at.error(
            &format!("{key}.random.moves"),
            format!("{} are too many; take at most {MOST_MOVES}", random.moves),
        )),
        (None, Some(random)) if !(random.duration_s.is_finite() && random.duration_s > 0.0) => {
            Err(at.error(&format!("{key}.random.duration_s"), "must be a number above zero"))
        }
        (None, Some(_)) => Ok(()),
        _ => Err(at.error(key, "give exactly one of `file` and `random`")),
    }
}

/// What is wrong with the `[montecarlo]` table, with its key.
fn montecarlo_fault(spec: &MonteCarloSpec, scenario: &Scenario) -> Option<(&'static str, String)> {
    for (key, error) in [("plant_error", spec.plant_error), ("start_error", spec.start_error)] {
        if !(0.0..1.0).contains(&error) {
            return Some((key, format!("{error} must lie in 0 .. 1")));
        }
    }
    if spec.trials == 0 || u32::try_from(spec.trials).is_err() {
        return Some(("trials", format!("{} trials make no study; take 1 to {}", spec.trials, u32::MAX)));
    }
    if spec.raw_decimation == 0 {
        return Some(("raw_decimation", "must be 1 or more".to_owned()));
    }
    if let Some(level) = spec.noise.iter().find(|level| !level.is_possible()) {
        return Some(("noise", format!("{level:?}: standard deviations are numbers from zero up")));
    }
    let motion = spec.random_motion.as_ref()?;
    if motion.moves < 2 || !(motion.duration_s.is_finite() && motion.duration_s > 0.0) {
        return Some(("random_motion", "takes 2 moves or more and a duration above zero".to_owned()));
    }
    let window = scenario.identification.fixed_window(scenario.sensors.rate_hz);
    let samples = scenario.samples(motion.duration_s);
    (samples < window || samples > MOST_SAMPLES)
        .then(|| ("random_motion", format!("{} s are {samples} samples; take {window} to 1000000", motion.duration_s)))
}
