//! What was found and what stays unexplained, in lines.

use super::gravity;
use crate::diagnosis::{
    Diagnosis, EXTENDED_SCENARIO, Family, Finding, Found, Gate, LOGS_DISAGREE, Levels, Minor, NamedParameter, Play,
    Verdict,
};
use crate::effects;
use crate::internal::diagnosis::{NOT_SIZED, effort, finding, joints, with_unit};
use crate::report::console::{measured, significant};
use crate::robot::{Joint, Robot};

/// Effects not found, and parameters of an effect, that the lines mention.
pub(super) const MENTIONED: usize = 4;

/// Smallest p-value that is printed with its size.
const SURE: f64 = 1e-12;

/// What the logs name, or several effects explain: two lines each, and more where they help. `findings` are those of `diagnosis.found`.
pub(super) fn named(robot: &Robot, diagnosis: &Diagnosis, findings: &[Finding]) -> Vec<String> {
    let mut lines = Vec::new();
    for (found, finding) in diagnosis.found.iter().zip(findings).filter(|(found, _)| !is_similar(found)) {
        lines.push(format!("- {}", missed(robot, diagnosis, found)));
        let change =
            if finding.parameters.is_empty() { String::new() } else { values(finding.effect, &finding.parameters) };
        let verb = match found.verdict {
            Verdict::Unexplained => "Its best fit:",
            _ if diagnosis.scope.against_reference => "Changed by",
            _ => "Add to the model:",
        };
        let open = if finding.is_sized { String::new() } else { format!(" Note: {NOT_SIZED}.") };
        lines.push(format!("  {verb} {change} ({EXTENDED_SCENARIO} has it). {}{open}", finding.explanation));
        let values: Vec<f64> = finding.parameters.iter().map(|parameter| parameter.value).collect();
        let turned = gravity::direction(robot, finding.effect, &values).filter(|_| !diagnosis.scope.against_reference);
        lines.extend(turned.map(|text| format!("  {text}")));
        lines.extend(of_guessed(robot, found.member.candidate.family()));
    }
    lines
}

/// Whether what was found is no more than similar to what acts on its joint: it is reported with what stays unexplained there. What happens
/// at times of its own, as impacts and events, is a line of its own.
fn is_similar(found: &Found) -> bool {
    found.verdict == Verdict::Unexplained && found.impacts.is_none() && found.member.candidate.log.is_none()
}

/// What stays unexplained, joint by joint, with the laws that are similar to it.
pub(super) fn unexplained(robot: &Robot, diagnosis: &Diagnosis, findings: &[Finding]) -> Vec<String> {
    let mut lines = Vec::new();
    for (joint, Joint { name, .. }) in robot.joints.iter().enumerate() {
        let found = diagnosis.found.iter().zip(findings);
        let own = found.filter(|(found, _)| is_similar(found) && joint_of(diagnosis, found) == joint);
        let similar: Vec<String> =
            own.map(|(found, finding)| similar(robot, diagnosis, (found, finding), joint)).collect();
        let left = diagnosis.unexplained.iter().filter(|left| left.joint == joint).map(|left| {
            let why = match diagnosis.nearest(joint) {
                _ if left.structure == LOGS_DISAGREE => ": these do not agree with the training logs".to_owned(),
                Some(minor) if similar.is_empty() => nearest(robot, minor, &diagnosis.scope.criteria.levels),
                _ => format!(", and {} explains it", none(diagnosis)),
            };
            format!("- {name}: {:.0} % of the residual {}{why}", 100.0 * left.share, left.structure)
        });
        let before = lines.len();
        lines.extend(left);
        if lines.len() == before && !similar.is_empty() {
            lines.push(format!("- {name}: {} explains what is similar to a law there", none(diagnosis)));
        }
        lines.extend(similar);
    }
    lines
}

