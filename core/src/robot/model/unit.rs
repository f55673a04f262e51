//! Units of quantities: what is an angle and a torque on a joint that turns is a length and a force on one that slides.

use serde::{Serialize, Serializer};
use std::fmt;

/// Unit of a quantity.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{JointKind, Unit};
///
/// // A viscous coefficient, of a joint that turns and of one that slides.
/// assert_eq!(Unit::Damping.to_string(), "N m s/rad");
/// assert_eq!(JointKind::Prismatic.unit(Unit::Damping), "N s/m");
/// // A mass is in kg on every joint.
/// assert_eq!(JointKind::Prismatic.unit(Unit::Mass), "kg");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unit {
    /// Ratios, exponents: 1.
    One,
    /// Times: s.
    Time,
    /// Periods per turn of a joint: 1/turn.
    PerTurn,
    /// Angles in space: rad.
    Angle,
    /// Lengths in space: m.
    Length,
    /// Forces in space: N.
    Force,
    /// Masses of bodies: kg.
    Mass,
    /// First moments of mass: kg m.
    FirstMoment,
    /// Moments of inertia of bodies: kg m2.
    MomentOfInertia,
    /// Positions of a joint: rad, or m.
    Position,
    /// Velocities of a joint: rad/s, or m/s.
    Velocity,
    /// Accelerations of a joint: rad/s^2, or m/s^2.
    Acceleration,
    /// Efforts of a joint: N m, or N.
    Effort,
    /// Viscous coefficients: N m s/rad, or N s/m.
    Damping,
    /// Coefficients of the square of the velocity: N m s2/rad2, or N s2/m2.
    QuadraticDamping,
    /// Coefficients of a power alpha of the velocity: N m (s/rad)^alpha, or N (s/m)^alpha.
    PowerDamping,
    /// Stiffnesses: N m/rad, or N/m.
    Stiffness,
    /// Compliances: rad/(N m), or m/N.
    Compliance,
    /// Inertias of rotors as their joint feels them: kg m2, or kg.
    Inertia,
}

impl Unit {
    /// On a joint that turns, and on one that slides.
    pub(super) const fn on_joints(self) -> [&'static str; 2] {
        match self {
            Unit::One => ["1"; 2],
            Unit::Time => ["s"; 2],
            Unit::PerTurn => ["1/turn"; 2],
            Unit::Angle => ["rad"; 2],
            Unit::Length => ["m"; 2],
            Unit::Force => ["N"; 2],
            Unit::Mass => ["kg"; 2],
            Unit::FirstMoment => ["kg m"; 2],
            Unit::MomentOfInertia => ["kg m2"; 2],
            Unit::Position => ["rad", "m"],
            Unit::Velocity => ["rad/s", "m/s"],
            Unit::Acceleration => ["rad/s^2", "m/s^2"],
            Unit::Effort => ["N m", "N"],
            Unit::Damping => ["N m s/rad", "N s/m"],
            Unit::QuadraticDamping => ["N m s2/rad2", "N s2/m2"],
            Unit::PowerDamping => ["N m (s/rad)^alpha", "N (s/m)^alpha"],
            Unit::Stiffness => ["N m/rad", "N/m"],
            Unit::Compliance => ["rad/(N m)", "m/N"],
            Unit::Inertia => ["kg m2", "kg"],
        }
    }

    /// As it is on a joint that turns, and in space.
    pub const fn name(self) -> &'static str {
        self.on_joints()[0]
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl Serialize for Unit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
