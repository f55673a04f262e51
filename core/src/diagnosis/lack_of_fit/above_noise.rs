//! Residuals well above the noise whose cause no test indicates: of a search that was ended before it looked for their structure, and of
//! logs in which structure is not separable from slow noise.

use super::structure::Unexplained;
use crate::diagnosis::criteria::{Gate, Judgement, Levels, StructureCriteria};
use crate::diagnosis::variance::{JointMap, ResidualMap};

/// How such a joint is reported.
pub(super) const ABOVE_NOISE: &str = "is above the noise";

/// The joints whose held-out residual is well above the noise (root mean squares, `[joint]`, N m), but those on which something is
/// reported already. A search that was ended does not answer that nothing is there.
pub(crate) fn above_noise(
    residual: &[f64],
    noise: &[f64],
    reported: &[Unexplained],
    criteria: &StructureCriteria,
) -> Vec<Unexplained> {
    let each = residual.iter().zip(noise).enumerate().filter_map(|(joint, (&residual, &noise))| {
        let clear = Judgement::above(Gate::AboveExpected, residual / noise, criteria.above_noise);
        untested(joint, clear, ABOVE_NOISE, reported)
    });
    each.collect()
}

/// What a joint's residual has above the noise, of which no test says what it is; None where it is not clear of that, or reported already.
fn untested(joint: usize, clear: Judgement, structure: &'static str, reported: &[Unexplained]) -> Option<Unexplained> {
    let is_open = clear.passed && reported.iter().all(|other| other.joint != joint);
    is_open.then(|| Unexplained {
        joint,
        share: 1.0 - clear.value.powi(-2),
        structure,
        family_wise_p: None,
        certain: false,
        instead_of: Vec::new(),
        passed: vec![clear],
    })
}

/// What is said of a joint whose residual is far above the noise of the map, though nothing in it is significant.
const NOT_SEPARATED: &str = "is far above the noise, and not separated from noise that is slow";

/// The joints whose residual in all logs is far above the noise of the map, but those on which something is reported already: with few
/// independent stretches of time no part of it is significant, and yet it is not nothing. Quiet logs with noise that is correlated over
/// half a second have up to 2.1 times that noise.
pub(crate) fn not_separated(map: &ResidualMap, reported: &[Unexplained], levels: &Levels) -> Vec<Unexplained> {
    let unexplained = |own: &JointMap| {
        let clear = Judgement::at_least(Gate::AboveExpected, own.residual / own.noise, levels.far);
        untested(own.joint, clear, NOT_SEPARATED, reported)
    };
    map.joints.iter().filter_map(unexplained).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_from_three_times_the_noise_of_the_map_are_reported_once() {
        let criteria = Levels::default();
        let map = |residual: f64| ResidualMap {
            joints: vec![JointMap {
                joint: 2,
                torque: 10.0,
                residual,
                noise: 1.0,
                correlation: 0.3,
                sensor_noise: 0.1,
                reported_from: 0.25,
                misfit: true,
                parts: Vec::new(),
                lines: Vec::new(),
            }],
        };
        assert!(not_separated(&map(2.99), &[], &criteria).is_empty());
        let found = not_separated(&map(3.0), &[], &criteria);
        assert!(found.len() == 1 && found[0].joint == 2 && !found[0].certain);
        assert!(not_separated(&map(3.0), &found, &criteria).is_empty());
    }

    #[test]
    fn residuals_from_twice_the_noise_are_reported_once() {
        let criteria = StructureCriteria::default();
        let of =
            |residual: f64, reported: &[Unexplained]| above_noise(&[residual, 0.1], &[1.0, 0.1], reported, &criteria);
        assert!(of(criteria.above_noise, &[]).is_empty());
        let found = of(criteria.above_noise + 1e-9, &[]);
        assert!(found.len() == 1 && found[0].joint == 0 && (found[0].share - 0.75).abs() < 1e-6);
        assert!(of(5.0, &found).is_empty());
    }
}