/// "  Similar to torque_offset on joint_2: offset 0.80 +- 0.10 N m takes 1.19 N m rms to 0.79 N m (noise 0.24 N m); it explains a part only."
fn similar(robot: &Robot, diagnosis: &Diagnosis, (found, finding): (&Found, &Finding), joint: usize) -> String {
    let effort = |value: f64| effort(&robot.joints[joint], value);
    let [before, after] = [found.rms[0][joint], found.rms[1][joint]];
    let takes = if after < before { "takes" } else { "fits the training logs, and on the others takes" };
    let why = found.withdrawn.map_or("explains a part only", |failed| failed.gate.reason());
    format!(
        "  Similar to {}: {} {takes} {} rms to {} (noise {}); it {why}.",
        names(robot, found),
        values(finding.effect, &finding.parameters),
        effort(before),
        effort(after),
        effort(diagnosis.errors.noise_floor[joint])
    )
}

/// "stribeck_friction on joint_2", with the alternatives that the logs do not separate from it.
pub(super) fn names(robot: &Robot, found: &Found) -> String {
    let families =
        [found.member.candidate.family()].into_iter().chain(found.alternatives.iter().map(|other| other.family));
    families.map(|family| place(robot, family)).collect::<Vec<String>>().join(" or ")
}

/// The joint that a finding is reported of. What sits in a joint is reported of that joint, unless only others gain by it; the weight of a
/// body is felt most further in.
fn joint_of(diagnosis: &Diagnosis, found: &Found) -> usize {
    let [before, after] = &found.rms;
    let gained = |j: usize| (before[j].powi(2) - after[j].powi(2)) / diagnosis.errors.noise_floor[j].powi(2);
    let most = |joints: Vec<usize>| joints.into_iter().max_by(|&a, &b| gained(a).total_cmp(&gained(b)));
    let own = Some(found.member.placed.joints()).filter(|_| !found.member.placed.effect.is_body());
    let own = own.and_then(most).filter(|&joint| gained(joint) > 0.0);
    own.or_else(|| most(found.member.candidate.joints())).unwrap_or(0)
}

/// "joint_2 misses 4.8 N m, 9 % of its torque: stribeck_friction takes that to 0.76 N m (noise 0.75 N m)."
fn missed(robot: &Robot, diagnosis: &Diagnosis, found: &Found) -> String {
    let [before, after] = &found.rms;
    let joint = joint_of(diagnosis, found);
    let names = match found.verdict {
        Verdict::Unexplained => format!("something similar to {}", names(robot, found)),
        _ => names(robot, found),
    };
    let chance =
        if found.family_wise_p < SURE { "below 1e-12".to_owned() } else { format!("{:.0e}", found.family_wise_p) };
    if let Some(play) = &found.impacts {
        return format!("{names}: {} (chance of a false alarm {chance}).", impacts(play));
    }
    if let Some(log) = found.member.candidate.log {
        let log =
            if diagnosis.scope.against_reference { "one log".to_owned() } else { format!("training log {}", log + 1) };
        return format!("In {log} alone, {names} acts (chance of a false alarm {chance}).");
    }
    let torque = diagnosis.errors.test_torque_rms[joint];
    let share =
        if torque > 0.0 { format!(" = {:.1} % of its torque", 100.0 * before[joint] / torque) } else { String::new() };
    let takes = if after[joint] < before[joint] { "takes it to" } else { "fits the training logs, and leaves" };
    format!(
        "{} misses {} rms{share}: {names} {takes} {} (noise {}; chance of a false alarm {chance}).",
        robot.joints[joint].name,
        effort(&robot.joints[joint], before[joint]),
        effort(&robot.joints[joint], after[joint]),
        effort(&robot.joints[joint], diagnosis.errors.noise_floor[joint])
    )
}

