//! What separates the cells of a table.

/// What may stand between two cells, besides blanks.
pub(super) const SEPARATORS: [u8; 4] = [b',', b';', b'\t', b'|'];

/// What separates the cells: the most frequent in the first line with content; None where there is none of them. Spreadsheets
/// of countries that write numbers with a comma put semicolons between them.
pub(super) fn separator(bytes: &[u8]) -> Option<u8> {
    let mut lines = bytes.split(|byte| matches!(byte, b'\r' | b'\n'));
    let header = lines.find(|line| !line.trim_ascii().is_empty()).unwrap_or_default().trim_ascii();
    let count = |separator: u8| header.iter().filter(|byte| **byte == separator).count();
    let best = SEPARATORS.into_iter().rev().max_by_key(|&separator| count(separator))?;
    (count(best) > 0 || !header.contains(&b' ')).then_some(if count(best) > 0 { best } else { b',' })
}

/// Turns the blanks between cells into tabs, line for line, as `numpy.savetxt` and others write tables.
pub(super) fn blanks_to_tabs(bytes: &mut Vec<u8>) -> u8 {
    let mut out = Vec::with_capacity(bytes.len());
    for (index, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
        if index > 0 {
            out.push(b'\n');
        }
        let mut blank = false;
        for &byte in line.trim_ascii() {
            match byte {
                b' ' | b'\t' => blank = true,
                _ => {
                    if std::mem::take(&mut blank) {
                        out.push(b'\t');
                    }
                    out.push(byte);
                }
            }
        }
    }
    *bytes = out;
    b'\t'
}
