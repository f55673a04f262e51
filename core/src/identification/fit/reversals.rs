//! Whether rows near reversals are as good as others.
//!
//! A row whose filter reaches a reversal, or slow motion, holds a part of the jump of friction there. Only in the model is that jump as
//! sharp as a sign: gears wind up, lubricant sticks, and the low-pass bends the motion. Where the residual is larger there, such rows bias
//! friction.

use crate::identification::regression::joint_regression::JointRegression;

/// Mean squared residual near reversals over that of the other rows from which a row there is worth less than a tenth of another. Friction
/// at low speed, which belongs to the parameters that are asked for, makes up to six times as much on real arms; a sign that is wrong in
/// time, twenty times.
const WORSE: f64 = 10.0;

/// Fewest rows for a mean square.
const FEWEST: usize = 30;

/// What the other rows must be at least: a share of all, and so many for each parameter of the joint.
const SHARE: f64 = 1.0 / 3.0;
const FEWEST_EACH: usize = 10;

/// Joints whose rows `near` reversals, `[joint][row]`, may stay in a fit that found `beta`.
pub(super) fn kept(regression: &[JointRegression], near: &[Vec<bool>], beta: &[f64]) -> Vec<bool> {
    let judge = |(joint, near): (&JointRegression, &Vec<bool>)| match near.iter().filter(|&&row| row).count() {
        ..FEWEST => true,
        _ => are_good(joint, near, &joint.residual(beta)),
    };
    regression.iter().zip(near).map(judge).collect()
}

/// Whether the rows of a joint that are `near` reversals show no more than the others, or cannot be done without.
fn are_good(joint: &JointRegression, near: &[bool], residual: &[f64]) -> bool {
    let mean_square = |wanted: bool| {
        let rows = joint.valid.iter().zip(near).zip(residual).filter(|((ok, near), _)| **ok && **near == wanted);
        let squares: Vec<f64> = rows.map(|(_, left)| left * left).collect();
        (squares.len(), squares.iter().sum::<f64>() / squares.len().max(1) as f64)
    };
    let ((_, there), (others, elsewhere)) = (mean_square(true), mean_square(false));
    let needed = (SHARE * joint.rows() as f64).max((FEWEST_EACH * joint.parameters.len()).max(FEWEST) as f64);
    tracing::debug!(joint.joint, others, needed, there, elsewhere, "rows near reversals");
    (others as f64) < needed || there < WORSE * elsewhere
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;

    /// Of 300 rows the first so many are near reversals, with a residual of so much times that of the others.
    fn keeps(near: usize, times: f64) -> bool {
        let sign = |row: usize| if row.is_multiple_of(2) { 1.0 } else { -1.0 };
        let residual = |row: usize| sign(row) * if row < near { times } else { 1.0 };
        let joint = JointRegression {
            joint: "a".into(),
            parameters: vec![0],
            columns: Channels::zeros(1, 300),
            torque: (0..300).map(residual).collect(),
            valid: vec![true; 300],
        };
        kept(&[joint], &[(0..300).map(|row| row < near).collect()], &[0.0])[0]
    }

    #[test]
    fn rows_worth_less_than_a_tenth_of_others_are_left_out() {
        assert!(keeps(100, 3.16) && !keeps(100, 3.17));
        // Few rows show nothing, and what most rows are is needed.
        assert!(keeps(29, 4.0) && !keeps(30, 4.0));
        assert!(!keeps(200, 4.0) && keeps(201, 4.0));
    }
}
