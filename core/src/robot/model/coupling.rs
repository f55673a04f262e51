//! The linear map from coordinates to what follows them, q = A x + b: joints that mimic others, and motors coupled in a wrist.
//!
//! The power is the same on both sides, so the torque on the coordinates is A' times that on what follows, and the regressor
//! of the coordinates is Y A (Featherstone 2008, section 3.5, with constant A).

use crate::channels::Channels;
use crate::lane::Lane;
use nalgebra::DMatrix;

/// A map whose inverse is larger than this does not move what follows independently.
const SINGULAR: f64 = 1e6;

/// One entry of the linear map: what follows one coordinate, q = multiplier x + offset.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::Coupling;
///
/// // A joint that goes the other way, half as far, from 0.2 rad. Torque on it acts back in the same ratio.
/// let coupling = Coupling { coordinate: 0, multiplier: -0.5, offset: 0.2 };
/// assert_eq!(coupling.position(1.0), -0.3);
/// assert_eq!((coupling.rate(1.0), coupling.torque(4.0)), (-0.5, -2.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling {
    /// The coordinate.
    pub coordinate: usize,
    /// Its entry of A.
    pub multiplier: f64,
    /// Entry of b.
    pub offset: f64,
}

impl Coupling {
    /// A coordinate follows itself.
    pub fn own(coordinate: usize) -> Self {
        Coupling { coordinate, multiplier: 1.0, offset: 0.0 }
    }

    /// Position of what follows at the coordinate's position `x`.
    #[inline(always)]
    pub fn position<L: Lane>(&self, x: L) -> L {
        x * L::splat(self.multiplier) + L::splat(self.offset)
    }

    /// Velocity or acceleration of what follows at that of the coordinate.
    #[inline(always)]
    pub fn rate<L: Lane>(&self, xd: L) -> L {
        xd * L::splat(self.multiplier)
    }

    /// Torque on the coordinate of the torque `tau` on what follows.
    #[inline(always)]
    pub fn torque<L: Lane>(&self, tau: L) -> L {
        tau * L::splat(self.multiplier)
    }
}

/// The whole map, a row for each that follows: the sum of its couplings.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use nalgebra::dmatrix;
/// use tauscope::channels::Channels;
/// use tauscope::robot::LinearMap;
///
/// // A wrist whose second joint also turns with the first motor.
/// let joints_of_motors = LinearMap::of_matrix(&dmatrix![1.0, 0.0; 1.0, 1.0]);
/// let motors = Channels::from_vectors(&[vec![0.5], vec![0.25]]);
/// let joints = joints_of_motors.positions(&motors);
/// assert_eq!(joints.at(0), [0.5, 0.75]);
///
/// // Back to the motors; and torque, A' tau, the other way than motion.
/// let back = joints_of_motors.inverse().expect("A can be inverted");
/// assert_eq!(back.positions(&joints), motors);
/// assert_eq!(joints_of_motors.torques(&Channels::from_vectors(&[vec![3.0], vec![2.0]])).at(0), [5.0, 2.0]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LinearMap {
    coordinates: usize,
    rows: Vec<Vec<Coupling>>,
}

impl LinearMap {
    /// The map from `coordinates` coordinates with the given rows.
    ///
    /// # Panics
    /// If a row names a coordinate that there is not.
    pub fn new(coordinates: usize, rows: Vec<Vec<Coupling>>) -> Self {
        assert!(rows.iter().flatten().all(|entry| entry.coordinate < coordinates), "a row names an unknown coordinate");
        LinearMap { coordinates, rows }
    }

    /// The map q = A x. Entries of zero are left out, so that a value that is not a number spoils only what follows it.
    pub fn of_matrix(matrix: &DMatrix<f64>) -> Self {
        let entry = |row: usize, coordinate: usize| {
            let multiplier = matrix[(row, coordinate)];
            (multiplier != 0.0).then_some(Coupling { coordinate, multiplier, offset: 0.0 })
        };
        let row = |row: usize| (0..matrix.ncols()).filter_map(|coordinate| entry(row, coordinate)).collect();
        Self::new(matrix.ncols(), (0..matrix.nrows()).map(row).collect())
    }

    /// Positions of all that follow, `[row][time]`, at the positions `x` of the coordinates, `[coordinate][time]`.
    pub fn positions(&self, x: &Channels) -> Channels {
        self.forward(x, |entry, x| entry.position(x))
    }

    /// Velocities or accelerations of all that follow, from those of the coordinates.
    pub fn rates(&self, xd: &Channels) -> Channels {
        self.forward(xd, |entry, xd| entry.rate(xd))
    }

