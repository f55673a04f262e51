//! Notices on the logs that belong to the answer: mixed rates, delays of the sampling, smooth friction, extrapolation; and what to do about
//! faults that stop a diagnosis.

use crate::diagnosis::answer::diagnosis::Diagnosis;
use crate::diagnosis::logs::{Consequence, DataFault};
use crate::output::{measured, significant};
use crate::quality::Kind;
use crate::robot::{Joint, Robot};

/// What to do about the faults that stop a diagnosis.
pub fn remedy(faults: &[DataFault]) -> String {
    let places = |still: bool| -> Vec<&str> {
        let stops = faults.iter().filter(|fault| fault.consequence == Consequence::Stops);
        let mut places: Vec<&str> = stops
            .filter(|fault| (fault.kind == Kind::HardlyMoves) == still)
            .map(|fault| fault.place.as_str())
            .collect();
        places.sort_unstable();
        places.dedup();
        places
    };
    let is_another = |fault: &DataFault| fault.kind == Kind::NothingExplains;
    if faults.iter().any(|fault| fault.consequence == Consequence::Stops && is_another(fault)) {
        return "give the file of the robot that the logs are of, with its joints in the order of the log, and run the diagnosis again".into();
    }
    match (places(false), places(true)) {
        (wrong, _) if !wrong.is_empty() => format!("correct {} and run the diagnosis again", wrong.join(", ")),
        (_, still) => format!("record a motion in which every joint takes part: {} stands still", still.join(", ")),
    }
}

/// Notices on the logs, above the answer.
pub fn shown(robot: &Robot, diagnosis: &Diagnosis) -> Vec<String> {
    let all = [
        unfinished(diagnosis),
        most_findings(diagnosis),
        equal_states(diagnosis),
        mixed_rates(diagnosis),
        sampling(robot, diagnosis),
        extrapolation(robot, diagnosis),
        beyond_sensors(robot, diagnosis),
    ];
    all.into_iter().flatten().collect()
}

/// Notice on logs that follow the motions of the reference logs.
pub(in crate::diagnosis::answer) fn equal_states(diagnosis: &Diagnosis) -> Option<String> {
    diagnosis.scope.equal_states.map(|share| {
        format!(
            "the logs follow the motions of the reference logs: {:.0} % of the rows have an equal state there, and residuals are differences \
             from these. What the model lacks both before and after cancels; the noise is that of two rows",
            100.0 * share
        )
    })
}

/// Notice on a search that was ended before it was done.
pub(in crate::diagnosis::answer) fn unfinished(diagnosis: &Diagnosis) -> Option<String> {
    diagnosis.unfinished.then(|| {
        "the search ended early: effects and alternatives may be missing. Repeat it with a longer --budget, or without one"
            .to_owned()
    })
}

/// Notice on a search that ended with as many findings as were asked for.
pub(in crate::diagnosis::answer) fn most_findings(diagnosis: &Diagnosis) -> Option<String> {
    diagnosis.is_full.then(|| {
        "the search ended at the largest number of findings: more effects may act. Repeat it with a larger --max-findings".to_owned()
    })
}

/// Notice on logs of several rates.
pub(in crate::diagnosis::answer) fn mixed_rates(diagnosis: &Diagnosis) -> Option<String> {
    let each: Vec<String> = diagnosis.logs.rates_hz.iter().map(|hz| format!("{hz:.0}")).collect();
    (each.len() > 1).then(|| {
        format!(
            "the logs were sampled at {} Hz. Means over 20 ms are noisier at the lower rate; the noise reported is that of all training logs \
             together. Record all logs at one rate",
            each.join(" and ")
        )
    })
}

/// Notice on delays and lags that are of the sampling.
pub(in crate::diagnosis::answer) fn sampling(robot: &Robot, diagnosis: &Diagnosis) -> Option<String> {
    let each = diagnosis.of_sampling.iter().map(|short| {
        let [time, std] = short.seconds.map(|seconds| 1e3 * seconds);
        let time = measured(time, std);
        match short.joint {
            None => format!("torque and positions lie {time} ms apart"),
            Some(joint) => format!("the torque of {} lags by {time} ms", robot.joints[joint].name),
        }
    });
    let each: Vec<String> = each.collect();
    (!each.is_empty()).then(|| {
        let each = each.join(", ");
        format!(
            "{each}: less than a sample, as sampling causes it; it is included in the model, not reported as a finding"
        )
    })
}

