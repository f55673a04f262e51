//! `report.html`: one file that can be sent, read offline and on a phone, in light and dark. The verdict comes first, in
//! words, then what it rests on.
//!
//! A [`Page`] is data: a verdict and sections of blocks; [`Page::render`] makes the file. [`run`], [`measured`],
//! [`diagnosis`], [`stopped`], [`montecarlo`] and [`paper`] fill it; [`evidence`] draws what a residual looks like over time,
//! velocity, position and frequency.

pub(crate) mod diagnosis;
pub(crate) mod evidence;
pub(crate) mod measured;
pub(crate) mod montecarlo;
pub(crate) mod paper;
pub(crate) mod provenance;
pub(crate) mod run;
pub(crate) mod stopped;

pub(crate) use provenance::Provenance;

use super::svg::chart::{Chart, Mark};
use super::svg::{Color, STYLE};
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Name of the report in a results folder.
pub(crate) const FILE: &str = "report.html";

/// Length of a cell from which on it is a sentence.
const PROSE: usize = 40;

const CSS: &str = include_str!("report.css");

/// Whether a verdict is good news.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tone {
    /// Nothing is wrong.
    Good,
    /// Something was found.
    Warn,
    /// Something is wrong, and why is not known.
    Bad,
}

/// A report.
#[derive(Debug, Clone)]
pub(crate) struct Page {
    /// What kind of report on what: "Diagnosis of irb1600".
    pub kind: String,
    /// The verdict in one sentence.
    pub verdict: String,
    /// Whether it is good news.
    pub tone: Tone,
    /// Sentences that carry the verdict.
    pub lead: Vec<String>,
    /// What to do next, where that is known.
    pub next: Option<String>,
    /// The evidence.
    pub sections: Vec<Section>,
    /// How the report came to be.
    pub provenance: Provenance,
}

/// A heading with what stands under it.
#[derive(Debug, Clone)]
pub(crate) struct Section {
    /// The heading.
    pub heading: String,
    /// What stands under it.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone)]
pub(crate) enum Block {
    /// A paragraph.
    Text(String),
    /// Sentences, one below the other.
    List(Vec<String>),
    /// A table; columns of numbers are set right.
    Table {
        /// Heads of the columns.
        header: Vec<String>,
        /// Cells, row by row.
        rows: Vec<Vec<String>>,
    },
    /// Charts side by side under one legend.
    Charts {
        /// What the lines are.
        legend: Vec<(String, Color, Mark)>,
        /// The charts.
        charts: Vec<Chart>,
    },
    /// A whole SVG figure with its own style, too wide for a phone: it scrolls by itself.
    Figure(String),
    /// Markdown with tables.
    Markdown(String),
    /// Blocks that are folded away under a line.
    Folded(String, Vec<Block>),
}

impl Section {
    /// A section with its blocks.
    pub(crate) fn new(heading: impl Into<String>, blocks: Vec<Block>) -> Self {
        Section { heading: heading.into(), blocks }
    }
}

impl Block {
    /// A paragraph.
    pub(crate) fn text(text: impl Into<String>) -> Self {
        Block::Text(text.into())
    }

    /// A table.
    pub(crate) fn table<H: Into<String>>(header: impl IntoIterator<Item = H>, rows: Vec<Vec<String>>) -> Self {
        Block::Table { header: header.into_iter().map(Into::into).collect(), rows }
    }

    fn render(&self) -> Markup {
        match self {
            Block::Text(text) => html! { p { (text) } },
            Block::List(items) => html! { ul { @for item in items { li { (item) } } } },
            Block::Table { header, rows } => table(header, rows),
            Block::Charts { legend, charts } => html! {
                figure {
                    div.legend { @for (name, color, mark) in legend { span { (key(*color, *mark)) (name) } } }
                    div.charts { @for chart in charts { (PreEscaped(chart.to_svg())) } }
                }
            },
            Block::Figure(svg) => html! { div.wide { (PreEscaped(svg)) } },
            Block::Markdown(text) => markdown(text),
            Block::Folded(summary, blocks) => html! {
                details { summary { (summary) } @for block in blocks { (block.render()) } }
            },
        }
    }
}

impl Page {
    /// The page as a file.
    pub(crate) fn render(&self) -> String {
        let tone = match self.tone {
            Tone::Good => "good",
            Tone::Warn => "warn",
            Tone::Bad => "bad",
        };
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width,initial-scale=1";
                    // Browsers ask for an icon where none is named.
                    link rel="icon" href="data:,";
                    title { (self.kind) }
                    style { (PreEscaped(CSS)) (PreEscaped(STYLE)) }
                }
                body {
                    header {
                        p.kind { (self.kind) }
                        h1 class=(tone) { (self.verdict) }
                        div.lead { @for sentence in &self.lead { p { (sentence) } } }
                        @if let Some(next) = &self.next { p.next { strong { "Next: " } (next) } }
                        nav { @for (index, section) in self.sections.iter().enumerate() {
                            a href={ "#s" (index) } { (section.heading) }
                        } }
                    }
                    main { @for (index, section) in self.sections.iter().enumerate() {
                        section id={ "s" (index) } {
                            h2 { (section.heading) }
                            @for block in &section.blocks { (block.render()) }
                        }
                    } }
                    footer { (self.provenance.render()) }
                }
            }
        };
        page.into_string()
    }
}