/// What is said of a load or a link that holds joints at positions which nobody gave: another position has the mass elsewhere.
fn of_guessed(robot: &Robot, family: Family) -> Option<String> {
    effects::find(family.effect).ok().filter(|effect| effect.is_body())?;
    let on = joints(robot, family);
    let carried = robot.guessed.iter().filter(|(_, carrier)| on.is_empty() || on.contains(carrier));
    let held: Vec<String> = carried.map(|(held, _)| held.clone()).collect();
    let first = held.first()?;
    let [carried, other, set] = match held.len() {
        1 => ["is carried by it at an assumed position", "at another position", "that position, or set it"],
        _ => ["are carried by it at assumed positions", "at other positions", "those positions, or set them"],
    };
    Some(format!(
        "  {} {carried}. The same mass {other} would explain this too. Log {set} in a dataset ([hold] {first} = ..).",
        held.join(", ")
    ))
}

/// "- Not reported: 3 smaller effects, together 0.3 N m on joint_2: .. (diagnosis.json lists all)."; without "smaller" where one is refused
/// for another reason than its size.
pub(super) fn smaller(robot: &Robot, diagnosis: &Diagnosis) -> Option<String> {
    let count = diagnosis.minor.len();
    let all: Vec<f64> = (0..robot.dof())
        .map(|joint| {
            let here = diagnosis.minor.iter().filter(|minor| minor.found.member.candidate.joints().contains(&joint));
            here.map(|minor| minor.size[joint].powi(2)).sum::<f64>().sqrt()
        })
        .collect();
    let joint = (0..all.len()).max_by(|&a, &b| all[a].total_cmp(&all[b])).filter(|_| count > 0)?;
    let is_small = diagnosis.minor.iter().all(|minor| minor.failed.gate == Gate::Size);
    let [smaller, plural] = [if is_small { "smaller " } else { "" }, if count == 1 { "" } else { "s" }];
    let names: Vec<String> = diagnosis
        .minor
        .iter()
        .take(MENTIONED)
        .map(|minor| {
            let family = minor.found.member.candidate.family();
            format!("{} {}", place(robot, family), minor.failed.gate.reason())
        })
        .collect();
    let size = effort(&robot.joints[joint], all[joint]);
    let together = if count == 1 { "" } else { "together " };
    Some(format!(
        "- Not reported: {count} {smaller}effect{plural}, {together}{size} on {}: {} (diagnosis.json lists all).",
        robot.joints[joint].name,
        names.join("; ")
    ))
}

/// "; the nearest law is load_dependent_friction on joint_2 (coefficient 0.05), no better than generic functions". Its standard
/// deviations do not hold the scatter between blocks, as those of findings do: none is printed.
fn nearest(robot: &Robot, minor: &Minor, levels: &Levels) -> String {
    let found = finding(robot, &minor.found, &[], levels);
    let parameters = found.parameters.iter().filter(|p| p.std.is_finite()).take(MENTIONED);
    let values: Vec<String> =
        parameters.map(|p| format!("{} {}", p.name, with_unit(significant(p.value), p.unit))).collect();
    let name = place(robot, minor.found.member.candidate.family());
    format!("; the nearest law is {name} ({}), no better than generic functions", values.join(", "))
}

/// The joint on which a smaller effect is largest over all joints on which it has torque, and its size there.
pub(crate) fn largest(minor: &Minor) -> (usize, f64) {
    let sizes = minor.found.member.candidate.joints().into_iter().map(|joint| (joint, minor.size[joint]));
    sizes.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
}

/// What shows a gear's play.
pub(crate) fn impacts(play: &Play) -> String {
    format!(
        "the torque jumps within milliseconds of {} of {} changes of sign of the gear's load, which means over 20 ms do not show",
        play.impacts, play.changes
    )
}

