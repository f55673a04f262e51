//! Places of the standard parameters of a joint.

use crate::robot::PARAMETERS;

/// Place of rotor inertia among the standard parameters of a joint, behind the inertial ones of its link.
pub(crate) const ROTOR: usize = PARAMETERS;

/// Place of viscous friction.
pub(crate) const VISCOUS: usize = PARAMETERS + 1;

/// Place of Coulomb friction.
pub(crate) const COULOMB: usize = PARAMETERS + 2;

/// Standard parameters of a joint: ten inertial ones, Ia, Fv, Fc.
pub const STANDARD: usize = PARAMETERS + 3;
