//! How a fit looks for the parameters of a law that are not linear, and quantities that follow from its parameters.

use crate::robot::Unit;

/// Where the values of a parameter that is not linear are looked for.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Search, StribeckFriction, TimeDelay};
///
/// // The Stribeck velocity (parameter 1) is a low speed; a delay is a shift of signals.
/// assert_eq!(StribeckFriction.search(1), Search::LowSpeed);
/// assert_eq!(TimeDelay.search(0), Search::Shift);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    /// Between its bounds: in equal ratios where they are positive and far apart, else in equal steps.
    Bounds,
    /// A speed below which the law acts: a small part of the joint's top speed, else nothing sets it apart from friction at all speeds.
    LowSpeed,
    /// A power of the speed; near one the law is viscous friction.
    PowerOfSpeed,
    /// A time constant: one longer than the logs makes a drift of the law.
    TimeConstant,
    /// An instant of a log.
    Instant,
    /// An instant from which a law counts where the clocks of the logs run on from one to the next; else it counts from the start of each.
    ClockStart,
    /// A position of the joint at which the law bends: inside its range of motion, else it is another law.
    Position,
    /// An angle about the joint, between its bounds all around it. What pulls along a line turns its torque over within a small part of a turn
    /// where that line passes near the axis: a test has several maxima over the angle.
    Angle,
    /// A number of periods per turn of the joint.
    PerTurn,
    /// A time by which signals are moved or spread, at multiples of its typical size: torque is not linear in it.
    Shift,
    /// A level at which torque is cut off: just below the largest.
    Level,
    /// A compliance, by the angle to which the largest torque winds the gear up: torque is not linear in it, since links swing.
    Compliance,
    /// Half the play of a gear. The time in which it is crossed grows with its third root, and with it all that follows.
    Gap,
}

/// Ratio of the bounds of a parameter from which its logarithm is what varies.
const WIDE: f64 = 10.0;

/// Whether a parameter between two bounds varies in equal ratios, and not in equal steps.
pub(crate) fn varies_by_factors(low: f64, high: f64) -> bool {
    low > 0.0 && high / low > WIDE
}

/// A parameter that every drive has, in the order of a joint's standard parameters.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{CoulombFriction, DriveParameter, Effect, StribeckFriction};
///
/// // Coulomb friction is a part of every drive; a Stribeck rise is one that a drive may lack.
/// assert_eq!(CoulombFriction.of_drive(), Some(DriveParameter::Coulomb));
/// assert_eq!(StribeckFriction.of_drive(), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DriveParameter {
    /// Inertia of the rotor at the joint's side of the gear, kg m2 (kg).
    Rotor = 0,
    /// Coefficient of viscous friction, N m s/rad (N s/m).
    Viscous = 1,
    /// Level of Coulomb friction, N m (N).
    Coulomb = 2,
}

/// What practitioners call a function of an effect's parameters: a payload's mass, the angle of a tilt.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{BaseTilt, Effect};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // A tilt is described by two angles; what practitioners ask for is the one between base and floor.
/// let arm = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// let tilt = BaseTilt.derived(&[0.03, -0.04], 0, &arm)[0];
/// assert_eq!((tilt.name, tilt.unit.name()), ("tilt", "rad"));
/// assert!((tilt.value - 0.05).abs() < 1e-4);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Derived {
    /// Its name.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// Its value.
    pub value: f64,
    /// Whether it has a meaning only where the first quantity differs from zero: a body without mass has no centre.
    pub of_the_first: bool,
}
