//! An effect in the model.

use super::candidates::Candidate;
use super::roles::{bounded, follows_estimate, linear, shapes};
use crate::diagnosis::criteria::Levels;
use crate::effects::Placed;

/// Share of a typical departure below which one acts in proportion to its size, and its column would be rounding.
const SMALL: f64 = 0.1;

/// Change of a parameter, in its standard deviations, from which a fit goes on.
const CONVERGED: f64 = 0.1;

/// An effect in the model, with what it takes there.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Member;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // Seven periods a turn, with the standard deviation.
/// let member: &Member = &diagnosis.found[0].member;
/// let (periods, std) = (member.placed.parameters[2], member.std[2]);
/// assert!((periods - 7.0).abs() < 0.1 && std < 0.1);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Member {
    /// The effect with its parameters as estimated.
    pub placed: Placed,
    /// Standard deviation of every parameter; zero for those held.
    pub std: Vec<f64>,
    /// Where its columns are taken.
    pub candidate: Candidate,
    /// Factors of the columns.
    pub factors: Vec<f64>,
    /// Whether its parameters are not estimated from the rows: it has no columns in the model.
    pub held: bool,
    /// By how much the fit would move each shape, to first order; zero of those that stay.
    pub shifts: Vec<f64>,
    /// Indices of parameters that the rows do not determine: they are held, amplitudes at zero, and their columns are zero.
    pub fixed: Vec<usize>,
}

impl Member {
    /// Index of the parameter of each of its columns: its linear parameters, then the derivatives to its shapes.
    pub(crate) fn places(&self) -> impl Iterator<Item = usize> + use<> {
        linear(self.placed.effect).into_iter().chain(shapes(self.placed.effect))
    }

    /// Whether the logs determine its size: some amplitude differs significantly from zero.
    pub fn is_sized(&self, levels: &Levels) -> bool {
        let significant = levels.significant_std();
        linear(self.placed.effect)
            .into_iter()
            .any(|index| self.placed.parameters[index].abs() > significant * self.std[index])
    }

    /// Whether its amplitudes are what they were `before`, to within a part of their standard deviations.
    pub(crate) fn has_converged(&self, before: &[f64]) -> bool {
        let moved = |((now, before), place): ((&f64, &f64), &usize)| {
            let std = self.std[*place];
            !std.is_finite() || (now - before).abs() <= CONVERGED * std
        };
        self.factors.iter().zip(before).zip(&linear(self.placed.effect)).all(moved)
    }

    /// Whether a shape would move by more than a part of its standard deviation.
    pub(crate) fn has_shift(&self) -> bool {
        let mut shapes = shapes(self.placed.effect).into_iter().zip(&self.shifts);
        shapes.any(|(index, shift)| self.std[index].is_finite() && shift.abs() > CONVERGED * self.std[index])
    }

    /// Takes the columns of departures at the sizes as estimated: what a large one does is not a multiple of what a small one does.
    pub(crate) fn take_departures_at_estimates(&mut self) {
        let effect = self.placed.effect;
        for (index, &estimate) in linear(effect).into_iter().zip(&self.factors) {
            let parameter = &effect.parameters()[index];
            let size = bounded(parameter, estimate);
            if follows_estimate(effect, index) && size.abs() > SMALL * parameter.typical.abs() {
                self.candidate.placed.parameters[index] = size;
            }
        }
    }

    /// A candidate with the factors of its columns as part of the model.
    pub(crate) fn new(candidate: &Candidate, factors: &[f64]) -> Self {
        let placed = candidate.placed.clone();
        let absent = linear(placed.effect).into_iter().zip(candidate.columns.iter());
        Member {
            fixed: absent.filter(|(_, column)| column.parts.is_empty()).map(|(index, _)| index).collect(),
            std: vec![0.0; placed.parameters.len()],
            shifts: vec![0.0; shapes(placed.effect).len()],
            factors: factors.to_vec(),
            candidate: candidate.clone(),
            placed,
            held: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;

    #[test]
    fn columns_of_departures_are_taken_where_they_are_not_small() {
        let placed = Placed::typical(find("torque_gain").unwrap(), 0);
        let typical = placed.amount();
        let at = |estimate: f64| {
            let candidate = Candidate { placed: placed.clone(), log: None, columns: Default::default() };
            let mut member = Member::new(&candidate, &[estimate]);
            member.take_departures_at_estimates();
            member.candidate.placed.amount()
        };
        assert_eq!(at(-0.11 * typical), -0.11 * typical);
        assert_eq!(at(0.09 * typical), typical);
        let upper = placed.effect.parameters()[0].upper;
        assert_eq!(at(2.0 * upper), upper);
        // Amplitudes are in proportion at any size.
        let spring = Placed::typical(find("joint_spring").unwrap(), 0);
        let candidate = Candidate { placed: spring.clone(), log: None, columns: Default::default() };
        let mut member = Member::new(&candidate, &[7.0, 8.0]);
        member.take_departures_at_estimates();
        assert_eq!(member.candidate.placed.parameters, spring.parameters);
    }

    #[test]
    fn shapes_that_stay_within_a_tenth_of_their_deviation_do_not_move() {
        let placed = Placed::typical(find("stribeck_friction").unwrap(), 0);
        let candidate = Candidate { placed, log: None, columns: Default::default() };
        let mut member = Member::new(&candidate, &[]);
        let index = shapes(member.placed.effect)[0];
        member.std[index] = 0.01;
        let mut has_shift = |shift: f64| {
            member.shifts[0] = shift;
            member.has_shift()
        };
        assert!(has_shift(-0.0011) && !has_shift(0.0009));
        member.std[index] = f64::INFINITY;
        assert!(!member.has_shift());
    }

    #[test]
    fn one_amplitude_told_from_zero_is_enough() {
        let placed = Placed::typical(find("friction_asymmetry").unwrap(), 0);
        let candidate = Candidate { placed, log: None, columns: Default::default() };
        let mut member = Member::new(&candidate, &[]);
        let criteria = Levels::default();
        let sizes = member.placed.parameters.clone();
        member.std = sizes.iter().map(|size| 0.6 * size.abs()).collect();
        assert!(!member.is_sized(&criteria));
        member.std[0] = 0.4 * sizes[0].abs();
        assert!(member.is_sized(&criteria));
        member.std.fill(f64::INFINITY);
        assert!(!member.is_sized(&criteria));
    }
}