fn table(header: &[String], rows: &[Vec<String>]) -> Markup {
    let numeric = |column: usize| -> bool {
        let mut cells = rows.iter().filter_map(|row| row.get(column)).filter(|cell| !matches!(cell.as_str(), "" | "-"));
        column > 0 && cells.all(|cell| cell.split_whitespace().next().is_some_and(is_number))
    };
    // Sentences keep a readable width where the table is wider than the page.
    let prose = |column: usize| rows.iter().any(|row| row.get(column).is_some_and(|cell| cell.len() > PROSE));
    let class = |column: usize| match (numeric(column), prose(column)) {
        (true, _) => Some("number"),
        (false, true) => Some("prose"),
        (false, false) => None,
    };
    let classes: Vec<Option<&str>> = (0..header.len()).map(class).collect();
    html! {
        div.table { table {
            thead { tr { @for (cell, class) in header.iter().zip(&classes) { th class=[class] { (cell) } } } }
            tbody { @for row in rows {
                tr { @for (cell, class) in row.iter().zip(&classes) { td class=[class] { (cell) } } }
            } }
        } }
    }
}

fn is_number(word: &str) -> bool {
    word.trim_start_matches(['<', '±', '−']).parse::<f64>().is_ok()
}

/// A short stroke for the legend.
fn key(color: Color, mark: Mark) -> Markup {
    let class = format!("line c{}", color as usize);
    let (path, width, dashes) = match mark {
        Mark::Points => ("M3,5h0M10,3h0M16,7h0M24,4h0", 4.0, None),
        Mark::Line(width) => ("M0,5h30", width.max(2.0), None),
        Mark::Dashed(width) => ("M0,5h30", width.max(1.5), Some("5 3")),
    };
    html! {
        svg.ts-figure viewBox="0 0 30 10" aria-hidden="true" {
            path class=(class) d=(path) stroke-width=(width) stroke-dasharray=[dashes] stroke-linecap=[(mark == Mark::Points).then_some("round")] {}
        }
    }
}

fn markdown(text: &str) -> Markup {
    let parser = pulldown_cmark::Parser::new_ext(text, pulldown_cmark::Options::ENABLE_TABLES);
    let mut rendered = String::new();
    pulldown_cmark::html::push_html(&mut rendered, parser);
    // Headings of the text stand below those of the page; wide tables scroll by themselves.
    let rendered = rendered.replace("<h2>", "<h3>").replace("</h2>", "</h3>");
    let rendered = rendered.replace("<table>", "<div class=\"table\"><table>").replace("</table>", "</table></div>");
    PreEscaped(rendered)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::svg::chart::Trace;

    fn page() -> Page {
        let trace = Trace { mark: Mark::Points, color: Color::Blue, x: vec![0.0, 1.0], y: vec![1.0, 2.0] };
        let chart = Chart { title: "joint <1>".into(), traces: vec![trace], ..Default::default() };
        Page {
            kind: "Test of <escaping>".into(),
            verdict: "a < b & c".into(),
            tone: Tone::Good,
            lead: vec!["because".into()],
            next: Some("again".into()),
            sections: vec![Section::new(
                "Numbers",
                vec![
                    Block::table(["name", "value", "word"], vec![vec!["a".into(), "1.5 N m".into(), "x".into()]]),
                    Block::Charts { legend: vec![("measured".into(), Color::Blue, Mark::Points)], charts: vec![chart] },
                    Block::Folded("more".into(), vec![Block::List(vec!["one".into()])]),
                    Block::Markdown("## T\n\n| a |\n|---|\n| 1 |\n".into()),
                ],
            )],
            provenance: Provenance::of(["tauscope", "run"], Some(7)),
        }
    }

    #[test]
    fn text_is_escaped_and_numbers_are_right() {
        let text = page().render();
        assert!(text.contains("a &lt; b &amp; c") && text.contains("joint &lt;1&gt;"), "{text}");
        assert!(text.contains("<td class=\"number\">1.5 N m</td>") && text.contains("<td>x</td>"), "{text}");
        assert!(text.contains("<h3>T</h3>") && text.contains("<td>1</td>"));
        assert!(text.contains("tauscope run") && text.contains('7'));
    }

    #[test]
    fn nothing_is_loaded_from_elsewhere() {
        let text = page().render();
        for load in ["src=", "url(", "@import", "<script", "href=\"http"] {
            assert!(!text.contains(load), "{load}");
        }
    }
}
