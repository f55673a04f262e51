//! Comments above the header.

use super::cells::number;
use super::separators::SEPARATORS;

/// Lines above the header that begin with `#` or `%` become blank, so that places in the file stay what they are. Where
/// numbers follow the last of them, as numpy writes it, it is the header.
pub(super) fn blank_comments(bytes: &mut [u8]) {
    let mut start = 0;
    while matches!(bytes.get(start), Some(b'#' | b'%')) {
        let line = |from: usize| from + bytes[from..].iter().take_while(|byte| **byte != b'\n').count();
        let end = line(start);
        let next = (end + 1).min(bytes.len());
        let below = &bytes[next..line(next)];
        let cells = || below.split(|byte| SEPARATORS.contains(byte) || *byte == b' ').filter(|cell| !cell.is_empty());
        // A row of messages holds names and numbers; a comment holds hardly any cell.
        let same = |bytes: &[u8]| bytes.iter().filter(|byte| **byte == b',').count();
        let numbers = cells().all(|cell| number(cell, true).is_some())
            || (same(below) > 0
                && same(below) == same(&bytes[start..end])
                && cells().next().is_some_and(|cell| number(cell, false).is_some()));
        if numbers {
            bytes[start] = b' ';
        } else {
            bytes[start..end].fill(b'\r');
        }
        start = next;
    }
}
