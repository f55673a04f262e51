//! Lines of `tauscope identify` about held-out residuals that are far above those of training.

use crate::identification::consistent::Consistent;
use crate::identification::fit::Fitted;
use crate::internal::root_mean_square;
use crate::report::console::significant;
use crate::robot::{Joint, Robot, Unit};

/// The held-out residual of base parameters is this many times that of the training logs, and this many times that of bodies that can
/// exist, where the training logs do not determine them: what these contradict is no body's.
const EXTRAPOLATES: f64 = 3.0;
const OF_BODIES: f64 = 2.0;

/// A held-out residual of this many times that of the training logs is no chance, and none of effects that a model lacks: in ninety trials
/// with effects, faults and descriptions of all kinds the largest was 3.2 times where the arm was the same and its parameters determined; with
/// another load it was 9 to 108 times.
const OF_ANOTHER_ARM: f64 = 5.0;

/// Share of the held-out torque below which a residual is not worth a line: a log without noise leaves next to nothing in training, and many
/// times that held out.
const OF_TORQUE: f64 = 0.01;

/// A line about the joints whose held-out torque the training logs do not determine, if there are any: base parameters that they leave open
/// make up for one another there and nowhere else, and bodies that can exist do not.
pub fn undetermined_held_out(robot: &Robot, fitted: &Fitted, consistent: &Consistent) -> Option<String> {
    let joints = 0..fitted.test_rms.len().min(consistent.test_rms.len());
    let each: Vec<String> = joints
        .filter(|&joint| extrapolates(fitted.train_rms[joint], fitted.test_rms[joint], consistent.test_rms[joint]))
        .map(|joint| {
            let [held_out, bodies] = [fitted.test_rms[joint], consistent.test_rms[joint]].map(significant);
            let Joint { name, kind, .. } = &robot.joints[joint];
            format!("{name} {held_out} {}, with the bodies of identified.urdf {bodies}", kind.unit(Unit::Effort))
        })
        .collect();
    (!each.is_empty()).then(|| {
        format!(
            "the training logs do not determine the held-out torque: the base parameters leave of it on {}. Take identified.urdf, not the base \
             parameters, or train on motions that move the joints together",
            each.join("; on ")
        )
    })
}

/// Whether base parameters with these residuals, root mean square, on the training and the held-out logs are not determined by the training
/// logs, where `bodies` that can exist leave so much of the held-out ones.
fn extrapolates(training: f64, held_out: f64, bodies: f64) -> bool {
    held_out > EXTRAPOLATES * training && held_out > OF_BODIES * bodies
}

/// A line about the joints whose held-out torque is not that of the arm that was trained from, if there are any: neither the base parameters
/// nor the bodies of `consistent`, where there are any, follow it.
pub fn of_another_arm(robot: &Robot, fitted: &Fitted, consistent: Option<&Consistent>) -> Option<String> {
    let torque = |joint: usize| {
        let rows = fitted.test.torque[joint].iter().zip(&fitted.test.residual[joint]);
        root_mean_square(&rows.filter_map(|(torque, residual)| residual.map(|_| *torque)).collect::<Vec<f64>>())
    };
    let is_other = |joint: &usize| {
        let (training, held_out) = (fitted.train_rms[*joint], fitted.test_rms[*joint]);
        let bodies = consistent.and_then(|bodies| bodies.test_rms.get(*joint));
        let is_open = bodies.is_some_and(|bodies| extrapolates(training, held_out, *bodies));
        !is_open && changed(training, held_out, torque(*joint))
    };
    let joints = (0..fitted.test_rms.len()).filter(is_other);
    let each = joints.map(|joint| {
        let Joint { name, kind, .. } = &robot.joints[joint];
        (name.as_str(), [fitted.train_rms[joint], fitted.test_rms[joint]], kind.unit(Unit::Effort))
    });
    text_of_another_arm(&each.collect::<Vec<_>>())
}

/// Whether a residual, root mean square, went up from the training to the held-out logs, of which `torque` is the torque, by more than
/// what a model lacks.
fn changed(training: f64, held_out: f64, torque: f64) -> bool {
    held_out > OF_ANOTHER_ARM * training && held_out > OF_TORQUE * torque
}

/// The line on joints with their residuals in training and held out, and the unit of both.
fn text_of_another_arm(joints: &[(&str, [f64; 2], &str)]) -> Option<String> {
    let each = joints.iter().map(|(name, [training, held_out], unit)| {
        let [times, from, to] = [held_out / training, *training, *held_out].map(significant);
        format!("{times} times on {name} ({to} after {from} {unit})")
    });
    let each: Vec<String> = each.collect();
    (!each.is_empty()).then(|| {
        format!(
            "the held-out residual is far above that of the training logs, {}: another load, or another state of the arm? `tauscope payload` \
             looks for a load, `tauscope diagnose` for what else differs",
            each.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_parameters_extrapolate_where_bodies_do_not() {
        assert!(extrapolates(1.0, 3.1, 1.5) && !extrapolates(1.0, 2.9, 1.0));
        // What bodies do not follow either has changed between the logs.
        assert!(!extrapolates(1.0, 30.0, 16.0) && extrapolates(1.0, 30.0, 14.0));
    }

    #[test]
    fn a_residual_that_goes_up_is_of_another_arm() {
        assert!(changed(0.2, 5.0, 40.0) && !changed(0.2, 0.9, 40.0) && !changed(f64::NAN, f64::NAN, 40.0));
        // Three hundredths of a per cent of the torque, in a log without noise.
        assert!(!changed(0.001, 0.012, 40.0));
        let said = text_of_another_arm(&[("shoulder", [0.2, 5.0], "N m"), ("elbow", [0.1, 0.6], "N m")]).unwrap();
        assert!(said.contains("25.0 times on shoulder (5.00 after 0.200 N m), 6.00 times on elbow ("), "{said}");
        assert_eq!(text_of_another_arm(&[]), None);
    }
}
