//! Shapes of laws where the residual is least: Gauss-Newton steps, halved until the sum of squares falls.
//!
//! A fit holds, next to a law's own columns, the derivatives of its torque to its shapes: the amplitudes that it finds belong to shapes that
//! are moved by the factors of these derivatives. Where parameters nearly replace each other (moment, stiffness and geometry of a strut),
//! amplitudes at shapes that stay where the search left them are those of another law. Amplitudes are eliminated: Golub, Pereyra (1973),
//! The differentiation of pseudo-inverses and nonlinear least squares problems whose variables separate, SIAM J. Numerical Analysis 10(2).

use super::Session;
use crate::diagnosis::model::arm_columns::Moved;
use crate::diagnosis::model::candidates::extent;
use crate::diagnosis::model::member::Member;
use crate::diagnosis::model::roles::shapes;
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::Column;
use crate::effects::moved;
use crate::error::Result;
use std::sync::Arc;

/// Most steps, and halvings of one.
const STEPS: usize = 12;
const HALVINGS: i32 = 5;

/// Longest step, as a share of what the scan's grid is refined by.
const LONGEST: f64 = 0.25;

impl Session<'_> {
    /// Moves the shapes of settled `members` until they are where the residual of the training rows is least, to a part of their standard
    /// deviations, and settles the members there.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn move_shapes(&mut self, members: &mut Vec<Member>, whitener: &Whitener) -> Result<()> {
        for _ in 0..STEPS {
            let least = self.amplitudes_at_shapes(members, whitener)?;
            self.settle(members, whitener)?;
            if !members.iter().any(Member::has_shift) {
                break;
            }
            let mut better = None;
            for halving in 0..=HALVINGS {
                let mut trial = self.shifted(members, 0.5f64.powi(halving))?;
                let squares = self.amplitudes_at_shapes(&mut trial, whitener)?;
                if squares < least && members.iter().zip(&trial).all(|(before, after)| is_the_same_law(before, after)) {
                    better = Some((trial, squares));
                    break;
                }
            }
            let Some((trial, squares)) = better else { break };
            tracing::debug!(least, squares, "shapes moved");
            *members = trial;
        }
        Ok(())
    }

    /// Members with their shapes moved by a `share` of what the fit finds.
    fn shifted(&self, members: &[Member], share: f64) -> Result<Vec<Member>> {
        let mut all = members.to_vec();
        for member in all.iter_mut().filter(|member| member.has_shift()) {
            let effect = member.placed.effect;
            let extent = extent(&self.logs.train.rows, member.placed.joint);
            let (shapes, shifts) = (shapes(effect), member.shifts.clone());
            let parameters = &mut member.candidate.placed.parameters;
            let longest = |index: usize, value: f64| (moved(effect, index, value, LONGEST) - value).abs();
            let steps =
                shapes.iter().zip(&shifts).map(|(&index, shift)| longest(index, parameters[index]) / shift.abs());
            let share = share * steps.fold(1.0, f64::min);
            for (&index, shift) in shapes.iter().zip(&shifts) {
                let value = extent.within_bounds(effect, index, parameters[index] + share * shift);
                (parameters[index], member.placed.parameters[index]) = (value, value);
            }
            let placed = std::slice::from_ref(&member.candidate.placed);
            let columns = self.logs.train.columns(&self.model.arm, member.candidate.log, placed, Moved::Tested)?;
            if let Some(mut columns) = columns.into_iter().next() {
                for (k, index) in member.places().take(columns.len()).enumerate() {
                    if member.fixed.contains(&index) {
                        Arc::make_mut(&mut columns)[k] = Column::default();
                    }
                }
                member.candidate.columns = columns;
            }
        }
        Ok(all)
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

/// Whether the only amplitude of a law has its sign still: a power of the speed below one and a negative one above bend alike, and are two laws.
fn is_the_same_law(before: &Member, after: &Member) -> bool {
    !matches!((&before.factors[..], &after.factors[..]), ([before], [after]) if before * after < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::model::candidates::{Candidate, columns};
    use crate::diagnosis::test_logs::log;
    use crate::effects::{Placed, find};
    use crate::identification::effect_model::{Arm, Trust};
    use crate::identification::model::Model;
    use crate::robot::{InertiaCheck, load};

    #[test]
    fn a_law_of_one_amplitude_keeps_its_sign() {
        let of = |effect: &str, factors: &[f64]| {
            let placed = Placed::typical(find(effect).unwrap(), 0);
            Member::new(&Candidate { placed, log: None, columns: Default::default() }, factors)
        };
        let power = |coefficient: f64| of("nonlinear_viscous_friction", &[coefficient]);
        assert!(is_the_same_law(&power(3.0), &power(0.1)) && !is_the_same_law(&power(3.0), &power(-4.0)));
        // The phase of a ripple turns with its order.
        let ripple = |cosine: f64| of("torque_ripple", &[cosine, 1.0]);
        assert!(is_the_same_law(&ripple(3.0), &ripple(-3.0)));
    }

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
        session.move_shapes(&mut members, &whitener).unwrap();
        let Member { placed, std, .. } = &members[0];
        for ((found, std), truth) in placed.parameters.iter().zip(std).zip([moment, stiffness, geometry, angle]) {
            assert!((found - truth).abs() < 4.0 * std && *std > 0.0, "{found} +- {std} instead of {truth}");
        }
        assert!(std[2] < 0.05 && !members[0].has_shift(), "{members:?}");
    }
}
