//! What a law of the library explains beyond generic functions of all kinds.

use super::design::{Design, Raw, Source};
use super::map::coloured_fit;
use super::mixed::{Fit, fit, fit_from};
use crate::diagnosis::model::DataSet;
use crate::diagnosis::regression::Column;

/// Strength of a law, over the noise, from which its fit starts where generic functions explain all.
const FAINT: f64 = 0.01;

/// Gain of the logarithm of the restricted likelihood on one joint by the columns of a law as a random effect of their own, all other
/// strengths estimated again with and without it. A law that replaces many generic functions by one or two numbers gains; one that
/// explains a part of what generic functions explain as well does not. `torques` are those of the arm, `[joint][row]`. None where the rows
/// are too long for the law: less than the share `resolved` of its square remains in their means.
pub(crate) fn gain_over_generic_functions(
    data: &DataSet,
    torques: &[Vec<f64>],
    fixed: &[Column],
    law: &[Column],
    joint: usize,
    resolved: f64,
) -> Option<f64> {
    let source = Source { rows: &data.rows, torque: &data.torque, fixed, arm: torques };
    let (raw, kept) = Raw::new(&source, joint).with_law(&source, law, joint);
    if kept < resolved {
        return None;
    }
    let (design, with, rho) = coloured_fit(&raw);
    let gain = gain(design, &with);
    tracing::debug!(joint, rho, with = with.log_likelihood, gain, "law over generic functions");
    Some(gain)
}

/// Gain of the fit `with` the law of `design`, the last of its kinds, over that without it. The likelihood may have several maxima: each
/// fit starts from the other, too, and the better one counts.
fn gain(design: Design, with: &Fit) -> f64 {
    let bare = design.clone().without_law();
    let kinds = bare.kinds.len();
    let best = |fits: [Fit; 2]| {
        let [one, other] = fits;
        if one.log_likelihood >= other.log_likelihood { one } else { other }
    };
    let without = best([fit(&bare), fit_from(&bare, with.strengths[..kinds].to_vec(), with.noise)]);
    let started = [&without.strengths[..], &vec![FAINT * without.noise; design.kinds.len() - kinds]].concat();
    let again = fit_from(&design, started, without.noise);
    (again.log_likelihood.max(with.log_likelihood) - without.log_likelihood).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::super::mixed::tests::one_kind_of_two;
    use super::*;
    use nalgebra::DVector;

    /// What the law `effects` of the functions of the first kind gains, hidden with this size in noise of deviation one, where the
    /// functions follow another law of size `other`.
    fn gained(size: f64, other: f64, seed: u64) -> f64 {
        let mut design = one_kind_of_two(other, seed);
        let along = |effects: [f64; 6], design: &Design| {
            let column = design.z.columns(0, 6) * DVector::from_row_slice(&effects);
            &column / (column.norm_squared() / column.len() as f64).sqrt()
        };
        let law = along([1.0, -0.5, 0.3, 0.8, -0.2, 0.6], &design);
        design.y += &law * size;
        let place = design.z.ncols();
        design.z = design.z.insert_column(place, 0.0);
        design.z.set_column(place, &law);
        design.kinds.push((None, place..place + 1));
        design.gram = design.z.tr_mul(&design.z);
        design.right = design.z.tr_mul(&design.y);
        let with = fit(&design);
        gain(design, &with)
    }

    #[test]
    fn a_law_replaces_the_functions_that_follow_it() {
        assert!((0..5).all(|seed| gained(2.0, 0.0, seed) > 3.0));
    }

    #[test]
    fn a_law_that_is_not_there_gains_nothing() {
        // Neither in noise nor where functions of its own kind follow another law.
        for other in [0.0, 2.0] {
            let gains: Vec<f64> = (0..10).map(|seed| gained(0.0, other, seed)).collect();
            assert!(gains.iter().filter(|gain| **gain > 3.0).count() <= 1, "{gains:?}");
        }
    }
}
