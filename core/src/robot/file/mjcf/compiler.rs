//! How a model is to be read: its `<compiler>` and what its orientations mean.

use super::super::rounding;
use super::defaults::Settled;
use super::element::Element;
use crate::error::Result;
use crate::robot::model::Pose;
use nalgebra::{Matrix3, Quaternion, Unit, UnitQuaternion, Vector3};
use std::cell::Cell;
use std::f64::consts::PI;

/// Printed decimals from which an angle may be rounded: a simulation runs with 1.57 as it stands, and its logs show it.
const FEWEST_DECIMALS: i32 = 3;

/// When the bodies' inertias come from their shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FromShapes {
    /// Always.
    Yes,
    /// Never.
    No,
    /// For bodies without inertial.
    Auto,
}

/// The settings of a model.
#[derive(Debug, Clone)]
pub(super) struct Compiler {
    radians: bool,
    sequence: Vec<char>,
    /// A range implies that it limits.
    pub auto_limits: bool,
    /// Where inertias come from.
    pub from_shapes: FromShapes,
    /// First and last group of shapes that have mass.
    pub groups: [f64; 2],
    /// Mass that the whole model is scaled to, kg.
    pub total_mass: Option<f64>,
    /// Angles with few printed digits that were taken as multiples of 15 degrees.
    pub rounded: Cell<usize>,
}

impl Compiler {
    /// The settings of a model: of several elements the later ones overrule.
    ///
    /// # Errors
    /// If a value is none that MuJoCo knows, or coordinates are global.
    pub(super) fn of(root: &Element) -> Result<Self> {
        let mut compiler = Compiler {
            radians: false,
            sequence: vec!['x', 'y', 'z'],
            auto_limits: true,
            from_shapes: FromShapes::Auto,
            groups: [0.0, 5.0],
            total_mass: None,
            rounded: Cell::new(0),
        };
        for element in root.all("compiler") {
            compiler.overrule(element)?;
        }
        Ok(compiler)
    }

    fn overrule(&mut self, element: &Element) -> Result<()> {
        let unknown = |name: &str, value: &str, known: &str| {
            Err(element.error(format!("{name}=\"{value}\" is not known; use {known}")))
        };
        match element.get("angle") {
            None => {}
            Some("radian") => self.radians = true,
            Some("degree") => self.radians = false,
            Some(value) => return unknown("angle", value, "radian or degree"),
        }
        if let Some(value) = element.get("eulerseq") {
            if value.len() != 3 || !value.chars().all(|axis| "xyzXYZ".contains(axis)) {
                return unknown("eulerseq", value, "three of x, y, z, X, Y, Z");
            }
            self.sequence = value.chars().collect();
        }
        if element.get("coordinate") == Some("global") {
            let problem = "coordinate=\"global\" is no longer read, by MuJoCo either; save the model from MuJoCo 2.2: \
                           local coordinates";
            return Err(element.error(problem));
        }
        if let Some(value) = element.get("autolimits") {
            self.auto_limits = value == "true";
        }
        match element.get("inertiafromgeom") {
            None => {}
            Some("true") => self.from_shapes = FromShapes::Yes,
            Some("false") => self.from_shapes = FromShapes::No,
            Some("auto") => self.from_shapes = FromShapes::Auto,
            Some(value) => return unknown("inertiafromgeom", value, "true, false or auto"),
        }
        let settings = Settled::plain(element);
        if let Some(range) = settings.numbers("inertiagrouprange", [2, 2])? {
            self.groups = [range[0], range[1]];
        }
        self.total_mass = settings.number("settotalmass")?.filter(|&mass| mass > 0.0).or(self.total_mass);
        Ok(())
    }

    /// An angle in the model's unit, in rad.
    pub(super) fn angle(&self, value: f64) -> f64 {
        if self.radians { value } else { value / 180.0 * PI }
    }

    /// A printed angle in rad, with all its digits.
    fn printed(&self, element: &Element, word: &str, value: f64) -> f64 {
        // The frames of joints must be parallel where they are meant to be; shapes need not.
        let frame = self.radians && ["body", "frame"].contains(&element.tag.as_str());
        match rounding::meant(word, FEWEST_DECIMALS).filter(|_| frame) {
            Some(exact) => {
                self.rounded.set(self.rounded.get() + 1);
                exact
            }
            None => self.angle(value),
        }
    }

    /// Position and orientation of an element in the frame around it.
    ///
    /// # Errors
    /// If numbers are malformed, or an axis has no direction.
    pub(super) fn pose(&self, element: &Settled) -> Result<Pose> {
        let translation = element.vector("pos")?.unwrap_or_default();
        Ok(Pose { rotation: self.rotation(element)?, translation })
    }

    fn rotation(&self, element: &Settled) -> Result<Matrix3<f64>> {
        let no_direction = |name: &str| element.element.error(format!("{name} has no direction"));
        let unit = |vector: Vector3<f64>, name: &str| Unit::try_new(vector, 1e-12).ok_or_else(|| no_direction(name));
        if let Some(v) = element.numbers("axisangle", [4, 4])? {
            let word = element.get("axisangle").and_then(|text| text.split_whitespace().nth(3)).unwrap_or_default();
            let axis = unit(Vector3::new(v[0], v[1], v[2]), "axisangle")?;
            return Ok(turn(&axis, self.printed(element.element, word, v[3])));
        }
        if let Some(angles) = element.numbers("euler", [3, 3])? {
            let words = element.get("euler").unwrap_or_default().split_whitespace();
            let mut rotation = Matrix3::identity();
            for ((word, angle), axis) in words.zip(angles).zip(&self.sequence) {
                let about = match axis.to_ascii_lowercase() {
                    'x' => Vector3::x_axis(),
                    'y' => Vector3::y_axis(),
                    _ => Vector3::z_axis(),
                };
                let step = turn(&about, self.printed(element.element, word, angle));
                // Small letters turn about axes that turned before, capitals about those that stand still.
                rotation = if axis.is_ascii_lowercase() { rotation * step } else { step * rotation };
            }
            return Ok(rotation);
        }
        if let Some(v) = element.numbers("xyaxes", [6, 6])? {
            let x = unit(Vector3::new(v[0], v[1], v[2]), "xyaxes")?.into_inner();
            let y = Vector3::new(v[3], v[4], v[5]);
            let y = unit(y - x * x.dot(&y), "xyaxes")?.into_inner();
            return Ok(Matrix3::from_columns(&[x, y, x.cross(&y)]));
        }
        if let Some(axis) = element.vector("zaxis")? {
            return Ok(from_z_to(&unit(axis, "zaxis")?));
        }
        let Some(v) = element.numbers("quat", [4, 4])? else { return Ok(Matrix3::identity()) };
        let quaternion = Quaternion::new(v[0], v[1], v[2], v[3]);
        let unit = UnitQuaternion::try_new(quaternion, 1e-12).ok_or_else(|| no_direction("quat"))?;
        Ok(unit.to_rotation_matrix().into_inner())
    }
}

/// The rotation about an axis.
pub(super) fn turn(axis: &Unit<Vector3<f64>>, angle: f64) -> Matrix3<f64> {
    nalgebra::Rotation3::from_axis_angle(axis, angle).into_inner()
}

/// The least rotation that takes z to a direction.
pub(super) fn from_z_to(axis: &Unit<Vector3<f64>>) -> Matrix3<f64> {
    let across = Vector3::z().cross(axis);
    turn(&Unit::try_new(across, 1e-12).unwrap_or(Vector3::x_axis()), across.norm().atan2(axis.z))
}
