//! Factors of torques that are the gears which the robot's file gives its motors: the log holds forces or controls of the motors.

use super::sizes::factors::REPORTED;
use crate::robot::Robot;

/// The gear of every joint of a robot in its file; 1 where it has none.
pub(super) fn of_file(robot: &Robot) -> Vec<f64> {
    let of = |name: &String| robot.actuators.iter().find(|motor| motor.joint == *name).map_or(1.0, |motor| motor.gear);
    robot.joint_names().iter().map(of).collect()
}

/// Whether the torques' own scales, or their `factors` where each is known by itself, are those of the `gears`: to within [`REPORTED`], and
/// one where a gear up to that has no factor that is reported.
pub(super) fn explain(scale: &[f64], factors: &[Option<f64>], gears: &[f64]) -> bool {
    let known: Vec<Option<f64>> = match factors.len() {
        // What stands for a factor that is not known is no factor.
        count if count == scale.len() && count > 1 => {
            factors.iter().map(|factor| factor.map(|factor| 1.0 / factor.abs())).collect()
        }
        _ => scale.iter().copied().map(Some).collect(),
    };
    let is_like = |(factor, gear): (&Option<f64>, &f64)| {
        let (Some(factor), gear) = (*factor, gear.abs()) else { return true };
        match factor == 1.0 {
            true => gear < REPORTED,
            false => gear >= REPORTED && factor < REPORTED * gear && gear < REPORTED * factor,
        }
    };
    known.iter().flatten().any(|factor| *factor != 1.0) && known.iter().zip(gears).all(is_like)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_gears_where_each_is_like_its_own() {
        let alone = |gears: &[f64]| explain(&[1.0, 99.0, 1.0], &[], gears);
        assert!(alone(&[1.0, 100.0, 1.0]) && alone(&[1.0, -100.0, 1.0]));
        // Another gear, and gears of torques without a factor.
        assert!(!alone(&[1.0, 40.0, 1.0]) && !alone(&[100.0; 3]) && !alone(&[1.0; 3]));
        let each = |gears: &[f64]| explain(&[100.0; 3], &[Some(0.01), Some(1.0 / 60.0), None], gears);
        assert!(each(&[100.0, 50.0, 7.0]) && !each(&[100.0, 20.0, 7.0]));
    }
}
