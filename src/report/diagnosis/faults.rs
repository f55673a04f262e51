//! Faults of the data in a line each, and the lines where they forbid an answer.

use crate::diagnosis::{Consequence, DataFault};
use crate::internal::diagnosis::remedy;
use crate::quality::with_logs;

/// Faults of the data that are listed one by one.
const FAULTS: usize = 6;

/// The lines where faults of the data forbid an answer.
pub(crate) fn stopped_lines(faults: &[DataFault]) -> String {
    let mut lines = vec!["The logs cannot be diagnosed: any effect named from them would be wrong.".to_owned()];
    lines.extend(fault_lines(faults));
    lines.push(format!("Next: {}.", remedy(faults)));
    lines.join("\n")
}

/// A line for each of the first faults.
pub(super) fn fault_lines(faults: &[DataFault]) -> Vec<String> {
    let each = faults.iter().map(|fault| (&fault.log[..], (fault.consequence, &fault.place[..], &fault.text[..])));
    let each = with_logs(each);
    let mut lines: Vec<String> = each
        .iter()
        .take(FAULTS)
        .map(|(logs, (consequence, place, text))| {
            let what = match consequence {
                Consequence::Stops => "Fault of the data",
                Consequence::Doubts => "Doubt",
                Consequence::LeftOut => "Left out",
                Consequence::Noted => "Note",
                Consequence::Corrected => "Corrected",
            };
            format!("{what}: {}: {place}: {text}", logs.join(", "))
        })
        .collect();
    if each.len() > FAULTS {
        lines.push(format!("... and {} more faults; diagnosis.json lists all", each.len() - FAULTS));
    }
    lines
}
