//! The regressor: torques are linear in X.

use super::terms::{Factor, terms};
use super::variant::{GRAVITY, JOINTS, PARAMETER_COUNT, Variant};

/// The regressor Y at one instant: tau_i = sum_k Y\[i\]\[k\] X_(k+1).
///
/// `theta` in rad, `dtheta` in rad/s, `ddtheta` in rad/s^2, joint angles as in the paper. tau in N m, X in the units of
/// [`super::tables::PARAMETERS`].
pub(crate) fn regressor(
    variant: Variant,
    theta: &[f64; JOINTS],
    dtheta: &[f64; JOINTS],
    ddtheta: &[f64; JOINTS],
) -> [[f64; PARAMETER_COUNT]; JOINTS] {
    let mut y = [[0.0; PARAMETER_COUNT]; JOINTS];
    for term in terms(variant) {
        let i = term.row;
        y[i][term.parameter - 1] += match term.factor {
            Factor::Acceleration(j) => ddtheta[j],
            Factor::AccelerationCosine(j) => ddtheta[j] * (theta[i] - theta[j]).cos(),
            Factor::VelocitySine(j, form) => form.evaluate(i, j, theta, dtheta),
            Factor::Gravity => GRAVITY * theta[i].cos(),
            Factor::CoulombFriction => {
                if dtheta[i] == 0.0 {
                    0.0
                } else {
                    dtheta[i].signum()
                }
            }
            Factor::ViscousFriction => dtheta[i],
        };
    }
    y
}
