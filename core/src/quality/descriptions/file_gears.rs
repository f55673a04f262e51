//! Factors of torques that are the gears which the robot's file gives its motors: the log holds forces or controls of the motors.

use super::verdict::Verdict;
use crate::robot::Robot;

/// A factor is that of a gear to within this: constants and described bodies differ from those of files by as much.
const LIKE: f64 = 2.0;

/// A gear up to this has no factor that is reported.
const HARDLY: f64 = 2.0;

/// The gear of every joint of a robot in its file; 1 where it has none.
pub(super) fn of_file(robot: &Robot) -> Vec<f64> {
    let of = |name: &String| robot.actuators.iter().find(|motor| motor.joint == *name).map_or(1.0, |motor| motor.gear);
    robot.joint_names().iter().map(of).collect()
}

/// Whether the factors of a verdict are those of the `gears`.
pub(super) fn explain(verdict: &Verdict, gears: &[f64]) -> bool {
    let scale = &verdict.description.torque_scale;
    let known: Vec<Option<f64>> = match verdict.factors.len() {
        // What stands for a factor that is not known is no factor.
        count if count == scale.len() && count > 1 => {
            verdict.factors.iter().map(|factor| factor.map(|factor| 1.0 / factor.abs())).collect()
        }
        _ => scale.iter().copied().map(Some).collect(),
    };
    let is_like = |(factor, gear): (&Option<f64>, &f64)| {
        let (Some(factor), gear) = (*factor, gear.abs()) else { return true };
        if factor == 1.0 { gear < HARDLY } else { gear >= HARDLY && factor < LIKE * gear && gear < LIKE * factor }
    };
    known.iter().flatten().any(|factor| *factor != 1.0) && known.iter().zip(gears).all(is_like)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::descriptions::{Change, Description};

    fn verdict(change: Change, factors: Vec<Option<f64>>) -> Verdict {
        Verdict {
            description: Description::as_given(3, [0.0, 0.0, -9.81].into()).with(change),
            before: 9.0,
            after: 0.01,
            each: [Vec::new(), Vec::new()],
            alternatives: Vec::new(),
            next: None,
            shown: None,
            factors,
            factor_bounds: Vec::new(),
            by_bodies: false,
            spread: None,
            assumed: Vec::new(),
            unlike_bodies: false,
            without_bodies: false,
            beyond_doubt: false,
        }
    }

    #[test]
    fn factors_are_gears_where_each_is_like_its_own() {
        let alone = verdict(Change::JointScale(1, 99.0), Vec::new());
        assert!(explain(&alone, &[1.0, 100.0, 1.0]) && explain(&alone, &[1.0, -100.0, 1.0]));
        // Another gear, and gears of torques without a factor.
        assert!(!explain(&alone, &[1.0, 40.0, 1.0]) && !explain(&alone, &[100.0; 3]) && !explain(&alone, &[1.0; 3]));
        let each = verdict(Change::TorqueScale(100.0), vec![Some(0.01), Some(1.0 / 60.0), None]);
        assert!(explain(&each, &[100.0, 50.0, 7.0]) && !explain(&each, &[100.0, 20.0, 7.0]));
    }
}
