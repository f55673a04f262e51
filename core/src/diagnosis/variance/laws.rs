//! What a law of the library explains beyond generic functions of all kinds.

use super::design::{ConstantOfLaw, Design, Raw, Source};
use super::map::coloured_fit;
use super::mixed::{Fit, fit, fit_from};
use crate::diagnosis::model::DataSet;
use crate::diagnosis::regression::Column;

/// Strength of a law, over the noise, from which its fit starts where generic functions explain all.
const FAINT: f64 = 0.01;

/// Knots over position, of twelve in its range, within which smooth functions of it resemble each other: gears out of centre and hoses bend
/// once or a few times over the range. Hats that do not resemble each other take one number each, and any smooth law would gain by that.
pub(super) const SMOOTH: [f64; 2] = [1.5, 4.0];

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
    Some(gain_in(&raw))
}

/// The same in a regression with a law. What follows a joint's position may be rough or smooth: the likelier counts, with and without.
fn gain_in(raw: &Raw) -> f64 {
    let (design, with, rho) = coloured_fit(raw);
    let mut best = likelihoods(&design, &bare(raw, &design, rho), &with);
    for knots in SMOOTH {
        let raw = raw.clone().smooth(knots);
        let design = raw.design(rho);
        let with = fit(&design);
        let smooth = likelihoods(&design, &bare(&raw, &design, rho), &with);
        best.iter_mut().zip(smooth).for_each(|(best, smooth)| *best = best.max(smooth));
    }
    let [with, without] = best;
    let gain = (with - without).max(0.0);
    tracing::debug!(constant = ?design.constant, rho, with, gain, "law over generic functions");
    gain
}

/// The design without the law. What a law explains by its constant, the kind of constants explains as well. An offset is that constant.
fn bare(raw: &Raw, design: &Design, rho: f64) -> Design {
    match design.constant {
        ConstantOfLaw::Part => raw.clone().without_law().design(rho),
        ConstantOfLaw::No | ConstantOfLaw::Whole => design.clone().without_law(),
    }
}

/// Logarithms of the likelihoods of the fit `with` the law of `design`, the last of its kinds, and of that of the `bare` design without it.
/// The likelihood may have several maxima: each fit starts from the other, too, and the better one counts.
fn likelihoods(design: &Design, bare: &Design, with: &Fit) -> [f64; 2] {
    let kinds = bare.kinds.len();
    let best = |fits: [Fit; 2]| {
        let [one, other] = fits;
        if one.log_likelihood >= other.log_likelihood { one } else { other }
    };
    let without = best([fit(bare), fit_from(bare, with.strengths[..kinds].to_vec(), with.noise)]);
    let started = [&without.strengths[..], &vec![FAINT * without.noise; design.kinds.len() - kinds]].concat();
    let again = fit_from(design, started, without.noise);
    [again.log_likelihood.max(with.log_likelihood), without.log_likelihood]
}

#[cfg(test)]
mod tests {
    use super::super::kinds::Kind;
    use super::super::mixed::tests::one_kind_of_two;
    use super::*;
    use nalgebra::{DMatrix, DVector};

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
        let [with, without] = likelihoods(&design, &design.clone().without_law(), &with);
        with - without
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

    /// What a law with these functions gains on a joint whose torque is a constant beyond the model, and noise of deviation one.
    fn gained_of_constant(law: &[fn(f64) -> f64]) -> (ConstantOfLaw, f64) {
        let noise = one_kind_of_two(0.0, 7);
        let (rows, offset) = (noise.y.len(), 1);
        let swing = |row: usize| (0.03 * row as f64).sin();
        let z = DMatrix::from_fn(rows, offset + law.len(), |row, k| match k.checked_sub(offset) {
            Some(k) => law[k](swing(row)),
            None => 1.0,
        });
        let raw = Raw {
            y: noise.y.add_scalar(3.0),
            x: DMatrix::zeros(rows, 0),
            z,
            kinds: vec![(Some(Kind::Offset), 0..offset), (None, offset..offset + law.len())],
            runs: noise.runs,
            time: noise.time,
            log: noise.log,
            together: noise.together,
        };
        (raw.design(0.0).constant, gain_in(&raw))
    }

    #[test]
    fn a_constant_is_credited_to_an_offset_alone() {
        let (constant, gain) = gained_of_constant(&[|_| 1.0]);
        assert!(constant == ConstantOfLaw::Whole && gain > 100.0, "{gain}");
        // A spring by its preload, and a strut that hardly bends, explain no more than that.
        for law in [&[|_| 1.0, |q| q][..], &[|q: f64| 1.0 + 0.2 * q]] {
            let (constant, gain) = gained_of_constant(law);
            assert!(constant == ConstantOfLaw::Part && gain < 3.0, "{constant:?} {gain}");
        }
        let (constant, gain) = gained_of_constant(&[|q| q]);
        assert!(constant == ConstantOfLaw::No && gain < 3.0, "{constant:?} {gain}");
    }
}
