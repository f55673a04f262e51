//! The report of the paper's study.

use super::{Block, Page, Provenance, Section, Tone};
use crate::report::paper::Verdict;

/// The report of the paper's study: its verdict, the tables as in `tables.md`, and the figures.
pub(crate) fn page(
    scenario: &str,
    verdict: &Verdict,
    tables: &str,
    figures: &[(&str, String)],
    provenance: Provenance,
) -> Page {
    let (right, wrong) = (verdict.right.len(), verdict.wrong.len());
    // The verdict stands in front of the page already.
    let rest = tables.find("\n## ").map_or(tables, |at| &tables[at..]);
    let rest =
        rest.strip_prefix("\n## Verdict").and_then(|rest| rest.find("\n## ").map(|at| &rest[at..])).unwrap_or(rest);
    let mut sections = vec![
        Section::new("What holds", vec![Block::List(verdict.right.clone())]),
        Section::new("What does not hold", vec![Block::List(verdict.wrong.clone())]),
    ];
    for part in rest.split("\n## ").filter(|part| !part.trim().is_empty()) {
        let (heading, text) = part.split_once('\n').unwrap_or((part, ""));
        sections.push(Section::new(heading.trim(), vec![Block::Markdown(text.to_owned())]));
    }
    let figures = figures.iter().map(|(_, svg)| Block::Figure(svg.clone())).collect();
    sections.push(Section::new("Figures", figures));
    Page {
        kind: format!("The paper's study, reproduced and judged: {scenario}"),
        verdict: format!(
            "Of the paper's claims that were tested, {right} hold{} and {wrong} do{} not.",
            if right == 1 { "s" } else { "" },
            if wrong == 1 { "es" } else { "" }
        ),
        tone: if wrong == 0 { Tone::Good } else { Tone::Warn },
        lead: vec![
            "Ogbemhe, Mpofu and Mokakabye, Robot dynamic model: Freudenstein-based optimal trajectory and parameter \
             identification. Its 78-parameter model is fitted as printed and with the misprints corrected, next to a spatial \
             model of the same arm."
                .to_owned(),
        ],
        next: None,
        sections,
        provenance,
    }
}
