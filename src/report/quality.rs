//! The result of `tauscope inspect`.

use super::console::{column_with_unit, significant, table};
use crate::internal::quality::excitation;
use crate::quality::descriptions::{Alternative, Change, Verdict, is_description, words};
use crate::quality::{Finding, JointSummary, Kind, Report, Severity, standing_together, with_logs};
use crate::recording::lenient::Rejected;
use crate::robot::{Robot, Unit};
use serde::Serialize;
use std::path::Path;

/// Share of a joint's torque from which what the robot's model leaves unexplained is mentioned though nothing is found: that of the right
/// robot leaves a hundredth of simulated torques, and about a tenth of real ones.
const MUCH: f64 = 0.3;

/// A log that is shorter, s, of which half of the joints reverse fewer times, has too few independent parts: what is wrong with it may
/// not show, as friction and gravity are not told apart by it. So long are those that show it.
const SHORT_S: f64 = 10.0;
const FEW_REVERSALS: usize = 4;
const LONG_S: f64 = 30.0;

/// Schema of what `tauscope inspect --json` prints.
pub(crate) const SCHEMA: &str = "tauscope.quality/1";

/// Rejected rows that are listed one by one.
const LISTED: usize = 100;

/// The content of the JSON.
#[derive(Debug, Serialize)]
pub(crate) struct Quality<'a> {
    log: String,
    robot: Option<&'a str>,
    usable: bool,
    rows: usize,
    rows_rejected: usize,
    /// The first hundred.
    rejected: &'a [Rejected],
    duration_s: f64,
    rate_hz: f64,
    jitter_s: f64,
    longest_step_s: f64,
    gaps: usize,
    condition_number: Option<f64>,
    joints: &'a [JointSummary],
    findings: &'a [Finding],
    /// What explains the log clearly better than its description.
    #[serde(skip_serializing_if = "Option::is_none")]
    description: Option<Hypotheses>,
    /// What was read otherwise than the robot's file has it, and which joints are held; with the first log.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
    /// The same of the other logs, where several were given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    others: Vec<Quality<'a>>,
}

/// A wrong description with its alternatives.
#[derive(Debug, Serialize)]
struct Hypotheses {
    changes: Vec<String>,
    /// Share of the torque that stays unexplained, geometric mean over the joints, held out: as described, and changed.
    unexplained: [f64; 2],
    /// The same of every torque column; null where it takes no part.
    unexplained_by_column: [Vec<Option<f64>>; 2],
    /// How many times larger the torque of each joint is than the robot's bodies need, where that is the change; null where it is not
    /// known.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    factors: Vec<Factor>,
    /// How well the logs determine the direction of gravity, where that is changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    gravity_direction: Option<Direction>,
    beyond_doubt: bool,
    /// Sets of changes that explain the logs as well.
    alternatives: Vec<Other>,
    /// The best set that is clearly worse.
    next: Option<Other>,
}

/// The set of directions of gravity that the logs do not separate.
#[derive(Debug, Serialize)]
struct Direction {
    gravity_m_s2: [f64; 3],
    /// All of them are within this angle of that one; null where some are farther than 25 degrees.
    within_degrees: f64,
    /// Directions along axes of the base, and the described one, that are among them.
    includes_m_s2: Vec<[f64; 3]>,
}

/// The scale of a joint's torque.
#[derive(Debug, Serialize)]
struct Factor {
    joint: String,
    times_too_large: Option<f64>,
    /// Its bounds, where a load that the robot's file lacks changes it much.
    #[serde(skip_serializing_if = "Option::is_none")]
    between: Option<[f64; 2]>,
}

/// Another set of changes.
#[derive(Debug, Serialize)]
struct Other {
    changes: Vec<String>,
    unexplained: f64,
}

impl Hypotheses {
    fn new(verdict: &Verdict, joints: &[String]) -> Hypotheses {
        let said = |changes: &[Change]| changes.iter().map(|&change| words(change, joints)).collect();
        let other = |other: &Alternative| Other { changes: said(&other.changes), unexplained: other.unexplained };
        Hypotheses {
            changes: said(&verdict.description.changes),
            unexplained: [verdict.before, verdict.after],
            unexplained_by_column: verdict.each.clone(),
            factors: factors(verdict, joints),
            gravity_direction: verdict.spread.as_ref().map(|spread| Direction {
                gravity_m_s2: verdict.description.gravity.into(),
                within_degrees: spread.degrees,
                includes_m_s2: spread.includes.clone(),
            }),
            beyond_doubt: verdict.beyond_doubt,
            alternatives: verdict.alternatives.iter().map(other).collect(),
            next: verdict.next.as_ref().map(other),
        }
    }
}

