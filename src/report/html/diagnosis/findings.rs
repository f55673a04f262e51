//! What was found: parameters with intervals, law, and what is easily taken for it.

use super::words::{NORMAL_95, named, probability, sentence, spaced};
use crate::diagnosis::{Diagnosis, Found};
use crate::effects::{About, Role};
use crate::internal::diagnosis::NOT_SIZED;
use crate::report::console::significant;
use crate::report::diagnosis::{impacts, largest};
use crate::report::html::{Block, Section};
use crate::robot::Robot;

/// The effects found, or the structure of the residual where there are none.
pub(super) fn section(robot: &Robot, diagnosis: &Diagnosis) -> Section {
    if diagnosis.found.is_empty() {
        let mut blocks = vec![Block::text("No effect of the library was found.")];
        let left = diagnosis.unexplained.iter().map(|left| {
            vec![
                robot.joints[left.joint].name.clone(),
                format!("{:.0} %", 100.0 * left.share),
                left.structure.to_owned(),
                left.family_wise_p.map_or_else(|| "-".into(), |p| probability(p.log10())),
            ]
        });
        let left: Vec<Vec<String>> = left.collect();
        if !left.is_empty() {
            blocks.push(Block::table(["joint", "share of the residual", "structure", "chance of as much"], left));
        }
        return Section::new("Findings", blocks);
    }
    let mut blocks = Vec::new();
    for found in &diagnosis.found {
        let placed = &found.member.placed;
        let about = placed.effect.about();
        let all = placed.effect.parameters().iter().enumerate().zip(placed.parameters.iter().zip(&found.member.std));
        let rows =
            all.filter(|((_, parameter), _)| parameter.role != Role::Held).map(|((k, parameter), (&value, &std))| {
                let unit = placed.unit(k, robot);
                if !std.is_finite() {
                    let undetermined = ["not determined by itself", unit, "", "", ""].map(str::to_owned);
                    return [parameter.name.to_owned()].into_iter().chain(undetermined).collect();
                }
                vec![
                    parameter.name.to_owned(),
                    significant(value),
                    unit.to_owned(),
                    significant(std),
                    significant(value - NORMAL_95 * std),
                    significant(value + NORMAL_95 * std),
                ]
            });
        let gain = 100.0 * found.gain_lower_bound;
        let shown = match &found.impacts {
            Some(play) => sentence(&format!(
                "{}; these hold at least {gain:.0} % of the innovations of the held-out torque",
                impacts(play)
            )),
            None => format!("It takes at least {gain:.0} % of the held-out sum of squares (lower bound at 84 %)."),
        };
        blocks.push(Block::text(format!(
            "{}: {} Chance of a false alarm: {}. {shown}",
            sentence(&named(robot, found.member.candidate.family())).trim_end_matches('.'),
            sentence(about.explanation),
            probability(found.family_wise_p.log10()),
        )));
        blocks.push(Block::table(["parameter", "value", "unit", "std", "95 % from", "to"], rows.collect()));
        if !found.member.is_sized(&diagnosis.scope.criteria.levels) {
            blocks.push(Block::text(sentence(NOT_SIZED)));
        }
        blocks.push(Block::text(format!("Law: {}. Reference: {}", about.equation, sentence(about.reference))));
        blocks.extend(confusions(robot, found, about));
    }
    Section::new("Findings", blocks)
}

/// Effects found that do not matter, where there are any.
pub(super) fn smaller(robot: &Robot, diagnosis: &Diagnosis) -> Option<Section> {
    let rows: Vec<Vec<String>> = diagnosis
        .minor
        .iter()
        .map(|minor| {
            let candidate = &minor.found.member.candidate;
            let (joint, size) = largest(minor);
            vec![
                named(robot, candidate.family()),
                format!("{} {} on {}", significant(size), robot.joints[joint].effort_unit(), robot.joints[joint].name),
                minor.failed.gate.reason().to_owned(),
                format!("{} (threshold {})", significant(minor.failed.value), significant(minor.failed.threshold)),
            ]
        })
        .collect();
    let text = "Effects that pass the tests of the search and are not reported as findings: they are not in the extended model.";
    (!rows.is_empty()).then(|| {
        let table = Block::table(["effect", "size", "why", "value"], rows);
        Section::new("Smaller effects", vec![Block::text(text), table])
    })
}

/// What else explains the same, or is easily taken for it.
fn confusions(robot: &Robot, found: &Found, about: &About) -> Vec<Block> {
    let how = |name: &str| about.rivals.iter().find(|rival| rival.name == name).map_or("", |rival| rival.how_to_tell);
    if !found.alternatives.is_empty() {
        let rows = found.alternatives.iter().map(|other| {
            vec![
                named(robot, other.family),
                significant(other.relative_likelihood),
                how(other.family.effect).to_owned(),
            ]
        });
        return vec![
            Block::text("Not separable from it on these logs:"),
            Block::table(["alternative", "relative likelihood", "how to separate"], rows.collect()),
        ];
    }
    let rivals = about.rivals.iter().map(|rival| vec![spaced(rival.name), rival.how_to_tell.to_owned()]);
    let rivals: Vec<Vec<String>> = rivals.collect();
    match rivals.is_empty() {
        true => Vec::new(),
        false => vec![
            Block::text("No other effect of the library explains these logs as well. It is easily taken for:"),
            Block::table(["effect", "how to separate"], rivals),
        ],
    }
}
