//! Every candidate with its test, and how small what was not found would have to be.

use super::words::{named, probability, spaced};
use crate::diagnosis::{Diagnosis, Family};
use crate::effects;
use crate::report::console::significant;
use crate::report::html::{Block, Section};
use crate::robot::Robot;

/// Candidates that stand in the table that is not folded away.
const RANKED: usize = 12;

/// The first scan, the likeliest candidate first.
pub(super) fn ranked(robot: &Robot, diagnosis: &Diagnosis) -> Section {
    let row = |(index, ranked): (usize, &crate::diagnosis::Ranked)| {
        vec![
            (index + 1).to_string(),
            named(robot, ranked.family),
            significant(ranked.statistic),
            ranked.freedom.to_string(),
            probability(ranked.log_p / std::f64::consts::LN_10),
            status(diagnosis, ranked.family).to_owned(),
        ]
    };
    let rows: Vec<Vec<String>> = diagnosis.evidence.ranking.iter().enumerate().map(row).collect();
    let header = ["rank", "candidate", "statistic", "degrees of freedom", "chance without it", "verdict"];
    let (first, rest) = rows.split_at(RANKED.min(rows.len()));
    let mut blocks = vec![
        Block::text(
            "The first scan: every effect at every place, added to the re-identified model, before anything was found. The \
             statistic is chi-square with its degrees of freedom where the effect is absent. Several are large when one \
             effect is there, because their torques resemble each other; the model comparison decides.",
        ),
        Block::table(header, first.to_vec()),
    ];
    if !rest.is_empty() {
        blocks.push(Block::Folded(format!("The other {}", rest.len()), vec![Block::table(header, rest.to_vec())]));
    }
    Section::new("Candidates, ranked", blocks)
}

fn status(diagnosis: &Diagnosis, family: Family) -> &'static str {
    if diagnosis.found.iter().any(|found| found.member.candidate.family() == family) {
        return "found";
    }
    let alternatives = diagnosis.found.iter().flat_map(|found| &found.alternatives);
    if alternatives.into_iter().any(|other| other.family == family) { "alternative" } else { "" }
}

/// Smallest sizes that would have been found, effects down, joints across.
pub(super) fn not_found(robot: &Robot, diagnosis: &Diagnosis) -> Section {
    let mut names: Vec<&str> = diagnosis.not_found.iter().map(|missed| missed.family.effect).collect();
    names.dedup();
    let rows = names.iter().map(|&name| {
        let mut units: Vec<&str> =
            diagnosis.not_found.iter().filter(|m| m.family.effect == name).map(|m| m.unit).collect();
        units.sort_unstable();
        units.dedup();
        let unit = units.join(" or ");
        let parameter = effects::find(name).ok().and_then(|effect| effect.parameters().first());
        let cell = |joint: usize| {
            let missed = diagnosis.not_found.iter().find(|missed| missed.family == Family { effect: name, joint });
            missed.map_or("".to_owned(), |missed| missed.minimum_detectable.map_or("-".to_owned(), significant))
        };
        let about = parameter.map_or(String::new(), |parameter| format!(", {}", parameter.name));
        let head = [format!("{}{about}", spaced(name)), unit];
        head.into_iter().chain((0..robot.dof()).map(cell)).collect()
    });
    let header = ["effect and its parameter".to_owned(), "unit".to_owned()].into_iter().chain(robot.joint_names());
    let rows: Vec<Vec<String>> = rows.collect();
    Section::new(
        "Not found, and how small it would have to be",
        vec![
            Block::text(
                "The smallest size that would have been found with a probability of 80 % on these logs. A dash: these logs \
                 do not separate it from the model. An effect of the whole arm, or between two joints, stands under its first.",
            ),
            Block::Folded(
                format!("Minimum detectable sizes of {} effects", rows.len()),
                vec![Block::table(header, rows)],
            ),
        ],
    )
}
