//! Checks of a scenario on its own; what needs the arm or a motion is checked where those are loaded.

use super::locate::Located;
use super::{MotionSpec, PerJoint, SCHEMA, Scenario};
use crate::error::Result;

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
        if !(value.is_finite() && value > 0.0) {
            return Err(at.error(key, format!("{value} must be a number above zero")));
        }
    }
    if !(0.0..1.0).contains(&controller.model_error) {
        return Err(at.error("controller.model_error", format!("{} must lie in 0 .. 1", controller.model_error)));
    }
    let band = scenario.identification.reversal_band_rad_s;
    if !(band.is_finite() && band >= 0.0) {
        return Err(at.error("identification.reversal_band_rad_s", format!("{band} must be zero or more")));
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
    let steps = 1.0 / (sensors.rate_hz * plant.step_s);
    if steps < 0.999 || (steps - steps.round()).abs() > 1e-6 {
        let problem = format!(
            "one sample takes {steps:.4} plant steps of {} s; choose a rate whose period is a whole number of steps",
            plant.step_s
        );
        return Err(at.error("sensors.rate_hz", problem));
    }
    if scenario.robot.gravity_m_s2.is_some_and(|g| g.iter().any(|v| !v.is_finite())) {
        return Err(at.error("robot.gravity_m_s2", "must be finite"));
    }
    for (key, value) in scenario.per_joint() {
        not_negative(key, value, at)?;
    }
    motion("motion", &scenario.motion, at)?;
    motion("held_out", &scenario.held_out, at)
}

fn not_negative(key: &str, value: &PerJoint, at: &Located) -> Result<()> {
    let values = match value {
        PerJoint::All(value) => std::slice::from_ref(value),
        PerJoint::Each(values) => values,
    };
    match values.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
        Some(bad) => Err(at.error(key, format!("{bad} must be a number of zero or more"))),
        None => Ok(()),
    }
}

fn motion(key: &str, spec: &MotionSpec, at: &Located) -> Result<()> {
    match (&spec.file, &spec.random) {
        (Some(_), None) => Ok(()),
        (None, Some(random)) if random.moves < 2 => {
            Err(at.error(&format!("{key}.random.moves"), "a motion out and back to zero takes 2 moves or more"))
        }
        (None, Some(random)) if !(random.duration_s.is_finite() && random.duration_s > 0.0) => {
            Err(at.error(&format!("{key}.random.duration_s"), "must be a number above zero"))
        }
        (None, Some(_)) => Ok(()),
        _ => Err(at.error(key, "give exactly one of `file` and `random`")),
    }
}
