//! The motions of a scenario: read or drawn, and checked against the limits of the arm.

use super::locate::Located;
use super::validate;
use super::{RandomMotion, Scenario};
use crate::error::Result;
use crate::excitation::random_sequence::random_sequence;
use crate::excitation::{JointLimits, Motion, MotionFile, Reference};
use crate::internal::excitation::check_kinds;
use crate::robot::{JointKind, Robot};

/// Position limits beyond this (rad) stand for a joint that turns without end.
const ENDLESS_RAD: f64 = 1e3;

/// Limits of the motions of an arm: those of its URDF, and the scenario's accelerations.
pub(super) fn limits(scenario: &Scenario, arm: &Robot) -> Vec<JointLimits> {
    arm.joints
        .iter()
        .zip(scenario.limits.acceleration_rad_s2.values(arm.dof()))
        .map(|(joint, acceleration)| JointLimits {
            lower: joint.limits.lower,
            upper: joint.limits.upper,
            velocity: joint.limits.velocity,
            acceleration,
        })
        .collect()
}

/// The motion under `key` of the scenario, `motion` or `held_out`.
///
/// # Errors
/// Names the key, and the joint, time and excess for a motion outside the limits.
pub(super) fn motion(
    scenario: &Scenario,
    key: &str,
    arm: &Robot,
    limits: &[JointLimits],
    at: &Located,
) -> Result<Motion> {
    let spec = if key == "motion" { &scenario.motion } else { &scenario.held_out };
    let names = arm.joint_names();
    let (motion, key) = match (&spec.file, &spec.random) {
        (Some(file), _) => {
            let key = format!("{key}.file");
            let motion = MotionFile::read(file)?.for_arm(&arm.name, &names).map_err(|e| at.wrap(&key, &e))?;
            (motion, key)
        }
        (None, Some(random)) => {
            let (label, key) = (key, format!("{key}.random"));
            let range = drawable(limits, arm, random);
            let sequence = random_sequence(scenario.seed, label, 0, random.moves, random.duration_s, &range);
            (Motion::Freudenstein(sequence.map_err(|e| at.wrap(&key, &e))?), key)
        }
        (None, None) => return Err(at.error(key, "give exactly one of `file` and `random`")),
    };
    let kinds: Vec<JointKind> = arm.joints.iter().map(|joint| joint.kind).collect();
    check_kinds(&motion, limits, 1.0 / scenario.plant.step_s, &names, &kinds).map_err(|e| at.wrap(&key, &e))?;
    validate::length(scenario, &key, motion.duration_s(), at)?;
    Ok(motion)
}

/// Limits to draw from: a joint that turns without end stays within half a turn either way, and one without a speed limit
/// within the speed its acceleration could reach.
pub(crate) fn drawable(limits: &[JointLimits], arm: &Robot, random: &RandomMotion) -> Vec<JointLimits> {
    use std::f64::consts::PI;
    limits
        .iter()
        .zip(&arm.joints)
        .map(|(own, joint)| {
            let endless = |bound: f64| joint.kind == JointKind::Revolute && bound.abs() > ENDLESS_RAD;
            JointLimits {
                lower: if endless(own.lower) { -PI } else { own.lower },
                upper: if endless(own.upper) { PI } else { own.upper },
                velocity: own.velocity.min(own.acceleration * random.duration_s),
                ..*own
            }
        })
        .collect()
}
