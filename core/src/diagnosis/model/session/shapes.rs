//! Shapes of laws where the residual is least: Gauss-Newton steps, halved until the sum of squares falls.
//!
//! A fit holds, next to a law's own columns, the derivatives of its torque to its shapes: the amplitudes that it finds belong to shapes that
//! are moved by the factors of these derivatives. Where parameters nearly replace each other (moment, stiffness and geometry of a strut),
//! amplitudes at shapes that stay where the search left them are those of another law. Amplitudes are eliminated: Golub, Pereyra (1973),
//! The differentiation of pseudo-inverses and nonlinear least squares problems whose variables separate, SIAM J. Numerical Analysis 10(2).

use super::Session;
use crate::diagnosis::model::arm_columns::Moved;
use crate::diagnosis::model::candidates::{Candidate, extent};
use crate::diagnosis::model::member::Member;
use crate::diagnosis::model::roles::{linear, shapes};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::Column;
use crate::effects::{Placed, moved};
use crate::error::Result;
use std::sync::Arc;

/// Most steps, and halvings of one.
const STEPS: usize = 12;
const HALVINGS: i32 = 5;

/// Longest step, as a share of what the scan's grid is refined by.
const LONGEST: f64 = 0.25;

impl Session<'_> {
    /// Moves the shapes of settled `members` until they are where the residual of the training rows is least, to a part of their standard
    /// deviations, and settles the members after every step.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn move_shapes(&mut self, members: &mut Vec<Member>, whitener: &Whitener) -> Result<()> {
        for _ in 0..STEPS {
            if !members.iter().any(Member::has_shift) {
                break;
            }
            let least = self.amplitudes_at_shapes(&mut members.clone(), whitener)?;
            let mut better = None;
            for halving in 0..=HALVINGS {
                let mut trial = self.shifted(members, 0.5f64.powi(halving))?;
                let squares = self.amplitudes_at_shapes(&mut trial, whitener)?;
                if squares < least {
                    better = Some((trial, squares));
                    break;
                }
            }
            let Some((trial, squares)) = better else { break };
            tracing::debug!(least, squares, "shapes moved");
            *members = trial;
            self.settle(members, whitener)?;
        }
        Ok(())
    }

    /// Members with their shapes moved by a `share` of what the fit finds.
    fn shifted(&self, members: &[Member], share: f64) -> Result<Vec<Member>> {
        let mut all = members.to_vec();
        for member in all.iter_mut().filter(|member| member.has_shift()) {
            let effect = member.placed.effect;
            let extent = extent(&self.logs.train.rows, member.placed.joint);
            let shapes = shapes(effect);
            let mut placed = member.candidate.placed.clone();
            let longest = |index: usize, value: f64| (moved(effect, index, value, LONGEST) - value).abs();
            let steps = shapes.iter().zip(&member.shifts);
            let steps = steps.map(|(&index, shift)| longest(index, placed.parameters[index]) / shift.abs());
            let share = share * steps.fold(1.0, f64::min);
            for (&index, shift) in shapes.iter().zip(&member.shifts) {
                let from = placed.parameters[index];
                let value = extent.moved_within_bounds(effect, index, from, from + share * shift);
                (placed.parameters[index], member.placed.parameters[index]) = (value, value);
            }
            if let Some(candidate) = self.candidate_at(placed, member)? {
                member.candidate = candidate;
            }
        }
        Ok(all)
    }

    /// The candidate of a member with other values of its shapes; None where it has no torque.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn candidate_at(&self, placed: Placed, member: &Member) -> Result<Option<Candidate>> {
        let log = member.candidate.log;
        let columns = self.logs.train.columns(&self.model.arm, log, std::slice::from_ref(&placed), Moved::Tested)?;
        Ok(columns.into_iter().next().map(|mut columns| {
            for (k, index) in linear(placed.effect).into_iter().enumerate().take(columns.len()) {
                if member.fixed.contains(&index) {
                    Arc::make_mut(&mut columns)[k] = Column::default();
                }
            }
            Candidate { placed, log, columns }
        }))
    }

    /// Takes the amplitudes of `members` that fit best with their shapes as they are; returns the whitened sum of squares of the training
    /// rows' residual.
    fn amplitudes_at_shapes(&self, members: &mut [Member], whitener: &Whitener) -> Result<f64> {
        let mut at_shapes = members.to_vec();
        at_shapes.iter_mut().for_each(|member| member.fixed.extend(shapes(member.placed.effect)));
        let train = &self.logs.train;
        let equations = whitener.equations(&self.model.columns(train, &at_shapes)?, &train.torque);
        let values = equations.solved(|_| 1.0).values;
        let blocks = self.blocks(members);
        for (member, block) in members.iter_mut().zip(&blocks.members).filter(|(member, _)| !member.held) {
            member.factors = block.amplitudes.clone().map(|place| values[place]).collect();
        }
        Ok(equations.squared_residuals(&vec![1.0; train.rows.dof()]).iter().sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::model::candidates::columns;
    use crate::diagnosis::test_logs::log;
    use crate::effects::find;
    use crate::identification::effect_model::{Arm, Trust};
    use crate::identification::model::Model;
    use crate::robot::{InertiaCheck, load};

    /// A strut of 434 N m and 1695 N m was reported with 6690 N m and 4680 N m: its amplitudes were those of shapes that did not move.
    #[test]
    fn amplitudes_belong_to_the_shapes_that_are_reported() {
        let robot =
            load(concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf"), InertiaCheck::Required).unwrap();
        let joint = 1;
        let [moment, stiffness, geometry, angle] = [434.0, 1695.0, 0.642, -0.1];
        let logs = [1, 2, 3].map(|seed| {
            let mut log = log(&Arm::new(&robot, Trust::Nominal), seed);
            let positions = log.q.channel(joint).to_vec();
            for (tau, q) in log.tau.channel_mut(joint).iter_mut().zip(positions) {
                let (sine, cosine) = (q - angle).sin_cos();
                let [length, shortest] = [cosine, 1.0].map(|cosine: f64| (1.0 - geometry * cosine).sqrt());
                *tau += (moment + stiffness * (length - shortest)) * geometry * sine / (2.0 * length);
            }
            log
        });
        let model = Model::new(&robot);
        let mut session = Session::new(&model, Trust::Nominal, &[&logs[0], &logs[1]], &[&logs[2]]).unwrap();
        let mut placed = Placed::typical(find("gravity_balancer").unwrap(), joint);
        placed.parameters = vec![700.0, 600.0, 0.376, -0.111];
        let found = columns(&session.model.arm, &session.logs.train.rows, std::slice::from_ref(&placed)).unwrap();
        let candidate = Candidate { placed, log: None, columns: Arc::new(found.into_iter().next().unwrap()) };
        let mut members = vec![Member::new(&candidate, &[700.0, 600.0])];
        let present = session.model.columns(&session.logs.train, &members).unwrap();
        let whitener = session.noise_under(&present);
        session.settle(&mut members, &whitener).unwrap();
        session.move_shapes(&mut members, &whitener).unwrap();
        let Member { placed, std, .. } = &members[0];
        for ((found, std), truth) in placed.parameters.iter().zip(std).zip([moment, stiffness, geometry, angle]) {
            assert!((found - truth).abs() < 4.0 * std && *std > 0.0, "{found} +- {std} instead of {truth}");
        }
        assert!(std[2] < 0.05 && !members[0].has_shift(), "{members:?}");
    }
}
