//! Inertias that say nothing about the arm: a file that describes none, or one body for every link.

use super::arm::Robot;
use super::joint::Joint;

/// Fewer bodies that are alike may be so in truth, as the fingers of a gripper and the links of a planar arm are.
const FEWEST: usize = 3;

/// Relative difference up to which two numbers of a file are one.
const SAME: f64 = 1e-6;

impl Robot {
    /// What is wrong where the inertias of the file are no knowledge of the arm: then they are not to be trusted.
    pub fn placeholders(&self) -> Option<String> {
        let bodies: Vec<&Joint> = (0..self.bodies()).map(|body| self.body(body)).collect();
        if bodies.iter().all(|body| body.inertia.mass() == 0.0) {
            return Some("the robot's file describes no inertias of the links that move".into());
        }
        // A tool that is welded to the last link may make that another.
        let alike = bodies.iter().filter(|body| is_same(body, bodies[0])).count();
        (alike >= FEWEST && alike + 1 >= bodies.len()).then(|| {
            format!(
                "the inertias of the robot's file are placeholders: identical for {alike} links ({} kg each)",
                bodies[0].inertia.mass()
            )
        })
    }
}

/// Whether two bodies have one mass and the same moments of inertia about their centres.
fn is_same(one: &Joint, other: &Joint) -> bool {
    let of = |body: &Joint| {
        let mut moments: Vec<f64> =
            body.inertia.tensor_about_center().symmetric_eigenvalues().iter().copied().collect();
        moments.sort_by(f64::total_cmp);
        moments.push(body.inertia.mass());
        moments
    };
    let (one, other) = (of(one), of(other));
    let size = other.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    one.iter().zip(&other).all(|(a, b)| (a - b).abs() <= SAME * b.abs().max(SAME * size))
}

#[cfg(test)]
mod tests {
    use crate::robot::{Inertia, InertiaCheck, load};

    #[test]
    fn bodies_that_are_all_alike_are_placeholders() {
        let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let robot = load(urdf, InertiaCheck::Required).unwrap();
        assert_eq!(robot.placeholders(), None);
        let with = |inertia: &dyn Fn(usize) -> Inertia| {
            let mut robot = robot.clone();
            robot.joints.iter_mut().enumerate().for_each(|(joint, own)| own.inertia = inertia(joint));
            robot.placeholders()
        };
        let body = |mass: f64, place: f64| {
            Inertia::from_center_of_mass(
                mass,
                nalgebra::Vector3::new(place, 0.0, 0.1),
                nalgebra::Matrix3::identity() * 0.01,
            )
        };
        let said = with(&|joint| body(2.0, 0.1 * joint as f64)).unwrap();
        assert!(said.contains("identical for 6 links (2 kg each)"), "{said}");
        // A tool on the last link; other masses.
        assert!(with(&|joint| body(if joint == 5 { 2.4 } else { 2.0 }, 0.0)).is_some());
        assert_eq!(with(&|joint| body(if joint > 3 { 2.4 } else { 2.0 }, 0.0)), None);
        assert!(with(&|_| Inertia::default()).unwrap().contains("no inertias"));
    }
}
