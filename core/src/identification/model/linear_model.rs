//! What a torque model must offer to be identified by linear regression.

use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::error::Result;
use crate::signal::Filter;

/// A model whose torque is linear in its parameters: tau_joint = columns * parameters.
pub trait LinearModel {
    /// Parameters that can act on `joint`, ascending.
    fn active(&self, joint: usize) -> Vec<usize>;

    /// The regressor along a motion at the times `time` (s): for every joint a table `[active parameter][time]` in the
    /// order of [`LinearModel::active`].
    fn columns(&self, motion: &Motion, time: &[f64]) -> Vec<Channels>;

    /// Every `step`-th filtered sample of [`LinearModel::columns`]. A model of long logs should make them block by block.
    ///
    /// # Errors
    /// Those of the filter: the motion is too short for it.
    fn filtered_columns(&self, motion: &Motion, time: &[f64], filter: &Filter, step: usize) -> Result<Vec<Channels>> {
        let thinned = |table: &Channels| -> Result<Channels> {
            let columns: Vec<Vec<f64>> =
                table.iter().map(|column| filter.apply_every(column, step)).collect::<Result<_>>()?;
            Ok(Channels::from_vectors(&columns))
        };
        self.columns(motion, time).iter().map(thinned).collect()
    }

    /// Torque of every joint under the parameters `beta`, `[joint][time]`.
    fn torque(&self, motion: &Motion, time: &[f64], beta: &[f64]) -> Channels {
        let mut torque = Channels::zeros(motion.joints(), motion.samples());
        for (joint, table) in self.columns(motion, time).iter().enumerate() {
            for (parameter, column) in self.active(joint).into_iter().zip(table.iter()) {
                for (value, x) in torque.channel_mut(joint).iter_mut().zip(column) {
                    *value += x * beta[parameter];
                }
            }
        }
        torque
    }
}
