//! Peaks of a joint's motion: the range it covers, its highest speed and its highest acceleration, and when.

/// An extreme value and the time it is reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extreme {
    /// The value, signed; rad, rad/s or rad/s^2.
    pub value: f64,
    /// When, s from the start of the motion.
    pub time_s: f64,
}

/// Extremes of one joint over a motion that starts at rest at zero (which the default value stands for).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::excitation::Peaks;
///
/// // States of a motion at three times: position, velocity, acceleration.
/// let mut peaks = Peaks::default();
/// for (time_s, state) in [(0.0, [0.0, 0.0, 2.0]), (0.5, [0.4, 0.9, 0.0]), (1.0, [0.6, 0.0, -3.0])] {
///     peaks.include(time_s, state);
/// }
/// assert_eq!((peaks.highest.value, peaks.lowest.value), (0.6, 0.0));
/// assert_eq!((peaks.acceleration.value, peaks.acceleration.time_s), (-3.0, 1.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    /// Lowest position, rad.
    pub lowest: Extreme,
    /// Highest position, rad.
    pub highest: Extreme,
    /// Velocity of the greatest magnitude, rad/s.
    pub velocity: Extreme,
    /// Acceleration of the greatest magnitude, rad/s^2.
    pub acceleration: Extreme,
}

impl Peaks {
    /// Widens the peaks to take in the [position, velocity, acceleration] reached at `time_s`.
    pub fn include(&mut self, time_s: f64, [position, velocity, acceleration]: [f64; 3]) {
        if position < self.lowest.value {
            self.lowest = Extreme { value: position, time_s };
        }
        if position > self.highest.value {
            self.highest = Extreme { value: position, time_s };
        }
        if velocity.abs() > self.velocity.value.abs() {
            self.velocity = Extreme { value: velocity, time_s };
        }
        if acceleration.abs() > self.acceleration.value.abs() {
            self.acceleration = Extreme { value: acceleration, time_s };
        }
    }
}
