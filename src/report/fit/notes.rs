//! Lines of `tauscope identify` about what to think of its numbers.

use super::place_of;
use crate::dynamics::{BaseParameters, Chain, mass_matrix};
use crate::identification::consistent::Consistent;
use crate::identification::fit::{Agreement, BetweenLogs, Constant, Fitted};
use crate::identification::prepare::Smoothing;
use crate::identification::smoothing_choice::usual_window;
use crate::internal::root_mean_square;
use crate::recording::Recording;
use crate::report::console::{measured, significant};
use crate::robot::{Joint, Robot, Unit};

/// Lines about the parameters that the logs do not determine, if there are any: those that are merged into others, and others.
pub fn undetermined(base: &BaseParameters, fitted: &Fitted) -> Vec<String> {
    // The leader identifies a long sum.
    let leader = |name: &str| name.split_whitespace().next().unwrap_or_default().to_owned();
    let groupings = base.groupings();
    let (mut merged, mut others) = (Vec::new(), Vec::new());
    for (name, _) in fitted.fit.names.iter().zip(&fitted.fit.undetermined).filter(|(_, held)| **held) {
        let own = groupings.iter().position(|grouping| grouping.name == *name);
        match own.map(|own| base.merged(own)) {
            Some([first, rest @ ..]) => {
                let into: Vec<String> =
                    [first].into_iter().chain(rest).map(|(other, _)| leader(&groupings[*other].name)).collect();
                merged.push(format!("{} into {}", leader(name), into.join(" and ")));
            }
            _ => others.push(leader(name)),
        }
    }
    let of = fitted.fit.arm_units.len();
    let merged = (!merged.is_empty()).then(|| {
        format!(
            "{} of {of} base parameters differ from others by small tilts or offsets alone, and not above the noise in these logs; they are \
             merged: {}",
            merged.len(),
            merged.join(", ")
        )
    });
    let others = (!others.is_empty()).then(|| {
        format!(
            "{} of {of} base parameters make no torque of their own above the noise in these logs ({}): they stay as described, and \
             the others make up for them",
            others.len(),
            others.join(", ")
        )
    });
    merged.into_iter().chain(others).collect()
}

/// A line about the constants that the residuals hold, if there are any.
pub fn constants(robot: &Robot, fitted: &Fitted) -> Option<String> {
    let found: Vec<(&Joint, &Constant)> = robot
        .joints
        .iter()
        .zip(&fitted.fit.constants)
        .filter_map(|(joint, constant)| Some((joint, constant.as_ref()?)))
        .collect();
    let each: Vec<String> = found
        .iter()
        .map(|(joint, constant)| {
            let (value, unit) = (significant(constant.value), joint.effort_unit());
            format!("{value} {unit} on {} ({:.0} % of its mean squared residual)", joint.name, 100.0 * constant.share)
        })
        .collect();
    let effects: Vec<String> =
        found.iter().map(|(joint, _)| format!("--effect torque_offset:{}", joint.name)).collect();
    (!found.is_empty()).then(|| {
        format!(
            "the residual holds a constant torque, which biases friction and gravity: {}; fit it with {}",
            each.join(", "),
            effects.join(" ")
        )
    })
}

/// A line about the parameters on which several training logs disagree or that they do not pin down, if there are several.
pub fn between_logs(fitted: &Fitted) -> Option<String> {
    let all = fitted.fit.names.iter().zip(&fitted.fit.between_logs);
    let found: Vec<(&String, &BetweenLogs)> = all.filter_map(|(name, found)| Some((name, found.as_ref()?))).collect();
    let (_, first) = found.first()?;
    let of = |agreement: fn(&Agreement) -> bool| found.iter().filter(move |(_, found)| agreement(&found.agreement));
    let pinned = of(|agreement| *agreement == Agreement::Pinned).count();
    let mut text = format!(
        "{pinned} of {} parameters are pinned: the {} training logs agree on their values, tested one at a time",
        found.len(),
        first.values.len()
    );
    // What changed also moves what it resembles: the surest first.
    let mut changed: Vec<_> = found
        .iter()
        .filter_map(|&(name, found)| match found.agreement {
            Agreement::Changed { after } => Some((found.p, name, found.values.split_at(after), after)),
            _ => None,
        })
        .collect();
    changed.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, name, (before, since), after) in changed {
        let mean = |values: &[f64]| significant(values.iter().sum::<f64>() / values.len() as f64);
        text += &format!("; {name} changed after log {after}, from {} to {}", mean(before), mean(since));
    }
    let open: Vec<&str> = of(|agreement| *agreement == Agreement::NotPinned).map(|(name, _)| name.as_str()).collect();
    match open.as_slice() {
        [] => {}
        few if few.len() <= FEW => text += &format!("; not pinned: {}", few.join(", ")),
        many => text += &format!("; {} are not pinned (identification.json names them)", many.len()),
    }
    Some(text)
}

