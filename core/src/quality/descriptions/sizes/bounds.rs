//! Within what the factors of torques are: a load that the robot's file lacks makes the torques of the described bodies smaller than those
//! of the real ones, and a wrist may carry many times what its own bodies weigh.
//!
//! The fit of the factors has a load of its own, which a factor of the wrist explains nearly as well. So factors are also found without a
//! load, and with one as heavy as arms usually carry: the truth is between these, unless masses are wrong besides.

use super::super::change::Description;
use super::super::fitting::{Fit, Physics, Rows};
use crate::robot::{Inertia, Robot};
use nalgebra::Matrix3;

/// Mass of a usual load over that of the moving bodies: arms of industry carry a tenth to a third of them, light ones up to half.
const LOAD: f64 = 0.25;

/// A usual load makes the torque of no joint larger by more than this: what is farther from a factor than that is a torque unlike its bodies.
const FARTHEST: f64 = 50.0;

/// Bounds of factors that are as near to each other as this say nothing that the number does not.
const SAME: f64 = 1.3;

/// Bounds of the factors of torques, how many times larger each is than it should be, in the order of the factors; none where a factor is
/// not known or as good as its number.
pub(crate) fn of_factors(
    robot: &Robot,
    rows: &Rows,
    description: &Description,
    factors: &[Option<f64>],
) -> Vec<Option<[f64; 2]>> {
    let whole = rows.whole();
    let others = description.without_scales();
    let multiples = |share: f64| -> Option<Vec<f64>> {
        let physics = Physics::multiples(&carrying(robot, share)?)?;
        let mut all = Fit::new(&physics.tables(&whole, &others), &whole, &others).parameters()?;
        // Those of the rotors come behind.
        all.truncate(robot.dof());
        Some(all)
    };
    let each: Vec<Vec<f64>> = [0.0, LOAD].into_iter().filter_map(multiples).collect();
    let shared = factors.len() == 1;
    let of = |(place, factor): (usize, &Option<f64>)| {
        let factor = (*factor)?.abs();
        let of_one = |all: &Vec<f64>| match shared {
            true => middle_half(all, factor),
            false => near(&all[place..=place], factor),
        };
        bounds(factor, &each.iter().flat_map(of_one).collect::<Vec<f64>>())
    };
    factors.iter().enumerate().map(of).collect()
}

/// The arm with a load of a share of its mass at the flange; none of an arm whose flange may be on another branch than its load.
fn carrying(robot: &Robot, share: f64) -> Option<Robot> {
    let mut out = robot.clone();
    if share > 0.0 {
        let mass = share * (0..robot.bodies()).map(|body| robot.body(body).inertia.mass()).sum::<f64>();
        let last = out.joints.last_mut().filter(|_| robot.tree.is_none())?;
        let load = Inertia::from_center_of_mass(mass, robot.flange.translation, Matrix3::zeros());
        last.inertia = last.inertia.welded_to(&load);
    }
    Some(out)
}

/// Multiples that may be those of a factor.
fn near(multiples: &[f64], factor: f64) -> Vec<f64> {
    let is_near = |multiple: &f64| *multiple > 0.0 && (multiple / factor).ln().abs() < FARTHEST.ln();
    multiples.iter().copied().filter(is_near).collect()
}

/// The ends of the middle half of the multiples: joints that share a factor have it with unlike constants, and single ones with wrong masses.
fn middle_half(multiples: &[f64], factor: f64) -> Vec<f64> {
    let mut near = near(multiples, factor);
    near.sort_by(f64::total_cmp);
    match near.len() {
        0 => Vec::new(),
        count => vec![near[(count - 1) / 4], near[count - 1 - (count - 1) / 4]],
    }
}

/// A torque that is like its bodies under none of the loads may be that of a load alone.
fn bounds(factor: f64, found: &[f64]) -> Option<[f64; 2]> {
    let alone = [factor / FARTHEST];
    let found = if found.is_empty() { &alone[..] } else { found };
    let [low, high] = found.iter().fold([factor; 2], |[low, high], own| [low.min(*own), high.max(*own)]);
    (high > SAME * low).then_some([low, high])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_the_factor_and_what_is_found_with_other_loads() {
        assert_eq!(bounds(10.0, &[9.0, 11.0]), None);
        assert_eq!(bounds(10.0, &[8.0, 9.0]), None);
        assert_eq!(bounds(50.0, &[51.0, 4.0]), Some([4.0, 51.0]));
        assert_eq!(bounds(50.0, &[]), Some([1.0, 50.0]));
        assert_eq!(near(&[0.0, 1e-3, 4.0, 1e4], 10.0), [4.0]);
        // Single joints with wrong masses, of eight.
        assert_eq!(middle_half(&[7.0, 8.0, 9.0, 10.0, 10.0, 11.0, 12.0, 40.0], 10.0), [8.0, 12.0]);
        assert_eq!(middle_half(&[8.0], 10.0), [8.0, 8.0]);
    }
}
