//! The answer in a few lines.

use super::faults::fault_lines;
use super::findings::{MENTIONED, named, names, none, place, smaller, unexplained, values};
use crate::diagnosis::{
    Consequence, DataFault, Diagnosis, Family, JointMap, Part, ResidualMap, Resimulation, Share, Verdict,
};
use crate::effects;
use crate::error::Error;
use crate::internal::diagnosis::{finding, findings, joints, shown, with_unit};
use crate::quality::Kind;
use crate::report::console::{by_joint, significant, table};
use crate::report::payload;
use crate::robot::{Robot, Unit};

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
    lines.extend(named(robot, diagnosis, &all[ahead..]));
    lines.extend(diagnosis.load.iter().flat_map(payload::weighed));
    lines.extend(unexplained(robot, diagnosis, &all[ahead..]));
    lines.extend(smaller(robot, diagnosis));
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
}
