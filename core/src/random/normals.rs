//! Standard normal numbers in bulk: bit for bit those that `rand_distr` draws one at a time.
//!
//! Its ziggurat (G. Marsaglia and W. W. Tsang, The ziggurat method for generating random variables, J. Statistical Software
//! 5(8), 2000, in the variant of J. A. Doornik, An improved ziggurat method to generate normal random samples, 2005) stacks
//! layers of equal area under the density. A word chooses a layer and a place in it, and in 99 of 100 cases that place lies
//! under the layer above, so that the number is found. Here this test is made for several words at once without branches;
//! the words that fail it go to `rand_distr`.

use super::words::Words;
use crate::lane::Lanes;
use rand::rand_core::Infallible;
use rand::{Rng, TryRng};
use rand_distr::{Distribution, StandardNormal};
use std::sync::LazyLock;

/// Layers of the ziggurat.
const LAYERS: usize = 256;

/// Words that are tested at once.
const TOGETHER: usize = 8;

/// Half-breadths of the layers from the lowest to that above the highest, which has none.
type Edges = [f64; LAYERS + 1];

static EDGES: LazyLock<Edges> = LazyLock::new(|| {
    let mut edges = [0.0; LAYERS + 1];
    for (layer, edge) in edges.iter_mut().enumerate().take(LAYERS) {
        // The word for half of a layer's breadth, which is under the density in every layer.
        let half: f64 = StandardNormal.sample(&mut OneWord(Some(0xC000_0000_0000_0000 | layer as u64)));
        *edge = 2.0 * half;
    }
    edges
});

/// Standard normal numbers from a random stream.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::random;
///
/// // The same seed, label and index give the same noise; another index gives other noise.
/// let draw = |index| {
///     let mut noise = [0.0; 1000];
///     random::normals(7, "torque", index).fill(&mut noise);
///     noise
/// };
/// assert_eq!(draw(0), draw(0));
/// assert_ne!(draw(0), draw(1));
/// let power = draw(0).iter().map(|value| value * value).sum::<f64>() / 1000.0;
/// assert!((power - 1.0).abs() < 0.2);
/// ```
#[derive(Debug)]
pub struct Normals {
    words: Words,
}

impl Normals {
    pub(super) fn new(key: [u8; 32]) -> Self {
        Normals { words: Words::new(Lanes::best(), key) }
    }

    /// The next numbers, as many as `out` has places.
    pub fn fill(&mut self, out: &mut [f64]) {
        let mut done = 0;
        while done < out.len() {
            let ahead = self.words.ahead();
            let count = ahead.len().min(out.len() - done);
            let found = quick(&EDGES, &ahead[..count], &mut out[done..done + count]);
            self.words.skip(found);
            done += found;
            if found < count {
                out[done] = StandardNormal.sample(&mut self.words);
                done += 1;
            }
        }
    }
}

/// Writes the numbers of the words up to the first one that does not pass the test; how many they are.
fn quick(edges: &Edges, words: &[u64], out: &mut [f64]) -> usize {
    let (groups, rest) = words.as_chunks::<TOGETHER>();
    let (outs, last) = out.as_chunks_mut::<TOGETHER>();
    let mut found = 0;
    for (words, out) in groups.iter().zip(outs) {
        let mut failed = 0u32;
        for (k, (&word, out)) in words.iter().zip(out).enumerate() {
            let (number, passed) = tested(edges, word);
            *out = number;
            failed |= u32::from(!passed) << k;
        }
        if failed != 0 {
            return found + failed.trailing_zeros() as usize;
        }
        found += TOGETHER;
    }
    for (&word, out) in rest.iter().zip(last) {
        let (number, passed) = tested(edges, word);
        if !passed {
            break;
        }
        *out = number;
        found += 1;
    }
    found
}

/// The number of a word, and whether it is surely under the density.
#[inline(always)]
fn tested(edges: &Edges, word: u64) -> (f64, bool) {
    let layer = (word & 0xff) as usize;
    // The upper 52 bits as the fraction of a number from 2 to 4.
    let place = f64::from_bits((word >> 12) | 0x4000_0000_0000_0000) - 3.0;
    let number = place * edges[layer];
    (number, number.abs() < edges[layer + 1])
}

/// One word, then words of ones.
struct OneWord(Option<u64>);

impl TryRng for OneWord {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.next_u64() as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.0.take().unwrap_or(u64::MAX))
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        bytes.fill_with(|| self.next_u64() as u8);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    #[test]
    fn numbers_are_those_drawn_one_at_a_time() {
        for (index, part) in [1, 7, 8, 255, 1000, 30_000].into_iter().enumerate() {
            let mut one = random::stream(5, "normals", index as u64);
            let mut bulk = random::normals(5, "normals", index as u64);
            let mut out = vec![0.0; part];
            let (mut outer, mut tail) = (0, 0);
            for _ in 0..200_000 / part {
                bulk.fill(&mut out);
                for own in &out {
                    let other: f64 = StandardNormal.sample(&mut one);
                    assert_eq!(own.to_bits(), other.to_bits(), "{own} {other}");
                    outer += usize::from(own.abs() > 3.0);
                    tail += usize::from(own.abs() > EDGES[1]);
                }
            }
            // 2.7e-3 and 2.6e-4 of the numbers: every way through the ziggurat was taken.
            assert!((400..700).contains(&outer) && (20..100).contains(&tail), "{outer} {tail}");
        }
    }

    #[test]
    fn edges_fall_from_layer_to_layer_and_hold_equal_areas() {
        let density = |x: f64| (-0.5 * x * x).exp();
        assert_eq!(EDGES[LAYERS], 0.0);
        let area = |k: usize| EDGES[k] * (density(EDGES[k + 1]) - density(EDGES[k]));
        for k in 1..LAYERS {
            assert!(EDGES[k] > EDGES[k + 1]);
            assert!((area(k) / area(1) - 1.0).abs() < 1e-9, "{k}: {} {}", area(k), area(1));
        }
    }
}