/// The factors of a verdict on the scale of torques, joint by joint, and those of single joints.
fn factors(verdict: &Verdict, joints: &[String]) -> Vec<Factor> {
    let description = &verdict.description;
    let of = |(place, joint): (usize, &String)| {
        let known = match verdict.factors.as_slice() {
            [] => Some(description.torque_scale[place].recip()),
            [shared] => *shared,
            each => each.get(place).copied().flatten(),
        };
        let place = if verdict.factor_bounds.len() == 1 { 0 } else { place };
        let between = verdict.factor_bounds.get(place).copied().flatten();
        Factor { joint: joint.clone(), times_too_large: known.map(f64::abs), between }
    };
    let is_scaled = description.scaled().next().is_some();
    joints.iter().enumerate().filter(|_| is_scaled).map(of).collect()
}

/// What was found in several logs of one arm, the first in front.
pub(crate) fn together<'a>(
    first: (&Path, &'a Report),
    others: &[(&Path, &'a Report)],
    robot: Option<&'a Robot>,
) -> Quality<'a> {
    let others = others.iter().map(|(path, report)| result(path, robot, report)).collect();
    let notes = robot.map(|robot| robot.notes.clone()).unwrap_or_default();
    Quality { notes, others, ..result(first.0, robot, first.1) }
}

/// What was found in the log at `path`.
pub(crate) fn result<'a>(path: &Path, robot: Option<&'a Robot>, report: &'a Report) -> Quality<'a> {
    Quality {
        log: path.display().to_string(),
        robot: robot.map(|robot| robot.name.as_str()),
        usable: report.usable,
        rows: report.rows,
        rows_rejected: report.rejected.len(),
        rejected: &report.rejected[..report.rejected.len().min(LISTED)],
        duration_s: report.duration_s,
        rate_hz: report.clock.rate_hz,
        jitter_s: report.clock.jitter_s,
        longest_step_s: report.clock.longest_step_s,
        gaps: report.gaps,
        condition_number: report.condition_number,
        joints: &report.joints,
        findings: &report.findings,
        description: report.description.as_ref().map(|verdict| {
            let joints: Vec<String> = report.joints.iter().map(|joint| joint.name.clone()).collect();
            Hypotheses::new(verdict, &joints)
        }),
        notes: Vec::new(),
        others: Vec::new(),
    }
}

/// The same for people: each log, and then what was found in several of them.
pub(crate) fn texts(logs: &[(&Path, &Report)], robot: Option<&Robot>) -> String {
    let told: Vec<Vec<Finding>> = logs.iter().map(|(_, report)| standing_together(&report.findings)).collect();
    let each = logs.iter().zip(&told).flat_map(|((path, _), told)| told.iter().map(move |finding| (*path, finding)));
    let each = with_logs(each);
    let (shared, own): (Vec<_>, Vec<_>) = each.into_iter().partition(|(paths, _)| paths.len() > 1);
    let mut parts: Vec<String> = logs
        .iter()
        .map(|(path, report)| {
            let own = own.iter().filter(|(paths, _)| paths.contains(path)).map(|(_, finding)| *finding);
            text(path, robot, report, &own.collect::<Vec<_>>())
        })
        .collect();
    let mut of: Vec<Vec<&Path>> = Vec::new();
    for (paths, _) in &shared {
        if !of.contains(paths) {
            of.push(paths.clone());
        }
    }
    for paths in of {
        let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
        let findings = shared.iter().filter(|(own, _)| *own == paths).map(|(_, finding)| line(finding));
        parts.push(format!("{}:\n{}", names.join(", "), findings.collect::<Vec<_>>().join("\n")));
    }
    parts.join("\n\n")
}

/// One log; `own` are the findings that no other log has.
fn text(path: &Path, robot: Option<&Robot>, report: &Report, own: &[&Finding]) -> String {
    let mut text = format!(
        "{}: {} rows over {:.3} s at {} Hz, jitter {} ms, {} gaps, {} rows left out",
        path.display(),
        report.rows,
        report.duration_s,
        significant(report.clock.rate_hz),
        significant(1e3 * report.clock.jitter_s),
        report.gaps,
        report.rejected.len(),
    );
    if let (Some(robot), Some(condition)) = (robot, report.condition_number) {
        text += &format!(
            "\n{}: {} (condition number of the base parameters {}: 1 is best)",
            robot.name,
            excitation(condition),
            significant(condition)
        );
    }
    if !report.joints.is_empty() {
        let percent = |share: Option<f64>| share.map_or("-".to_owned(), |s| format!("{:.0} %", 100.0 * s));
        let columns = [("position", Unit::Position), ("speed", Unit::Velocity), ("torque rms", Unit::Effort)];
        let [position, speed, torque] = columns.map(|(what, unit)| column_with_unit(robot, what, unit));
        let unit = |units: &[String], joint: usize| units.get(joint).cloned().unwrap_or_default();
        let rows = report
            .joints
            .iter()
            .enumerate()
            .map(|(place, joint)| {
                vec![
                    joint.name.clone(),
                    format!("{:.3} .. {:.3}{}", joint.range[0], joint.range[1], unit(&position.1, place)),
                    percent(joint.range_share),
                    significant(joint.speed) + &unit(&speed.1, place),
                    percent(joint.speed_share),
                    joint.reversals.to_string(),
                    significant(joint.torque_rms) + &unit(&torque.1, place),
                    percent(joint.unexplained),
                    joint.dead_time_s.map_or("-".to_owned(), |lag| format!("{:.1}", 1e3 * lag)),
                ]
            })
            .collect();
        let header = [
            "joint",
            position.0.as_str(),
            "of limits",
            speed.0.as_str(),
            "of limit",
            "reversals",
            torque.0.as_str(),
            "unexplained",
            "torque lag, ms",
        ];
        text += &format!("\n\n{}", table(&header, rows));
    }
    if !own.is_empty() {
        text += &format!("\n\n{}", own.iter().map(|finding| line(finding)).collect::<Vec<_>>().join("\n"));
    }
    if report.findings.iter().all(|finding| finding.severity == Severity::Note) {
        text += &format!("\n\n{}", nothing_wrong(report, robot.is_some()));
    }
    text
}

/// The sentence where nothing wrong is found.
fn nothing_wrong(report: &Report, is_known: bool) -> String {
    if let Some(short) = too_short(report) {
        return short;
    }
    // Such a note tells what is wrong, though it stops nothing.
    let tells = |finding: &Finding| {
        matches!(finding.kind, Kind::ModelTorque | Kind::DeadTime)
            || finding.kind.is_another_robot()
            || is_description(finding.kind)
    };
    if report.findings.iter().any(tells) {
        return "Nothing else is wrong with it.".into();
    }
    match is_known {
        true => nothing_but_unexplained(&report.joints),
        false => "Nothing is wrong with it as far as it shows without the robot: --robot compares torques and motion with its file.".into(),
    }
}

/// The sentence about a log that ends before its torques repeat themselves: none of its faults would be certain.
fn too_short(report: &Report) -> Option<String> {
    let mut reversals: Vec<usize> = report.joints.iter().map(|joint| joint.reversals).collect();
    reversals.sort_unstable();
    let median = *reversals.get(reversals.len() / 2)?;
    let last = reversals.last()?;
    let times = match reversals[0] == *last {
        true => last.to_string(),
        false => format!("{} to {last}", reversals[0]),
    };
    (report.duration_s < SHORT_S && median < FEW_REVERSALS).then(|| {
        format!(
            "Nothing wrong shows in it, but {:.1} s in which joints reverse {times} times are too short to decide: log {LONG_S} s or more in \
             which each reverses {} times or more.",
            report.duration_s,
            2 * FEW_REVERSALS
        )
    })
}

/// The same with the joints of which the robot's model leaves a share of the torque: another robot, or a zero that is off, is no fault of a
/// log by itself. A constant torque is none of these: it is that of a sensor or a current.
fn nothing_but_unexplained(joints: &[JointSummary]) -> String {
    let much = joints.iter().filter_map(|joint| Some((joint, joint.unexplained.filter(|share| *share > MUCH)?)));
    let (constant, others): (Vec<_>, Vec<_>) =
        much.partition(|(joint, _)| joint.constant.is_some_and(|constant| constant.unexplained <= MUCH));
    let of_constants = constant.iter().filter_map(|(joint, share)| {
        let torque = joint.constant?.torque;
        Some(format!("{} on {} ({:.0} % of its torque)", significant(torque), joint.name, 100.0 * share))
    });
    let of_constants = of_constants.collect::<Vec<_>>().join(", ");
    let of_others = others.iter().map(|(joint, share)| format!("{:.0} % of {}", 100.0 * share, joint.name));
    let of_others = of_others.collect::<Vec<_>>().join(", ");
    let offset = "A constant torque that no body makes, as an offset of a sensor or a current";
    match (of_constants.is_empty(), of_others.is_empty()) {
        (true, true) => "Nothing is wrong with it.".into(),
        (false, true) => format!("Nothing is wrong with it by itself. {offset}, N m or N: {of_constants}."),
        (has_none, false) => {
            let constants = if has_none {
                String::new()
            } else {
                format!(" {offset}, N m or N, is not among that: {of_constants}.")
            };
            // A wrong robot or mounting shows on most joints; a coarse encoder, play and noise on those that they are in.
            let check = match 2 * others.len() > joints.len() {
                true => {
                    "check that it is this robot, how it is mounted (--gravity), that the zeros of its joints are right, and what it carries"
                }
                false => {
                    "noise of an encoder or of a torque, play, or friction that is not modelled does that on single joints, as a wrong zero does"
                }
            };
            format!(
                "Nothing is wrong with it by itself, but the robot's model leaves much of the torque unexplained ({of_others}): {check}; `tauscope \
                 diagnose` says what the model misses.{constants}"
            )
        }
    }
}

fn line(finding: &Finding) -> String {
    let severity = match finding.severity {
        Severity::Fatal => "fatal",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    format!("{severity}: {}: {}", finding.place, finding.text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::Constant;
    use crate::quality::descriptions::Description;

    #[test]
    fn factors_of_torques_are_listed_by_joint() {
        let joints = ["a".to_owned(), "b".to_owned()];
        let given = Description::as_given(2, [0.0, 0.0, -9.81].into());
        let of = |description: Description, factors: Vec<Option<f64>>| {
            let each = [vec![Some(0.5); 2], vec![Some(0.01); 2]];
            let verdict = Verdict {
                description,
                before: 0.5,
                after: 0.01,
                each,
                alternatives: Vec::new(),
                next: None,
                shown: None,
                factors,
                currents: false,
                factor_bounds: Vec::new(),
                by_bodies: false,
                spread: None,
                assumed: Vec::new(),
                unlike_bodies: false,
                without_bodies: false,
                beyond_doubt: false,
            };
            serde_json::to_value(Hypotheses::new(&verdict, &joints)).unwrap()["factors"].clone()
        };
        let listed = |a: Option<f64>, b: Option<f64>| serde_json::json!([{"joint": "a", "times_too_large": a}, {"joint": "b", "times_too_large": b}]);
        // Of one torque, of all alike, of each its own, of which one is not known, and none.
        assert_eq!(of(given.with(Change::JointScale(1, 0.125)), Vec::new()), listed(Some(1.0), Some(8.0)));
        let shared = given.with(Change::TorqueScale(1e-3));
        assert_eq!(of(shared, vec![Some(1000.0)]), listed(Some(1000.0), Some(1000.0)));
        let each = given.with_scales(20.0, &[16.0, 1.0]);
        assert_eq!(of(each, vec![Some(16.0), None]), listed(Some(16.0), None));
        assert_eq!(of(given.with(Change::TorqueSign(0)), Vec::new()), serde_json::Value::Null);
    }

    fn joint(name: &str, unexplained: f64, constant: Option<Constant>) -> JointSummary {
        JointSummary {
            name: name.into(),
            range: [0.0, 1.0],
            range_share: None,
            speed: 1.0,
            speed_share: None,
            reversals: 3,
            torque_rms: 1.0,
            unexplained: Some(unexplained),
            constant,
            dead_time_s: None,
        }
    }

    #[test]
    fn torque_that_stays_unexplained_is_mentioned() {
        let of = |unexplained: f64, constant: Option<Constant>| {
            nothing_but_unexplained(&[joint("a", unexplained, constant), joint("b", 0.01, None)])
        };
        assert_eq!(of(0.29, None), "Nothing is wrong with it.");
        let said = of(0.31, None);
        assert!(said.starts_with("Nothing is wrong with it by itself") && said.contains("31 % of a)"), "{said}");
        // One of two joints is no other robot; two of three are.
        assert!(said.contains("on single joints") && !said.contains("this robot"), "{said}");
        let three = [joint("a", 0.31, None), joint("b", 0.31, None), joint("c", 0.01, None)];
        assert!(nothing_but_unexplained(&three).contains("this robot"));
        // An offset is no other robot.
        let said = of(0.47, Some(Constant { torque: -0.2, unexplained: 0.05 }));
        assert!(said.contains("-0.2") && said.contains("on a (47 %") && !said.contains("this robot"), "{said}");
        let said = of(0.47, Some(Constant { torque: -0.2, unexplained: 0.4 }));
        assert!(said.contains("47 % of a)"), "{said}");
    }
}
