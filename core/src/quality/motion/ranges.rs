//! Positions that are shares of each joint's range.

/// What shares of ranges are of.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ranges {
    /// Middle and half of the range of every joint that turns, rad, where they are those of the robot's limits.
    pub of_limits: Option<Vec<[f64; 2]>>,
    /// Share of the torques that stays unexplained as degrees, and as shares of these.
    pub unexplained: [f64; 2],
    /// Turns of the motor per turn of the joint, where the positions may be those of motors instead.
    pub gear: Option<f64>,
}

impl Ranges {
    /// What is wrong with the positions, and what makes angles of them.
    pub(super) fn text(&self) -> String {
        let cause =
            "the positions are no angles but shares of each joint's range, from -100 to 100, as LeRobot records them";
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        let motors = "[motors] position_at = \"motor\", torque_at = \"joint\"";
        match &self.of_limits {
            Some(ranges) => {
                let list = |value: &dyn Fn(&[f64; 2]) -> f64| {
                    ranges.iter().map(|own| format!("{:.5}", value(own))).collect::<Vec<_>>().join(", ")
                };
                format!(
                    "{cause}: with the limits of the URDF as ranges {} of the torque stays unexplained, as degrees {}. If the calibration has these \
                     ranges, say so in a dataset: {motors}, gear_ratio = [{}], position_offset = [{}]; else put in 200 over the calibrated range in \
                     rad, and its middle",
                    percent(self.unexplained[1]),
                    percent(self.unexplained[0]),
                    list(&|own| 100.0 / own[1]),
                    list(&|own| own[0])
                )
            }
            None => format!(
                "{cause}: most joints come to the ends, and as degrees {} of the torque stays unexplained. Record degrees (use_degrees = true), or \
                 give each joint's calibrated range in a dataset: {motors}, gear_ratio = [200 over the range in rad, ..], position_offset = [the \
                 middle of the range in rad, ..]{}",
                percent(self.unexplained[0]),
                self.gear.map_or(String::new(), |gear| {
                    format!(". Less likely they are those of the motors, before gears of about {gear:.0} (gear_ratio = {gear:.0})")
                })
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Ranges;

    #[test]
    fn a_dataset_makes_angles_of_shares() {
        let ranges = Ranges { of_limits: Some(vec![[0.5, 2.0], [0.0, 1.6]]), unexplained: [0.6, 0.01], gear: None };
        let text = ranges.text();
        assert!(text.contains("gear_ratio = [50.00000, 62.50000], position_offset = [0.50000, 0.00000]"), "{text}");
        assert!(Ranges { of_limits: None, ..ranges }.text().contains("calibrated range in a dataset"));
    }
}
