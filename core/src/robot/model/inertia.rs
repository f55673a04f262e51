//! The ten inertial parameters of a rigid body.

use super::unit::Unit;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Number of inertial parameters of one body.
pub const PARAMETERS: usize = 10;

/// Symbols of the inertial parameters, in the order in which [`Inertia`] holds them.
pub const SYMBOLS: [&str; PARAMETERS] = ["m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];

/// Units of the inertial parameters, in the same order.
pub const UNITS: [Unit; PARAMETERS] = {
    let (moment, inertia) = (Unit::FirstMoment, Unit::MomentOfInertia);
    [Unit::Mass, moment, moment, moment, inertia, inertia, inertia, inertia, inertia, inertia]
};

/// Inertial parameters m, mx, my, mz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz of a body, about the origin and in the axes of the
/// frame it is attached to (kg, kg m, kg m2). Torque is linear in these ten (Atkeson, An and Hollerbach 1986).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use nalgebra::{Matrix3, Vector3};
/// use tauscope::robot::Inertia;
///
/// // A point of 2 kg at 0.5 m along x: m, first moments and, by the parallel-axis theorem, moments about the origin.
/// let body = Inertia::from_center_of_mass(2.0, Vector3::new(0.5, 0.0, 0.0), Matrix3::zeros());
/// assert_eq!(body.0, [2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.5]);
/// assert_eq!(body.physical_fault(1e-9), None);
///
/// // Parameters of bodies welded together add up.
/// assert_eq!(body.welded_to(&body).mass(), 4.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inertia(pub [f64; PARAMETERS]);

impl Inertia {
    /// From mass, centre of mass and the inertia tensor about the centre of mass, all in the axes of the frame.
    pub fn from_center_of_mass(mass: f64, center: Vector3<f64>, tensor: Matrix3<f64>) -> Self {
        let about_origin = tensor + steiner(mass, center);
        let first = mass * center;
        Inertia([
            mass,
            first.x,
            first.y,
            first.z,
            about_origin[(0, 0)],
            about_origin[(0, 1)],
            about_origin[(1, 1)],
            about_origin[(0, 2)],
            about_origin[(1, 2)],
            about_origin[(2, 2)],
        ])
    }

    /// Mass in kg.
    pub fn mass(&self) -> f64 {
        self.0[0]
    }

    /// First moment m c in kg m.
    pub fn first_moment(&self) -> Vector3<f64> {
        Vector3::new(self.0[1], self.0[2], self.0[3])
    }

    /// Inertia tensor about the frame origin in kg m2.
    pub fn tensor(&self) -> Matrix3<f64> {
        let [_, _, _, _, xx, xy, yy, xz, yz, zz] = self.0;
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// Centre of mass in m; the origin for a body without mass.
    pub fn center_of_mass(&self) -> Vector3<f64> {
        if self.mass() == 0.0 { Vector3::zeros() } else { self.first_moment() / self.mass() }
    }

    /// Inertia tensor about the centre of mass in kg m2.
    pub fn tensor_about_center(&self) -> Matrix3<f64> {
        self.tensor() - steiner(self.mass(), self.center_of_mass())
    }

    /// The same body seen from a parent frame, in which this frame stands at `translation`, turned by `rotation`.
    pub(crate) fn seen_from_parent(&self, rotation: &Matrix3<f64>, translation: &Vector3<f64>) -> Self {
        Self::from_center_of_mass(
            self.mass(),
            rotation * self.center_of_mass() + translation,
            rotation * self.tensor_about_center() * rotation.transpose(),
        )
    }

    /// Two bodies welded together, both given in the same frame.
    pub fn welded_to(&self, other: &Inertia) -> Self {
        let mut sum = *self;
        for (value, extra) in sum.0.iter_mut().zip(&other.0) {
            *value += extra;
        }
        sum
    }

    /// Why no distribution of positive mass can have these parameters, or None where one can: mass and principal
    /// moments must not be negative, and no principal moment may exceed the sum of the other two
    /// (Traversaro et al. 2016). `slack` is the relative violation that is forgiven as rounding in a file.
    pub fn physical_fault(&self, slack: f64) -> Option<String> {
        if let Some((value, symbol)) = self.0.iter().zip(SYMBOLS).find(|(value, _)| !value.is_finite()) {
            return Some(format!("{symbol} is {value}; it must be a finite number"));
        }
        if self.mass() < 0.0 {
            return Some(format!("mass {} kg is negative; give a mass of zero or more", self.mass()));
        }
        let tensor = self.tensor_about_center();
        let mut moments: Vec<f64> = SymmetricEigen::new(tensor).eigenvalues.iter().copied().collect();
        moments.sort_by(f64::total_cmp);
        let [low, mid, high] = [moments[0], moments[1], moments[2]];
        if low < -slack * high.abs() {
            return Some(format!(
                "inertia tensor has the negative principal moment {low:.6e} kg m2 (principal moments {low:.6e}, {mid:.6e}, \
                 {high:.6e}); it must be positive definite"
            ));
        }
        if high > (low + mid) * (1.0 + slack) + f64::MIN_POSITIVE {
            return Some(format!(
                "inertia breaks the triangle inequality: the principal moment {high:.6e} exceeds the sum of the other two, \
                 {low:.6e} + {mid:.6e} kg m2; no body has such an inertia, check ixx..izz and their units"
            ));
        }
        None
    }
}

/// Parallel-axis term m (|c|^2 1 - c c').
fn steiner(mass: f64, center: Vector3<f64>) -> Matrix3<f64> {
    mass * (Matrix3::identity() * center.norm_squared() - center * center.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parallel_axis_by_hand() {
        // 2 kg point-like body with tensor diag(1, 1, 1) at (1, 0, 0): Iyy and Izz gain 2 kg m2.
        let body = Inertia::from_center_of_mass(2.0, Vector3::x(), Matrix3::identity());
        assert_eq!(body.0, [2.0, 2.0, 0.0, 0.0, 1.0, 0.0, 3.0, 0.0, 0.0, 3.0]);
        assert_eq!(body.tensor_about_center(), Matrix3::identity());
    }

    #[test]
    fn a_rod_turned_into_the_parent_frame() {
        // A rod along its own x, turned so that its x is the parent's y and put at z = 1.
        let rod =
            Inertia::from_center_of_mass(1.0, Vector3::zeros(), Matrix3::from_diagonal(&Vector3::new(0.0, 1.0, 1.0)));
        let turn = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let seen = rod.seen_from_parent(&turn, &Vector3::z());
        assert_eq!(seen.tensor(), Matrix3::from_diagonal(&Vector3::new(2.0, 1.0, 1.0)));
        assert_eq!(seen.first_moment(), Vector3::z());
    }

    #[test]
    fn impossible_bodies_are_named() {
        let with = |moments: [f64; 3], mass| {
            Inertia::from_center_of_mass(mass, Vector3::zeros(), Matrix3::from_diagonal(&Vector3::from(moments)))
        };
        assert_eq!(with([1.0, 1.0, 2.0], 1.0).physical_fault(1e-9), None, "a flat disc is the limit case");
        assert!(with([1.0, 1.0, 2.1], 1.0).physical_fault(1e-9).unwrap().contains("triangle"));
        assert!(with([-0.1, 1.0, 1.0], 1.0).physical_fault(1e-9).unwrap().contains("negative principal"));
        assert!(with([1.0; 3], -1.0).physical_fault(1e-9).unwrap().contains("negative"));
        assert!(with([1.0; 3], f64::NAN).physical_fault(1e-9).unwrap().contains("NaN"));
    }
}
