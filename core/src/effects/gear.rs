//! The elastic gear with play between motor and link: one law for joint elasticity and backlash.

/// A gear whose torque is K (twist + T d twist/dt) outside a dead zone of +- `half_gap`, twist = motor - link position
/// seen at the joint (Spong 1987; Nordin and Gutman 2002 for the dead zone).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::Gear;
///
/// // A gear of 100 kN m/rad with 2 mrad of play, behind one without play.
/// let gear = Gear { compliance: 1e-5, half_gap: 1e-3 }.in_series(Gear { compliance: 1e-5, half_gap: 0.0 });
/// assert_eq!(gear.torque(0.5e-3, 0.0), 0.0);
/// assert!((gear.torque(3e-3, 0.0) - 100.0).abs() < 1e-9);
/// assert!((gear.twist(100.0) - 3e-3).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gear {
    /// Compliance 1/K, rad/(N m).
    pub compliance: f64,
    /// Half the play, rad.
    pub half_gap: f64,
}

/// Damping of gears: time T in K (twist + T d twist/dt), s. Makes the impacts of teeth lose most of their speed (a
/// coefficient of restitution of about 0.4 on a stiff gear), and gives a gear that swings at 10 to 50 Hz a damping ratio
/// of 3 to 16 %.
pub(super) const DAMPING_TIME_S: f64 = 1e-3;

/// Stiffness that stands for a rigid gear when only its play matters, N m/rad over the motor's inertia: the square of
/// 600 rad/s, which the default plant step still follows.
pub(super) const STIFF: f64 = 600.0 * 600.0;

/// Runge-Kutta steps of [`Gear::follow`]: no longer than this, s, a sixth of a radian of the swing on a gear of [`STIFF`], and so many
/// between two samples, at least and at most.
const STEP_S: f64 = 2.8e-4;
const STEPS: [usize; 2] = [8, 32];

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

    /// Twist, its rate and its acceleration at samples `period` seconds apart, of a gear whose link would carry `load` if
    /// it moved with the motor and has the inertia `inertia` (kg m2) about the joint: inertia d2 twist/dt2 = load - torque
    /// of the gear. Starts at rest under the first load.
    pub fn follow(&self, load: &[f64], inertia: &[f64], period: f64) -> [Vec<f64>; 3] {
        let steps = ((period / STEP_S).ceil() as usize).clamp(STEPS[0], STEPS[1]);
        let step = period / steps as f64;
        let mut twist = load.first().map_or(0.0, |&first| self.twist(first));
        let mut rate = 0.0;
        let mut path = [(); 3].map(|()| Vec::with_capacity(load.len()));
        for sample in 0..load.len() {
            let next = (sample + 1).min(load.len() - 1);
            let acceleration = |share: f64, twist: f64, rate: f64| {
                let carried = load[sample] + share * (load[next] - load[sample]);
                (carried - self.torque(twist, rate)) / inertia[sample]
            };
            for (values, value) in path.iter_mut().zip([twist, rate, acceleration(0.0, twist, rate)]) {
                values.push(value);
            }
            for k in 0..steps {
                let at = |part: f64| (k as f64 + part) / steps as f64;
                let (v1, a1) = (rate, acceleration(at(0.0), twist, rate));
                let (v2, a2) =
                    (rate + 0.5 * step * a1, acceleration(at(0.5), twist + 0.5 * step * v1, rate + 0.5 * step * a1));
                let (v3, a3) =
                    (rate + 0.5 * step * a2, acceleration(at(0.5), twist + 0.5 * step * v2, rate + 0.5 * step * a2));
                let (v4, a4) = (rate + step * a3, acceleration(at(1.0), twist + step * v3, rate + step * a3));
                twist += step / 6.0 * (v1 + 2.0 * (v2 + v3) + v4);
                rate += step / 6.0 * (a1 + 2.0 * (a2 + a3) + a4);
            }
        }
        path
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
        assert!((gear.torque(0.003, 1.0) - 300.0).abs() < 1e-9);
        assert!((gear.twist(200.0) - 0.003).abs() < 1e-15);
    }

    #[test]
    fn a_link_falls_through_the_play_and_swings_on_the_spring() {
        // Load from +2 to -2 N m at t = 0: 1 kg m2 falls through 2 mm-rad of play in sqrt(2 * 0.002 / 2) s.
        let gear = Gear { compliance: 1e-6, half_gap: 1e-3 };
        let load: Vec<f64> = (0..200).map(|k| if k == 0 { 2.0 } else { -2.0 }).collect();
        let [twist, rate, _] = gear.follow(&load, &[1.0; 200], 1e-3);
        assert!((twist[0] - 0.001_002).abs() < 1e-12);
        let crossing = twist.iter().position(|&t| t < -0.001).unwrap() as f64 * 1e-3;
        assert!((crossing - 0.0447).abs() < 0.003, "{crossing}");
        let fastest = rate.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        assert!((fastest - (2.0f64 * 2.0 * 0.002).sqrt()).abs() < 0.01, "{fastest}");
    }

    #[test]
    fn teeth_do_not_pull() {
        let gear = Gear { compliance: 1e-5, half_gap: 1e-3 };
        assert_eq!(gear.torque(0.0011, -1.0), 0.0);
    }
}
