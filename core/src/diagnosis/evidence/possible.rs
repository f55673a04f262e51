//! Whether an estimate can be: within the bounds of its parameters, of the size at which its columns were taken, and of a torque that its
//! joint can have.

use crate::diagnosis::criteria::{Gate, Judgement};
use crate::diagnosis::model::{Candidate, Session, bends, extent, is_level, linear};
use crate::diagnosis::regression::{Column, Test, combined, rms};
use crate::effects::{Parameter, Placed, Role};

impl Session<'_> {
    /// The gate that an estimate fails which is beyond its bounds by more than its uncertainty, or of another size than its columns. A change
    /// of an amplitude may go either way.
    pub(super) fn out_of_bounds(&self, candidate: &Candidate, test: &Test) -> Option<Judgement> {
        let change = self.logs.train.rows.of_change();
        let effect = candidate.placed.effect;
        let criteria = &self.criteria.estimate;
        let another_size =
            |value: f64, size: f64| Some(criteria.same_size(value, size)).filter(|judgement| !judgement.passed);
        if is_level(effect) {
            let sizes = linear(effect).into_iter().map(|index| candidate.placed.parameters[index]);
            return test.values.iter().zip(sizes).find_map(|(value, size)| another_size(*value, size));
        }
        let far = self.criteria.levels.far;
        if candidate.one_sided() && !change && test.values[0] <= 0.0 {
            return Some(Judgement::below(Gate::WithinBounds, -test.values[0] / test.std[0], 0.0));
        }
        if let [only] = linear(effect)[..]
            && bends(effect, only)
        {
            // The column is that of one size; an estimate of another size is of something else. The smallest column is as good
            // as straight, and stands for everything below it.
            let size = candidate.placed.parameters[only];
            let is_straight = || {
                let sizes = extent(&self.logs.train.rows, candidate.placed.joint).sizes(effect, only);
                let smallest = sizes.first().copied().unwrap_or_default();
                size.abs() <= smallest && test.values[0].abs() < criteria.same_size * size.abs()
            };
            if let Some(failed) = another_size(test.values[0], size).filter(|_| !is_straight()) {
                return Some(failed);
            }
        }
        let estimates = linear(effect).into_iter().zip(test.values.iter().zip(&test.std));
        let judgements = estimates.filter_map(|(index, (value, std))| {
            let Parameter { lower, upper, role, .. } = effect.parameters()[index];
            let either_way = change && role == Role::Amplitude;
            // One without a finite standard deviation may lie anywhere.
            let within = value + far * std >= lower && value - far * std <= upper;
            let beyond = ((lower - value) / std).max((value - upper) / std);
            let judgement = Judgement::at_most(Gate::WithinBounds, beyond, far).or(within);
            (!either_way && !judgement.passed).then_some(judgement)
        });
        judgements.max_by(|a, b| a.value.total_cmp(&b.value))
    }

    /// The gate that an estimate fails which no machine has, or whose torque is more than can be of its joint's.
    pub(super) fn unbelievable(&self, candidate: &Candidate, test: &Test) -> Option<Judgement> {
        let effect = candidate.placed.effect;
        if is_level(effect) {
            return None;
        }
        let mut placed = candidate.placed.clone();
        linear(effect).iter().zip(&test.values).for_each(|(&index, &value)| placed.parameters[index] = value);
        Judgement::first_failed([self.can_be(&placed, &combined(&candidate.columns, &test.values))])
    }

    /// Whether a machine can have a law with its parameters, and its joint so much `torque` of it along the training logs.
    pub(crate) fn can_be(&self, placed: &Placed, torque: &Column) -> Judgement {
        let believable = self.believable(placed);
        if !believable.passed || is_level(placed.effect) {
            return believable;
        }
        let in_proportion = Judgement::at_most(Gate::InProportion, self.proportion(placed, torque), 1.0);
        if in_proportion.passed { believable } else { in_proportion }
    }

    /// Whether a machine can have a law with its parameters.
    fn believable(&self, Placed { effect, joint, parameters }: &Placed) -> Judgement {
        // At what torque a drive is cut off is its own.
        let over = if is_level(*effect) { 0.0 } else { effect.over_limit(parameters, *joint, self.model.base.robot()) };
        Judgement::at_most(Gate::Believable, over, 1.0)
    }

    /// The torque `own` of a law over what can be of its joint's: on the valid rows, and for friction in all others too, to which a law that
    /// hardly reaches the valid rows is carried on.
    fn proportion(&self, &Placed { effect, joint, .. }: &Placed, own: &Column) -> f64 {
        let (dry, share) = (effect.about().dry, effect.largest_share());
        let mut most = 0.0f64;
        if !dry && share.is_none() {
            return most;
        }
        if dry {
            let largest = |values: &[f64]| values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
            for (joint, values) in &own.parts {
                let (friction, torque) = (largest(values), largest(&self.logs.train.rows.torque[*joint]));
                most = most.max(if friction > 0.0 { friction / torque } else { 0.0 });
            }
        }
        let Some(share) = share else { return most };
        let valid = &self.logs.train.rows.valid;
        let of_effect = rms(valid, own)[joint];
        let all = Column::on(joint, self.logs.train.rows.torque[joint].clone());
        let limit = self.model.base.robot().joints[joint].limits.effort;
        let of_drive = if limit.is_finite() { self.criteria.levels.minor * limit } else { 0.0 };
        let can_be = largest(share, rms(valid, &all)[joint], of_drive);
        most.max(if of_effect > 0.0 { of_effect / can_be } else { 0.0 })
    }
}

/// Largest torque of a law that can have a `share` of its joint's `torque`. A wrist that carries next to nothing has the offset and the hoses
/// of a drive that could carry more: every joint is taken to work with a minor part `of_drive`, and that much a law can have on any.
fn largest(share: f64, torque: f64, of_drive: f64) -> f64 {
    (share * torque.max(of_drive)).max(of_drive)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hose of 1.2 N m on a wrist of 1.6 N m whose drive has 20: without it a strut was named there.
    #[test]
    fn a_law_can_have_its_share_of_the_torque_or_a_minor_part_of_the_drive() {
        assert_eq!(largest(0.5, 1.6, 2.0), 2.0);
        assert_eq!(largest(0.5, 10.0, 2.0), 5.0);
        assert_eq!(largest(0.5, 1.6, 0.0), 0.8);
        assert_eq!(largest(10.0, 1.6, 2.0), 20.0);
    }
}
