//! Over which speed dry friction changes its direction. Books write a sign; simulators and drivers write tanh(v / width), whose tails reach
//! far beyond the rows that are left out near reversals and look like friction that falls at low speed.
//!
//! One law that is wrong on one joint must not be taken for it: the width is that of all joints, and what the joints that gain most by it
//! gain does not count.

use super::known::Known;
use super::side::Side;
use super::whitening::Whitener;
use crate::error::Result;
use crate::identification::model::Model;
use rayon::prelude::*;

/// Widths that are tried, rad/s or m/s. Narrower ones end within the rows that are left out.
const WIDTHS: [f64; 8] = [0.01, 0.015, 0.02, 0.03, 0.04, 0.05, 0.07, 0.1];

/// Joints whose gain does not count, where more than twice as many are left.
const LEFT_OUT: usize = 2;

/// By how much more likely, in its logarithm, the torque of the others must be than with a plain sign.
const LIKELIER: f64 = 5.0;

/// The width under which the torque of most joints is likeliest, rad/s or m/s; zero where a plain sign does as well. `side` is all logs, made
/// with the arm as `known`: where motions are slow tells most, and those may be the held-out ones.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn likeliest(model: &Model, known: &Known, side: &Side) -> Result<f64> {
    let whitener = Whitener::new(&side.rows, &side.torque, &side.baseline);
    let left = |side: &Side| -> Vec<f64> {
        let residual = whitener.fit(&side.baseline, &side.torque).residual;
        let of_joint = |joint| residual.part(joint).unwrap_or_default().iter().map(|r| r * r).sum();
        (0..model.dof()).map(of_joint).collect()
    };
    let plain = left(side);
    let gain = |&width: &f64| -> Result<(f64, f64)> {
        let known = known.with_sign_width(width);
        let with = left(&Side::new(model, &known, side.rows.clone(), side.training)?);
        let gains: Vec<f64> = plain.iter().zip(with).map(|(plain, with)| 0.5 * (plain - with)).collect();
        tracing::debug!(width, ?gains, "width of the sign of friction");
        Ok((of_most(gains), width))
    };
    let gains: Vec<(f64, f64)> = WIDTHS.par_iter().map(gain).collect::<Result<_>>()?;
    let best = gains.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b));
    Ok(best.filter(|(gain, _)| *gain > LIKELIER).map_or(0.0, |(_, width)| width))
}

/// The sum without the largest.
fn of_most(mut gains: Vec<f64>) -> f64 {
    gains.sort_by(f64::total_cmp);
    let counted = gains.len() - LEFT_OUT.min(gains.len().saturating_sub(1) / 2);
    gains[..counted].iter().sum()
}

#[cfg(test)]
mod tests {
    use super::of_most;

    #[test]
    fn what_one_or_two_joints_gain_does_not_count() {
        assert_eq!(of_most(vec![900.0, 1.0, 2.0, 800.0, -1.0, 0.5]), 2.5);
        assert_eq!(of_most(vec![5.0, 9.0, 4.0]), 9.0);
        assert_eq!(of_most(vec![7.0]), 7.0);
    }
}
