//! Gears between the motors that were logged and their joints.

/// Gears that all joints which turn share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gears {
    /// Turns of the motor per turn of the joint.
    pub ratio: f64,
    /// Whether some motors turn the other way than their joints.
    pub some_reversed: bool,
}

impl Gears {
    /// What is wrong with positions before the gears, of which `largest` is the largest.
    pub(super) fn text(self, largest: f64) -> String {
        let ratio = self.ratio;
        let signs = match self.some_reversed {
            true => {
                "; some motors turn the other way than their joints, which an inspection with the gears names ([motors] sign)"
            }
            false => "",
        };
        format!(
            "the positions are those of the motors, before gears of about {ratio:.0}: up to {largest:.1}, they are so many times too large in rad, and \
             in no unit do they explain the torques as well. Give the gears in a dataset ([motors] gear_ratio = {ratio:.0}, position_at = \
             \"motor\"; torque_at = \"motor\" for torques of the motors){signs}{}",
            or_shares(largest)
        )
    }
}

/// Positions up to this size may be shares of each joint's range instead, as LeRobot records them.
const SHARES: f64 = 100.0;

/// The other cause of positions that look like those before gears, by their largest.
fn or_shares(largest: f64) -> &'static str {
    match largest <= SHARES {
        true => {
            ". Or they are shares of each joint's range from -100 to 100, as LeRobot records them: record degrees (use_degrees), or convert each \
             joint by its calibration"
        }
        false => "",
    }
}

#[cfg(test)]
mod tests {
    use super::or_shares;

    #[test]
    fn positions_up_to_a_hundred_may_be_shares() {
        assert!(or_shares(65.6).contains("LeRobot") && or_shares(100.1).is_empty());
    }
}
