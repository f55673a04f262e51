//! Words of a random stream, many at once: those of `ChaCha8Rng`, which makes four blocks side by side where wide lanes make
//! sixteen.

use crate::lane::Lanes;
use chacha20::ChaCha8Rng;
use rand::rand_core::Infallible;
use rand::{Rng, RngExt, SeedableRng, TryRng};

/// Words that are made at once: those of sixteen blocks.
const MADE: usize = 128;

/// The words of one stream, from its start.
#[derive(Debug)]
pub(super) struct Words {
    lanes: Lanes,
    /// Starting words of the next block.
    start: [u32; 16],
    /// The same stream, for lanes that do not make blocks.
    stream: ChaCha8Rng,
    made: [u64; MADE],
    next: usize,
}

impl Words {
    /// The words of the stream with this key.
    pub(super) fn new(lanes: Lanes, key: [u8; 32]) -> Self {
        let mut start = [0; 16];
        let parts = b"expand 32-byte k".chunks_exact(4).chain(key.chunks_exact(4));
        for (word, part) in start.iter_mut().zip(parts) {
            *word = part.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte));
        }
        Words { lanes, start, stream: ChaCha8Rng::from_seed(key), made: [0; MADE], next: MADE }
    }

    /// Words not used yet, at least one.
    pub(super) fn ahead(&mut self) -> &[u64] {
        if self.next == MADE {
            self.make();
            self.next = 0;
        }
        &self.made[self.next..]
    }

    /// Uses up words.
    pub(super) fn skip(&mut self, count: usize) {
        self.next += count;
    }

    fn make(&mut self) {
        if self.lanes.chacha8(&self.start, &mut self.made) {
            let (counter, carried) = self.start[12].overflowing_add(16);
            self.start[12] = counter;
            self.start[13] += u32::from(carried);
        } else {
            self.stream.fill(&mut self.made);
        }
    }
}

impl TryRng for Words {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.next_u64() as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let word = self.ahead()[0];
        self.skip(1);
        Ok(word)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for part in bytes.chunks_mut(size_of::<u64>()) {
            part.copy_from_slice(&self.next_u64().to_le_bytes()[..part.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_generator_in_all_lanes() {
        let key = std::array::from_fn(|k| (37 * k + 11) as u8);
        for lanes in Lanes::available() {
            let (mut own, mut other) = (Words::new(lanes, key), ChaCha8Rng::from_seed(key));
            for word in 0..10 * MADE {
                assert_eq!(own.next_u64(), other.next_u64(), "{lanes:?}: word {word}");
            }
            // The counter's lower half runs over, with words taken in bytes on the way.
            own = Words::new(lanes, key);
            own.start[12] = 16u32.wrapping_neg();
            own.stream.set_word_pos(u128::from(own.start[12]) * 16);
            other.set_word_pos(u128::from(own.start[12]) * 16);
            let (mut bytes, mut others) = ([0; 4096], [0; 4096]);
            own.fill_bytes(&mut bytes);
            other.fill_bytes(&mut others);
            assert_eq!(bytes, others, "{lanes:?}");
        }
    }
}
