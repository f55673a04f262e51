//! A MuJoCo model as a description.

use super::super::xml::XmlText;
use super::bodies::Bodies;
use super::defaults::Settled;
use super::element::{self, Element};
use super::models::Models;
use super::{couplings, drives, replicate};
use crate::error::{Error, Result};
use crate::robot::description::{Description, settle_mimics};
use crate::robot::model::{GRAVITY, Inertia};
use nalgebra::Vector3;

/// Reads a robot from a MuJoCo model, with the files it includes and the models it attaches.
///
/// Joint positions are MuJoCo's `qpos`. The world is the root link; a body with several joints becomes several links, the
/// body itself the last.
///
/// # Errors
/// Names file, line and element for: unreadable or malformed files, names that occur twice, classes that are not there,
/// numbers that are malformed or not finite, axes without direction.
pub(crate) fn read(source: &XmlText) -> Result<Description> {
    let path = &source.path;
    let mut root = element::load(source)?;
    if root.tag != "mujoco" {
        return Err(Error::input(
            path,
            Some(root.line),
            format!("<{}>", root.tag),
            "a MuJoCo model starts with <mujoco>",
        ));
    }
    let models = Models::of(&mut root)?;
    let notes = replicate::expand(&mut root, &models)?;
    let mut bodies = Bodies::of(&root, &models)?;
    bodies.notes.extend(notes);
    if bodies.joints.is_empty() {
        return Err(Error::input(
            path,
            None,
            "<worldbody>",
            "there is no body; is this a part that another file includes?",
        ));
    }
    drives::set_efforts(&root, &mut bodies, &models)?;
    let actuators = drives::named(&root, &bodies, &models)?;
    drives::number(&root, &mut bodies);
    couplings::couple(&root, &mut bodies)?;
    settle_mimics(path, &mut bodies.joints, &mut bodies.notes)?;
    scale(&mut bodies, models.main().total_mass);
    let count = models.rounded();
    if count > 0 {
        bodies.notes.push(format!(
            "{count} rounded angle(s) are taken as the multiple of 15 degrees within the printed digits"
        ));
    }
    let gravity = gravity(&root, &mut bodies.notes)?;
    Ok(Description {
        name: root.get("model").unwrap_or("MuJoCo model").to_owned(),
        source: path.clone(),
        gravity,
        links: bodies.links,
        joints: bodies.joints,
        actuators,
        addresses: bodies.addresses,
        notes: bodies.notes,
    })
}

/// Gravity of the model; one other than the standard is worth a note.
fn gravity(root: &Element, notes: &mut Vec<String>) -> Result<Vector3<f64>> {
    let mut gravity = Vector3::from(GRAVITY);
    for option in root.all("option") {
        gravity = Settled::plain(option).vector("gravity")?.unwrap_or(gravity);
        if option.all("flag").any(|flag| flag.get("gravity") == Some("disable")) {
            gravity = Vector3::zeros();
        }
    }
    if gravity != Vector3::from(GRAVITY) {
        notes.push(format!("gravity is {} {} {} m/s2 in this model", gravity.x, gravity.y, gravity.z));
    }
    Ok(gravity)
}

/// Scales all bodies to a total mass.
fn scale(bodies: &mut Bodies, wanted: Option<f64>) {
    let total: f64 = bodies.links.iter().map(|link| link.inertia.mass()).sum();
    let Some(wanted) = wanted.filter(|_| total > 0.0) else { return };
    for link in &mut bodies.links {
        link.inertia = Inertia(link.inertia.0.map(|value| value * wanted / total));
    }
}
