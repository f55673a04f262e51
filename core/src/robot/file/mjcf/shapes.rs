//! Bodies of a MuJoCo model: given, or those of solid shapes.

use super::compiler::{Compiler, FromShapes, from_z_to};
use super::defaults::Settled;
use super::element::Element;
use super::models::{Class, Models, class_within};
use crate::error::Result;
use crate::robot::model::{Inertia, Pose};
use nalgebra::{Matrix3, Unit, Vector3};
use std::f64::consts::PI;

/// Density of a shape that gives none, kg/m3.
const DENSITY: f64 = 1000.0;

/// Sizes below this, m, are no shape, and their volumes would leave double precision.
const SMALLEST: f64 = 1e-9;

/// A body, and how many of its shapes could not be counted.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Body {
    /// About and in the axes of the body frame.
    pub inertia: Inertia,
    /// Shapes whose mass needs a file: meshes and height fields.
    pub unknown: usize,
    /// Whether its `<inertial>` gives way to its shapes.
    pub overruled: bool,
}

/// The body of an element: its inertial, or where the compiler wants it, its shapes. As in MuJoCo, an inertial overruled by shapes
/// that have no mass stays; so it does where the mass of the shapes is not known.
///
/// # Errors
/// If a number is malformed or a class is not there.
pub(super) fn body<'a>(element: &'a Element, models: &'a Models, class: Class<'a>) -> Result<Body> {
    let (given, compiler) = (element.first("inertial"), models.compiler(element));
    match (given, compiler.from_shapes) {
        (Some(given), FromShapes::Auto | FromShapes::No) => {
            Ok(Body { inertia: inertial(given, compiler)?, ..Body::default() })
        }
        (None, FromShapes::No) => Ok(Body::default()),
        _ => {
            let mut body = Body::default();
            add(&mut body, element, &Pose::identity(), models, class)?;
            if let Some(given) = given {
                body.overruled = body.unknown == 0 && body.inertia.mass() > 0.0;
                if !body.overruled {
                    body.inertia = inertial(given, compiler)?;
                }
            }
            Ok(body)
        }
    }
}

fn inertial(element: &Element, compiler: &Compiler) -> Result<Inertia> {
    let given = Settled::plain(element);
    let Some(mass) = given.number("mass")? else { return Err(element.error("it has no mass; add mass=\"...\"")) };
    let at = compiler.pose(&given)?;
    let tensor = match (given.numbers("fullinertia", [6, 6])?, given.vector("diaginertia")?) {
        (Some(v), _) => Matrix3::new(v[0], v[3], v[4], v[3], v[1], v[5], v[4], v[5], v[2]),
        (None, diagonal) => Matrix3::from_diagonal(&diagonal.unwrap_or_default()),
    };
    Ok(Inertia::from_center_of_mass(mass, at.translation, at.rotation * tensor * at.rotation.transpose()))
}

/// Adds the shapes of an element, those within `<frame>` included; `place` is its pose in the body.
fn add<'a>(body: &mut Body, element: &'a Element, place: &Pose, models: &'a Models, class: Class<'a>) -> Result<()> {
    for frame in element.all("frame") {
        add(body, frame, &place.then(&models.pose(frame)?), models, class_within(frame, class))?;
    }
    for geom in element.all("geom") {
        let compiler = models.compiler(geom);
        let geom = models.settled(geom, class)?;
        let group = geom.number("group")?.unwrap_or(0.0);
        if group < compiler.groups[0] || group > compiler.groups[1] {
            continue;
        }
        match solid(&geom, compiler)? {
            Some((mass, at, moments)) => {
                let at = place.then(&at);
                let tensor = at.rotation * Matrix3::from_diagonal(&moments) * at.rotation.transpose();
                body.inertia = body.inertia.welded_to(&Inertia::from_center_of_mass(mass, at.translation, tensor));
            }
            None => body.unknown += 1,
        }
    }
    Ok(())
}

