//! The elastic gear with play between motor and link: one law for joint elasticity and backlash.

/// A gear whose torque is K (twist + T d twist/dt) outside a dead zone of +- `half_gap`, twist = motor - link position
/// seen at the joint (Spong 1987; Nordin and Gutman 2002 for the dead zone).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gear {
    /// Compliance 1/K, rad/(N m).
    pub compliance: f64,
    /// Half the play, rad.
    pub half_gap: f64,
}

/// Structural damping of gears: time T in K (twist + T d twist/dt), s. Keeps the gear's own oscillation from ringing on
/// for ever (a damping ratio of 2 to 6 % at 30 to 100 Hz), and is too small to show in a motion.
pub const DAMPING_TIME_S: f64 = 2e-4;

/// Stiffness that stands for a rigid gear when only its play matters, N m/rad over the motor's inertia: the square of
/// 600 rad/s, which the default plant step still follows.
pub const STIFF: f64 = 600.0 * 600.0;

impl Gear {
    /// Two gears in series.
    pub fn in_series(self, other: Gear) -> Gear {
        Gear { compliance: self.compliance + other.compliance, half_gap: self.half_gap + other.half_gap }
    }

    /// Whether it is a rigid connection.
    pub fn is_rigid(&self) -> bool {
        self.compliance == 0.0 && self.half_gap == 0.0
    }

    /// The gear with the compliance that a gear without a given one has behind a motor inertia of `armature` kg m2.
    pub fn completed(self, armature: f64) -> Gear {
        if self.compliance > 0.0 { self } else { Gear { compliance: 1.0 / (STIFF * armature), ..self } }
    }

    /// Torque that motor and link exchange at a twist and its rate.
    pub fn torque(&self, twist: f64, rate: f64) -> f64 {
        let beyond = twist.abs() - self.half_gap;
        if beyond <= 0.0 {
            return 0.0;
        }
        let pushed = beyond * twist.signum() + DAMPING_TIME_S * rate;
        // Damping must not pull: the tooth only pushes.
        if pushed * twist > 0.0 { pushed / self.compliance } else { 0.0 }
    }

    /// Twist under a steady torque: the inverse of [`Gear::torque`].
    pub fn twist(&self, torque: f64) -> f64 {
        let play = if torque == 0.0 { 0.0 } else { self.half_gap * torque.signum() };
        self.compliance * torque + play
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let gear = Gear { compliance: 1e-5, half_gap: 1e-3 };
        assert_eq!(gear.torque(0.0005, 0.0), 0.0);
        assert!((gear.torque(0.003, 0.0) - 200.0).abs() < 1e-9);
        assert!((gear.torque(-0.003, 0.0) + 200.0).abs() < 1e-9);
        assert!((gear.torque(0.003, 1.0) - 220.0).abs() < 1e-9);
        assert!((gear.twist(200.0) - 0.003).abs() < 1e-15);
    }

    #[test]
    fn teeth_do_not_pull() {
        let gear = Gear { compliance: 1e-5, half_gap: 1e-3 };
        assert_eq!(gear.torque(0.0011, -10.0), 0.0);
    }
}
