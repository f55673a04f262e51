//! Text in UTF-8 with lines that end in line feeds, from what programs write.

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Bytes of the beginning that show what they are.
const SHOWS: usize = 1000;

/// The text of a file: without a byte order mark, from UTF-16 (as Windows writes "Unicode text") or Latin-1, and with a line feed behind
/// each line where there are carriage returns alone. None of what is no text.
pub(super) fn utf8_lines(mut bytes: Vec<u8>) -> Option<Vec<u8>> {
    if bytes.starts_with(BYTE_ORDER_MARK) {
        bytes.drain(..BYTE_ORDER_MARK.len());
    }
    if let Some(big_endian) = is_utf16(&bytes) {
        bytes = from_utf16(&bytes, big_endian);
    }
    if bytes.iter().take(SHOWS).any(|byte| *byte == 0) {
        return None;
    }
    if !begins_in_utf8(&bytes) {
        bytes = bytes.into_iter().map(char::from).collect::<String>().into_bytes();
    }
    if !bytes.contains(&b'\n') {
        bytes.iter_mut().filter(|byte| **byte == b'\r').for_each(|byte| *byte = b'\n');
    }
    Some(bytes)
}

/// Whether the beginning, where the names stand, is UTF-8; a letter that its end cuts off does not count.
fn begins_in_utf8(bytes: &[u8]) -> bool {
    match std::str::from_utf8(&bytes[..bytes.len().min(SHOWS)]) {
        Ok(_) => true,
        Err(error) => error.error_len().is_none(),
    }
}

/// Whether the bytes are UTF-16, and then whether the larger byte comes first.
fn is_utf16(bytes: &[u8]) -> Option<bool> {
    match bytes {
        [0xFF, 0xFE, ..] => return Some(false),
        [0xFE, 0xFF, ..] => return Some(true),
        _ => {}
    }
    let pairs = bytes[..bytes.len().min(SHOWS)].chunks_exact(2);
    let all = pairs.len();
    // Names and numbers are nearly all ASCII, of which one byte is zero.
    let zeros = |place: usize| pairs.clone().filter(|pair| pair[place] == 0 && pair[1 - place] != 0).count();
    [true, false].into_iter().find(|&big_endian| all > 4 && 10 * zeros(usize::from(!big_endian)) > 9 * all)
}

fn from_utf16(bytes: &[u8], big_endian: bool) -> Vec<u8> {
    let unit = |pair: &[u8]| {
        let pair = [pair[0], pair[1]];
        if big_endian { u16::from_be_bytes(pair) } else { u16::from_le_bytes(pair) }
    };
    let text: String = char::decode_utf16(bytes.chunks_exact(2).map(unit)).map(|c| c.unwrap_or('?')).collect();
    text.trim_start_matches('\u{FEFF}').as_bytes().to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_and_old_macs_write_text_too() {
        let text = "t;q1;tau1\n0,1;2;3 µ\n";
        let utf16 = |big: bool, mark: bool| -> Vec<u8> {
            let units = mark.then_some(0xFEFF).into_iter().chain(text.encode_utf16());
            units.flat_map(|unit| if big { unit.to_be_bytes() } else { unit.to_le_bytes() }).collect()
        };
        for bytes in [utf16(true, true), utf16(false, true), utf16(true, false), utf16(false, false), text.into()] {
            assert_eq!(utf8_lines(bytes).unwrap(), text.as_bytes());
        }
        assert_eq!(utf8_lines(b"\xEF\xBB\xBFt,q1\r0,1\r".to_vec()).unwrap(), b"t,q1\n0,1\n");
        assert_eq!(utf8_lines(b"t,q1\r\n0,1".to_vec()).unwrap(), b"t,q1\r\n0,1");
        assert_eq!(utf8_lines(b"t,q1 [\xB0]\n".to_vec()).unwrap(), "t,q1 [°]\n".as_bytes());
        // What is broken further down does not change the names.
        let mut broken = format!("t,q1 [°]\n{}", "0,1\n".repeat(SHOWS)).into_bytes();
        broken.push(0xB0);
        assert_eq!(utf8_lines(broken.clone()).unwrap(), broken);
        assert_eq!(utf8_lines(vec![1, 0, 0, 0, 7, 0, 0, 0, 9, 9, 0, 0]), None);
    }
}
