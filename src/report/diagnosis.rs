//! What `tauscope diagnose` tells: `diagnosis.json`, and a few lines for people.

use super::console::significant;
use crate::diagnosis::candidates::Family;
use crate::diagnosis::selection::Found;
use crate::diagnosis::{Diagnosis, Verdict};
use crate::effects::{self, Placed, Role, Scope};
use crate::robot::Robot;
use serde::Serialize;

/// Schema of the `diagnosis.json` that `tauscope diagnose` writes.
pub const SCHEMA: &str = "tauscope.diagnosis/1";

/// Effects not found that the lines for people mention.
const MENTIONED: usize = 3;

/// The content of `diagnosis.json`.
#[derive(Debug, Serialize)]
pub struct DiagnosisResult {
    verdict: Verdict,
    robot: String,
    joints: Vec<String>,
    alpha: f64,
    position_cutoff_hz: f64,
    effective_tests: f64,
    noise_floor_nm: Vec<f64>,
    simulation: TestRms,
    baseline: Baseline,
    findings: Vec<Finding>,
    extended: Extended,
    not_found: Vec<NotFound>,
    unexplained: Vec<Unexplained>,
    next_experiment: String,
    data_quality: Vec<Quality>,
}

#[derive(Debug, Serialize)]
struct TestRms {
    test_rms_nm: Vec<f64>,
}

#[derive(Debug, Serialize)]
struct Baseline {
    train_rms_nm: Vec<f64>,
    test_rms_nm: Vec<f64>,
}

#[derive(Debug, Serialize)]
struct Finding {
    effect: &'static str,
    joints: Vec<String>,
    verdict: Verdict,
    alternatives: Vec<Alternative>,
    parameters: Vec<Parameter>,
    family_wise_p: f64,
    test_rms_before_nm: Vec<f64>,
    test_rms_after_nm: Vec<f64>,
    gain_lower_bound: f64,
    explanation: &'static str,
}

#[derive(Debug, Serialize)]
struct Alternative {
    effect: &'static str,
    joints: Vec<String>,
    relative_likelihood: f64,
}

#[derive(Debug, Serialize)]
struct Parameter {
    name: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    joint: Option<String>,
    value: f64,
    std: f64,
    unit: &'static str,
}

#[derive(Debug, Serialize)]
struct Extended {
    test_rms_nm: Vec<f64>,
    gap_closed: f64,
}

#[derive(Debug, Serialize)]
struct NotFound {
    effect: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    joint: Option<String>,
    verdict: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    minimum_detectable: Option<f64>,
    unit: &'static str,
}

#[derive(Debug, Serialize)]
struct Unexplained {
    joint: String,
    share: f64,
    structure: &'static str,
    family_wise_p: f64,
}

#[derive(Debug, Serialize)]
struct Quality {
    kind: &'static str,
    r#where: &'static str,
    text: &'static str,
}

/// The answer as `diagnosis.json` holds it.
pub fn result(robot: &Robot, diagnosis: &Diagnosis) -> DiagnosisResult {
    let [train, test] = diagnosis.baseline_rms.clone();
    let not_found = diagnosis.not_found.iter().map(|missed| NotFound {
        effect: missed.family.effect,
        joint: joints(robot, missed.family).into_iter().next(),
        verdict: if missed.minimum_detectable.is_some() { "not_found" } else { "not_testable" },
        minimum_detectable: missed.minimum_detectable,
        unit: missed.unit,
    });
    let unexplained = diagnosis.unexplained.iter().map(|left| Unexplained {
        joint: robot.joints[left.joint].name.clone(),
        share: left.share,
        structure: left.structure,
        family_wise_p: left.family_wise_p,
    });
    let held_out = diagnosis.held_out_from_training.then_some(Quality {
        kind: "held_out_from_training",
        r#where: "training logs",
        text: "no test log was given: the last part of every training log was held out",
    });
    DiagnosisResult {
        verdict: diagnosis.verdict,
        robot: robot.name.clone(),
        joints: robot.joint_names(),
        alpha: diagnosis.alpha,
        position_cutoff_hz: diagnosis.cutoff_hz,
        effective_tests: diagnosis.effective_tests,
        noise_floor_nm: diagnosis.noise_floor.clone(),
        simulation: TestRms { test_rms_nm: diagnosis.simulation_test_rms.clone() },
        baseline: Baseline { train_rms_nm: train, test_rms_nm: test },
        findings: diagnosis.found.iter().map(|found| finding(robot, found)).collect(),
        extended: Extended { test_rms_nm: diagnosis.extended_test_rms.clone(), gap_closed: diagnosis.gap_closed },
        not_found: not_found.collect(),
        unexplained: unexplained.collect(),
        next_experiment: diagnosis.next_experiment.clone(),
        data_quality: held_out.into_iter().collect(),
    }
}

