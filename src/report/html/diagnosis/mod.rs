//! The report of a diagnosis.

mod candidates;
mod findings;
mod residual_map;
mod words;

use words::{NORMAL_95, named, sentence};

use super::evidence::{self, Contender, Joint};
use super::provenance::file_name;
use super::{Block, Page, Provenance, Section, Tone};
use crate::diagnosis::{DataFault, Diagnosis, Found, Resimulation, Verdict};
use crate::effects::Role;
use crate::internal::diagnosis::shown;
use crate::quality::with_logs;
use crate::recording::Recording;
use crate::report::console::significant;
use crate::report::diagnosis::{held, impacts};
use crate::report::payload;
use crate::report::svg::Color;
use crate::report::viewer::{joined, joined_time, offsets};
use crate::robot::Robot;

/// Time between two rows of a diagnosis, s.
const ROW_S: f64 = 0.02;

/// What a diagnosis was given.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Logs<'a> {
    /// Logs to find from.
    pub train: &'a [&'a Recording],
    /// Logs to judge by, in the order of the evidence.
    pub held_out: &'a [&'a Recording],
    /// What is wrong with them.
    pub faults: &'a [DataFault],
}

/// The report of a diagnosis; `resimulation` is the simulation of the extended model, where one was made.
pub(crate) fn page(
    robot: &Robot,
    diagnosis: &Diagnosis,
    resimulation: Option<&Resimulation>,
    logs: Logs,
    provenance: Provenance,
) -> Page {
    let joints = rows(robot, diagnosis, logs.held_out);
    let mut contenders = vec![contender("as described", Color::Green), contender("re-identified", Color::Blue)];
    if !diagnosis.found.is_empty() {
        contenders.push(contender("with the findings", Color::Orange));
    }
    let mut sections = vec![how_far(robot, diagnosis, resimulation)];
    sections.push(residual_map::section(robot, diagnosis));
    sections.push(findings::section(robot, diagnosis));
    sections.extend(findings::smaller(robot, diagnosis));
    sections.extend(evidence::sections(&joints, &contenders, ROW_S));
    sections.push(candidates::ranked(robot, diagnosis));
    sections.push(candidates::not_found(robot, diagnosis));
    sections.push(quality(robot, diagnosis, logs));
    let (verdict, tone) = verdict(robot, diagnosis);
    Page {
        kind: format!("Diagnosis of {}", robot.name),
        verdict,
        tone,
        lead: lead(robot, diagnosis),
        next: Some(sentence(&diagnosis.next_experiment)),
        sections,
        provenance,
    }
}

fn contender(name: &str, color: Color) -> Contender {
    Contender { name: name.into(), color }
}

/// The answer in one sentence.
fn verdict(robot: &Robot, diagnosis: &Diagnosis) -> (String, Tone) {
    let names: Vec<String> = diagnosis
        .found
        .iter()
        .map(|found| {
            let own = named(robot, found.member.candidate.family());
            let others = found.alternatives.iter().map(|other| named(robot, other.family));
            [own].into_iter().chain(others).collect::<Vec<_>>().join(" or ")
        })
        .collect();
    match diagnosis.verdict {
        Verdict::Named => (format!("The model misses {}.", names.join(", and ")), Tone::Warn),
        Verdict::OneOf => {
            (format!("The model misses {}; the logs do not separate them.", names.join(", and ")), Tone::Warn)
        }
        Verdict::Unexplained => ("The model misses something that is not in the library of effects.".into(), Tone::Bad),
        Verdict::NotTestable => ("Faults of the data forbid an answer.".into(), Tone::Bad),
        Verdict::None => ("The model explains the logs: nothing beyond the noise.".into(), Tone::Good),
    }
}

