//! What is known of the arm twice: its geometry with free bodies, and its bodies as described. Each is asked where the other alone
//! does not decide.
//!
//! A model that lacks something (play, elasticity, a wrong mass) leaves a residual that is the same in every block, and among
//! hundreds of changed descriptions one always fits it a little better. No test over blocks sees that. So a change must take much of
//! a torque's residual away; and described bodies count only where they are right: where they explain the torques as well as free
//! ones do.

use super::change::Change;
use super::compare::{Comparison, compare};
use super::fitting::{Physics, Rows};
use super::shares::{ALIKE, WRONG_MASSES};
use super::tried::Tried;

/// Under described bodies a torque may have this many times the residual that it has under free ones, and all torques together, as a
/// geometric mean, so many times. Right bodies come within a few per cent, and leave less than free ones do under a wrong description;
/// bodies that are wrong by half leave two to ten times as much.
const AS_GOOD: f64 = 2.0;
const AS_GOOD_TOGETHER: f64 = 1.2;

/// A residual below this share of the torque is as good as any: no drive's torque is known better.
const GOOD: f64 = 0.02;

/// What is known of an arm.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    /// The model under which descriptions are compared.
    pub physics: &'a Physics,
    /// The model that must agree where the gain under the first is not enough: the described bodies where that has free ones, and free
    /// bodies where it has those described.
    pub other: Option<&'a Physics>,
}

impl<'a> Known<'a> {
    /// The only knowledge.
    pub(super) fn alone(physics: &'a Physics) -> Known<'a> {
        Known { physics, other: None }
    }

    /// Whether a description whose gain over a reference is certain is also much better, and is so for what the arm is.
    pub(super) fn supports(&self, reference: &Tried, best: &Tried, gain: &Comparison, rows: &Rows) -> bool {
        let changes = best.description.changes.len().saturating_sub(reference.description.changes.len());
        let other = |tried: &Tried| Tried::new(self.other?, rows, tried.description.clone());
        match self.physics {
            Physics::Alone => true,
            // The torques of other bodies are no multiples: much must be explained by the change.
            Physics::Multiples(_) => gain.is_large(changes) && gain.is_large_beyond(WRONG_MASSES),
            // Free bodies may make up for much of what is wrong, as for gravity that a torque lacks.
            Physics::Free(_) => {
                let under_bodies = || Some((other(reference)?, other(best)?));
                let is_large = gain.is_large(changes);
                let Some((before, after)) = under_bodies() else { return is_large };
                let compared = |from: &Tried, to: &Tried| compare(&from.evaluation, &to.evaluation, &rows.log);
                match is_large {
                    // Another configuration of a wrist moves its bodies nearly alike. Those described know better where they explain
                    // the torques without it.
                    true => {
                        before.share() >= ALIKE || !compared(&after, &before).is_some_and(|loss| loss.is_distinct())
                    }
                    false => {
                        after.share() < ALIKE && compared(&before, &after).is_some_and(|gain| gain.is_large(changes))
                    }
                }
            }
            // Free bodies may not see the change, and lose nothing by being asked without it.
            Physics::Bodies(_) | Physics::Sprung(..) | Physics::Masses(_) => {
                let free = [best, reference].map(other);
                let [Some(with), Some(without)] = &free else { return false };
                gain.is_large(changes)
                    && gain.is_large_beyond(WRONG_MASSES)
                    && ([with, without].into_iter().all(|free| as_good(best, free))
                        || (has_no_gravity(best, reference) && is_no_worse(with, without, rows)))
            }
        }
    }
}

/// Whether a description differs from another in nothing but that its torque lacks gravity.
fn has_no_gravity(best: &Tried, reference: &Tried) -> bool {
    reference.description.changes.is_empty() && best.description.changes == [Change::WithoutGravity]
}

/// Whether a model is not clearly worse than another. Free bodies that gain nothing by gravity show that the torque lacks it, however wrong
/// the described masses are.
fn is_no_worse(own: &Tried, other: &Tried, rows: &Rows) -> bool {
    !compare(&own.evaluation, &other.evaluation, &rows.log).is_some_and(|loss| loss.is_distinct())
}

/// Whether the bodies leave about as little of the torques as free ones do.
fn as_good(described: &Tried, free: &Tried) -> bool {
    let both = described.evaluation.unexplained.iter().zip(&free.evaluation.unexplained);
    let ratio = |(own, free): (&Option<f64>, &Option<f64>)| Some(own.as_ref()?.max(GOOD) / free.as_ref()?.max(GOOD));
    let ratios: Vec<f64> = both.filter_map(ratio).collect();
    let together = ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len().max(1) as f64;
    ratios.iter().all(|ratio| *ratio < AS_GOOD) && together < AS_GOOD_TOGETHER.ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::descriptions::Description;
    use crate::quality::descriptions::fitting::Evaluation;

    #[test]
    fn described_bodies_count_where_they_explain_every_torque_as_well_as_free_ones() {
        let tried = |shares: [Option<f64>; 2]| Tried {
            description: Description::as_given(2, nalgebra::Vector3::zeros()),
            evaluation: Evaluation { held_out: Vec::new(), unexplained: shares.to_vec() },
        };
        let good = |described: [f64; 2], free: [f64; 2]| as_good(&tried(described.map(Some)), &tried(free.map(Some)));
        assert!(good([0.143, 0.3], [0.1, 0.3]) && !good([0.145, 0.3], [0.1, 0.3]), "1.2 together");
        assert!(good([0.19, 0.2], [0.1, 0.3]) && !good([0.21, 0.2], [0.1, 0.3]), "2 of one torque");
        assert!(good([0.02, 0.028], [0.001, 0.001]) && !good([0.02, 0.03], [0.001, 0.001]));
        assert!(as_good(&tried([Some(0.01), None]), &tried([Some(0.01), Some(0.1)])));
    }
}
