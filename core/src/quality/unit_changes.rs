//! Units of a log that are not those of its description.

use super::motion::OtherUnit;
use crate::robot::JointKind;
use std::f64::consts::PI;

/// A unit of velocities other than rad/s and m/s.
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
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UnitChanges {
    /// True seconds per second of the clock.
    pub time_factor: Option<f64>,
    /// Unit of the position of each joint that is in another than rad or m; empty where none is.
    pub positions: Vec<Option<OtherUnit>>,
    /// Unit of the velocity of each joint that is in another than rad/s or m/s; empty where none is.
    pub velocities: Vec<Option<OtherRate>>,
}
