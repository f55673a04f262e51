//! Viscous friction: torque proportional to speed.

use super::{About, Effect, Instant, Parameter};

/// Fv v.
#[derive(Debug, Clone, Copy)]
pub struct ViscousFriction;

static ABOUT: About = About {
    name: "viscous_friction",
    equation: "tau = Fv v",
    explanation: "Lubricant and drive losses that grow in proportion to speed.",
    reference: "Armstrong-Helouvry, Dupont, Canudas de Wit (1994), Automatica 30(7)",
};

static PARAMETERS: [Parameter; 1] = [Parameter { symbol: "Fv", unit: "N m s/rad" }];

impl Effect for ViscousFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant) -> f64 {
        p[0] * x.qd[joint]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let x = Instant { t: 0.0, q: &[0.0], qd: &[-0.5], direction: &[-1.0] };
        assert_eq!(ViscousFriction.torque(&[40.0], 0, &x), -20.0);
    }
}
