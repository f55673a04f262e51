//! Channels without values, and torques that were not measured.

use crate::recording::Recording;
use crate::recording::columns::{ABSENT, Layout};

/// A column with a smaller share of numbers holds nothing: drivers send a value when they start, and then none.
const FEWEST_VALUES: f64 = 0.01;

/// Values that a column of velocity may lack, as a share of the rows: these rows are left out. A velocity can also be taken
/// from the position, so that more than this costs the velocity and not the rows.
const FEW_GAPS: f64 = 0.01;

/// A torque that lacks more than half of its values would take the rows of the other joints with it.
const MOST_VALUES: f64 = 0.5;

/// A torque or velocity that is the same in fewer rows may be that by chance.
const FEWEST_ROWS: usize = 50;

/// A position that covers more than so many of its usual steps goes on: noise about one place, and the last digit of an encoder,
/// cover a few.
const GOES_ON: f64 = 10.0;

/// A joint is at a constant speed where its mean speed in each of so many parts of the log is within this share of that of the whole.
const PARTS: usize = 10;
const STEADY: f64 = 0.1;

/// The columns in use of which no row holds a number; none where there is no row, or where it is all that there is of position.
pub(crate) fn empty_columns(layout: &Layout, columns: &[Vec<f64>]) -> Vec<usize> {
    let is_empty = |column: &usize| {
        let values = &columns[*column];
        let finite = values.iter().filter(|value| value.is_finite()).count() as f64;
        !values.is_empty() && finite < FEWEST_VALUES * values.len() as f64
    };
    let time = layout.time();
    let empty: Vec<usize> = layout.used().into_iter().filter(|column| *column != time && is_empty(column)).collect();
    let positions = layout.positions();
    if positions.iter().all(|column| empty.contains(column)) { Vec::new() } else { empty }
}

/// The columns of velocity and acceleration that lack more than a few of the values: what they lack must not cost rows in
/// which positions and torques are there.
pub(crate) fn derivatives_with_gaps(layout: &Layout, columns: &[Vec<f64>]) -> Vec<usize> {
    let lacks = |column: &usize| {
        let values = &columns[*column];
        let missing = values.iter().filter(|value| !value.is_finite()).count() as f64;
        missing > FEW_GAPS * values.len() as f64
    };
    layout.derivatives().filter(lacks).collect()
}

/// The columns of torque that lack most of the values while another joint has them: they cost their joint, and not the rows of the
/// others.
pub(crate) fn torques_with_gaps(layout: &Layout, columns: &[Vec<f64>]) -> Vec<usize> {
    let torques: Vec<usize> = layout.torques().iter().copied().filter(|column| *column != ABSENT).collect();
    let holds = |column: &usize| {
        let values = &columns[*column];
        values.iter().filter(|value| value.is_finite()).count() as f64 / values.len().max(1) as f64
    };
    let (most, few): (Vec<usize>, Vec<usize>) = torques.into_iter().partition(|column| holds(column) > MOST_VALUES);
    if most.is_empty() { Vec::new() } else { few }
}

/// Puts NaN in the place of torques that are the same in every row, unless all are; returns a note on it.
pub(crate) fn constant_torques(log: &mut Recording) -> Vec<String> {
    let constant = |joint: usize| Some((joint, in_every_row(log.tau.channel(joint))?));
    let constant: Vec<(usize, f64)> = (0..log.joints()).filter_map(constant).collect();
    let with_torque = (0..log.joints()).filter(|joint| log.has_torque(*joint)).count();
    if constant.len() == with_torque {
        return Vec::new();
    }
    constant.iter().for_each(|&(joint, _)| log.tau.channel_mut(joint).fill(f64::NAN));
    let mut values: Vec<f64> = Vec::new();
    for &(_, value) in &constant {
        if !values.contains(&value) {
            values.push(value);
        }
    }
    // Joints that share a value have one line.
    let line = |value: f64| {
        let own: Vec<String> =
            constant.iter().filter(|own| own.1 == value).map(|&(joint, _)| log.joints[joint].clone()).collect();
        match own.as_slice() {
            [one] => format!("the torque of {one} is {value} in every row: it was not measured, and is not used"),
            several => format!(
                "the torques of {} are {value} in every row: they were not measured, and are not used",
                several.join(", ")
            ),
        }
    };
    values.into_iter().map(line).collect()
}

