//! The mounting of an arm and its known payload.

use super::description::Dataset;
use crate::error::Result;
use crate::robot::{Inertia, LARGEST_GRAVITY, Robot};
use nalgebra::{Matrix3, Vector3};

impl Dataset {
    /// Puts the mounting and the known payload on an arm.
    ///
    /// # Errors
    /// Numbers that are not finite, a payload that no body can have.
    pub fn mount(&self, robot: &mut Robot) -> Result<()> {
        if let Some(gravity) = self.spec.mounting.gravity_m_s2 {
            let gravity = Vector3::from(gravity);
            if !gravity.norm().is_finite() || gravity.norm() > LARGEST_GRAVITY {
                let problem = format!("{:?} is no gravity in m/s2: give it as in [0, 0, -9.81]", gravity.as_slice());
                return Err(self.error("mounting.gravity_m_s2", problem));
            }
            robot.gravity = gravity;
        }
        let Some(payload) = &self.spec.payload else { return Ok(()) };
        let (tip, flange) = (robot.tip(), robot.flange);
        let last = robot.body_mut(tip);
        let [xx, xy, yy, xz, yz, zz] = payload.inertia_kg_m2;
        let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let body = Inertia::from_center_of_mass(payload.mass_kg, Vector3::from(payload.center_m), tensor);
        if let Some(problem) = body.physical_fault(1e-3) {
            return Err(self.error("payload", problem));
        }
        last.inertia = last.inertia.welded_to(&body.seen_from_parent(&flange.rotation, &flange.translation));
        Ok(())
    }
}
