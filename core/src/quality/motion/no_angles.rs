//! Positions that are no angles of the joints.

use super::gears::Gears;
use super::ranges::Ranges;

/// What positions are that are no angles of the joints.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum NoAngles {
    /// Those of the motors.
    BeforeGears(Gears),
    /// Shares of the joints' ranges.
    OfRanges(Ranges),
}

impl NoAngles {
    /// What is wrong with the positions, of which `largest` is the largest.
    pub(super) fn text(&self, largest: f64) -> String {
        match self {
            NoAngles::BeforeGears(gears) => gears.text(largest),
            NoAngles::OfRanges(ranges) => ranges.text(),
        }
    }
}
