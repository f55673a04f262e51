//! The 78-parameter model of Ogbemhe, Mpofu and Mokakabye, "Robot dynamic model: freudenstein-based optimal trajectory
//! and parameter identification" (ABB IRB 1600), equations (4)-(9) and Table A1.
//!
//! tau = Y(theta, theta', theta'') X with X1..X78 constant. With M_ij = C_max(i,j) + cos(theta_i - theta_j) B_ij off
//! the diagonal and M_jj = C_j + B_jj on it, row i reads
//!
//! tau_i = sum_j M_ij theta_j'' + velocity terms in B_ij sin(theta_i - theta_j) + g cos(theta_i) G_i
//!         + sgn(theta_i') f_is + theta_i' f_iv,
//!
//! where every C, B, G and f is a sum of X. [`DEPARTURES`] lists each place at which this code does not follow the
//! print; [`Variant`] says how far it goes in mending. What remains in all variants, because it is the model itself:
//!
//! - The equations are those of a planar chain: every joint turns in one vertical plane and only differences of two
//!   angles occur. The IRB 1600 is a spatial arm (joint 1 turns about the vertical, where gravity does no work).
//! - The cosine and gravity terms hold for angles measured from the fixed horizontal, the sums of moments of inertia
//!   in C for angles measured from the link before. The paper puts the joint angles in both; so does this code,
//!   with those of Table 1. [`AbsoluteAngles`] is the other reading, for comparison.
//! - X occur in sums: only 48 (as printed) or 44 (mended) combinations show in the torques, whatever the motion; see
//!   [`structure`].
//! - Friction has a column each for sgn and velocity; sgn(0) is 0.
//!
//! | place | printed | used | by | why |
//! |---|---|---|---|---|
//! | (4) theta2'' | X12 outside the cosine | X12 inside | C, E | (4)'s own sine term and all of (5) have it inside |
//! | (5) sin(theta1 - theta2) | theta2'^2 - theta1' theta2' | theta1' theta2' - theta1'^2 | C, E | copied from (4); see (6)-(9) |
//! | (5) sin(theta2 - theta3) | X35..X37 | X35..X38 | C, E | the cosine and (6) have X38 |
//! | (6) theta1'', theta2'', theta3'' | X18 | X13 | C, E | (4) and (5) have X13 at theta3'' |
//! | (7) sin(theta4 - theta5) | theta4' theta5' + theta5'^2 | theta5'^2 - theta4' theta5' | C, E | all other rows |
//! | (8) theta3'' and sin(theta3 - theta5) | X56, X57 | X55, X56 | C, E | (6) and the masses in Table A1 |
//! | (8) sin(theta4 - theta5) | X66, X64 | X65, X64 | C, E | the cosine of (8), and (7) |
//! | (9) theta3'' and sin(theta3 - theta6) | X58 | X57 | C, E | (6); X58 is gravity on joint 3 |
//! | (8) theta6'', (9) theta5'' | m6 cos() X71 | cos() X71 | all | m6 is no known number and X71 holds it already |
//! | (4)-(9) all sine terms | d/dt dT/dtheta' only | less dT/dtheta | E | Euler-Lagrange has both |
//! | (4)-(9) g | no value | 9.81 m/s^2 | all | |
//! | (13), (14), alpha, (17) | see [`crate::excitation::freudenstein`] | | all | |
//! | Table A1, 2 | kg/s for friction, kg m^2 for gravity | N m, N m s/rad; kg m | all | the equations |
//! | Table A1 | friction symbols repeat joint numbers | the joint of the row | all | the equations |
//! | Table A1 | X13, X18 as X7; X22 with links 2, 3 | links 3..6, 4..6, 5..6 | all | the pattern X1, X7, X25 |
//! | Table 1 | see [`tables`] | | all | |
//! | Table 2 | values of X29..X42 lost | None | all | |
//!
//! (C [`Variant::Consistent`], E [`Variant::EulerLagrange`].)
//!
//! Two things that look like slips are none. (5) has X7 at theta2'': M22 = C_2 + B_22 with C_2 = X7. And the sine terms of
//! (6)-(9) change sign with the order of the joints: sin(theta_i - theta_j) (theta_j'^2 - theta_i' theta_j') written with
//! the lower joint number first.

mod departures;
mod equations;
mod linear;
pub mod structure;
pub mod tables;

pub use departures::{DEPARTURES, Departure, Place};
pub use equations::VelocityForm;
pub use linear::AbsoluteAngles;

use equations::{Factor, terms};

/// Number of parameters X.
pub const PARAMETER_COUNT: usize = 78;

/// Number of joints.
pub const JOINTS: usize = 6;

/// Acceleration of gravity in m/s^2; the paper gives no value.
pub const GRAVITY: f64 = 9.81;

/// How far misprints are mended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Variant {
    /// Letter by letter; only what cannot be computed otherwise is settled. The mass matrix is not symmetric.
    AsPrinted,
    /// Slips of index, bracket and sign mended by comparing the rows, so that the mass matrix is symmetric and all sine
    /// terms are of one form. Energy is still not conserved: the sine terms are those of d/dt dT/dtheta' alone.
    Consistent,
    /// As [`Variant::Consistent`], with dT/dtheta subtracted: the sine terms become B_ij sin(theta_i - theta_j)
    /// theta_j'^2, and the power of the torques without friction and gravity is the change of kinetic energy.
    EulerLagrange,
}

impl Variant {
    /// All variants, from the print outwards.
    pub const ALL: [Variant; 3] = [Variant::AsPrinted, Variant::Consistent, Variant::EulerLagrange];

    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Variant::AsPrinted => "as_printed",
            Variant::Consistent => "consistent",
            Variant::EulerLagrange => "euler_lagrange",
        }
    }
}

/// The regressor Y at one instant: tau_i = sum_k Y\[i\]\[k\] X_(k+1).
///
/// `theta` in rad, `dtheta` in rad/s, `ddtheta` in rad/s^2, joint angles as in the paper. tau in N m, X in the units of
/// [`tables::PARAMETERS`].
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

#[cfg(test)]
mod tests;