/// Notice on friction that does not change its direction at once.
pub(in crate::diagnosis::answer) fn smooth_friction(robot: &Robot, diagnosis: &Diagnosis) -> Option<String> {
    let rounding = &diagnosis.logs.coulomb_rounding;
    let each = robot.joints.iter().zip(rounding).filter(|(_, own)| own.width() > 0.0);
    let each: Vec<(&str, String)> = each
        .map(|(joint, own)| {
            let width = with_unit(significant(own.width()), joint.velocity_unit());
            (own.formula(), format!("{} {width}", joint.name))
        })
        .collect();
    let mut forms: Vec<&str> = each.iter().map(|(formula, _)| *formula).collect();
    forms.sort_unstable();
    forms.dedup();
    // The form is given with each joint where there are several.
    let each: Vec<String> = each
        .into_iter()
        .map(|(formula, joint)| if forms.len() > 1 { format!("{joint} ({formula})") } else { joint })
        .collect();
    (!each.is_empty()).then(|| {
        format!(
            "Coulomb friction is smoothed as {}, as simulators write it. That is included in the baseline, not reported as a finding. On \
             a real arm, look for friction at low speed with slower motions. Widths: {}",
            forms.join(" or "),
            each.join(", ")
        )
    })
}

/// Notice where the training logs leave the model more open on the held-out logs than the noise.
pub(in crate::diagnosis::answer) fn extrapolation(robot: &Robot, diagnosis: &Diagnosis) -> Option<String> {
    let each = diagnosis.errors.prediction_std.iter().zip(&diagnosis.errors.noise_floor).zip(&robot.joints);
    let open = each.filter(|((std, noise), _)| std > noise).map(|((std, noise), joint)| match std.is_finite() {
        true => format!("{} (standard deviation {}, noise {})", joint.name, effort(joint, *std), effort(joint, *noise)),
        false => format!("{} (not determined at all)", joint.name),
    });
    let open: Vec<String> = open.collect();
    let nominal = match robot.placeholders() {
        None => "; inertias taken from the URDF (--trust nominal) need fewer of them",
        Some(_) => "",
    };
    (!open.is_empty()).then(|| {
        format!(
            "the prediction of the held-out torque is less certain than the noise on {}: conclusions there are as uncertain. Add training \
             motions as rich as the held-out ones{nominal}",
            open.join(", ")
        )
    })
}

/// Notice on joints whose residual is far beyond the noise of their sensors and of which nothing is found, nor structure unexplained: the
/// noise model holds what is slow, periodic or faster than the rows.
pub(in crate::diagnosis::answer) fn beyond_sensors(robot: &Robot, diagnosis: &Diagnosis) -> Option<String> {
    let explained = |joint: &usize| {
        let found = diagnosis.found.iter().any(|found| found.member.candidate.joints().contains(joint));
        found || diagnosis.unexplained.iter().any(|left| left.joint == *joint)
    };
    let errors = &diagnosis.errors;
    let factor = diagnosis.scope.criteria.structure.above_noise;
    let far = far_beyond(&errors.extended_test_rms, &errors.sensor_noise, factor);
    let each = far.into_iter().filter(|joint| !explained(joint)).map(|joint| {
        let [left, noise] = [&errors.extended_test_rms, &errors.sensor_noise].map(|all| all[joint]);
        format!("{} ({}, {:.1} times)", robot.joints[joint].name, effort(&robot.joints[joint], left), left / noise)
    });
    let each: Vec<String> = each.collect();
    (!each.is_empty()).then(|| {
        format!(
            "the held-out residual is well beyond the noise of the torque sensor on {}, and nothing that it follows is significant: slow or \
             coloured noise of the drives, or vibration, elasticity and play that these logs do not separate from it",
            each.join(", ")
        )
    })
}

/// Joints whose residual exceeds the noise of the sensor by a factor, where that noise is known.
fn far_beyond(left: &[f64], sensor: &[f64], factor: f64) -> Vec<usize> {
    let is_far = |&joint: &usize| sensor[joint] > 0.0 && left[joint] > factor * sensor[joint];
    (0..left.len()).filter(is_far).collect()
}

/// An effort of a joint with its unit.
pub fn effort(joint: &Joint, value: f64) -> String {
    with_unit(significant(value), joint.effort_unit())
}

/// A value with its unit; ratios have none.
pub fn with_unit(value: String, unit: &str) -> String {
    if unit == "1" { value } else { format!("{value} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_are_far_beyond_sensors_from_a_factor_on() {
        assert_eq!(far_beyond(&[2.01, 1.99, 5.0, f64::NAN], &[1.0, 1.0, 0.0, 1.0], 2.0), [0]);
    }
}
