//! Coulomb friction: torque of one size against the direction of motion; at standstill anything up to that size.

use super::{About, Effect, Instant, Parameter};

/// Fc sign(v).
#[derive(Debug, Clone, Copy)]
pub struct CoulombFriction;

static ABOUT: About = About {
    name: "coulomb_friction",
    equation: "tau = Fc sign(v); |tau| <= Fc at standstill",
    explanation: "Dry friction of gears, seals and bearings: the same size at every speed, it flips with the direction.",
    reference: "Armstrong-Helouvry, Dupont, Canudas de Wit (1994), Automatica 30(7)",
};

static PARAMETERS: [Parameter; 1] = [Parameter { symbol: "Fc", unit: "N m" }];

impl Effect for CoulombFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn is_dry(&self) -> bool {
        true
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant) -> f64 {
        p[0] * x.direction[joint]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let x = Instant { t: 0.0, q: &[0.0], qd: &[-0.5], direction: &[-1.0] };
        assert_eq!(CoulombFriction.torque(&[30.0], 0, &x), -30.0);
        assert_eq!(CoulombFriction.torque(&[30.0], 0, &Instant { direction: &[0.0], ..x }), 0.0);
    }
}
