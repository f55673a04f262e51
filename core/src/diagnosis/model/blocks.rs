//! Named blocks of the parameter vector of a model.

use super::member::Member;
use super::roles::{linear, shapes};
use std::ops::Range;

/// Places of the parameters of a model in its parameter vector, which has the order of
/// [`ArmModel::columns`](super::ArmModel::columns): first the baseline (base parameters, or friction and rotors where bodies are
/// taken from the URDF; positions of gears with play; parameters of known effects that are estimated again), then each effect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ParameterBlocks {
    /// The baseline.
    pub baseline: Range<usize>,
    /// Parameters of known effects that are estimated again: the last ones of the baseline.
    pub known: Range<usize>,
    /// The effects in the model, in their order.
    pub members: Vec<MemberBlock>,
}

/// Places of an effect's parameters; empty where they are held.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct MemberBlock {
    /// Amplitudes and departures: the torque is linear in them.
    pub amplitudes: Range<usize>,
    /// Shapes, by derivatives of the torque to them.
    pub shapes: Range<usize>,
}

impl MemberBlock {
    /// All of them.
    pub(crate) fn all(&self) -> Range<usize> {
        self.amplitudes.start..self.shapes.end
    }
}

impl ParameterBlocks {
    /// The place after the last parameter.
    pub(crate) fn end(&self) -> usize {
        self.members.last().map_or(self.baseline.end, |block| block.shapes.end)
    }

    /// The blocks of a model with so many `baseline` parameters, of which the last `known` are those of known effects, and of `members`.
    pub(super) fn new(baseline: usize, known: usize, members: &[Member]) -> Self {
        let mut place = baseline;
        let mut next = |count: usize| {
            place += count;
            place - count..place
        };
        let block = |member: &Member| {
            let effect = member.placed.effect;
            let counts = if member.held { [0, 0] } else { [linear(effect).len(), shapes(effect).len()] };
            MemberBlock { amplitudes: next(counts[0]), shapes: next(counts[1]) }
        };
        let members = members.iter().map(block).collect();
        ParameterBlocks { baseline: 0..baseline, known: baseline - known..baseline, members }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::model::Candidate;
    use crate::effects::{Placed, StribeckFriction, TorqueOffset};

    #[test]
    fn blocks_follow_each_other_and_held_effects_have_none() {
        let member = |effect, held| {
            let candidate = Candidate { placed: Placed::typical(effect, 0), log: None, columns: Default::default() };
            Member { held, ..Member::new(&candidate, &[]) }
        };
        let members = [member(&StribeckFriction, false), member(&TorqueOffset, true), member(&TorqueOffset, false)];
        let blocks = ParameterBlocks::new(10, 2, &members);
        assert_eq!((&blocks.baseline, &blocks.known), (&(0..10), &(8..10)));
        let [stribeck, held, offset] = &blocks.members[..] else { panic!() };
        assert_eq!((stribeck.amplitudes.clone(), stribeck.shapes.clone(), stribeck.all()), (10..11, 11..12, 10..12));
        assert!(held.all().is_empty());
        assert_eq!((offset.all(), blocks.end()), (12..13, 13));
        assert_eq!(ParameterBlocks::new(10, 2, &[]).end(), 10);
    }
}
