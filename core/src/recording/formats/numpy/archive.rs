//! ZIP archives.

use std::io::Read;

/// A file in a ZIP archive.
pub(super) struct Entry {
    pub name: String,
    method: u16,
    size: usize,
    unpacked: usize,
    offset: usize,
}

impl Entry {
    /// The unpacked content; none where it is cut off or packed in another way.
    pub(super) fn content(&self, bytes: &[u8]) -> Option<Vec<u8>> {
        let header = bytes.get(self.offset..self.offset + 30)?;
        let start = self.offset + 30 + half(header, 26)? + half(header, 28)?;
        let packed = bytes.get(start..start.checked_add(self.size)?)?;
        match self.method {
            0 => Some(packed.to_vec()),
            8 => {
                let mut out = Vec::new();
                flate2::read::DeflateDecoder::new(packed).take(self.unpacked as u64).read_to_end(&mut out).ok()?;
                Some(out)
            }
            _ => None,
        }
    }
}

/// The files of a ZIP archive, from the directory at its end; None where it has none.
pub(super) fn entries(bytes: &[u8]) -> Option<Vec<Entry>> {
    let end = bytes.windows(4).rposition(|window| window == b"PK\x05\x06")?;
    let end = &bytes[end..];
    let (count, mut at) = (half(end, 10)?, word(end, 16)?);
    let mut out = Vec::new();
    for _ in 0..count {
        let entry = bytes.get(at..)?;
        if !entry.starts_with(b"PK\x01\x02") {
            return None;
        }
        let lengths = [half(entry, 28)?, half(entry, 30)?, half(entry, 32)?];
        out.push(Entry {
            name: String::from_utf8_lossy(entry.get(46..46 + lengths[0])?).into_owned(),
            method: half(entry, 10)? as u16,
            size: word(entry, 20)?,
            unpacked: word(entry, 24)?,
            offset: word(entry, 42)?,
        });
        at += 46 + lengths.iter().sum::<usize>();
    }
    Some(out)
}

fn half(bytes: &[u8], at: usize) -> Option<usize> {
    bytes.get(at..at + 2).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]])))
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize)
}
