//! Noises that were estimated before: a model comparison adds columns on one joint after the other, and the noise of all other joints is
//! asked for again as it was.

use super::joint_whitener::JointWhitener;
use quick_cache::sync::Cache;
use std::hash::{DefaultHasher, Hasher};
use std::sync::Arc;

/// Noises that are kept.
const KEPT: usize = 400;

/// Noises of joints by what they were estimated from. They are functions of that alone: what is remembered changes no number.
#[derive(Debug)]
pub(crate) struct NoiseMemory(Cache<u128, Arc<JointWhitener>>);

impl Default for NoiseMemory {
    fn default() -> Self {
        NoiseMemory(Cache::new(KEPT))
    }
}

impl NoiseMemory {
    /// The noise estimated from these inputs, worked out if it is not known.
    ///
    /// Two threads that ask for the same at once both work it out: one that waits could take up work that waits for itself.
    pub(super) fn get(&self, key: u128, estimate: impl FnOnce() -> JointWhitener) -> Arc<JointWhitener> {
        if let Some(known) = self.0.get(&key) {
            return known;
        }
        let new = Arc::new(estimate());
        self.0.insert(key, new.clone());
        new
    }
}

/// A key of 128 bits of a joint, its valid rows, the torque and the columns there.
pub(super) fn key<'a>(joint: usize, valid: &[bool], signals: impl Iterator<Item = &'a [f64]> + Clone) -> u128 {
    let half = |salt: u64| {
        let mut hasher = DefaultHasher::new();
        hasher.write_u64(salt);
        hasher.write_usize(joint);
        valid.iter().for_each(|&ok| hasher.write_u8(u8::from(ok)));
        for signal in signals.clone() {
            hasher.write_usize(signal.len());
            signal.iter().for_each(|value| hasher.write_u64(value.to_bits()));
        }
        u128::from(hasher.finish())
    };
    half(0) << 64 | half(1)
}
