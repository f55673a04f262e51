//! What practitioners call the parameters of an effect: a payload's mass and centre of mass, the angle of a tilt.

use crate::diagnosis::model::{Member, linear};
use crate::diagnosis::regression::Solved;
use crate::robot::{Inertia, Robot};

/// A centre of mass is told where the mass is this many standard deviations from zero.
const MASS_TELLS: f64 = 3.0;

/// A quantity that follows from an effect's parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its standard deviation, by the delta method; infinite where the logs do not tell it by itself.
    pub std: f64,
    /// Its unit.
    pub unit: &'static str,
}

/// What follows from the parameters of every member; `first` is the column of the first member's first parameter.
pub(super) fn derived(members: &[Member], solved: &Solved, first: usize, robot: &Robot) -> Vec<Vec<Derived>> {
    let mut first = first;
    members
        .iter()
        .map(|member| {
            let effect = member.placed.effect;
            let places: Vec<usize> = (first..first + linear(effect).len()).collect();
            first += member.columns();
            let parameters = &member.placed.parameters;
            let last = member.placed.joint + 1 == robot.dof();
            let with = |of: &dyn Fn(&[f64]) -> Vec<f64>| delta(of, parameters, &places, solved);
            match effect.about().name {
                "payload" => body(with(&|p| mass_and_center(p, None))),
                "link_inertia_error" if last => body(with(&|p| mass_and_center(p, Some(robot)))),
                "base_tilt" => with(&|p| vec![(p[0].cos() * p[1].cos()).acos()])
                    .into_iter()
                    .map(|(value, std)| Derived { name: "tilt", value, std, unit: "rad" })
                    .collect(),
                _ => Vec::new(),
            }
        })
        .collect()
}

/// Functions of parameters with their standard deviations.
fn delta(of: &dyn Fn(&[f64]) -> Vec<f64>, at: &[f64], places: &[usize], solved: &Solved) -> Vec<(f64, f64)> {
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
            moved(step).iter().zip(moved(-step)).map(|(ahead, behind)| (ahead - behind) / (2.0 * step)).collect()
        })
        .collect();
    values
        .iter()
        .enumerate()
        .map(|(index, &value)| {
            let slopes: Vec<(usize, f64)> =
                places.iter().zip(&slopes).map(|(place, slope)| (*place, slope[index])).collect();
            (value, solved.deviation(&slopes))
        })
        .collect()
}

/// Mass and centre of mass in the flange frame, from parameters about that frame, or about the last joint's frame of `robot`.
fn mass_and_center(parameters: &[f64], robot: Option<&Robot>) -> Vec<f64> {
    let Ok(parameters) = parameters.try_into() else { return Vec::new() };
    let body = Inertia(parameters);
    let mut center = body.center_of_mass();
    if let Some(robot) = robot {
        center = robot.flange.rotation.transpose() * (center - robot.flange.translation);
    }
    vec![body.mass(), center.x, center.y, center.z]
}

/// Names for mass and centre of mass; the centre only where there is a mass.
fn body(values: Vec<(f64, f64)>) -> Vec<Derived> {
    let names = [("mass", "kg"), ("center_x", "m"), ("center_y", "m"), ("center_z", "m")];
    let told = values.first().map_or(0, |(mass, std)| if mass.abs() > MASS_TELLS * std { values.len() } else { 1 });
    let named = names.into_iter().zip(values).take(told);
    named.map(|((name, unit), (value, std))| Derived { name, value, std, unit }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::regression::{Column, solve};

    #[test]
    fn centre_of_mass_by_hand() {
        // 4 +- 0.1 kg, first moment 0.8 +- 0.02 kg m, uncorrelated: 0.2 m, of which the slopes are 1/4 and -0.05.
        let unit = |k: usize, size: f64| Column::on(0, (0..11).map(|row| if row == k { size } else { 0.0 }).collect());
        let sizes = [1.0, 1.0 / 0.1, 1.0 / 0.02].into_iter().chain([1e6; 8]);
        let columns: Vec<Column> = sizes.enumerate().map(|(k, size)| unit(k, size)).collect();
        let solved = solve(&columns, &unit(0, 1.0));
        let parameters = [4.0, 0.8, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let places: Vec<usize> = (1..11).collect();
        let named = body(delta(&|p| mass_and_center(p, None), &parameters, &places, &solved));
        assert_eq!((named[1].name, named[1].unit), ("center_x", "m"));
        assert!((named[0].value - 4.0).abs() < 1e-12 && (named[0].std - 0.1).abs() < 1e-9);
        assert!((named[1].value - 0.2).abs() < 1e-12);
        assert!((named[1].std - (0.25f64 * 0.02).hypot(0.05 * 0.1)).abs() < 1e-9, "{named:?}");
        // A mass that is nothing has no centre.
        let light = [0.1, 0.8, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(body(delta(&|p| mass_and_center(p, None), &light, &places, &solved)).len(), 1);
    }
}