/// Names of parameters that one line holds.
const FEW: usize = 6;

/// Bodies that can exist leave this many times the residual of the fit, and this share of the torque at least, where something else makes
/// the torque: links whose inertias do not fit each other cost less.
const NOT_OF_BODIES: f64 = 5.0;
const OF_TORQUE: f64 = 0.2;

/// A line about joints whose torque no bodies make, if there are any: the base parameters can be those of gravity upside down.
pub fn not_of_bodies(robot: &Robot, fitted: &Fitted, consistent: &Consistent) -> Option<String> {
    let left = |joint: &usize| {
        let (bodies, fit) = (consistent.train_rms[*joint], fitted.train_rms[*joint]);
        bodies > NOT_OF_BODIES * fit && bodies > OF_TORQUE * consistent.torque_rms[*joint]
    };
    let joints: Vec<usize> = (0..robot.dof()).filter(left).collect();
    let each: Vec<String> = joints
        .iter()
        .map(|&joint| {
            let [bodies, torque, fit] =
                [consistent.train_rms[joint], consistent.torque_rms[joint], fitted.train_rms[joint]].map(significant);
            let Joint { name, kind, .. } = &robot.joints[joint];
            format!(
                "{name} is left with {bodies} {} of {torque}, which the fit without them explains to {fit}",
                kind.unit(Unit::Effort)
            )
        })
        .collect();
    let [x, y, z] = [robot.gravity.x, robot.gravity.y, robot.gravity.z].map(significant);
    (!joints.is_empty()).then(|| {
        format!(
            "identified.urdf is wrong: no bodies make these torques: {}; is gravity along [{x}, {y}, {z}] m/s2 of the base (the mounting: \
             --gravity, or [mounting] in a dataset), and are the signs right? `tauscope inspect` looks for both",
            each.join("; ")
        )
    })
}

/// A line about joints of whose torque the bodies as described leave much, if there are any; `train` are the logs that were fitted.
pub fn unlike_described(robot: &Robot, fitted: &Fitted, train: &[&Recording]) -> Option<String> {
    let torque = |joint: usize| {
        let measured = train.iter().flat_map(|log| log.tau.channel(joint)).filter(|torque| torque.is_finite());
        root_mean_square(&measured.copied().collect::<Vec<f64>>())
    };
    let each: Vec<String> = (0..robot.dof())
        .map(|joint| (&robot.joints[joint], fitted.train_rms[joint], torque(joint)))
        .filter(|(_, left, torque)| *left > OF_TORQUE * torque)
        .map(|(Joint { name, kind, .. }, left, torque)| {
            format!("{} of {} {} on {name}", significant(left), significant(torque), kind.unit(Unit::Effort))
        })
        .collect();
    (!each.is_empty()).then(|| {
        format!(
            "the bodies as described leave {} of the logs that they were fitted to: masses of the description, the mounting, a load or the unit of the              torques are not as given; `tauscope inspect` and `diagnose` look for what is wrong, --trust structure estimates the bodies",
            each.join(", ")
        )
    })
}

/// Standard deviations from which a parameter of a drive is negative.
const NEGATIVE: f64 = 3.0;

/// Whether a value is surely below zero; one that is not known is not.
fn is_negative(value: f64, std: f64) -> bool {
    value < -NEGATIVE * std
}

/// The joints on which a parameter of the drive is negative, with its place among those of the fit. Sums with parameters of links may be
/// negative, and are none.
fn negative<'a>(robot: &'a Robot, fitted: &Fitted, symbol: &str) -> Vec<(&'a Joint, usize)> {
    let std = fitted.fit.estimate.std();
    let on = |joint: usize| {
        let place = place_of(fitted, joint, symbol)?;
        let alone = !fitted.fit.names[place].contains(' ') && !fitted.fit.undetermined[place];
        (alone && is_negative(fitted.fit.estimate.beta[place], std[place])).then(|| (&robot.joints[joint], place))
    };
    (0..robot.dof()).filter_map(on).collect()
}

/// Joints with the values of a parameter that is negative on them.
fn listed(fitted: &Fitted, negative: &[(&Joint, usize)], unit: Unit) -> String {
    let std = fitted.fit.estimate.std();
    let each = negative.iter().map(|&(joint, place)| {
        format!("{} ({} {})", joint.name, measured(fitted.fit.estimate.beta[place], std[place]), joint.kind.unit(unit))
    });
    each.collect::<Vec<_>>().join(", ")
}

/// Share of the inertia of a joint's bodies from which a negative rotor is reported. Filters, noise of positions and laws of friction that a
/// model lacks put as much as 8 % into the acceleration of right logs; masses and moments of a file are known no better.
const OF_INERTIA: f64 = 0.15;

