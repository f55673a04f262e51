//! Torques that are linear in X: the regressor, and the mass matrix that it implies.

use super::terms::{Factor, terms};
use super::variant::{GRAVITY, JOINTS, PARAMETER_COUNT, Variant};

/// The regressor Y at one instant: tau_i = sum_k Y\[i\]\[k\] X_(k+1).
///
/// `theta` in rad, `dtheta` in rad/s, `ddtheta` in rad/s^2, joint angles as in the paper. tau in N m, X in the units of
/// [`super::tables::PARAMETERS`].
pub fn regressor(
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

/// The mass matrix that the accelerations imply for the parameters `x`, in kg m^2.
pub fn mass_matrix(variant: Variant, theta: &[f64; JOINTS], x: &[f64; PARAMETER_COUNT]) -> [[f64; JOINTS]; JOINTS] {
    let mut mass = [[0.0; JOINTS]; JOINTS];
    for term in terms(variant) {
        let value = x[term.parameter - 1];
        match term.factor {
            Factor::Acceleration(j) => mass[term.row][j] += value,
            Factor::AccelerationCosine(j) => mass[term.row][j] += value * (theta[term.row] - theta[j]).cos(),
            _ => {}
        }
    }
    mass
}
