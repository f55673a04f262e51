//! Noise levels, smoothing and estimators: their names and looks.

use crate::report::montecarlo::size;
use crate::report::svg::Color;
use crate::report::svg::chart::Mark;
use crate::study::montecarlo::{Cell, Summary};
use crate::study::testbed::Variant;

/// Looks of the estimators, in their order.
const LOOKS: [(Color, Mark); 7] = [
    (Color::Blue, Mark::Line(2.0)),
    (Color::Orange, Mark::Line(2.0)),
    (Color::Green, Mark::Line(2.0)),
    (Color::Purple, Mark::Line(2.0)),
    (Color::Blue, Mark::Dashed(2.0)),
    (Color::Orange, Mark::Dashed(2.0)),
    (Color::Green, Mark::Dashed(2.0)),
];

pub(super) fn levels(summary: &Summary) -> u32 {
    summary.cells.iter().map(|cell| cell.noise_level + 1).max().unwrap_or(0)
}

/// A smoothing in words.
pub(super) fn smoothing(signals: Variant, window: u32) -> String {
    match signals {
        Variant::SavitzkyGolay => format!("a window of {window} samples"),
        Variant::Butterworth => "the Butterworth low-pass".to_owned(),
        Variant::Raw | Variant::Exact => "no smoothing".to_owned(),
    }
}

/// A noise level in words.
pub(super) fn level(cell: &Cell) -> String {
    match (cell.encoder_rad, cell.torque_nm) {
        (None, None) => "the scenario's noise".to_owned(),
        (Some(q), None) => format!("{} rad of noise", size(q)),
        (None, Some(tau)) => format!("{} N m of noise", size(tau)),
        (Some(q), Some(tau)) => format!("{} rad and {} N m of noise", size(q), size(tau)),
    }
}

pub(super) fn estimators(summary: &Summary) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for cell in &summary.cells {
        if !names.contains(&cell.estimator.as_str()) {
            names.push(&cell.estimator);
        }
    }
    names
}

pub(super) fn legend(summary: &Summary) -> Vec<(String, Color, Mark)> {
    let named = estimators(summary).into_iter().zip(LOOKS.iter().cycle());
    named.map(|(name, &(color, mark))| (name.to_owned(), color, mark)).collect()
}
