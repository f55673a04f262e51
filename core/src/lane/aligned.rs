//! Numbers that start where a line of the cache does, so that a load of the widest lanes never touches two lines.

use std::ops::{Deref, DerefMut};

/// Bytes in a line of the cache, and in the widest register.
const LINE: usize = 64;

/// A run of numbers whose first one starts a line of the cache.
#[derive(Debug)]
pub(crate) struct Aligned {
    /// The numbers with room to move them up to where a line starts.
    values: Vec<f64>,
    first: usize,
    len: usize,
}

impl Aligned {
    /// So many zeros.
    pub(crate) fn zeros(len: usize) -> Self {
        let values = vec![0.0; len + LINE / size_of::<f64>() - 1];
        // Where the alignment is not known, the numbers are as good unaligned.
        let first = values.as_ptr().align_offset(LINE).min(values.len() - len);
        Aligned { values, first, len }
    }
}

impl Clone for Aligned {
    fn clone(&self) -> Self {
        // The copy lies elsewhere, and its lines start elsewhere in it.
        let mut copy = Aligned::zeros(self.len);
        copy.copy_from_slice(self);
        copy
    }
}

impl Deref for Aligned {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.values[self.first..][..self.len]
    }
}

impl DerefMut for Aligned {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values[self.first..][..self.len]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_start_a_line_in_copies_too() {
        for len in [0, 1, 7, 8, 1000] {
            let mut own = Aligned::zeros(len);
            own.iter_mut().enumerate().for_each(|(k, x)| *x = k as f64);
            let copy = own.clone();
            for run in [&own, &copy] {
                assert_eq!(run.len(), len);
                assert_eq!(run.as_ptr() as usize % LINE, 0);
                assert!(run.iter().enumerate().all(|(k, &x)| x == k as f64));
            }
        }
    }
}
