//! Backlash: play in the gear, in which motor and link move freely of each other.

use crate::effects::{About, Effect, Gear, Hidden, Limit, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::robot::{Robot, Unit};

/// A dead zone of +- half_gap between motor and link.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Backlash, Effect};
///
/// // The link lags by half the play, on the side of the load.
/// let gear = Backlash.gear(&[5e-4]).expect("a gear with play");
/// assert_eq!((gear.twist(10.0), gear.twist(-10.0)), (5e-4, -5e-4));
/// assert_eq!(gear.torque(3e-4, 0.0), 0.0);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Backlash;

static ABOUT: About = About {
    name: "backlash",
    equation: "tau_gear = 0 while |q_motor - q_link| <= half_gap; beyond it the teeth touch",
    explanation: "Worn or loose gears have play: whenever the load changes sign the link lags until the other flank of \
                  the teeth is reached.",
    reference: "Nordin and Gutman (2002), Controlling mechanical systems with backlash - a survey, Automatica 38(10)",
    rivals: &[
        Rival {
            name: "joint_elasticity",
            how_to_tell: "elasticity moves the link in proportion to the load, not at once when the load changes sign",
        },
        Rival {
            name: "presliding_hysteresis",
            how_to_tell: "presliding acts where the velocity changes sign, backlash where the gear's torque does",
        },
        Rival { name: "encoder_offset", how_to_tell: "an offset does not change sides with the load" },
    ],
    site: Site::Gear,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Play,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "half_gap",
    symbol: "b",
    unit: Unit::Position,
    role: Role::Departure,
    lower: 0.0,
    upper: 0.05,
    typical: 5e-4,
}];

/// About an arc second, and 5 um: gears without play are specified to a minute. What is timed or fitted as less is noise of the encoders that
/// the controller feeds back.
static LIMITS: [Limit; 1] = [Limit::least("half_gap, rad or m", 5e-6)];

impl Effect for Backlash {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn is_asked_about(&self) -> bool {
        true
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn search(&self, _: usize) -> Search {
        Search::Gap
    }

    fn limits(&self) -> &'static [Limit] {
        &LIMITS
    }

    fn over_limit(&self, p: &[f64], _: usize, _: &Robot) -> f64 {
        LIMITS[0].over(p[0])
    }

    /// No position below the noise of the encoder is known.
    fn least_size(&self, position_noise: f64) -> f64 {
        position_noise
    }

    fn gear(&self, p: &[f64]) -> Option<Gear> {
        Some(Gear { compliance: 0.0, half_gap: p[0] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::JointElasticity;

    #[test]
    fn by_hand() {
        // 0.5 mrad of play to either side in front of a gear of 250 000 N m/rad: nothing at 0.5 mrad, 375 N m at 2 mrad.
        let gear = Backlash.gear(&[5e-4]).unwrap().in_series(JointElasticity.gear(&[4e-6]).unwrap());
        assert_eq!(gear.torque(5e-4, 0.0), 0.0);
        assert_eq!(gear.torque(-5e-4, 0.0), 0.0);
        assert!((gear.torque(2e-3, 0.0) - 375.0).abs() < 1e-9);
        assert!((gear.torque(-2e-3, 0.0) + 375.0).abs() < 1e-9);
    }

    #[test]
    fn the_link_changes_sides_with_the_load() {
        let gear = Backlash.gear(&[5e-4]).unwrap();
        assert_eq!([gear.twist(1.0), gear.twist(-1.0), gear.twist(0.0)], [5e-4, -5e-4, 0.0]);
    }

    #[test]
    fn absent_it_is_rigid() {
        assert!(Backlash.gear(&[0.0]).unwrap().is_rigid());
    }
}
