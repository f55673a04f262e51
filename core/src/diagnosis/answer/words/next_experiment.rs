//! What to do next.

use crate::diagnosis::criteria::Levels;
use crate::diagnosis::lack_of_fit::{LOGS_DISAGREE, Unexplained};
use crate::diagnosis::search::Found;
use crate::identification::effect_model::Trust;
use crate::robot::Robot;

/// Root mean squares over the held-out logs, `[joint]`, N m: the residual of the arm as described, that of the extended model, and the
/// noise.
pub(in crate::diagnosis::answer) struct Sizes<'a> {
    pub described: &'a [f64],
    pub left: &'a [f64],
    pub noise: &'a [f64],
}

/// What to do next, where the question is what changed or what is. Of what is open the largest comes first, over the noise of its joint.
pub(in crate::diagnosis::answer) fn next_experiment(
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
