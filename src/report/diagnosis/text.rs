//! The answer in a few lines.

use super::faults::fault_lines;
use super::gravity;
use crate::diagnosis::{
    Consequence, DataFault, Diagnosis, EXTENDED_SCENARIO, Family, Found, Gate, JointMap, LOGS_DISAGREE, Levels, Minor,
    NamedParameter, Part, Play, ResidualMap, Resimulation, Share, Verdict,
};
use crate::effects;
use crate::error::Error;
use crate::internal::diagnosis::{NOT_SIZED, effort, finding, findings, joints, shown, with_unit};
use crate::quality::Kind;
use crate::report::console::{by_joint, measured, significant, table};
use crate::report::payload;
use crate::robot::{Robot, Unit};

/// Effects not found, and parameters of an effect, that the lines mention.
const MENTIONED: usize = 4;

/// Smallest p-value that is printed with its size.
const SURE: f64 = 1e-12;

/// The answer in a few lines.
pub(crate) fn lines(
    robot: &Robot,
    diagnosis: &Diagnosis,
    resimulation: Option<&Resimulation>,
    faults: &[DataFault],
) -> String {
    let mut lines = vec![headline(diagnosis, faults)];
    lines.extend(robot.notes.iter().map(|note| format!("Note: {note}.")));
    lines.extend(fault_lines(faults));
    if diagnosis.logs.held_out_from_training {
        lines.push("No test log was given: 30 % of every training log was held out.".into());
    }
    lines.extend(diagnosis.logs.passband.map(|low_pass| {
        format!(
            "The torque passed a low-pass of {:.2} Hz before it was logged; the model passes the same.",
            low_pass.hz
        )
    }));
    lines.extend(shown(robot, diagnosis).into_iter().map(|text| format!("Note: {text}.")));
    for found in &diagnosis.before {
        let finding = finding(robot, found, &[], &diagnosis.scope.criteria.levels);
        let values = values(finding.effect, &finding.parameters);
        lines.push(format!("Present before the change: {}: {values}", names(robot, found)));
    }
    let all = findings(robot, diagnosis);
    let ahead = all.len() - diagnosis.found.len();
    lines.extend(all[..ahead].iter().map(|finding| format!("- {}", finding.explanation)));
    for (found, finding) in diagnosis.found.iter().zip(&all[ahead..]) {
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
    lines.extend(diagnosis.load.iter().flat_map(payload::weighed));
    lines.extend(smaller(robot, diagnosis));
    for left in &diagnosis.unexplained {
        let joint = &robot.joints[left.joint].name;
        let percent = 100.0 * left.share;
        let why = match diagnosis.nearest(left.joint) {
            _ if left.structure == LOGS_DISAGREE => ": these do not agree with the training logs".to_owned(),
            Some(minor) => nearest(robot, minor, &diagnosis.scope.criteria.levels),
            None => format!(", and {} explains it", none(diagnosis)),
        };
        lines.push(format!("- {joint}: {percent:.0} % of the residual {}{why}", left.structure));
    }
    lines.extend(where_it_lives(robot, diagnosis));
    lines.push(String::new());
    lines.push(error_table(robot, diagnosis, resimulation));
    lines.push(String::new());
    lines.extend(followed(robot, &diagnosis.map));
    let errors = &diagnosis.errors;
    let is_above_noise = errors.baseline_rms[1].iter().zip(&errors.noise_floor).any(|(left, noise)| left > noise);
    if !diagnosis.found.is_empty() && !is_above_noise {
        lines.push(
            "On the held-out logs the re-identified model is at the noise already: they show no gap to close."
                .to_owned(),
        );
    } else if !diagnosis.found.is_empty() {
        let closed = percent(diagnosis.errors.gap_closed);
        let mut line = format!("The findings close {closed} of the gap to the noise");
        if let Some(run) = resimulation {
            line += &format!("; simulated in {}, {}", run.engine.name, percent(run.gap_closed));
            if run.gap_closed.value < 0.0 {
                line += ". The simulated arm does not follow the logged motion that closely, as one with soft gears or play: judge the findings by the \
                         residuals along that motion (`with findings`)";
            }
        }
        lines.push(line + ".");
    }
    lines.extend(unseen(robot, diagnosis));
    lines.push(format!("Next: {}.", diagnosis.next_experiment));
    lines.join("\n")
}

/// The line where the extended model could not be simulated along the held-out motions, which changes nothing else of the answer.
pub(crate) fn not_simulated(problem: &Error) -> String {
    format!(
        "The extended model was not simulated ({problem}); the verdict and the errors above do not depend on it, and --no-resimulation \
         leaves it out."
    )
}

/// What explains nothing: all that was tried.
fn none(diagnosis: &Diagnosis) -> String {
    match diagnosis.scope.candidates.as_slice() {
        _ if diagnosis.unfinished => "no effect found so far".into(),
        [] => "no effect of the library".into(),
        tried => format!("none of the effects tried ({})", tried.join(", ")),
    }
}

fn headline(diagnosis: &Diagnosis, faults: &[DataFault]) -> String {
    let changed = diagnosis.scope.against_reference;
    let none = none(diagnosis);
    let unexplained =
        [format!("something changed that {none} explains"), format!("the model misses something that {none} explains")];
    let answer = match diagnosis.verdict {
        Verdict::Named if changed => "something changed, and the logs name it",
        Verdict::Named | Verdict::OneOf if !changed && all_constant(diagnosis) => {
            "constant torques explain what the model misses, as sensors and amplifiers have them"
        }
        Verdict::Named => "the logs name what the model misses",
        Verdict::OneOf if changed => "something changed, and several effects explain it",
        Verdict::OneOf => "several effects explain what the model misses",
        Verdict::Unexplained if changed => &unexplained[0],
        Verdict::Unexplained => &unexplained[1],
        Verdict::None if changed => "nothing changed beyond the noise",
        Verdict::None => "nothing beyond the noise: the re-identified model explains the logs",
        Verdict::NotTestable => "the logs cannot be diagnosed",
    };
    let mut doubts = faults.iter().filter(|fault| fault.consequence == Consequence::Doubts).peekable();
    let doubt = match (doubts.peek().is_some(), doubts.all(|fault| fault.kind == Kind::ClockFactor)) {
        (false, _) => "",
        (true, true) => {
            "the clock of the logs may be wrong, or the size of the robot (see the doubt below); if both are right, "
        }
        (true, false) => "the logs may not be those of this robot (see the doubt below); if they are, ",
    };
    format!("Verdict: {doubt}{answer} (family-wise error rate: {}).", percent_of(diagnosis.scope.alpha))
}

/// Whether each finding is a constant torque, or may be one.
fn all_constant(diagnosis: &Diagnosis) -> bool {
    let is_constant = |family: Family| effects::find(family.effect).is_ok_and(|effect| effect.is_constant());
    diagnosis.unexplained.is_empty()
        && diagnosis.found.iter().all(|found| {
            let others = found.alternatives.iter().map(|other| other.family);
            others.chain([found.member.candidate.family()]).any(is_constant)
        })
}

/// "stribeck_friction on joint_2", with the alternatives that the logs do not separate from it.
fn names(robot: &Robot, found: &Found) -> String {
    let families =
        [found.member.candidate.family()].into_iter().chain(found.alternatives.iter().map(|other| other.family));
    let names = families.map(|family| place(robot, family)).collect::<Vec<String>>().join(" or ");
    if found.verdict != Verdict::Unexplained {
        return names;
    }
    let why = found.withdrawn.map_or("explains a part only", |failed| failed.gate.reason());
    format!("something similar to {names} (which {why})")
}

/// "joint_2 misses 4.8 N m, 9 % of its torque: stribeck_friction takes that to 0.76 N m (noise 0.75 N m)."
fn missed(robot: &Robot, diagnosis: &Diagnosis, found: &Found) -> String {
    let [before, after] = &found.rms;
    let gained = |j: usize| (before[j].powi(2) - after[j].powi(2)) / diagnosis.errors.noise_floor[j].powi(2);
    let most = |joints: Vec<usize>| joints.into_iter().max_by(|&a, &b| gained(a).total_cmp(&gained(b)));
    // What sits in a joint is reported of that joint, unless only others gain by it; the weight of a body is felt most further in.
    let own = Some(found.member.placed.joints()).filter(|_| !found.member.placed.effect.is_body());
    let own = own.and_then(most).filter(|&joint| gained(joint) > 0.0);
    let joint = own.or_else(|| most(found.member.candidate.joints())).unwrap_or(0);
    let names = names(robot, found);
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
    // What is taken back has no chance of its own.
    let chance = match found.verdict {
        Verdict::Unexplained => String::new(),
        _ => format!("; chance of a false alarm {chance}"),
    };
    let takes = if after[joint] < before[joint] { "takes it to" } else { "fits the training logs, and leaves" };
    format!(
        "{} misses {} rms{share}: {names} {takes} {} (noise {}{chance}).",
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
fn smaller(robot: &Robot, diagnosis: &Diagnosis) -> Option<String> {
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
fn values(effect: &str, parameters: &[NamedParameter]) -> String {
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

/// When the residual is largest where it is unexplained, for the joint on which it exceeds the noise most; and what it follows, where no
/// other line reports that.
fn where_it_lives(robot: &Robot, diagnosis: &Diagnosis) -> Option<String> {
    let [_, of] = &diagnosis.errors.structure;
    let excess = |j: usize| of[j].rms_nm / diagnosis.errors.noise_floor[j];
    let misfit = diagnosis.scope.criteria.levels.misfit;
    let joint = (0..of.len()).max_by(|&a, &b| excess(a).total_cmp(&excess(b))).filter(|&j| excess(j) > misfit)?;
    let worst = of[joint].worst?;
    let is_reported = diagnosis.unexplained.iter().any(|left| left.joint == joint)
        || diagnosis.map.joints.iter().any(|map| map.joint == joint && !is_unstructured(map));
    let follows = match of[joint].follows.most() {
        _ if is_reported => String::new(),
        (variable, share) => format!("follows {variable} most ({:.0} %) and ", 100.0 * share),
    };
    (diagnosis.verdict == Verdict::Unexplained).then(|| {
        format!(
            "On {}, the residual {follows}is largest from {:.1} to {:.1} s of held-out log {}.",
            robot.joints[joint].name,
            worst.from_s,
            worst.to_s,
            worst.log + 1
        )
    })
}

/// Whether the map of a joint reports nothing that its residual follows.
fn is_unstructured(map: &JointMap) -> bool {
    map.reported().chain(map.unseparated()).next().is_none() && map.reported_lines().next().is_none()
}

/// The table of held-out errors; those of fitted models are left out where the training logs do not determine the torque.
fn error_table(robot: &Robot, diagnosis: &Diagnosis, resimulation: Option<&Resimulation>) -> String {
    let errors = &diagnosis.errors;
    let identified = if diagnosis.scope.against_reference { "before the change" } else { "re-identified" };
    let (unit, names) = by_joint(robot);
    let given = |title: &str, values| (title.to_owned(), values, false);
    let fitted = |title: &str, values| (title.to_owned(), values, true);
    let mut columns: Vec<(String, &Vec<f64>, bool)> = vec![
        given("torque", &errors.test_torque_rms),
        given("as described", &errors.simulation_test_rms),
        fitted(identified, &errors.baseline_rms[1]),
    ];
    columns.extend((!diagnosis.found.is_empty()).then(|| fitted("with findings", &errors.extended_test_rms)));
    columns.extend(resimulation.map(|run| (format!("in {}", run.engine.name), &run.extended_rms, false)));
    columns.extend([given("noise", &errors.noise_floor), given("of sensor", &errors.sensor_noise)]);
    let rows = names.into_iter().enumerate().map(|(joint, name)| {
        let value = |(_, values, fitted): &(String, &Vec<f64>, bool)| {
            let is_known = diagnosis.logs.equations[joint] && (!fitted || errors.are_determined(joint));
            significant(if is_known { values[joint] } else { f64::NAN })
        };
        [name].into_iter().chain(columns.iter().map(value)).collect()
    });
    let title = format!("held-out rms, {unit}");
    let header: Vec<&str> =
        std::iter::once(title.as_str()).chain(columns.iter().map(|(title, ..)| title.as_str())).collect();
    table(&header, rows.collect())
}

/// What the residual of the baseline follows, for the joints on which it follows anything.
pub(crate) fn followed(robot: &Robot, map: &ResidualMap) -> Option<String> {
    let (unit, names) = by_joint(robot);
    let title = format!("residual in all logs, rms in {unit}");
    let rows = map.joints.iter().filter_map(|map| {
        let part = |part: &Part| format!("{} {}", part.follows.title(), significant(part.rms));
        let parts = map.reported().take(MENTIONED).map(part);
        let unseparated: Vec<String> = map.unseparated().take(MENTIONED).map(part).collect();
        let unseparated = (!unseparated.is_empty()).then(|| format!("not separated: {}", unseparated.join(" or ")));
        let lines = map.reported_lines().map(|line| format!("{} Hz {}", significant(line.hz), significant(line.rms)));
        let follows: Vec<String> = parts.chain(unseparated).chain(lines).collect();
        let sizes = [map.residual, map.noise].map(significant);
        let row = [names[map.joint].clone()].into_iter().chain(sizes).chain([follows.join(", ")]);
        (!follows.is_empty()).then(|| row.collect())
    });
    let rows: Vec<Vec<String>> = rows.collect();
    (!rows.is_empty()).then(|| table(&[title.as_str(), "re-identified", "noise", "it follows"], rows) + "\n")
}

/// Sizes of effects that would have been found, where none was.
fn unseen(robot: &Robot, diagnosis: &Diagnosis) -> Option<String> {
    if !diagnosis.found.is_empty() {
        return None;
    }
    let is_asked_about = |name: &str| effects::find(name).is_ok_and(|effect| effect.is_asked_about());
    // Where structure is unexplained the noise is not all that there is, and no size is known to be found.
    let is_clear = |family: Family| {
        let own = joints(robot, family);
        let mut left = diagnosis.unexplained.iter().map(|left| &robot.joints[left.joint].name);
        !left.any(|joint| own.is_empty() || own.contains(joint))
    };
    let clear = diagnosis.not_found.iter().filter(|missed| is_clear(missed.family));
    let seen = clear.filter_map(|missed| Some((missed, missed.minimum_detectable?)));
    // That an effect larger than any arm has one would have been found says nothing.
    let seen = seen.filter(|(missed, size)| *size <= effects::find(missed.family.effect).map_or(0.0, largest_usual));
    let shown: Vec<String> = seen
        .filter(|(missed, _)| is_asked_about(missed.family.effect))
        .scan(Vec::new(), |shown: &mut Vec<&str>, (missed, size)| {
            let new = !shown.contains(&missed.family.effect);
            shown.push(missed.family.effect);
            Some(new.then(|| format!("{} {}", place(robot, missed.family), with_unit(significant(size), missed.unit))))
        })
        .flatten()
        .take(MENTIONED)
        .collect();
    (!shown.is_empty()).then(|| {
        format!("Effects above these sizes would have been found: {} (diagnosis.json lists all).", shown.join("; "))
    })
}

/// Ten times the typical size of an effect, in its own unit; a torque may be of any arm.
fn largest_usual(effect: &dyn effects::Effect) -> f64 {
    match effect.parameters().first() {
        Some(parameter) if effect.headline().is_empty() && parameter.unit != Unit::Effort => {
            10.0 * parameter.typical.abs()
        }
        _ => f64::INFINITY,
    }
}

/// A probability as a percentage.
fn percent_of(probability: f64) -> String {
    match probability < 1e-4 {
        true => format!("{:.0e} %", 100.0 * probability),
        false => format!("{} %", (1e8 * probability).round() / 1e6),
    }
}

fn percent(share: Share) -> String {
    let [low, high] = share.interval;
    format!("{:.0} % ({:.0} to {:.0} %)", 100.0 * share.value, 100.0 * low, 100.0 * high)
}

/// An effect with its joints, in words.
pub(crate) fn place(robot: &Robot, family: Family) -> String {
    let joints = joints(robot, family);
    if joints.is_empty() { family.effect.to_owned() } else { format!("{} on {}", family.effect, joints.join(" and ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_simulated_is_said_with_its_joint_in_one_line() {
        let said = not_simulated(&Error::request("elbow", "the simulation ran away at 0.488 s"));
        assert!(
            said.starts_with("The extended model was not simulated (elbow: the simulation ran away at 0.488 s); "),
            "{said}"
        );
        assert_eq!(said.lines().count(), 1);
    }

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
