//! The rows of the regression.

use super::arm::Arm;
use super::arm_parameters::{ArmParameter, Trust};
use super::parts::Parts;
use super::sensing::Sensing;
use super::signals::difference;
use super::state::EffectModel;
use crate::channels::Channels;
use crate::error::Result;
use crate::identification::preparation::prepare::{self, Prepared};
use crate::identification::regression::joint_regression::JointRegression;
use crate::recording::Recording;

/// Rows without weight between two logs, so that the noise of one is not carried into the next.
const SEPARATION: usize = 32;

impl EffectModel<'_> {
    /// The linear regression at the present nonlinear parameters, all logs one after the other: torque less what has no
    /// free parameter, columns of the arm's parameters and of the amplitudes.
    ///
    /// # Errors
    /// If a log is too short for its preparation.
    pub fn regression(&self) -> Result<Vec<JointRegression>> {
        let arm = self.found_arm();
        let mut joints: Vec<Vec<JointRegression>> = (0..self.model.dof()).map(|_| Vec::new()).collect();
        for (recording, prepared) in &self.logs {
            for (all, one) in joints.iter_mut().zip(self.rows(&arm, recording, prepared)?) {
                all.push(one);
            }
        }
        Ok(joints.into_iter().map(|parts| JointRegression::joined(parts, SEPARATION)).collect())
    }

    /// The rows of every joint that see a reversal or slow motion, `[joint][row]`.
    pub(in crate::identification) fn rows_at_reversals(&self) -> Vec<Vec<bool>> {
        let of_joint = |joint: usize| {
            let logs = self.logs.iter().map(|(_, prepared)| prepared.rows_at_reversals(joint));
            logs.reduce(|all, one| [all, vec![false; SEPARATION], one].concat()).unwrap_or_default()
        };
        (0..self.joints()).map(of_joint).collect()
    }

    /// Time of every row of [`EffectModel::regression`], each log's own, s; NaN for the rows that only separate logs.
    ///
    /// # Errors
    /// If a log is too short for its preparation.
    pub(crate) fn row_times(&self) -> Result<Vec<f64>> {
        let mut times = Vec::new();
        for (_, prepared) in &self.logs {
            if !times.is_empty() {
                times.extend([f64::NAN; SEPARATION]);
            }
            times.extend(prepared.row_times()?);
        }
        Ok(times)
    }

    /// Position and velocity of every joint at those rows, `[joint][row]`; NaN for the rows that only separate logs.
    ///
    /// # Errors
    /// If a log is too short for its preparation.
    pub(crate) fn row_motion(&self) -> Result<[Vec<Vec<f64>>; 2]> {
        let mut tables = [vec![Vec::new(); self.joints()], vec![Vec::new(); self.joints()]];
        for (_, prepared) in &self.logs {
            for joint in 0..self.joints() {
                for (table, own) in tables.iter_mut().zip(prepared.row_motion(joint)?) {
                    if !table[joint].is_empty() {
                        table[joint].extend([f64::NAN; SEPARATION]);
                    }
                    table[joint].extend(own);
                }
            }
        }
        Ok(tables)
    }

    /// Standard deviation of the white noise in the torque of the rows, for each joint, N m: what no model can explain.
    ///
    /// # Errors
    /// If a log is too short for its preparation.
    pub fn torque_noise(&self) -> Result<Vec<f64>> {
        let mut squares = vec![0.0; self.joints()];
        for (_, prepared) in &self.logs {
            for (sum, noise) in squares.iter_mut().zip(prepared.torque_noise()?) {
                *sum += noise * noise / self.logs.len() as f64;
            }
        }
        Ok(squares.into_iter().map(f64::sqrt).collect())
    }

    /// The regression rows of one log; `arm` is as found.
    fn rows(&self, arm: &Arm, recording: &Recording, prepared: &Prepared) -> Result<Vec<JointRegression>> {
        let undone = self.without_encoder_errors(recording);
        let corrected;
        let (recording, prepared) = match &undone {
            Some(log) => {
                corrected = prepare::measured(log, &self.preparation.smoothing, self.preparation.band)?.like(prepared);
                (log, &corrected)
            }
            None => (recording, prepared),
        };
        let period = 1.0 / recording.rate_hz();
        let link = self.link_motion(arm, recording, prepared)?;
        let mut parts = Parts::new(self, arm, prepared, &link);
        let mut base = match self.trust {
            Trust::Structure => prepared.columns(self.model, &link)?,
            Trust::Nominal => vec![Channels::default(); self.model.dof()],
        };
        (0..self.model.dof())
            .map(|joint| {
                if !self.model.has_equation(joint) {
                    let name = self.model.robot().joints[joint].name.clone();
                    return Ok(JointRegression::without_equation(name, prepared.row_times()?.len()));
                }
                let sensing = Sensing::new(self.sensors(joint).collect(), period);
                let rows = match sensing.acts() {
                    true => self.sensed_rows(joint, &parts, prepared, recording.samples(), &sensing),
                    false => self.plain_rows(joint, &parts, prepared, std::mem::take(&mut base[joint])),
                };
                parts.release(joint);
                rows
            })
            .collect()
    }

    /// The regression rows of one joint of one log whose sensors read true; `base` are those of its base columns, where
    /// they are fitted.
    fn plain_rows(&self, joint: usize, parts: &Parts, prepared: &Prepared, base: Channels) -> Result<JointRegression> {
        let active = self.model.active(joint);
        let place = |parameter: ArmParameter| match parameter {
            ArmParameter::Base(base) => active.iter().position(|&own| own == base),
            ArmParameter::Drive(..) => None,
        };
        let places: Vec<Option<usize>> = self.arm.iter().map(|&parameter| place(parameter)).collect();
        let all = places.iter().flatten().count() == base.channels();
        let mut parameters = Vec::new();
        let mut columns = Channels::default();
        for (index, &parameter) in self.arm.iter().enumerate() {
            if let Some(place) = places[index] {
                if !all {
                    columns.push(base.channel(place));
                }
            } else if let Some(column) = parts.column(parameter, joint) {
                columns.push(&prepared.thinned(&column)?);
            } else {
                continue;
            }
            parameters.push(index);
        }
        if all && base.channels() > 0 {
            columns = base;
        }
        for (index, column) in parts.amplitudes(joint) {
            columns.push(&prepared.thinned(column)?);
            parameters.push(index);
        }
        let torque = prepared.torque.channel(joint);
        let torque = match parts.known(joint) {
            Some(known) => prepared.thinned(&difference(torque, known))?,
            None => prepared.thinned(torque)?,
        };
        self.joint_rows(joint, parameters, columns, torque, prepared)
    }

    /// The regression rows of one joint of one log whose torque went through `sensing`.
    fn sensed_rows(
        &self,
        joint: usize,
        parts: &Parts,
        prepared: &Prepared,
        samples: usize,
        sensing: &Sensing,
    ) -> Result<JointRegression> {
        let sensed = |column: &[f64]| sensing.small_signal(column);
        let columns = parts.columns(joint);
        let mut own: Vec<(usize, Vec<f64>)> = columns.iter().map(|(k, column)| (*k, sensed(column))).collect();
        for (index, (effect, k)) in self.amplitudes().into_iter().enumerate() {
            if let Some(column) = sensing.amplitude(&self.placed[effect], k, samples) {
                own.push((self.baseline.len() + index, column));
            }
        }
        let mut known = parts.known(joint).map_or_else(|| sensed(&vec![0.0; samples]), sensed);
        let total = parts.predicted(joint, &self.all_linear());
        sensing.clip(&total, &mut known, &mut own);
        let mut columns = Channels::default();
        for (_, column) in &own {
            columns.push(&prepared.thinned(column)?);
        }
        let torque = prepared.thinned(&difference(prepared.torque.channel(joint), &known))?;
        self.joint_rows(joint, own.into_iter().map(|(index, _)| index).collect(), columns, torque, prepared)
    }

    fn joint_rows(
        &self,
        joint: usize,
        parameters: Vec<usize>,
        columns: Channels,
        torque: Vec<f64>,
        prepared: &Prepared,
    ) -> Result<JointRegression> {
        // Without a column there are no rows to count.
        let columns = if parameters.is_empty() { Channels::zeros(0, torque.len()) } else { columns };
        let name = self.model.robot().joints[joint].name.clone();
        Ok(JointRegression { joint: name, parameters, columns, torque, valid: prepared.rows_to_use(joint) })
    }
}
