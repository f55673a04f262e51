//! Residuals well above the noise whose cause no test indicates: of a search that was ended before it looked for their structure, and of
//! logs in which structure is not separable from slow noise.

use super::reported::Unexplained;
use crate::diagnosis::criteria::{Criteria, Gate, Judgement, StructureCriteria};
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
        untested(joint, [clear], ABOVE_NOISE, reported)
    });
    each.collect()
}

/// What a joint's residual has above the noise, of which no test says what it is; None where it is not clear of that, or reported already.
fn untested<const N: usize>(
    joint: usize,
    clear: [Judgement; N],
    structure: &'static str,
    reported: &[Unexplained],
) -> Option<Unexplained> {
    let is_open = Judgement::first_failed(clear).is_none() && reported.iter().all(|other| other.joint != joint);
    is_open.then(|| Unexplained {
        joint,
        share: 1.0 - clear[0].value.powi(-2),
        structure,
        family_wise_p: None,
        certain: false,
        instead_of: Vec::new(),
        passed: clear.to_vec(),
    })
}

/// How a joint is reported whose residual is far above the noise of the map, though nothing in it is significant.
const NOT_SEPARATED: &str = "is far above the noise, and not separated from noise that is slow";

/// How a joint is reported that misses much of its torque, far above the noise of its sensor, though the residual is like noise.
const NOT_OF_SENSORS: &str = "is far above the noise of the sensor, and not separated from noise";

/// Whether a residual of a joint is more than the white noise of its torque, by the least share that counts: one that is not has no
/// structure to report. Controllers feed the noise of encoders back, and the torque that this makes goes with the motion as measured.
pub(super) fn above_sensor(residual: f64, sensor_noise: f64, criteria: &Criteria) -> Judgement {
    Judgement::at_least(Gate::AboveExpected, residual / sensor_noise, 1.0 + criteria.levels.minor)
}

/// The joints whose residual in all logs is far above the noise of the map, but those on which something is reported already: with few
/// independent blocks no part of it is significant, and yet it is not nothing. Quiet logs with noise that is correlated over
/// half a second have up to 2.1 times that noise. The noise of the map is estimated from the residual. A residual that it takes for noise is
/// none where it is a good part of the joint's torque and far above the noise of its sensor, as that of a gear that rattles.
pub(crate) fn not_separated(map: &ResidualMap, reported: &[Unexplained], criteria: &Criteria) -> Vec<Unexplained> {
    let far = criteria.levels.far;
    let unexplained = |own: &JointMap| {
        let over =
            |expected: f64, factor: f64| Judgement::at_least(Gate::AboveExpected, own.residual / expected, factor);
        let of_sensor = [over(own.sensor_noise, far), over(own.torque, criteria.levels.minor)];
        untested(own.joint, [over(own.noise, far)], NOT_SEPARATED, reported)
            .or_else(|| untested(own.joint, of_sensor, NOT_OF_SENSORS, reported))
    };
    map.joints.iter().filter_map(unexplained).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_from_three_times_the_noise_of_the_map_are_reported_once() {
        let criteria = Criteria::default();
        let map = |residual: f64| ResidualMap {
            joints: vec![JointMap {
                joint: 2,
                torque: 100.0,
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
        // What is like noise is none from a tenth of the torque on, and three times the noise of the sensor.
        let like_noise = |torque: f64, sensor_noise: f64| {
            let mut map = map(1.2);
            (map.joints[0].torque, map.joints[0].sensor_noise) = (torque, sensor_noise);
            not_separated(&map, &[], &criteria)
        };
        assert_eq!(like_noise(11.99, 0.39)[0].structure, NOT_OF_SENSORS);
        assert!(like_noise(12.01, 0.39).is_empty() && like_noise(11.99, 0.41).is_empty());
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
