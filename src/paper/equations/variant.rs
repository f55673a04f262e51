//! The variants of the model and its sizes.

/// Number of parameters X.
pub(crate) const PARAMETER_COUNT: usize = 78;

/// Number of joints.
pub(crate) const JOINTS: usize = 6;

/// Acceleration of gravity in m/s^2; the paper gives no value.
pub(crate) const GRAVITY: f64 = 9.81;

/// How far misprints are corrected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Variant {
    /// Letter by letter; only what cannot be computed otherwise is settled. The mass matrix is not symmetric.
    AsPrinted,
    /// Slips of index, bracket and sign corrected by comparing the rows, so that the mass matrix is symmetric and all sine
    /// terms are of one form. Energy is still not conserved: the sine terms are those of d/dt dT/dtheta' alone.
    Consistent,
    /// As [`Variant::Consistent`], with dT/dtheta subtracted: the sine terms become B_ij sin(theta_i - theta_j)
    /// theta_j'^2, and the power of the torques without friction and gravity is the change of kinetic energy.
    EulerLagrange,
}

impl Variant {
    /// All variants, from the print outwards.
    pub(crate) const ALL: [Variant; 3] = [Variant::AsPrinted, Variant::Consistent, Variant::EulerLagrange];

    /// Name in results.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Variant::AsPrinted => "as_printed",
            Variant::Consistent => "consistent",
            Variant::EulerLagrange => "euler_lagrange",
        }
    }
}
