//! What was worked out before: a model comparison adds columns on one joint after the other, and the noise and the regression of all other
//! joints are asked for again as they were.

use super::innovations::InnovationsFilter;
use super::joint_whitener::JointWhitener;
use crate::diagnosis::regression::JointFactors;
use quick_cache::sync::Cache;
use quick_cache::{DefaultHashBuilder, Weighter};
use std::sync::Arc;
use twox_hash::xxhash3_128;

/// Noises that are kept.
const NOISES: usize = 400;

/// Values of factors that are kept, 8 bytes each, and about how many factors that are.
const VALUES: u64 = 12_000_000;
const FACTORS: usize = 200;

/// Noises and regressions of joints by what they were estimated from. They are functions of that alone: what is remembered changes no
/// number.
#[derive(Debug)]
pub(crate) struct NoiseMemory {
    noises: Cache<u128, Arc<JointWhitener>>,
    pub(super) factors: Arc<FactorMemory>,
}

impl Default for NoiseMemory {
    fn default() -> Self {
        NoiseMemory { noises: Cache::new(NOISES), factors: Arc::default() }
    }
}

impl NoiseMemory {
    /// The noise estimated from these inputs.
    pub(super) fn get(&self, key: u128, estimate: impl FnOnce() -> JointWhitener) -> Arc<JointWhitener> {
        remembered(&self.noises, key, estimate)
    }
}

/// Factors of regressions, by their inputs.
#[derive(Debug)]
pub(super) struct FactorMemory(Cache<u128, Arc<JointFactors>, Values>);

/// Factors weigh as much as they have values.
#[derive(Debug, Clone)]
struct Values;

impl Weighter<u128, Arc<JointFactors>> for Values {
    fn weight(&self, _: &u128, factors: &Arc<JointFactors>) -> u64 {
        factors.size().max(1) as u64
    }
}

impl Default for FactorMemory {
    fn default() -> Self {
        FactorMemory(Cache::with(FACTORS, VALUES, Values, DefaultHashBuilder::default(), Default::default()))
    }
}

impl FactorMemory {
    /// The factors of these inputs.
    pub(super) fn get(&self, key: u128, factor: impl FnOnce() -> JointFactors) -> Arc<JointFactors> {
        remembered(&self.0, key, factor)
    }
}

/// The value of a key, worked out if it is not known.
///
/// Two threads that ask for the same at once both work it out: one that waits could take up work that waits for itself.
fn remembered<V, W>(known: &Cache<u128, Arc<V>, W>, key: u128, make: impl FnOnce() -> V) -> Arc<V>
where
    W: Weighter<u128, Arc<V>> + Clone,
{
    if let Some(known) = known.get(&key) {
        return known;
    }
    let new = Arc::new(make());
    known.insert(key, new.clone());
    new
}

/// A key of 128 bits of a joint, its valid rows, the torque and the columns there.
pub(super) fn key_of_noise<'a>(joint: usize, valid: &[bool], signals: impl Iterator<Item = &'a [f64]>) -> u128 {
    let mut hasher = xxhash3_128::Hasher::new();
    hasher.write(&joint.to_le_bytes());
    hasher.write(bytemuck::cast_slice(valid));
    write(&mut hasher, signals);
    hasher.finish_128()
}

/// A key of a filter and the signals that it whitens.
pub(super) fn key_of_factors<'a>(filter: &InnovationsFilter, signals: impl Iterator<Item = &'a [f64]>) -> u128 {
    let mut hasher = xxhash3_128::Hasher::new();
    let noise = filter.noise();
    write(&mut hasher, [noise.coefficients.as_slice(), &[noise.innovation_std]].into_iter());
    hasher.write(bytemuck::cast_slice(filter.rows()));
    hasher.write(bytemuck::cast_slice(filter.starts()));
    write(&mut hasher, signals);
    hasher.finish_128()
}

fn write<'a>(hasher: &mut xxhash3_128::Hasher, signals: impl Iterator<Item = &'a [f64]>) {
    for signal in signals {
        hasher.write(&signal.len().to_le_bytes());
        hasher.write(bytemuck::cast_slice(signal));
    }
}