/// The parameters that are printed: from the one on by which practitioners call the effect's size, else the first few. Where the logs
/// determine none of them by itself, their values say nothing one by one, and their names are printed without.
pub(super) fn values(effect: &str, parameters: &[NamedParameter]) -> String {
    let headline = effects::find(effect).map_or(&[][..], |effect| effect.headline());
    let named = parameters.iter().position(|parameter| headline.contains(&parameter.name)).unwrap_or(0);
    let shown = &parameters[named..parameters.len().min(named + MENTIONED)];
    if shown.len() > 1 && parameters.iter().all(|parameter| !parameter.std.is_finite()) {
        let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name).collect();
        return format!("{}, of which the logs determine combinations alone", names.join(", "));
    }
    let each = shown.iter().map(|p| match p.std.is_finite() {
        true => format!("{} {}", p.name, with_unit(measured(p.value, p.std), p.unit)),
        false => format!("{} not determined by itself (held at {})", p.name, significant(held(p.value))),
    });
    each.collect::<Vec<String>>().join(", ")
}

/// A value that is held, without what rounding leaves of zero.
pub(crate) fn held(value: f64) -> f64 {
    /// Below the smallest parameter of any law in SI units: compliances are about 1e-6 rad/(N m).
    const ROUNDING: f64 = 1e-9;
    if value.abs() < ROUNDING { 0.0 } else { value }
}

/// An effect with its joints, in words.
pub(crate) fn place(robot: &Robot, family: Family) -> String {
    let joints = joints(robot, family);
    if joints.is_empty() { family.effect.to_owned() } else { format!("{} on {}", family.effect, joints.join(" and ")) }
}

/// What explains nothing: all that was tried.
pub(super) fn none(diagnosis: &Diagnosis) -> String {
    match diagnosis.scope.candidates.as_slice() {
        _ if diagnosis.unfinished => "no effect found so far".into(),
        [] => "no effect of the library".into(),
        tried => format!("none of the effects tried ({})", tried.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_held_at_assumed_positions_are_named_with_the_link_that_carries_them() {
        let tree = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/trees/two_finger.urdf");
        let arm = crate::robot::description::read(tree.as_ref()).unwrap();
        let joints =
            arm.moving().into_iter().filter(|joint| !joint.name.contains("finger")).map(|joint| joint.name.clone());
        let joints: Vec<String> = joints.collect();
        let last = joints.len() - 1;
        let mut choice = crate::robot::Choice { joints: Some(joints), ..Default::default() };
        let robot = |choice: &crate::robot::Choice| arm.robot(choice, crate::robot::InertiaCheck::Ignored).unwrap();
        let of = |robot: &Robot, effect, joint| of_guessed(robot, Family { effect, joint });
        let guessed = robot(&choice);
        let said = of(&guessed, "link_inertia_error", last).unwrap();
        assert!(said.contains("finger_left_joint") && said.contains("[hold]"), "{said}");
        assert!(of(&guessed, "payload", 0).is_some());
        assert_eq!((of(&guessed, "link_inertia_error", 0), of(&guessed, "stribeck_friction", last)), (None, None));
        // Where someone said how they stand, nothing is assumed.
        choice.hold.insert("finger_left_joint".into(), 0.01);
        assert_eq!(of(&robot(&choice), "payload", 0), None);
    }
    #[test]
    fn parameters_that_are_determined_only_together_have_no_values_of_their_own() {
        let of = |name, value, std| NamedParameter { name, joint: None, value, std, unit: "kg" };
        let (unknown, known) = (f64::INFINITY, 0.02);
        let said = values("link_inertia_error", &[of("dm", 1.1e-12, unknown), of("dmx", -0.127, unknown)]);
        assert_eq!(said, "dm, dmx, of which the logs determine combinations alone");
        let said = values("link_inertia_error", &[of("dm", 1.1e-12, unknown), of("dmx", -0.127, known)]);
        assert_eq!(said, "dm not determined by itself (held at 0), dmx -0.127 +- 0.020 kg");
        let said = values("link_inertia_error", &[of("dm", 1e-6, unknown)]);
        assert_eq!(said, "dm not determined by itself (held at 1.00e-6)");
    }
}
