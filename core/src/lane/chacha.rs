//! Sixteen blocks of ChaCha with eight rounds side by side in AVX-512 (D. J. Bernstein, ChaCha, a variant of Salsa20, 2008).
//!
//! A register holds the same word of every block, so that the rounds need no shuffling; in the end registers are turned into
//! rows, as the blocks follow each other.

use std::arch::x86_64::*;

/// Numbers of 64 bits in sixteen blocks.
pub(super) const WORDS: usize = 128;

/// The key stream of sixteen blocks from the first one's starting words, of which number 12 is the lower half of the counter
/// and has room for sixteen.
#[target_feature(enable = "avx512f")]
pub(super) fn blocks(start: &[u32; 16], out: &mut [u64; WORDS]) {
    let mut first = [_mm512_setzero_si512(); 16];
    for (words, &word) in first.iter_mut().zip(start) {
        *words = _mm512_set1_epi32(word.cast_signed());
    }
    let numbers = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    first[12] = _mm512_add_epi32(first[12], numbers);
    let mut x = first;
    for _ in 0..4 {
        // Columns, then diagonals.
        quarter(&mut x, 0, 4, 8, 12);
        quarter(&mut x, 1, 5, 9, 13);
        quarter(&mut x, 2, 6, 10, 14);
        quarter(&mut x, 3, 7, 11, 15);
        quarter(&mut x, 0, 5, 10, 15);
        quarter(&mut x, 1, 6, 11, 12);
        quarter(&mut x, 2, 7, 8, 13);
        quarter(&mut x, 3, 4, 9, 14);
    }
    for (words, first) in x.iter_mut().zip(first) {
        *words = _mm512_add_epi32(*words, first);
    }
    // Two words of a block side by side; blocks 0, 1, 4, 5, ... first, then those between.
    let (mut some, mut others) = ([first[0]; 8], [first[0]; 8]);
    for (pair, (some, others)) in some.iter_mut().zip(&mut others).enumerate() {
        *some = _mm512_unpacklo_epi32(x[2 * pair], x[2 * pair + 1]);
        *others = _mm512_unpackhi_epi32(x[2 * pair], x[2 * pair + 1]);
    }
    for (between, columns) in [(0, some), (2, others)] {
        for (row, words) in rows(columns).into_iter().enumerate() {
            let block = 4 * (row / 2) + row % 2 + between;
            let target = &mut out[8 * block..][..8];
            // SAFETY: the slice has the eight numbers that are written.
            unsafe { _mm512_storeu_si512(target.as_mut_ptr().cast(), words) }
        }
    }
}

/// A quarter of a round.
#[inline]
#[target_feature(enable = "avx512f")]
fn quarter(x: &mut [__m512i; 16], a: usize, b: usize, c: usize, d: usize) {
    x[a] = _mm512_add_epi32(x[a], x[b]);
    x[d] = _mm512_rol_epi32::<16>(_mm512_xor_si512(x[d], x[a]));
    x[c] = _mm512_add_epi32(x[c], x[d]);
    x[b] = _mm512_rol_epi32::<12>(_mm512_xor_si512(x[b], x[c]));
    x[a] = _mm512_add_epi32(x[a], x[b]);
    x[d] = _mm512_rol_epi32::<8>(_mm512_xor_si512(x[d], x[a]));
    x[c] = _mm512_add_epi32(x[c], x[d]);
    x[b] = _mm512_rol_epi32::<7>(_mm512_xor_si512(x[b], x[c]));
}

/// The rows of eight columns of eight numbers.
#[inline]
#[target_feature(enable = "avx512f")]
fn rows(columns: [__m512i; 8]) -> [__m512i; 8] {
    let mut rows = columns;
    for odd in 0..2 {
        let mut pairs = [columns[0]; 4];
        for (k, pair) in pairs.iter_mut().enumerate() {
            let (one, other) = (columns[2 * k], columns[2 * k + 1]);
            *pair = if odd == 0 { _mm512_unpacklo_epi64(one, other) } else { _mm512_unpackhi_epi64(one, other) };
        }
        let [a, b, c, d] = pairs;
        let (ab, cd) = (_mm512_shuffle_i64x2::<0x88>(a, b), _mm512_shuffle_i64x2::<0x88>(c, d));
        rows[odd] = _mm512_shuffle_i64x2::<0x88>(ab, cd);
        rows[odd + 4] = _mm512_shuffle_i64x2::<0xdd>(ab, cd);
        let (ab, cd) = (_mm512_shuffle_i64x2::<0xdd>(a, b), _mm512_shuffle_i64x2::<0xdd>(c, d));
        rows[odd + 2] = _mm512_shuffle_i64x2::<0x88>(ab, cd);
        rows[odd + 6] = _mm512_shuffle_i64x2::<0xdd>(ab, cd);
    }
    rows
}