fn finding(robot: &Robot, found: &Found) -> Finding {
    let placed = &found.member.placed;
    let own = joints(robot, found.member.candidate.family());
    let values = placed.effect.parameters().iter().zip(placed.parameters.iter().zip(&found.member.std));
    let alternatives = found.alternatives.iter().map(|other| Alternative {
        effect: other.family.effect,
        joints: joints(robot, other.family),
        relative_likelihood: other.relative_likelihood,
    });
    let [before, after] = found.rms.clone();
    Finding {
        effect: placed.effect.about().name,
        verdict: if found.alternatives.is_empty() { Verdict::Named } else { Verdict::OneOf },
        alternatives: alternatives.collect(),
        parameters: values
            .filter(|(parameter, _)| parameter.role != Role::Held)
            .map(|(parameter, (&value, &std))| Parameter {
                name: parameter.name,
                joint: own.first().cloned(),
                value,
                std,
                unit: parameter.unit,
            })
            .collect(),
        joints: own,
        family_wise_p: found.family_wise_p,
        test_rms_before_nm: before,
        test_rms_after_nm: after,
        gain_lower_bound: found.gain_lower_bound,
        explanation: placed.effect.about().explanation,
    }
}

/// Names of the joints of an effect; none for one on the whole arm.
pub fn joints(robot: &Robot, family: Family) -> Vec<String> {
    let effect = effects::find(family.effect).ok();
    let placed = effect.filter(|effect| effect.about().scope != Scope::Arm);
    let placed = placed.map(|effect| Placed::typical(effect, family.joint).joints()).unwrap_or_default();
    placed.into_iter().map(|joint| robot.joints[joint].name.clone()).collect()
}

/// The answer in a few lines.
pub fn lines(robot: &Robot, diagnosis: &Diagnosis) -> String {
    let answer = match diagnosis.verdict {
        Verdict::Named => "the logs name what the model misses",
        Verdict::OneOf => "the logs leave a choice of what the model misses",
        Verdict::Unexplained => "the model misses something that is not in the library of effects",
        Verdict::None => "nothing beyond the noise: the model explains the logs",
    };
    let mut lines = vec![format!("Verdict: {answer} (false alarms: at most {} %)", 100.0 * diagnosis.alpha)];
    for found in &diagnosis.found {
        let family = found.member.candidate.family();
        let mut line = format!("- {}", place(robot, family));
        for other in &found.alternatives {
            line += &format!(" or {}", place(robot, other.family));
        }
        let values = finding(robot, found).parameters;
        let values: Vec<String> = values
            .iter()
            .take(4)
            .map(|p| format!("{} {} +- {} {}", p.name, significant(p.value), significant(p.std), p.unit))
            .collect();
        lines.push(format!("{line}: {}; chance of a false alarm {:.1e}", values.join(", "), found.family_wise_p));
        lines.push(format!("  {}", found.member.placed.effect.about().explanation));
    }
    for left in &diagnosis.unexplained {
        let joint = &robot.joints[left.joint].name;
        lines.push(format!("- {joint}: {:.0} % of what is left {}", 100.0 * left.share, left.structure));
    }
    let row = |what: &str, rms: &[f64]| {
        let numbers: Vec<String> = rms.iter().map(|&value| significant(value)).collect();
        format!("{what}: {} N m", numbers.join(", "))
    };
    lines.push(row("Held-out rms, arm as described", &diagnosis.simulation_test_rms));
    lines.push(row("Held-out rms, re-identified   ", &diagnosis.baseline_rms[1]));
    if !diagnosis.found.is_empty() {
        lines.push(row("Held-out rms, with the effects", &diagnosis.extended_test_rms));
        lines.push(format!("Share of the gap to the noise that this closes: {:.0} %", 100.0 * diagnosis.gap_closed));
    }
    lines.push(row("Noise                         ", &diagnosis.noise_floor));
    if diagnosis.found.is_empty() {
        let seen = diagnosis.not_found.iter().filter_map(|missed| Some((missed, missed.minimum_detectable?)));
        for (missed, size) in seen.take(MENTIONED) {
            lines.push(format!(
                "Not found: {} above {} {}",
                place(robot, missed.family),
                significant(size),
                missed.unit
            ));
        }
    }
    if diagnosis.held_out_from_training {
        lines.push("No test log was given: the last part of every training log was held out".into());
    }
    lines.push(format!("Next: {}", diagnosis.next_experiment));
    lines.join("\n")
}

/// An effect with its joints, in words.
pub fn place(robot: &Robot, family: Family) -> String {
    let joints = joints(robot, family);
    if joints.is_empty() { family.effect.to_owned() } else { format!("{} on {}", family.effect, joints.join(" and ")) }
}