/// Positions at which the inertia of the bodies is taken.
const POSITIONS: usize = 50;

/// A line about the joints whose rotor inertia is negative, if there are any: no rotor has one, and something else acts with the
/// acceleration. `bodies` are those of the arm as far as they are known, `train` the logs that were fitted.
pub fn negative_rotor(robot: &Robot, fitted: &Fitted, bodies: &Robot, train: &[&Recording]) -> Option<String> {
    let own = of_bodies(bodies, train);
    let joint_of = |name: &str| robot.joints.iter().position(|joint| joint.name == name);
    let is_much = |&(joint, place): &(&Joint, usize)| {
        joint_of(&joint.name).is_some_and(|at| -fitted.fit.estimate.beta[place] > OF_INERTIA * own[at])
    };
    let joints: Vec<(&Joint, usize)> = negative(robot, fitted, "Ia").into_iter().filter(is_much).collect();
    (!joints.is_empty()).then(|| {
        format!(
            "rotor inertia is negative on {}, which no rotor's is: something else acts with the acceleration. It may be a delay between position and \
             torque, a low-pass of one of them, a clock that runs wrong, a mass of the file that is too large, or friction that the model lacks. Do not \
             use it; `tauscope inspect` looks for delays and clocks, `tauscope diagnose` for the other causes",
            listed(fitted, &joints, Unit::Inertia)
        )
    })
}

/// Inertia of its bodies that each joint moves, as a mean over the logs, without rotors.
fn of_bodies(bodies: &Robot, logs: &[&Recording]) -> Vec<f64> {
    let (chain, inertial) = (Chain::new(bodies), bodies.inertial_parameters());
    let mut sums = vec![0.0; bodies.dof()];
    let mut count = 0;
    for log in logs {
        for row in (0..log.samples()).step_by((log.samples() * logs.len() / POSITIONS).max(1)) {
            let q: Vec<f64> = (0..bodies.dof()).map(|joint| log.q.channel(joint)[row]).collect();
            let inertia = mass_matrix(&chain, &inertial, &q);
            sums.iter_mut().enumerate().for_each(|(joint, sum)| *sum += inertia[(joint, joint)]);
            count += 1;
        }
    }
    sums.into_iter().map(|sum| sum / f64::from(count.max(1))).collect()
}

/// A line about the joints whose Coulomb friction is negative, if there are any: no drive is pushed along by its friction.
pub fn negative_coulomb(robot: &Robot, fitted: &Fitted) -> Option<String> {
    let joints = negative(robot, fitted, "Fc");
    (!joints.is_empty()).then(|| {
        format!(
            "Coulomb friction is negative on {}, which no drive's is: the sign of its torque or of its motion is wrong, its torque comes late or is \
             that of another joint, or a law of friction that the model lacks is in it. Do not use it; `tauscope inspect` looks for signs, columns and \
             delays, `tauscope diagnose` for laws of friction",
            listed(fitted, &joints, Unit::Effort)
        )
    })
}

/// A line about a Savitzky-Golay window that is longer than the usual one, since the positions of `log` are noisy.
pub fn longer_window(smoothing: &Smoothing, log: &Recording) -> Option<String> {
    let Smoothing::SavitzkyGolay { window, .. } = *smoothing else { return None };
    let usual = usual_window(log.rate_hz());
    (window > usual).then(|| {
        let [window_s, usual_s] = [window, usual].map(|samples| samples as f64 / log.rate_hz());
        format!(
            "positions are smoothed over {window} samples ({window_s:.2} s) instead of {usual} ({usual_s:.2} s): their noise would make the \
             accelerations, and take the inertias down (--window sets it)"
        )
    })
}

/// A line about the joints whose viscous friction is negative, if there are any: no drive takes up power, but friction that falls with
/// speed looks like it.
pub fn falling_friction(robot: &Robot, fitted: &Fitted) -> Option<String> {
    let joints: Vec<&str> = negative(robot, fitted, "Fv").iter().map(|(joint, _)| joint.name.as_str()).collect();
    let effects: Vec<String> = joints.iter().map(|name| format!("--effect stribeck_friction:{name}")).collect();
    (!joints.is_empty()).then(|| {
        format!(
            "viscous friction is negative on {}: friction falls with speed there, which Coulomb and viscous friction cannot follow; fit it with \
             {}, and do not use these values at other speeds",
            joints.join(", "),
            effects.join(" ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_within_its_noise_is_not_negative() {
        assert!(is_negative(-3.1, 1.0) && !is_negative(-2.9, 1.0) && !is_negative(3.1, 1.0));
        // As described, or not known.
        assert!(!is_negative(0.0, 0.0) && !is_negative(-1.0, f64::NAN) && !is_negative(f64::NAN, 1.0));
    }
}
