//! What practitioners call the parameters of an effect: a payload's mass and centre of mass, the angle of a tilt.

use crate::diagnosis::criteria::Levels;
use crate::diagnosis::model::{Member, MemberBlock, linear};
use crate::diagnosis::regression::Solved;
use crate::effects::{self, Placed};
use crate::robot::Robot;

/// A quantity that follows from an effect's parameters.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Derived;
///
/// // As `Diagnosis::derived` has it for a payload: its mass, which is significant.
/// let mass = Derived { name: "mass", value: 1.52, std: 0.03, unit: "kg" };
/// assert!(mass.value > 3.0 * mass.std);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its standard deviation, by the delta method from those of the parameters between blocks; infinite where the logs do not determine
    /// it by itself.
    pub std: f64,
    /// Its unit.
    pub unit: &'static str,
}

/// What follows from the parameters of every member; `blocks` are their places in what is `solved`.
pub(in crate::diagnosis::answer) fn derived(
    members: &[Member],
    solved: &Solved,
    blocks: &[MemberBlock],
    robot: &Robot,
    levels: &Levels,
) -> Vec<Vec<Derived>> {
    let each = members.iter().zip(blocks);
    each.map(|(member, block)| {
        let effect = member.placed.effect;
        let places: Vec<usize> = block.amplitudes.clone().collect();
        let Placed { joint, parameters, .. } = &member.placed;
        let of = |p: &[f64]| effect.derived(p, *joint, robot);
        let quantities = of(parameters);
        let values = |p: &[f64]| of(p).into_iter().map(|quantity| quantity.value).collect();
        let wider: Vec<f64> = linear(effect)
            .into_iter()
            .zip(&places)
            .map(|(k, &place)| wider(member.std[k], solved.std(place)))
            .collect();
        let std = delta(&values, parameters, &places, &wider, solved).into_iter().map(|(_, std)| std);
        meaningful(quantities.into_iter().zip(std).collect(), levels.far)
    })
    .collect()
}

/// Quantities with their standard deviations, without those that mean nothing where the first is not so many standard deviations from zero.
fn meaningful(quantities: Vec<(effects::Derived, f64)>, least: f64) -> Vec<Derived> {
    let significant = quantities.first().is_some_and(|(first, std)| first.value.abs() > least * std);
    let kept = quantities.into_iter().filter(|(quantity, _)| significant || !quantity.of_the_first);
    kept.map(|(quantity, std)| Derived { name: quantity.name, value: quantity.value, std, unit: quantity.unit.name() })
        .collect()
}

/// How many times a standard deviation that holds the scatter between blocks exceeds that of the noise.
fn wider(scatter: f64, noise: f64) -> f64 {
    let ratio = scatter / noise;
    if ratio.is_finite() { ratio.max(1.0) } else { 1.0 }
}

/// Functions of parameters with their standard deviations: those of the parameters are so many times `wider` than the noise makes
/// them, with its correlations.
fn delta(
    of: &dyn Fn(&[f64]) -> Vec<f64>,
    at: &[f64],
    places: &[usize],
    wider: &[f64],
    solved: &Solved,
) -> Vec<(f64, f64)> {
    let values = of(at);
    let slopes: Vec<Vec<f64>> = (0..places.len())
        .map(|k| {
            let std = solved.std(places[k]);
            let step = 1e-3 * if std.is_finite() { std.max(1e-9) } else { at[k].abs().max(1.0) };
            let moved = |by: f64| {
                let mut moved = at.to_vec();
                moved[k] += by;
                of(&moved)
            };
            let (ahead, behind) = (moved(step), moved(-step));
            // Where the parameters are hardly known they are other quantities a step away, of which these are no function.
            if ahead.len() != values.len() || behind.len() != values.len() {
                return vec![f64::NAN; values.len()];
            }
            ahead.iter().zip(behind).map(|(ahead, behind)| (ahead - behind) / (2.0 * step)).collect()
        })
        .collect();
    values
        .iter()
        .enumerate()
        .map(|(index, &value)| {
            let slopes: Vec<(usize, f64)> = places
                .iter()
                .zip(&slopes)
                .zip(wider)
                .map(|((place, slope), wider)| (*place, wider * slope[index]))
                .collect();
            let is_known = slopes.iter().all(|(_, slope)| slope.is_finite());
            (value, if is_known { solved.deviation(&slopes) } else { f64::INFINITY })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::regression::{Column, solve};
    use crate::robot::{InertiaCheck, load};

    #[test]
    fn centre_of_mass_by_hand() {
        // 4 +- 0.1 kg, first moment 0.8 +- 0.02 kg m, uncorrelated: 0.2 m, of which the slopes are 1/4 and -0.05.
        let unit = |k: usize, size: f64| Column::on(0, (0..11).map(|row| if row == k { size } else { 0.0 }).collect());
        let sizes = [1.0, 1.0 / 0.1, 1.0 / 0.02].into_iter().chain([1e6; 8]);
        let columns: Vec<Column> = sizes.enumerate().map(|(k, size)| unit(k, size)).collect();
        let solved = solve(&columns, &unit(0, 1.0));
        let parameters = [4.0, 0.8, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let places: Vec<usize> = (1..11).collect();
        let payload = effects::find("payload").unwrap();
        let robot =
            load(concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf"), InertiaCheck::Required).unwrap();
        let named = |parameters: &[f64]| {
            let of = |p: &[f64]| payload.derived(p, 0, &robot);
            let values = |p: &[f64]| of(p).iter().map(|quantity| quantity.value).collect();
            let std = delta(&values, parameters, &places, &[1.0; 10], &solved).into_iter().map(|(_, std)| std);
            meaningful(of(parameters).into_iter().zip(std).collect(), 3.0)
        };
        // Between blocks the mass scatters twice as much as the noise, the moment three times.
        let of = |p: &[f64]| payload.derived(p, 0, &robot).iter().map(|quantity| quantity.value).collect();
        let scattered = delta(&of, &parameters, &places, &[2.0, 3.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0], &solved);
        assert!((scattered[0].1 - 0.2).abs() < 1e-9);
        assert!((scattered[1].1 - (0.25f64 * 0.06).hypot(0.05 * 0.2)).abs() < 1e-9);
        assert_eq!([wider(0.4, 0.1), wider(0.05, 0.1), wider(f64::INFINITY, 0.1)], [4.0, 1.0, 1.0]);
        let light = named(&[0.1, 0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let named = named(&parameters);
        assert_eq!((named[1].name, named[1].unit), ("center_x", "m"));
        assert!((named[0].value - 4.0).abs() < 1e-12 && (named[0].std - 0.1).abs() < 1e-9);
        assert!((named[1].value - 0.2).abs() < 1e-12);
        assert!((named[1].std - (0.25f64 * 0.02).hypot(0.05 * 0.1)).abs() < 1e-9, "{named:?}");
        // A mass that is nothing has no centre.
        assert_eq!(light.len(), 1);
        // A centre at the edge of the arm's reach: a step further it is the first moment that is given, and one quantity less.
        let edge = (1.0 - 1e-6) * robot.reach() * 0.01;
        let at_edge = delta(&of, &[0.01, edge, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], &places, &[1.0; 10], &solved);
        assert_eq!(at_edge.len(), 4);
        assert!(at_edge.iter().all(|(_, std)| *std == f64::INFINITY));
    }
}
