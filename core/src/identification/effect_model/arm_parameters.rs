//! The linear parameters of the arm itself: base parameters, or those of its drives.

use crate::effects::Placed;
use crate::identification::model::Model;
use crate::identification::model::standard::{ROTOR, STANDARD};

/// Which parameters of the arm are taken from the URDF.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::effect_model::{EffectModel, Preparation, Trust};
/// use tauscope::identification::model::Model;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
///
/// // Trusted inertias leave friction and rotors to be fitted: three parameters a joint. Else all base parameters are.
/// let model = Model::new(&robot);
/// let fitted = |trust| EffectModel::new(&model, trust, &[&log], Preparation::usual(&log), Vec::new());
/// assert_eq!(fitted(Trust::Nominal)?.baseline_len(), 3 * 5);
/// assert_eq!(fitted(Trust::Structure)?.baseline_len(), model.base().len());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Trust {
    /// Inertias are taken from the URDF; friction and rotor inertia of every joint are fitted.
    Nominal,
    /// Inertias are estimated: only the geometry is taken from the URDF, and all base parameters are fitted.
    Structure,
}

/// A linear parameter of the arm itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ArmParameter {
    /// A base parameter, by its index.
    Base(usize),
    /// Rotor inertia (0), viscous (1) or Coulomb friction (2) of a joint whose link is taken from the URDF.
    Drive(usize, usize),
}

/// Joint and kind (a [`DriveParameter`](crate::effects::DriveParameter) as a number) of a parameter that belongs to a drive alone.
pub(super) fn drive_of(model: &Model, parameter: ArmParameter) -> Option<(usize, usize)> {
    match parameter {
        ArmParameter::Drive(joint, which) => Some((joint, which)),
        ArmParameter::Base(base) => model.drive_of(base),
    }
}

/// Whether an effect stands for what differs from a parameter of a drive ([`drive_of`]).
pub(super) fn stands_for(placed: &Placed, (joint, which): (usize, usize)) -> bool {
    placed.joint == joint && placed.effect.of_drive().is_some_and(|parameter| parameter as usize == which)
}

/// The arm's linear parameters with their values according to its URDF: where fits start.
pub(super) fn arm_parameters(model: &Model, trust: Trust) -> Vec<(ArmParameter, f64)> {
    match trust {
        Trust::Structure => {
            let values = model.base().values(&Model::standard_values(model.robot()));
            values.into_iter().enumerate().map(|(base, value)| (ArmParameter::Base(base), value)).collect()
        }
        Trust::Nominal => {
            let joints = model.robot().joints.iter().enumerate();
            joints
                .filter(|(joint, _)| model.has_equation(*joint))
                .flat_map(|(joint, spec)| {
                    let drive = [spec.drive.armature, spec.drive.viscous, spec.drive.coulomb];
                    drive.into_iter().enumerate().map(move |(k, value)| (ArmParameter::Drive(joint, k), value))
                })
                .collect()
        }
    }
}

pub(super) fn arm_name(model: &Model, parameter: ArmParameter) -> String {
    match parameter {
        ArmParameter::Base(base) => model.base().groupings()[base].name.clone(),
        ArmParameter::Drive(joint, which) => format!("{}{}", ["Ia", "Fv", "Fc"][which], joint + 1),
    }
}

/// The standard parameter that a parameter of the arm is, or that leads it.
pub(super) fn leader(model: &Model, parameter: ArmParameter) -> usize {
    match parameter {
        ArmParameter::Base(base) => model.base().kept()[base],
        ArmParameter::Drive(joint, which) => joint * STANDARD + ROTOR + which,
    }
}

/// Whether a parameter is merged into others, which take all but the little that a tilt makes of it.
pub(super) fn is_merged(model: &Model, parameter: ArmParameter) -> bool {
    matches!(parameter, ArmParameter::Base(base) if !model.base().merged(base).is_empty())
}
