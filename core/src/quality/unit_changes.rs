//! Units of a log that are not those of its description.

use super::motion::OtherUnit;
use crate::robot::JointKind;
use std::f64::consts::PI;

/// A unit of velocities other than rad/s and m/s.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::quality::{OtherRate, OtherUnit};
///
/// // As a dataset names them.
/// assert_eq!(OtherRate::PerSecond(OtherUnit::Degree).symbol(), "deg/s");
/// assert_eq!(OtherRate::Rpm.symbol(), "rpm");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OtherRate {
    /// A unit of positions per second.
    PerSecond(OtherUnit),
    /// Turns per minute.
    Rpm,
}

impl OtherRate {
    /// How a dataset names it.
    pub fn symbol(self) -> String {
        match self {
            OtherRate::PerSecond(unit) => format!("{}/s", unit.symbol()),
            OtherRate::Rpm => "rpm".to_owned(),
        }
    }

    /// How many of it make one of SI.
    pub(crate) fn in_si(self) -> f64 {
        match self {
            OtherRate::PerSecond(unit) => unit.in_si(),
            OtherRate::Rpm => 30.0 / PI,
        }
    }

    /// Those in which velocities of a kind of joint may be.
    pub(super) fn of(kind: JointKind) -> impl Iterator<Item = OtherRate> {
        let rpm = (kind == JointKind::Revolute).then_some(OtherRate::Rpm);
        OtherUnit::of(kind).iter().copied().map(OtherRate::PerSecond).chain(rpm)
    }
}

/// Units of a log that are not those of its description.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::quality::{OtherUnit, UnitChanges};
/// use tauscope::recording;
///
/// // Positions of joint j2 are in degrees, all others in rad.
/// let mut log = recording::load("../tests/reference/payload/before.csv", None)?;
/// let before = log.q.channel(1)[0];
/// let positions = vec![None, Some(OtherUnit::Degree), None, None, None];
/// let units = UnitChanges { positions, ..UnitChanges::default() };
/// units.apply(&mut log);
/// assert!((log.q.channel(1)[0] - before.to_radians()).abs() < 1e-12);
/// assert!(UnitChanges::default().is_none() && !units.is_none());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UnitChanges {
    /// True seconds per second of the clock.
    pub time_factor: Option<f64>,
    /// Unit of the position of each joint that is in another than rad or m; empty where none is.
    pub positions: Vec<Option<OtherUnit>>,
    /// Unit of the velocity of each joint that is in another than rad/s or m/s; empty where none is.
    pub velocities: Vec<Option<OtherRate>>,
}
