//! What practitioners call the parameters of an effect: a payload's mass and centre of mass, the angle of a tilt.

use super::estimates::Estimates;
use super::roles::linear;
use super::session::Member;
use crate::robot::{Inertia, Robot};
use nalgebra::DVector;

/// A centre of mass is told where the mass is this many standard deviations from zero.
const MASS_TELLS: f64 = 3.0;

/// A quantity that follows from an effect's parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its standard deviation, by the delta method.
    pub std: f64,
    /// Its unit.
    pub unit: &'static str,
}

/// What follows from the parameters of every member; `first` is the column of the first member's first parameter.
pub fn derived(members: &[Member], estimates: &Estimates, first: usize, robot: &Robot) -> Vec<Vec<Derived>> {
    let mut first = first;
    members
        .iter()
        .map(|member| {
            let effect = member.placed.effect;
            let places: Vec<usize> = (first..first + linear(effect).len()).collect();
            first += member.columns();
            let parameters = &member.placed.parameters;
            let last = member.placed.joint + 1 == robot.dof();
            let with = |of: &dyn Fn(&[f64]) -> Vec<f64>| delta(of, parameters, &places, estimates);
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
fn delta(of: &dyn Fn(&[f64]) -> Vec<f64>, at: &[f64], places: &[usize], estimates: &Estimates) -> Vec<(f64, f64)> {
    let values = of(at);
    let slopes: Vec<Vec<f64>> = (0..places.len())
        .map(|k| {
            let variance = estimates.covariance[(places[k], places[k])];
            let step = 1e-3 * variance.sqrt().max(1e-9);
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
            let slope = DVector::from_iterator(places.len(), slopes.iter().map(|slope| slope[index]));
            let covariance = estimates.covariance.select_rows(places).select_columns(places);
            (value, slope.dot(&(covariance * &slope)).max(0.0).sqrt())
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
    use nalgebra::DMatrix;

    #[test]
    fn centre_of_mass_by_hand() {
        // 4 +- 0.1 kg, first moment 0.8 +- 0.02 kg m, uncorrelated: 0.2 m, of which the slopes are 1/4 and -0.05.
        let mut covariance = DMatrix::zeros(11, 11);
        covariance[(1, 1)] = 0.01;
        covariance[(2, 2)] = 4e-4;
        let estimates = Estimates { values: vec![0.0; 11], covariance };
        let parameters = [4.0, 0.8, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let places: Vec<usize> = (1..11).collect();
        let named = body(delta(&|p| mass_and_center(p, None), &parameters, &places, &estimates));
        assert_eq!((named[1].name, named[1].unit), ("center_x", "m"));
        assert!((named[0].value - 4.0).abs() < 1e-12 && (named[0].std - 0.1).abs() < 1e-9);
        assert!((named[1].value - 0.2).abs() < 1e-12);
        assert!((named[1].std - (0.25f64 * 0.02).hypot(0.05 * 0.1)).abs() < 1e-9, "{named:?}");
        // A mass that is nothing has no centre.
        let light = [0.1, 0.8, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(body(delta(&|p| mass_and_center(p, None), &light, &places, &estimates)).len(), 1);
    }
}
