//! How a session changes: other logs, other rows, another arm. Nothing else changes what it holds.

use super::{Session, State};
use crate::diagnosis::model::data_set::DataSet;
use crate::diagnosis::model::known::Known;
use crate::diagnosis::model::prepared::PreparedLogs;
use crate::diagnosis::regression::Column;
use crate::effects::Rounding;
use crate::identification::effect_model::Arm;
use crate::robot::Robot;

impl<'a> Session<'a> {
    /// Goes on with other prepared logs, which have more columns in their baselines or fewer rows.
    pub(crate) fn go_on_with(&mut self, logs: PreparedLogs) {
        self.state.logs = logs;
    }

    /// Takes the same logs with other rows, training logs first, and the cut-off of each joint's positions in them, Hz.
    pub(crate) fn take_data_sets(&mut self, [train, test]: [DataSet; 2], cutoffs_hz: Vec<f64>) {
        let logs = &mut self.state.logs;
        (logs.train, logs.test, logs.cutoffs_hz) = (train, test, cutoffs_hz);
    }

    /// Takes the torque of what each joint's positions hold in its band, of both data sets.
    pub(crate) fn take_bands(&mut self, bands: [Vec<Column>; 2]) {
        self.data_sets().into_iter().zip(bands).for_each(|(data, bands)| data.bands = bands);
    }

    /// Marks joints whose torque, moved in time, holds more of the encoders' noise than of the motion.
    pub(crate) fn mark_noisy(&mut self, joints: &[bool]) {
        let logs = self.data_sets().into_iter().flat_map(|data| &mut data.rows.logs);
        logs.for_each(|log| log.noisy = joints.to_vec());
    }

    /// Leaves out the rows of both data sets in which `errors` exceed what is `bearable`, of each joint the share `most` at most.
    pub(crate) fn leave_out_largest(&mut self, errors: &[Vec<Column>; 2], bearable: &[f64], most: f64) {
        let both = self.data_sets().into_iter().zip(errors);
        both.for_each(|(data, errors)| data.rows.leave_out_largest(errors, bearable, most));
    }

    /// Leaves out the rows of all joints that hold samples `from..to` of a training log.
    pub(crate) fn leave_out_samples(&mut self, log: usize, from: usize, to: usize) {
        self.state.logs.train.rows.leave_out_samples(log, from, to);
    }

    /// Takes other things for known beforehand; the arm is as known.
    pub(crate) fn know(&mut self, known: Known<'a>) {
        self.state.model.known = known;
        self.take_arm_as_known();
    }

    /// Takes the arm as it was known before any fit.
    pub(crate) fn take_arm_as_known(&mut self) {
        let model = &mut self.state.model;
        model.arm = model.known.arm.clone();
    }

    /// Takes the arm's parameters from `robot` instead of from a fit.
    pub fn take_parameters_of(&mut self, robot: &Robot) {
        let model = &mut self.state.model;
        model.arm = Arm::new(robot, model.trust).with_coulomb_rounding(model.arm.coulomb_rounding.clone());
    }

    /// Adds a change of the standard parameters to the arm as found.
    pub(crate) fn describe_change(&mut self, change: &[f64]) {
        self.state.model.arm.describe(change);
    }

    /// Takes another rounding of the sign of friction, `[joint]`: with the columns of Coulomb friction in both baselines.
    pub(crate) fn round_friction(&mut self, rounding: Vec<Rounding>) {
        let State { logs, model, .. } = &mut self.state;
        for data in [&mut logs.train, &mut logs.test] {
            for (place, column) in model.arm.dry_columns(model.base, &data.rows, &rounding) {
                data.baseline[place] = column;
            }
        }
        model.known = model.known.with_coulomb_rounding(rounding.clone());
        model.arm = model.arm.clone().with_coulomb_rounding(rounding);
    }

    /// Takes the gains of the log-likelihood by the roundings that were not taken, `[joint]`.
    pub(crate) fn take_rounding_gains(&mut self, gains: Vec<f64>) {
        self.state.model.rounding_gains = gains;
    }

    /// Moves inertia from a joint's link to its rotor, kg m2 (kg), in the arm as known and as found.
    pub(crate) fn move_inertia_to_rotor(&mut self, joint: usize, more: f64) {
        let model = &mut self.state.model;
        for arm in [&mut model.known.arm, &mut model.arm] {
            if let Some(divided) = arm.with_more_in_rotor(model.base, joint, more) {
                *arm = divided;
            }
        }
    }

    /// Leaves open whether the gears of `joints` have play.
    pub(crate) fn leave_play_open(&mut self, joints: Vec<usize>) {
        self.state.model.open_play = joints;
    }

    fn data_sets(&mut self) -> [&mut DataSet; 2] {
        let PreparedLogs { train, test, .. } = &mut self.state.logs;
        [train, test]
    }
}