fn lead(robot: &Robot, diagnosis: &Diagnosis) -> Vec<String> {
    let mut lead = Vec::new();
    for found in &diagnosis.found {
        let about = found.member.placed.effect.about();
        let [before, after] = &found.rms;
        let gain = |joint: &usize| before[*joint] / after[*joint];
        let seen = (0..robot.dof()).filter(|&joint| diagnosis.logs.equations[joint]);
        let most = seen.max_by(|a, b| gain(a).total_cmp(&gain(b))).unwrap_or_default();
        let (joint, unit) = (&robot.joints[most], robot.joints[most].effort_unit());
        let shown = match &found.impacts {
            Some(play) => sentence(&impacts(play)),
            None => format!(
                "With it the held-out residual of {} falls from {} to {} {unit}; the noise is {} {unit}.",
                joint.name,
                significant(before[most]),
                significant(after[most]),
                significant(diagnosis.errors.noise_floor[most]),
            ),
        };
        lead.push(format!(
            "{}, {}. {} {shown}",
            sentence(&named(robot, found.member.candidate.family())).trim_end_matches('.'),
            values(robot, found).join(", "),
            about.explanation,
        ));
    }
    for left in &diagnosis.unexplained {
        let joint = &robot.joints[left.joint].name;
        lead.push(format!("On {joint}, {:.0} % of the residual {}.", 100.0 * left.share, left.structure));
    }
    if !diagnosis.found.is_empty() {
        lead.push(format!(
            "Together the findings close {:.0} % of the gap between the re-identified model and the noise, on logs that the \
             fit has not seen.",
            100.0 * diagnosis.errors.gap_closed.value
        ));
    }
    lead.push(format!(
        "Where nothing is wrong, at most {} % of diagnoses name anything: the level is corrected for the number of \
         independent tests, which is {:.0}.",
        100.0 * diagnosis.scope.alpha,
        diagnosis.scope.effective_tests
    ));
    lead
}

/// "rise 24.6 N m (95 %: 23.9 to 25.3)" for every parameter that was estimated.
fn values(robot: &Robot, found: &Found) -> Vec<String> {
    let placed = &found.member.placed;
    let all = placed.effect.parameters().iter().enumerate().zip(placed.parameters.iter().zip(&found.member.std));
    all.filter(|((_, parameter), _)| parameter.role != Role::Held)
        .map(|((k, parameter), (&value, &std))| {
            if !std.is_finite() {
                return format!("{} not determined by itself (held at {})", parameter.name, significant(held(value)));
            }
            let [low, high] = [-NORMAL_95, NORMAL_95].map(|factor| significant(value + factor * std));
            format!("{} {} {} (95 %: {low} to {high})", parameter.name, significant(value), placed.unit(k, robot))
        })
        .collect()
}

fn how_far(robot: &Robot, diagnosis: &Diagnosis, resimulation: Option<&Resimulation>) -> Section {
    let rows = robot.joints.iter().enumerate().map(|(j, joint)| {
        let floor = diagnosis.errors.noise_floor[j];
        let last = if diagnosis.found.is_empty() {
            diagnosis.errors.baseline_rms[1][j]
        } else {
            diagnosis.errors.extended_test_rms[j]
        };
        let torque = diagnosis.errors.test_torque_rms[j];
        let name = format!("{}, {}", joint.name, joint.effort_unit());
        // Fitted models say nothing where the training logs do not determine the torque.
        let fitted = |rms: f64| significant(if diagnosis.errors.are_determined(j) { rms } else { f64::NAN });
        let mut row = vec![
            name,
            significant(torque),
            significant(diagnosis.errors.simulation_test_rms[j]),
            fitted(diagnosis.errors.baseline_rms[1][j]),
        ];
        if !diagnosis.found.is_empty() {
            row.push(fitted(last));
        }
        row.extend(resimulation.map(|run| significant(run.extended_rms[j])));
        row.extend([significant(floor), fitted(last / floor)]);
        if !diagnosis.logs.equations[j] {
            row[1..].fill("-".to_owned());
        }
        row
    });
    let mut header = vec!["joint", "torque", "as described", "re-identified"];
    if !diagnosis.found.is_empty() {
        header.push("with the findings");
    }
    if resimulation.is_some() {
        header.push("in the simulator");
    }
    header.extend(["noise floor", "residual / noise"]);
    Section::new(
        "How far off the model is",
        vec![
            Block::text(
                "Root mean square of measured less predicted torque on held-out logs, over means of 20 ms: the arm as its \
                 URDF describes it, with its parameters re-identified, and with the findings added; in the simulator: the \
                 extended model driven along the measured motion.",
            ),
            Block::table(header, rows.collect()),
        ],
    )
}

