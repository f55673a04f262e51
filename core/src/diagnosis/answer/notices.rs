//! Notes on the logs that belong to the answer: mixed rates, delays of the sampling, smooth friction, extrapolation; what to
//! do about faults that stop a diagnosis, and what to do next.

use super::diagnosis::Diagnosis;
use crate::diagnosis::criteria::Levels;
use crate::diagnosis::lack_of_fit::{LOGS_DISAGREE, Unexplained};
use crate::diagnosis::logs::{Consequence, DataFault};
use crate::diagnosis::search::Found;
use crate::identification::effect_model::Trust;
use crate::output::significant;
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
    ];
    all.into_iter().flatten().collect()
}

/// Notice on logs that follow the motions of the reference logs.
pub(super) fn equal_states(diagnosis: &Diagnosis) -> Option<String> {
    diagnosis.scope.equal_states.map(|share| {
        format!(
            "the logs follow the motions of the reference logs: {:.0} % of the rows have an equal state there, and residuals are differences \
             from these. What the model lacks both before and after cancels; the noise is that of two rows",
            100.0 * share
        )
    })
}

/// Notice on a search that was ended before it was done.
pub(super) fn unfinished(diagnosis: &Diagnosis) -> Option<String> {
    diagnosis.unfinished.then(|| {
        "the search ended early: effects and alternatives may be missing. Repeat it with a longer --budget, or without one"
            .to_owned()
    })
}

/// Notice on a search that ended with as many findings as were asked for.
pub(super) fn most_findings(diagnosis: &Diagnosis) -> Option<String> {
    diagnosis.is_full.then(|| {
        "the search ended at the largest number of findings: more effects may act. Repeat it with a larger --max-findings".to_owned()
    })
}

/// Notice on logs of several rates.
pub(super) fn mixed_rates(diagnosis: &Diagnosis) -> Option<String> {
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
pub(super) fn sampling(robot: &Robot, diagnosis: &Diagnosis) -> Option<String> {
    let each = diagnosis.of_sampling.iter().map(|short| {
        let [time, std] = short.seconds.map(|seconds| significant(1e3 * seconds));
        match short.joint {
            None => format!("torque and positions lie {time} +- {std} ms apart"),
            Some(joint) => format!("the torque of {} lags by {time} +- {std} ms", robot.joints[joint].name),
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
pub(super) fn smooth_friction(robot: &Robot, diagnosis: &Diagnosis) -> Option<String> {
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
pub(super) fn extrapolation(robot: &Robot, diagnosis: &Diagnosis) -> Option<String> {
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

/// An effort of a joint with its unit.
pub fn effort(joint: &Joint, value: f64) -> String {
    with_unit(significant(value), joint.effort_unit())
}

/// A value with its unit; ratios have none.
pub fn with_unit(value: String, unit: &str) -> String {
    if unit == "1" { value } else { format!("{value} {unit}") }
}

/// Root mean squares over the held-out logs, `[joint]`, N m: what the arm as described leaves, the residual of the extended model, and the
/// noise.
pub(super) struct Sizes<'a> {
    pub described: &'a [f64],
    pub left: &'a [f64],
    pub noise: &'a [f64],
}

/// What to do next, where the question is what changed or what is. Of what is open the largest comes first, over the noise of its joint.
pub(super) fn next_experiment(
    found: &[Found],
    unexplained: &[Unexplained],
    (robot, trust, of_change): (&Robot, Trust, bool),
    Sizes { described, left, noise }: Sizes,
    levels: &Levels,
) -> String {
    if unexplained.iter().any(|left| left.structure == LOGS_DISAGREE) {
        return "the held-out logs disagree with the training logs: check that all are of one arm with one load, and give them as training \
                logs, or the others as --reference, to ask what changed"
            .into();
    }
    let explained = |found: &Found| {
        let [before, after] = &found.rms;
        let gains = before.iter().zip(after).zip(noise).map(|((b, a), noise)| (b * b - a * a) / (noise * noise));
        gains.fold(0.0, f64::max)
    };
    let open = |structure: &Unexplained| structure.share * (left[structure.joint] / noise[structure.joint]).powi(2);
    let tied = found.iter().filter_map(|found| Some((explained(found), found, found.alternatives.first()?)));
    let tied = tied.max_by(|(a, ..), (b, ..)| a.total_cmp(b));
    let structure = unexplained.iter().max_by(|a, b| open(a).total_cmp(&open(b)));
    let is_larger = |size: f64| structure.is_none_or(|structure| size >= open(structure));
    if let Some((_, found, other)) = tied.filter(|(size, ..)| is_larger(*size)) {
        let about = found.member.placed.effect.about();
        let how = about.rivals.iter().find(|rival| rival.name == other.family.effect).map(|rival| rival.how_to_tell);
        let how = how.unwrap_or("record motions of other speeds, ranges and loads");
        let on = |effect: &str, joint: usize| match found.member.candidate.family().effect == other.family.effect {
            true => format!("{effect} on {}", robot.joints[joint].name),
            false => effect.to_owned(),
        };
        let [own, other] = [on(about.name, found.member.placed.joint), on(other.family.effect, other.family.joint)];
        return format!("to separate {own} from {other}: {how}");
    }
    if let Some(structure) = structure {
        let joint = &robot.joints[structure.joint].name;
        return format!(
            "move {joint} alone over its whole range, slowly and fast, both ways: the residual {}",
            structure.structure
        );
    }
    // What is asked is the change alone: how far off the description is, is no part of it.
    let off = |joint: usize| if of_change { 1.0 } else { described[joint] / left[joint] };
    let worst = (0..robot.dof()).max_by(|&a, &b| off(a).total_cmp(&off(b))).filter(|&joint| off(joint) > levels.far);
    match (found.is_empty(), worst) {
        (true, Some(joint)) if trust == Trust::Nominal => format!(
            "the friction and the rotors of the description are off (the residual of {} is {:.1} times that with re-identified ones): \
             extended.urdf holds these",
            robot.joints[joint].name,
            off(joint)
        ),
        (true, Some(joint)) if robot.placeholders().is_some() => format!(
            "the residual of {} is {:.1} times that with re-identified inertias and friction, since the inertias of the description are \
             placeholders: extended.urdf holds the re-identified ones",
            robot.joints[joint].name,
            off(joint)
        ),
        (true, Some(joint)) if robot.joints[joint].drive.is_frictionless() => format!(
            "the residual of {} is {:.1} times that with re-identified inertias and friction, since the description has no friction there: \
             extended.urdf holds the re-identified ones. --trust nominal shows whether its inertias are right or a load is missing",
            robot.joints[joint].name,
            off(joint)
        ),
        (true, Some(joint)) => format!(
            "the description is off (the residual of {} is {:.1} times that with re-identified inertias and friction): extended.urdf holds \
             these. A payload or one wrong link shows with --trust nominal, or with logs from before it as --reference",
            robot.joints[joint].name,
            off(joint)
        ),
        (true, None) => "a longer or livelier motion lowers the minimum detectable sizes".into(),
        (false, _) => {
            "record a new motion and repeat the diagnosis with --scenario extended.toml: no residual above the noise should remain".into()
        }
    }
}
