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
//! print; [`Variant`] is how far misprints are corrected. What remains in all variants, because it is the model itself:
//!
//! - The equations are those of a planar chain: every joint turns in one vertical plane and only differences of two
//!   angles occur. The IRB 1600 is a spatial arm (joint 1 turns about the vertical, where gravity does no work).
//! - The cosine and gravity terms hold for angles measured from the fixed horizontal, the sums of moments of inertia
//!   in C for angles measured from the link before. The paper puts the joint angles in both; so does this code,
//!   with those of Table 1. [`AbsoluteAngles`] is the other reading, for comparison.
//! - X occur in sums: only 48 (as printed) or 44 (corrected) combinations show in the torques, whatever the motion; see
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
mod linear;
mod regressor;
pub(crate) mod structure;
pub(crate) mod tables;
mod terms;
#[cfg(test)]
mod tests;
mod variant;
mod velocity_form;

pub(crate) use departures::DEPARTURES;
pub(crate) use linear::AbsoluteAngles;
pub(crate) use regressor::regressor;
pub(crate) use variant::{GRAVITY, JOINTS, PARAMETER_COUNT, Variant};