fn quality(robot: &Robot, diagnosis: &Diagnosis, given: Logs) -> Section {
    let Logs { train, held_out, faults } = given;
    let log = |kind: &str, index: usize, log: &Recording| {
        let cells = [log.samples().to_string(), format!("{:.1} s", log.duration()), format!("{:.0} Hz", log.rate_hz())];
        [format!("{kind} {}", index + 1)].into_iter().chain(cells).collect::<Vec<String>>()
    };
    let logs = train.iter().enumerate().map(|(k, one)| log("training", k, one));
    let logs = logs.chain(held_out.iter().enumerate().map(|(k, one)| log("held out", k, one)));
    let evidence = &diagnosis.evidence;
    let range = |values: &[f64]| {
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
    };
    let rows = robot.joints.iter().enumerate().map(|(j, joint)| {
        let used = evidence.valid[j].iter().filter(|&&ok| ok).count() as f64 / evidence.len().max(1) as f64;
        let ((low, high), (slow, fast)) = (range(&evidence.q[j]), range(&evidence.qd[j]));
        vec![
            joint.name.clone(),
            format!("{:.0} %", 100.0 * used),
            format!("{} {}", significant(low), joint.position_unit()),
            format!("{} {}", significant(high), joint.position_unit()),
            format!("{} {}/s", significant(slow.abs().max(fast)), joint.position_unit()),
            format!("{} Hz", significant(diagnosis.logs.cutoffs_hz[j])),
        ]
    });
    let mut blocks = vec![Block::table(["log", "samples", "length", "rate"], logs.collect())];
    if faults.is_empty() {
        blocks.push(Block::text("No fault was found in the logs."));
    } else {
        let each = faults.iter().map(|fault| (file_name(&fault.log), (&fault.place[..], &fault.text[..])));
        let row = |(logs, (place, text)): (Vec<String>, (&str, &str))| vec![logs.join(", "), place.into(), text.into()];
        let rows = with_logs(each).into_iter().map(row);
        blocks.push(Block::table(["log", "place", "what is wrong"], rows.collect()));
    }
    if diagnosis.logs.held_out_from_training {
        blocks.push(Block::text(
            "No test log was given: 30 % of every training log was held out. A log of another motion is a harder \
             test.",
        ));
    }
    blocks.extend(diagnosis.load.iter().flat_map(payload::weighed).map(|text| Block::text(sentence(&text))));
    blocks.extend(shown(robot, diagnosis).into_iter().map(|text| Block::text(sentence(&format!("{text}.")))));
    if let Some(low_pass) = diagnosis.logs.passband {
        blocks.push(Block::text(format!(
            "The torque ends at a frequency at which no step of friction does: it went through a low-pass before it was logged. \
             All of the model passes the zero-phase Butterworth low-pass of {} Hz (order {}) with the smallest residual.",
            significant(low_pass.hz),
            low_pass.order
        )));
    }
    blocks.push(Block::text(
        "Of the held-out logs, with the cut-off at which the positions of each joint were smoothed, the cut-off with the smallest innovations:",
    ));
    let head = ["joint", "valid rows", "lowest position", "highest", "fastest", "cut-off"];
    blocks.push(Block::table(head, rows.collect()));
    Section::new("Data quality", blocks)
}

/// The rows of the held-out logs, one log after the other.
fn rows(robot: &Robot, diagnosis: &Diagnosis, held_out: &[&Recording]) -> Vec<Joint> {
    let evidence = &diagnosis.evidence;
    let bounds: Vec<(usize, usize)> = evidence.starts.windows(2).map(|pair| (pair[0], pair[1])).collect();
    let offsets = offsets(held_out.iter().map(|log| [log.time[0], log.time[log.samples() - 1]]));
    let logs: Vec<(f64, &[f64])> =
        offsets.into_iter().zip(bounds.iter().map(|&(from, to)| &evidence.time[from..to])).collect();
    let time = joined_time(&logs);
    let all = |values: &[f64]| joined(&bounds.iter().map(|&(from, to)| &values[from..to]).collect::<Vec<_>>());
    robot
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let mut residuals = vec![all(&evidence.described[j]), all(&evidence.baseline[j])];
            if !diagnosis.found.is_empty() {
                residuals.push(all(&evidence.extended[j]));
            }
            let counts: Vec<f64> = evidence.valid[j].iter().map(|&ok| f64::from(u8::from(ok))).collect();
            Joint {
                name: joint.name.clone(),
                effort_unit: joint.effort_unit(),
                position_unit: joint.position_unit(),
                time: time.clone(),
                torque: all(&evidence.torque[j]),
                q: all(&evidence.q[j]),
                qd: all(&evidence.qd[j]),
                residuals,
                valid: all(&counts).into_iter().map(|share| share == 1.0).collect(),
                noise: diagnosis.errors.noise_floor[j],
            }
        })
        .collect()
}
