//! Joint elasticity: the gear gives way between the motor, whose encoder is read, and the link.

use crate::effects::{About, Effect, Gear, Hidden, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::robot::Unit;

/// A gear of stiffness K = 1 / compliance.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, JointElasticity};
///
/// // A gear of 250 kN m/rad winds up by 2 mrad under 500 N m.
/// let gear = JointElasticity.gear(&[4e-6]).expect("an elastic gear");
/// assert!((gear.twist(500.0) - 2e-3).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct JointElasticity;

static ABOUT: About = About {
    name: "joint_elasticity",
    equation: "tau_gear = (q_motor - q_link) / compliance",
    explanation: "Gears and shafts wind up under load, so the link is not where the motor's encoder reads and oscillates behind it.",
    reference: "Spong (1987), Modeling and control of elastic joint robots, ASME Journal of Dynamic Systems, \
                Measurement, and Control 109(4)",
    rivals: &[
        Rival {
            name: "backlash",
            how_to_tell: "play shifts the link by a fixed angle when the load changes sign; elasticity in proportion to \
                          the load",
        },
        Rival {
            name: "time_delay",
            how_to_tell: "a delay shifts friction as well, and in proportion to speed; elasticity shifts only what passes \
                          through the gear, in proportion to its load",
        },
        Rival {
            name: "rotor_inertia",
            how_to_tell: "a rotor needs torque in proportion to acceleration; elasticity needs its second derivative too",
        },
    ],
    site: Site::Gear,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::LikePlay,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "compliance",
    symbol: "1/K",
    unit: Unit::Compliance,
    role: Role::Departure,
    lower: 0.0,
    upper: 1.0,
    typical: 4e-6,
}];

impl Effect for JointElasticity {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn search(&self, _: usize) -> Search {
        Search::Compliance
    }

    fn gear(&self, p: &[f64]) -> Option<Gear> {
        Some(Gear { compliance: p[0], half_gap: 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        // K = 250 000 N m/rad: a motor 2 mrad ahead of its link pushes it with 500 N m; 800 N m wind it up by 3.2 mrad.
        let gear = JointElasticity.gear(&[4e-6]).unwrap();
        assert!((gear.torque(2e-3, 0.0) - 500.0).abs() < 1e-9);
        assert!((gear.torque(-2e-3, 0.0) + 500.0).abs() < 1e-9);
        assert!((gear.twist(800.0) - 3.2e-3).abs() < 1e-15);
    }

    #[test]
    fn absent_it_is_rigid() {
        assert!(JointElasticity.gear(&[0.0]).unwrap().is_rigid());
    }
}