/// Puts NaN in the place of velocities that are the same in every row although the position goes on, and not at a constant speed: they are
/// not used; returns a note on it. Positions that were wrapped have been unwrapped.
pub(crate) fn constant_velocities(log: &mut Recording) -> Vec<String> {
    let Some(qd) = &mut log.qd else { return Vec::new() };
    let mut notes = Vec::new();
    for (joint, name) in log.joints.iter().enumerate() {
        let own = qd.channel_mut(joint);
        let q = log.q.channel(joint);
        let measured = |value: &f64| !goes_on(q) || (*value != 0.0 && is_steady(&log.time, q));
        if let Some(value) = in_every_row(own).filter(|value| !measured(value)) {
            notes.push(format!(
                "the velocity of {name} is {value} in every row although the joint moves: it was not measured, and is not used"
            ));
            own.fill(f64::NAN);
        }
    }
    if (0..log.joints()).all(|joint| !log.has_velocity(joint)) {
        log.qd = None;
    }
    notes
}

/// Whether a position goes on at the same speed all along: over each of some parts of the log.
fn is_steady(time: &[f64], q: &[f64]) -> bool {
    let speed = |from: usize, to: usize| (q[to] - q[from]) / (time[to] - time[from]);
    let last = q.len() - 1;
    let mean = speed(0, last);
    let part = |k: usize| k * last / PARTS;
    (0..PARTS).all(|k| (speed(part(k), part(k + 1)) - mean).abs() < STEADY * mean.abs())
}

/// The value of a signal that has the same in every row, if there are rows enough to decide.
fn in_every_row(signal: &[f64]) -> Option<f64> {
    let first = signal.first().copied().filter(|first| first.is_finite() && signal.len() >= FEWEST_ROWS)?;
    signal.iter().all(|value| *value == first).then_some(first)
}

/// Whether a position covers more than noise about one place does, in any unit.
fn goes_on(q: &[f64]) -> bool {
    let mut steps: Vec<f64> = q.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0).collect();
    if steps.is_empty() {
        return false;
    }
    let middle = steps.len() / 2;
    let usual = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let (low, high) = q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    high - low > GOES_ON * usual
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::samples;

    #[test]
    fn a_constant_torque_was_not_measured() {
        let mut log = samples::full(3, 60);
        log.tau.channel_mut(1).fill(0.0);
        let notes = constant_torques(&mut log);
        assert!(notes.len() == 1 && notes[0].contains("axis_2 is 0 in every row"), "{notes:?}");
        assert_eq!([0, 1, 2].map(|joint| log.has_torque(joint)), [true, false, true]);
        let mut all = samples::full(2, 60);
        all.tau.as_mut_slice().fill(0.0);
        assert!(constant_torques(&mut all).is_empty() && all.has_torque(0));
    }

    #[test]
    fn a_constant_velocity_of_a_joint_that_moves_was_not_measured() {
        let mut log = samples::full(3, 60);
        log.qd = Some(log.q.map(|_, q| vec![0.0; q.len()]));
        let moving: Vec<f64> = (0..60).map(|i| 0.01 * f64::from(i)).collect();
        log.q.channel_mut(0).copy_from_slice(&moving);
        log.q.channel_mut(1).fill(0.3);
        // The last digit of an encoder.
        let flickers: Vec<f64> = (0..60).map(|i| 0.3 + 1e-4 * f64::from(i % 3)).collect();
        log.q.channel_mut(2).copy_from_slice(&flickers);
        let notes = constant_velocities(&mut log);
        assert!(notes.len() == 1 && notes[0].contains("axis_1 is 0 in every row"), "{notes:?}");
        assert_eq!([0, 1, 2].map(|joint| log.has_velocity(joint)), [false, true, true]);
    }

    #[test]
    fn a_wheel_at_a_constant_speed_has_a_constant_velocity() {
        let measured = |bend: f64, velocity: f64| {
            let mut log = samples::full(1, 101);
            log.time = (0..101).map(|row| 0.01 * f64::from(row)).collect();
            // Its speed grows from one to one and twice the bend.
            let q: Vec<f64> = log.time.iter().map(|t| t + bend * t * t).collect();
            log.q.channel_mut(0).copy_from_slice(&q);
            log.qd = Some(log.q.map(|_, q| vec![velocity; q.len()]));
            constant_velocities(&mut log).is_empty()
        };
        // The parts at the ends are 0.9 times the bend from the mean.
        assert_eq!([measured(0.0, 1.0), measured(0.12, 1.0), measured(0.14, 1.0)], [true, true, false]);
        assert!(!measured(0.0, 0.0));
    }
}