    fn forward(&self, x: &Channels, law: impl Fn(&Coupling, f64) -> f64) -> Channels {
        assert_eq!(x.channels(), self.coordinates, "the map is of another number of coordinates");
        let mut out = Channels::zeros(self.rows.len(), x.samples());
        for (row, entries) in self.rows.iter().enumerate() {
            for entry in entries {
                let signal = x.channel(entry.coordinate);
                out.channel_mut(row).iter_mut().zip(signal).for_each(|(sum, &x)| *sum += law(entry, x));
            }
        }
        out
    }

    /// Torques on the coordinates, A' tau, of those on all that follow, `[row][time]`.
    pub fn torques(&self, tau: &Channels) -> Channels {
        assert_eq!(tau.channels(), self.rows.len(), "the map has another number of rows");
        let mut out = Channels::zeros(self.coordinates, tau.samples());
        for (row, entries) in self.rows.iter().enumerate() {
            for entry in entries {
                let sums = out.channel_mut(entry.coordinate).iter_mut();
                sums.zip(tau.channel(row)).for_each(|(sum, &tau)| *sum += entry.torque(tau));
            }
        }
        out
    }

    /// The map back, x = A^-1 (q - b); none if it is not square, or so near to singular that some motion of the coordinates
    /// moves nothing.
    pub fn inverse(&self) -> Option<LinearMap> {
        let mut matrix = DMatrix::<f64>::zeros(self.rows.len(), self.coordinates);
        for (row, entries) in self.rows.iter().enumerate() {
            entries.iter().for_each(|entry| matrix[(row, entry.coordinate)] += entry.multiplier);
        }
        let offset = |entries: &Vec<Coupling>| entries.iter().map(|entry| entry.offset).sum::<f64>();
        let offsets = nalgebra::DVector::from_iterator(self.rows.len(), self.rows.iter().map(offset));
        let inverse = matrix.is_square().then(|| matrix.try_inverse()).flatten()?;
        if inverse.amax() >= SINGULAR {
            return None;
        }
        let shift = &inverse * offsets;
        let mut back = Self::of_matrix(&inverse);
        for (entries, shift) in back.rows.iter_mut().zip(&shift) {
            // A row of an invertible matrix is not empty.
            entries[0].offset = -*shift;
        }
        Some(back)
    }
}

#[cfg(test)]
mod tests {
    use super::{Coupling, LinearMap};
    use crate::channels::Channels;

    /// x1 = 2 q1, x2 = q1 - 0.5 q2 + 0.3.
    fn map() -> LinearMap {
        let entry = |coordinate, multiplier, offset| Coupling { coordinate, multiplier, offset };
        LinearMap::new(2, vec![vec![entry(0, 2.0, 0.0)], vec![entry(0, 1.0, 0.1), entry(1, -0.5, 0.2)]])
    }

    #[test]
    fn the_power_is_the_same_on_both_sides() {
        let (map, rates) = (map(), Channels::from_vectors(&[vec![0.3, -1.0], vec![2.0, 0.7]]));
        let tau = Channels::from_vectors(&[vec![5.0, 1.0], vec![-2.0, 3.0]]);
        let (followers, on_coordinates) = (map.rates(&rates), map.torques(&tau));
        let power = |a: &Channels, b: &Channels, at: usize| -> f64 {
            a.at(at).iter().zip(b.at(at)).map(|(rate, torque)| rate * torque).sum()
        };
        for sample in 0..2 {
            let (one, other) = (power(&followers, &tau, sample), power(&rates, &on_coordinates, sample));
            assert!((one - other).abs() < 1e-12, "{one} {other}");
        }
        assert_eq!(on_coordinates.at(0), [8.0, 1.0]);
    }

    #[test]
    fn the_map_back_undoes_it() {
        let (map, x) = (map(), Channels::from_vectors(&[vec![0.3, -1.0], vec![2.0, 0.7]]));
        let q = map.positions(&x);
        assert!((q.channel(1)[0] - (0.3 - 1.0 + 0.3)).abs() < 1e-15);
        let back = map.inverse().unwrap().positions(&q);
        for (found, expected) in back.as_slice().iter().zip(x.as_slice()) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        let double = LinearMap::new(2, vec![vec![Coupling::own(0)], vec![Coupling::own(0)]]);
        assert_eq!((double.inverse(), LinearMap::new(2, vec![vec![Coupling::own(0)]]).inverse()), (None, None));
    }
}
