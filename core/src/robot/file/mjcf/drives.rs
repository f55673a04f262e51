//! What the drives of a MuJoCo model can deliver at its joints.

use super::bodies::{Bodies, largest};
use super::defaults::{ACTUATORS, Settled};
use super::element::Element;
use super::models::Models;
use crate::error::Result;
use crate::robot::model::Actuator;

/// Sets the effort limits of the joints: what their drives can deliver together, and no more than the joints let through.
///
/// # Errors
/// If a number is malformed or a class is not there.
pub(super) fn set_efforts(root: &Element, bodies: &mut Bodies, models: &Models) -> Result<()> {
    let mut delivered: Vec<Option<f64>> = vec![None; bodies.joints.len()];
    for element in root.all("actuator").flat_map(|section| &section.children) {
        let Some(name) = element.get("joint").or(element.get("jointinparent")) else { continue };
        let Some(joint) = bodies.joints.iter().position(|joint| joint.name == name) else { continue };
        if ACTUATORS.contains(&element.tag.as_str()) {
            let drive = models.settled(element, None)?;
            *delivered[joint].get_or_insert(0.0) += highest(&drive, models.compiler(element).auto_limits)?;
        }
    }
    for (joint, delivered) in bodies.joints.iter_mut().zip(delivered) {
        let effort = delivered.unwrap_or(f64::INFINITY).min(joint.limits.effort);
        joint.limits.effort = if effort > 0.0 { effort } else { f64::INFINITY };
    }
    Ok(())
}

/// The drives that have a name and move one joint.
///
/// # Errors
/// As [`set_efforts`].
pub(super) fn named(root: &Element, bodies: &Bodies, models: &Models) -> Result<Vec<Actuator>> {
    let mut out = Vec::new();
    for element in root.all("actuator").flat_map(|section| &section.children) {
        let joint = element.get("joint").or(element.get("jointinparent"));
        let (Some(name), Some(joint)) = (element.get("name"), joint) else { continue };
        if ACTUATORS.contains(&element.tag.as_str()) && bodies.joints.iter().any(|own| own.name == joint) {
            let gear = models.settled(element, None)?.number("gear")?.unwrap_or(1.0);
            out.push(Actuator { name: name.to_owned(), joint: joint.to_owned(), gear });
        }
    }
    Ok(out)
}

/// Numbers the drives as the simulator does, each with the joint that it moves alone.
pub(super) fn number(root: &Element, bodies: &mut Bodies) {
    for element in root.all("actuator").flat_map(|section| &section.children) {
        if ACTUATORS.contains(&element.tag.as_str()) {
            bodies.addresses.add_motor(element.get("joint").or(element.get("jointinparent")));
        }
    }
    bodies.addresses.settle();
}

/// The highest effort of one drive at its joint.
fn highest(drive: &Settled, auto_limits: bool) -> Result<f64> {
    let gear = drive.number("gear")?.unwrap_or(1.0).abs();
    let bound = |range, limited| largest(drive, [range, limited], auto_limits);
    let force = bound("forcerange", "forcelimited")?;
    // A plain motor's force is its control times its gain; that of a servo follows an error.
    let plain = match drive.element.tag.as_str() {
        "motor" => Some(1.0),
        "general" => {
            let plain = ["gaintype", "biastype", "dyntype"]
                .iter()
                .all(|name| matches!(drive.get(name), None | Some("fixed" | "none")));
            let gain = drive.number("gainprm")?.unwrap_or(1.0);
            plain.then_some(gain.abs())
        }
        _ => None,
    };
    let control = match plain {
        Some(gain) => gain * bound("ctrlrange", "ctrllimited")?,
        None => f64::INFINITY,
    };
    Ok(gear * force.min(control))
}
