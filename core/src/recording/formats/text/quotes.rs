//! Quotes that are not closed.

/// Stands for the quotes of a line in which one is not closed.
pub(super) const OPEN_QUOTE: u8 = 0x01;

/// A quote that is not closed would swallow all lines up to the next one: no cell of a log goes over several lines, so
/// that such a line is broken, and its quotes are none.
pub(super) fn without_open_quotes(bytes: &mut [u8]) {
    if !bytes.contains(&b'"') {
        return;
    }
    for line in bytes.split_mut(|&byte| byte == b'\n') {
        if line.iter().filter(|&&byte| byte == b'"').count() % 2 == 1 {
            line.iter_mut().filter(|byte| **byte == b'"').for_each(|byte| *byte = OPEN_QUOTE);
        }
    }
}
