//! The sign of Coulomb friction near standstill, as simulators and drivers round it.

/// Velocity gained over this time at the present acceleration goes with the velocity in the soft constraint of MuJoCo, s: by its default
/// `solref` (time constant 0.02 s, critically damped) and `solimp` (impedance 0.95) the damping is 2 / (0.95 * 0.02 s), whose inverse it is.
const CONSTRAINT_LEAD_S: f64 = 0.0095;

/// How the direction of motion is rounded. Widths are velocities, rad/s or m/s.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::Rounding;
///
/// // At the width, and a steady speed, a ramp is at its end, and the others are on their way.
/// let forms = [Rounding::Sharp, Rounding::Tanh(0.1), Rounding::Ramp(0.1), Rounding::Root(0.1)];
/// let at_width = forms.map(|r| r.direction(0.1, 0.0));
/// assert_eq!([at_width[0], at_width[2]], [1.0, 1.0]);
/// assert!((at_width[1] - 0.762).abs() < 1e-3 && (at_width[3] - 0.707).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Rounding {
    /// Not at all: the plain sign.
    #[default]
    Sharp,
    /// tanh(v / width), as most simulators and drivers write it.
    Tanh(f64),
    /// Straight up to the width and constant from there on.
    Ramp(f64),
    /// The ramp of the velocity some milliseconds ahead, v + a T, which the constraint solver of MuJoCo makes of `frictionloss`: below its
    /// limit the force of a soft constraint is D (b v + a), with T = 1 / b (documentation of MuJoCo, Computation, "Constraint model").
    Constraint(f64),
    /// v / sqrt(v^2 + width^2), whose tails reach far.
    Root(f64),
}

impl Rounding {
    /// Direction of motion at a velocity, rad/s or m/s, and an acceleration, rad/s2 or m/s2: from -1 to 1.
    #[inline]
    pub fn direction(self, velocity: f64, acceleration: f64) -> f64 {
        match self {
            Rounding::Tanh(width) if width > 0.0 => (velocity / width).tanh(),
            Rounding::Ramp(width) if width > 0.0 => (velocity / width).clamp(-1.0, 1.0),
            Rounding::Constraint(width) if width > 0.0 => {
                ((velocity + CONSTRAINT_LEAD_S * acceleration) / width).clamp(-1.0, 1.0)
            }
            Rounding::Root(width) if width > 0.0 => velocity / velocity.hypot(width),
            _ if velocity > 0.0 => 1.0,
            _ if velocity < 0.0 => -1.0,
            _ => velocity,
        }
    }

    /// Its width; zero of a plain sign.
    pub fn width(self) -> f64 {
        match self {
            Rounding::Sharp => 0.0,
            Rounding::Tanh(width) | Rounding::Ramp(width) | Rounding::Constraint(width) | Rounding::Root(width) => {
                width
            }
        }
    }

    /// The same form with a width that is so many times as large.
    pub(crate) fn scaled(self, factor: f64) -> Rounding {
        match self {
            Rounding::Sharp => Rounding::Sharp,
            Rounding::Tanh(width) => Rounding::Tanh(factor * width),
            Rounding::Ramp(width) => Rounding::Ramp(factor * width),
            Rounding::Constraint(width) => Rounding::Constraint(factor * width),
            Rounding::Root(width) => Rounding::Root(factor * width),
        }
    }

    /// Whether two are of one form.
    pub(crate) fn is_like(self, other: Rounding) -> bool {
        self.form() == other.form()
    }

    /// A number for its form.
    pub(crate) fn form(self) -> u64 {
        match self {
            Rounding::Sharp => 0,
            Rounding::Tanh(_) => 1,
            Rounding::Ramp(_) => 2,
            Rounding::Root(_) => 3,
            Rounding::Constraint(_) => 4,
        }
    }

    /// Its formula.
    pub(crate) fn formula(self) -> &'static str {
        match self {
            Rounding::Sharp => "sign(v)",
            Rounding::Tanh(_) => "tanh(v / width)",
            Rounding::Ramp(_) => "v / width up to the width and constant beyond",
            Rounding::Constraint(_) => "frictionloss of MuJoCo, (v + a 9.5 ms) / width up to 1,",
            Rounding::Root(_) => "v / sqrt(v^2 + width^2)",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constraint_goes_by_the_velocity_ahead() {
        let constraint = Rounding::Constraint(0.2);
        assert_eq!(constraint.direction(0.1, 0.0), 0.5);
        // 0.1 rad/s + 0.0095 s * 4 rad/s2.
        assert!((constraint.direction(0.1, 4.0) - 0.69).abs() < 1e-12);
        assert!((constraint.direction(0.0, -8.0) + 0.38).abs() < 1e-12);
        assert_eq!([constraint.direction(0.1, 20.0), Rounding::Constraint(0.0).direction(0.1, -20.0)], [1.0; 2]);
        assert!(!constraint.is_like(Rounding::Ramp(0.2)) && constraint.scaled(2.0) == Rounding::Constraint(0.4));
    }

    #[test]
    fn forms_by_hand() {
        let at = |velocity: f64| {
            [Rounding::Sharp, Rounding::Tanh(0.2), Rounding::Ramp(0.2), Rounding::Root(0.2)]
                .map(|r| r.direction(velocity, 0.0))
        };
        assert_eq!(at(0.0), [0.0; 4]);
        let [sharp, tanh, ramp, root] = at(-0.15);
        assert_eq!(sharp, -1.0);
        assert!((ramp + 0.75).abs() < 1e-12 && (tanh + 0.635_148_952).abs() < 1e-8 && (root + 0.6).abs() < 1e-12);
        assert_eq!(at(0.21)[2], 1.0);
        assert_eq!(Rounding::Ramp(0.2).scaled(0.5), Rounding::Ramp(0.1));
        assert!(Rounding::Ramp(0.2).is_like(Rounding::Ramp(0.1)) && !Rounding::Ramp(0.2).is_like(Rounding::Tanh(0.2)));
        assert_eq!([Rounding::Sharp.width(), Rounding::Root(0.3).width()], [0.0, 0.3]);
        // Without a width each is a plain sign.
        assert_eq!(
            [Rounding::Tanh(0.0), Rounding::Ramp(0.0), Rounding::Root(0.0)].map(|r| r.direction(-1e-9, 0.0)),
            [-1.0; 3]
        );
    }
}
