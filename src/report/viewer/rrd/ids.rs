//! Identities of recordings, rows and views.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::time::{SystemTime, UNIX_EPOCH};

/// Gives out identities that no other file has: recordings with the same identity are one recording to the viewer.
///
/// Nothing that is shown depends on these numbers, so they need no recorded seed.
#[derive(Debug)]
pub(crate) struct Ids {
    start: u64,
    file: u64,
    next: u64,
}

impl Ids {
    /// Identities of a new file.
    pub(crate) fn new() -> Self {
        let start = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_nanos() as u64);
        Ids { start, file: RandomState::new().build_hasher().finish(), next: 0 }
    }

    /// When the file was begun, ns since 1970.
    pub(crate) fn start(&self) -> i64 {
        self.start as i64
    }

    /// The id of a row, a chunk or a message: the later of two is the greater.
    pub(crate) fn row(&mut self) -> u128 {
        self.next += 1;
        // Half the range is left for the rows of the file.
        u128::from(self.start) << 64 | u128::from(self.file / 2 + self.next)
    }

    /// The id of a recording or a view.
    pub(crate) fn other(&mut self) -> u128 {
        self.next += 1;
        u128::from(self.file) << 64 | u128::from(self.next)
    }
}

/// An identity as the viewer writes it in paths.
pub(crate) fn uuid(id: u128) -> String {
    let hex = format!("{id:032x}");
    [&hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..]].join("-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identities_differ_within_a_file_and_between_files() {
        let (mut one, mut other) = (Ids::new(), Ids::new());
        let rows = [one.row(), one.row(), one.row()];
        assert!(rows.is_sorted_by(|a, b| a < b));
        assert_ne!(one.row(), other.row());
        assert_ne!(one.other(), one.other());
        assert_ne!(one.other(), other.other());
    }

    #[test]
    fn paths_have_the_usual_groups() {
        assert_eq!(uuid(0x0123_4567_89ab_cdef_0123_4567_89ab_cdef), "01234567-89ab-cdef-0123-456789abcdef");
        assert_eq!(uuid(1), "00000000-0000-0000-0000-000000000001");
    }
}
