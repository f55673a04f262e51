//! The direction of gravity that a finding gives.

use crate::effects::{self, Scope};
use crate::robot::Robot;

/// Where gravity points in the base of `robot` with an effect of such parameters (and what derives from them) that turns it; none of
/// another effect.
pub(super) fn direction(robot: &Robot, effect: &str, values: &[f64]) -> Option<String> {
    let effect = effects::find(effect).ok().filter(|effect| effect.about().scope == Scope::Arm)?;
    let own = values.get(..effect.parameters().len())?;
    let mut turned = robot.clone();
    effect.alter(own, 0, &mut turned);
    let [x, y, z]: [f64; 3] = turned.gravity.into();
    let degrees = turned.gravity.angle(&robot.gravity).to_degrees();
    (turned.gravity != robot.gravity).then(|| {
        format!(
            "By this tilt of {degrees:.1} degrees gravity points along [{x:.2}, {y:.2}, {z:.2}] m/s2 of the base ([mounting] gravity_m_s2 of \
             a dataset, or --gravity)."
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{self, InertiaCheck};

    #[test]
    fn a_tilt_has_a_direction() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/irb1600_6_120.urdf");
        let arm = robot::load(file, InertiaCheck::Required).unwrap();
        // Pitched by 30 degrees the base's x axis points down.
        let said = direction(&arm, "base_tilt", &[0.0, std::f64::consts::FRAC_PI_6, 0.5]).unwrap();
        assert!(said.contains("30.0 degrees") && said.contains("[4.91, 0.00, -8.50]"), "{said}");
        assert_eq!(direction(&arm, "stribeck_friction", &[1.0, 0.1, 0.5]), None);
    }
}
