//! Columns of effects along a data set that were worked out before: a search comes back to the same shapes, and every fit with an effect
//! takes its columns and their derivatives again.

use super::arm_columns::Moved;
use super::candidates::columns_in;
use super::roles::acts_upon_arm;
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::Column;
use crate::effects::Placed;
use crate::error::Result;
use crate::identification::effect_model::Arm;
use quick_cache::sync::Cache;
use quick_cache::{DefaultHashBuilder, Weighter};
use std::sync::Arc;

/// Values of columns that are kept, 8 bytes each.
const KEPT_VALUES: u64 = 16_000_000;
/// Groups of columns that this is about.
const GROUPS: usize = 500;

/// Columns by all that they depend on but the rows. A copy knows none yet: its rows may become others.
#[derive(Debug)]
pub(crate) struct EffectColumns(Cache<Key, Arc<Vec<Column>>, Values>);

/// Effect, joint, log, how torque is moved, and bit by bit the parameters, the rounding of the sign of friction, and the arm as found where
/// the effect depends on it.
type Key = (&'static str, usize, Option<usize>, Moved, Vec<u64>);

/// A group weighs as much as it has values.
#[derive(Debug, Clone)]
struct Values;

impl Weighter<Key, Arc<Vec<Column>>> for Values {
    fn weight(&self, _: &Key, group: &Arc<Vec<Column>>) -> u64 {
        let values = group.iter().flat_map(|column| &column.parts).map(|(_, values)| values.len() as u64);
        values.sum::<u64>().max(1)
    }
}

impl Default for EffectColumns {
    fn default() -> Self {
        EffectColumns(Cache::with(GROUPS, KEPT_VALUES, Values, DefaultHashBuilder::default(), Default::default()))
    }
}

impl Clone for EffectColumns {
    fn clone(&self) -> Self {
        EffectColumns::default()
    }
}

impl EffectColumns {
    /// [`columns_in`] of effects, one group each.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn get(
        &self,
        arm: &Arm,
        rows: &Rows,
        log: Option<usize>,
        placed: &[Placed],
        moved: Moved,
    ) -> Result<Vec<Arc<Vec<Column>>>> {
        let found = if placed.iter().any(|one| acts_upon_arm(one.effect)) { arm.state() } else { Vec::new() };
        let key = |one: &Placed| -> Key {
            let rounding = arm.coulomb_rounding.iter().flat_map(|own| [own.form(), own.width().to_bits()]);
            let bits = one.parameters.iter().map(|value| value.to_bits()).chain(rounding);
            let found = if acts_upon_arm(one.effect) { &found[..] } else { &[] };
            (one.effect.about().name, one.joint, log, moved, bits.chain(found.iter().copied()).collect())
        };
        let keys: Vec<Key> = placed.iter().map(key).collect();
        let known: Vec<Option<Arc<Vec<Column>>>> = keys.iter().map(|key| self.0.get(key)).collect();
        let new = placed.iter().zip(&known).filter(|(_, known)| known.is_none());
        let new: Vec<Placed> = new.map(|(one, _)| one.clone()).collect();
        let mut new = columns_in(arm, rows, log, &new, moved)?.into_iter();
        let groups = known.into_iter().zip(keys).filter_map(|(known, key)| match known {
            Some(known) => Some(known),
            None => new.next().map(Arc::new).inspect(|group| self.0.insert(key, group.clone())),
        });
        Ok(groups.collect())
    }
}