/// Mass, pose and principal moments of a shape about its centre; None if they need a file.
fn solid(geom: &Settled, compiler: &Compiler) -> Result<Option<(f64, Pose, Vector3<f64>)>> {
    let (mut at, mut size) = (compiler.pose(geom)?, geom.numbers("size", [1, 3])?.unwrap_or_default());
    let (mass, density) = (geom.number("mass")?, geom.number("density")?.unwrap_or(DENSITY));
    let kind = geom.get("type").unwrap_or("sphere");
    let weightless = mass == Some(0.0) || mass.is_none() && density == 0.0;
    if weightless || kind == "plane" {
        return Ok(Some((0.0, at, Vector3::zeros())));
    }
    // A mesh, or a simple shape fitted to one.
    if ["mesh", "hfield", "sdf"].contains(&kind) || geom.get("mesh").is_some() {
        return Ok(None);
    }
    if let Some(ends) = geom.numbers("fromto", [6, 6])? {
        let (from, to) = (Vector3::new(ends[0], ends[1], ends[2]), Vector3::new(ends[3], ends[4], ends[5]));
        let Some((axis, length)) = Unit::try_new_and_get(to - from, 1e-12) else {
            return Err(geom.element.error("fromto has no length"));
        };
        at = Pose { rotation: from_z_to(&axis), translation: 0.5 * (from + to) };
        let radius = size.first().copied().unwrap_or(0.0);
        size = match kind {
            "box" | "ellipsoid" => vec![radius, radius, 0.5 * length],
            _ => vec![radius, 0.5 * length],
        };
    }
    let wanted = match kind {
        "sphere" => 1,
        "capsule" | "cylinder" => 2,
        "box" | "ellipsoid" => 3,
        _ => return Err(geom.element.error(format!("the shape {kind} is not known"))),
    };
    if size.len() < wanted {
        return Err(geom.element.error(format!("a {kind} needs {wanted} sizes, found {}", size.len())));
    }
    if size[..wanted].iter().any(|&size| size < SMALLEST) {
        return Err(geom.element.error(format!("the sizes of a {kind} must be above zero")));
    }
    let (volume, moments) = of_unit_mass(kind, &size);
    Ok(Some((mass.unwrap_or(density * volume), at, mass.unwrap_or(density * volume) * moments)))
}

/// Volume of a shape, and its principal moments if it weighs 1 kg.
fn of_unit_mass(kind: &str, size: &[f64]) -> (f64, Vector3<f64>) {
    let r = size[0];
    let ball = 4.0 / 3.0 * PI * r.powi(3);
    match kind {
        "sphere" => (ball, Vector3::repeat(0.4 * r * r)),
        "cylinder" => (2.0 * PI * r * r * size[1], cylinder(r, 2.0 * size[1])),
        "capsule" => {
            let height = 2.0 * size[1];
            let volume = PI * r * r * height + ball;
            let ends = ball / volume;
            // Half balls, their centres of mass 3/8 of the radius beyond the ends of the cylinder.
            let about_center = 0.4 * r * r + height * (2.0 * height + 3.0 * r) / 8.0;
            let caps = Vector3::new(about_center, about_center, 0.4 * r * r);
            (volume, (1.0 - ends) * cylinder(r, height) + ends * caps)
        }
        _ => {
            let squares = Vector3::new(size[0] * size[0], size[1] * size[1], size[2] * size[2]);
            let sums = Vector3::repeat(squares.sum()) - squares;
            let product = size[0] * size[1] * size[2];
            match kind {
                "box" => (8.0 * product, sums / 3.0),
                _ => (4.0 / 3.0 * PI * product, sums / 5.0),
            }
        }
    }
}

fn cylinder(radius: f64, height: f64) -> Vector3<f64> {
    let across = (3.0 * radius * radius + height * height) / 12.0;
    Vector3::new(across, across, 0.5 * radius * radius)
}
