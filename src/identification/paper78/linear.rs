//! The 78-parameter model along a motion, for regression.

use super::equations::terms;
use super::{JOINTS, PARAMETER_COUNT, Variant, regressor};
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::identification::linear_model::LinearModel;

/// Parameter k, counted from 0, is X_(k+1).
impl LinearModel for Variant {
    fn active(&self, joint: usize) -> Vec<usize> {
        let mut parameters: Vec<usize> =
            terms(*self).iter().filter(|term| term.row == joint).map(|term| term.parameter - 1).collect();
        parameters.sort_unstable();
        parameters.dedup();
        parameters
    }

    /// # Panics
    /// If the motion is not one of six joints.
    fn columns(&self, motion: &Motion, time: &[f64]) -> Vec<Channels> {
        assert_eq!(motion.joints(), JOINTS, "the paper's model is that of an arm of six joints");
        let mut columns = vec![Channels::zeros(PARAMETER_COUNT, time.len()); JOINTS];
        for sample in 0..time.len() {
            let [theta, dtheta, ddtheta] =
                [&motion.q, &motion.qd, &motion.qdd].map(|signals| std::array::from_fn(|j| signals.channel(j)[sample]));
            for (table, row) in columns.iter_mut().zip(regressor(*self, &theta, &dtheta, &ddtheta)) {
                table.set(sample, &row);
            }
        }
        let kept = |joint: usize| -> Vec<Vec<f64>> {
            self.active(joint).into_iter().map(|k| columns[joint].channel(k).to_vec()).collect()
        };
        (0..JOINTS).map(|joint| Channels::from_vectors(&kept(joint))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::structure::random_states;
    use super::*;

    #[test]
    fn columns_are_the_regressor_without_what_is_zero_by_construction() {
        let states = random_states(4, 20);
        let signals = |which: usize| {
            let joints: Vec<Vec<f64>> =
                (0..JOINTS).map(|j| states.iter().map(|state| state[which][j]).collect()).collect();
            Channels::from_vectors(&joints)
        };
        let motion = Motion { q: signals(0), qd: signals(1), qdd: signals(2) };
        for variant in [Variant::AsPrinted, Variant::Consistent, Variant::EulerLagrange] {
            let columns = variant.columns(&motion, &[0.0; 20]);
            for (sample, [theta, dtheta, ddtheta]) in states.iter().enumerate() {
                for (joint, row) in regressor(variant, theta, dtheta, ddtheta).iter().enumerate() {
                    let active = variant.active(joint);
                    assert_eq!(columns[joint].channels(), active.len());
                    for (k, &value) in row.iter().enumerate() {
                        let found =
                            active.iter().position(|&a| a == k).map_or(0.0, |c| columns[joint].channel(c)[sample]);
                        assert_eq!(found, value, "{variant:?} joint {joint} X{}", k + 1);
                    }
                }
            }
        }
        // (9): X25, X26, X44, X57, X66, X71 and X75..X78.
        assert_eq!(Variant::Consistent.active(5), [24, 25, 43, 56, 65, 70, 74, 75, 76, 77]);
    }
}
