//! What a torque model must offer to be identified by linear regression.

use crate::channels::Channels;
use crate::dynamics::Motion;

/// A model whose torque is linear in its parameters: tau_joint = columns * parameters.
pub trait LinearModel {
    /// Parameters that can act on `joint`, ascending.
    fn active(&self, joint: usize) -> Vec<usize>;

    /// The regressor along a motion at the times `time` (s): for every joint a table `[active parameter][time]` in the
    /// order of [`LinearModel::active`].
    fn columns(&self, motion: &Motion, time: &[f64]) -> Vec<Channels>;

    /// The table of one joint out of [`LinearModel::columns`], for those who need not hold all of them at once.
    fn columns_on(&self, joint: usize, motion: &Motion, time: &[f64]) -> Channels {
        self.columns(motion, time).swap_remove(joint)
    }
}
