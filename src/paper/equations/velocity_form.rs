//! The velocity factors of the sine terms.

use super::variant::JOINTS;

/// The velocity factors found in print, with a < b the two joints of the term.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum VelocityForm {
    /// sin(theta_a - theta_b) (theta_b'^2 - theta_a' theta_b'): row a of d/dt dT/dtheta'.
    Lower,
    /// sin(theta_a - theta_b) (theta_a' theta_b' - theta_a'^2): row b of d/dt dT/dtheta'.
    Higher,
    /// sin(theta_a - theta_b) (theta_a' theta_b' + theta_b'^2): the misprint of (7).
    Sum,
    /// sin(theta_i - theta_j) theta_j'^2: the Euler-Lagrange equation.
    Centrifugal,
}

impl VelocityForm {
    /// Value in row `i` for the other joint `j`.
    pub(super) fn evaluate(self, i: usize, j: usize, theta: &[f64; JOINTS], dtheta: &[f64; JOINTS]) -> f64 {
        let (a, b) = (i.min(j), i.max(j));
        let sine = (theta[a] - theta[b]).sin();
        let (va, vb) = (dtheta[a], dtheta[b]);
        match self {
            VelocityForm::Lower => sine * (vb * vb - va * vb),
            VelocityForm::Higher => sine * (va * vb - va * va),
            VelocityForm::Sum => sine * (va * vb + vb * vb),
            VelocityForm::Centrifugal => (theta[i] - theta[j]).sin() * dtheta[j] * dtheta[j],
        }
    }
}
