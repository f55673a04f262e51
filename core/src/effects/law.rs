//! What a law does: the trait of all effects, and the state of the arm that it sees.

use super::about::{About, Parameter};
use super::gear::Gear;
use super::limit::Limit;
use super::search::{Derived, DriveParameter, Search};
use crate::dynamics::Chain;
use crate::robot::{Pose, Robot};

/// The state of the arm at one instant, as a law sees it. All slices have one entry per joint.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dynamics::Chain;
/// use tauscope::effects::{Effect, Instant, JointSpring, ViscousFriction};
/// use tauscope::robot::{self, InertiaCheck};
///
/// let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let (q, qd, qdd, direction, load) = (&[0.5], &[2.0], &[0.0], &[1.0], &[0.0]);
/// let chain = Chain::new(&robot);
/// let [t, started] = [0.0, 0.0];
/// let state = Instant { t, started, q, qd, qdd, direction, load, robot: &robot, chain: &chain, frames: None };
///
/// // Laws add their torque to what is there: 10 N m/rad at 0.5 rad, then 3 N m s/rad at 2 rad/s.
/// let mut torque = [0.0];
/// JointSpring.torque(&[10.0, 0.0], 0, &state, &[], &mut torque);
/// ViscousFriction.torque(&[3.0], 0, &state, &[], &mut torque);
/// assert_eq!(torque, [11.0]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Instant<'a> {
    /// Time, s.
    pub t: f64,
    /// Time at which the log or the simulation began, s.
    pub started: f64,
    /// Positions.
    pub q: &'a [f64],
    /// Velocities.
    pub qd: &'a [f64],
    /// Accelerations.
    pub qdd: &'a [f64],
    /// Direction of motion in -1 ..= 1: the sign of the velocity, or of the imminent motion at standstill. Empty along a log for laws
    /// without friction ([`About::dry`](super::About::dry)).
    pub direction: &'a [f64],
    /// Torque that the gear passes on to the rigid bodies: inverse dynamics without rotor and friction. Empty along a log for laws
    /// that use no acceleration.
    pub load: &'a [f64],
    /// The arm as it is known.
    pub robot: &'a Robot,
    /// Its geometry, for laws that need kinematics or inverse dynamics.
    pub chain: &'a Chain,
    /// Poses of its joint frames and flange ([`Robot::frames`]), where they are known already.
    pub frames: Option<&'a [Pose]>,
}

/// A physical law.
///
/// `p` holds its parameters in the order of [`Effect::parameters`]; `joint` is where it is placed (the first of a pair;
/// zero for the whole arm).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{self, DriveParameter, LIBRARY};
///
/// // What a law is called, what it takes, and what it is to a drive.
/// let law = effects::find("viscous_friction")?;
/// let parameter = &law.parameters()[0];
/// assert_eq!((law.about().equation, parameter.unit.name()), ("tau = Fv v", "N m s/rad"));
/// assert_eq!(law.of_drive(), Some(DriveParameter::Viscous));
///
/// // Laws of gears have no torque of their own: they are between motor and link.
/// let gears = LIBRARY.iter().filter(|law| law.gear(&[1e-3]).is_some());
/// assert!(gears.map(|law| law.about().name).eq(["backlash", "joint_elasticity"]));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub trait Effect: Sync {
    /// Its entry in the catalogue.
    fn about(&self) -> &'static About;

    /// Its parameters.
    fn parameters(&self) -> &'static [Parameter];

    /// Changes masses, inertias, rotor or gravity.
    fn alter(&self, p: &[f64], joint: usize, robot: &mut Robot) {
        let _ = (p, joint, robot);
    }

    /// Adds the torque that the motors must deliver because of it to `out`, one entry per joint. `memory` is the law's own state.
    fn torque(&self, p: &[f64], joint: usize, x: &Instant, memory: &[f64], out: &mut [f64]) {
        let _ = (p, joint, x, memory, out);
    }

    /// Torque on its joint at many positions of it, where it depends on nothing else and lanes work it out faster than
    /// [`Effect::torque`] does one after the other; None for all other laws.
    fn torque_at_positions(&self, p: &[f64], q: &[f64]) -> Option<Vec<f64>> {
        let _ = (p, q);
        None
    }

    /// Whether its torque takes the poses of the joint frames.
    fn uses_frames(&self) -> bool {
        false
    }

    /// Times between which it has torque, s.
    fn acts_between(&self, p: &[f64]) -> [f64; 2] {
        let _ = p;
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    /// Number of values the law remembers from one instant to the next; zero at the start.
    fn memory(&self) -> usize {
        0
    }

    /// Carries the memory over `dt` seconds during which the arm is as `x` on average.
    fn advance(&self, p: &[f64], joint: usize, x: &Instant, dt: f64, memory: &mut [f64]) {
        let _ = (p, joint, x, dt, memory);
    }

    /// The gear between motor and link, where the effect is in the gear.
    fn gear(&self, p: &[f64]) -> Option<Gear> {
        let _ = p;
        None
    }

    /// Changes the logged torque of its joint; `period` is the time between samples, s.
    fn distort_torque(&self, p: &[f64], signal: &mut [f64], period: f64) {
        let _ = (p, signal, period);
    }

    /// Changes the logged position of its joint.
    fn distort_position(&self, p: &[f64], signal: &mut [f64]) {
        let _ = (p, signal);
    }

    /// Where the values of its parameter `index` are looked for, where that is not linear.
    fn search(&self, index: usize) -> Search {
        let _ = index;
        Search::Bounds
    }

    /// The values that books give the held parameter `index`: one for each form in which the law is written. None where there is one.
    fn forms(&self, index: usize) -> &'static [f64] {
        let _ = index;
        &[]
    }

    /// Moves what happens once to between two times, s.
    fn move_between(&self, from: f64, to: f64, p: &mut [f64]) {
        let _ = (from, to, p);
    }

    /// Whether parameters that are each within their bounds make sense together.
    fn is_sensible(&self, p: &[f64]) -> bool {
        let _ = p;
        true
    }

    /// Prior standard deviations of its amplitudes and departures, in their order; None where nothing is known beforehand.
    fn prior(&self, joint: usize, robot: &Robot) -> Option<Vec<f64>> {
        let _ = (joint, robot);
        None
    }

    /// Whether it can be on a joint of this arm at all, whatever its parameters.
    fn can_be_on(&self, joint: usize, robot: &Robot) -> bool {
        let _ = (joint, robot);
        true
    }

    /// What a machine can have of it, beyond the bounds of its parameters: the limits that [`Effect::over_limit`] takes.
    fn limits(&self) -> &'static [Limit] {
        &[]
    }

    /// How far it is from what a machine can have: the largest of its quantities over their limits ([`Limit::over`]). At most one for what
    /// can be, infinite where a quantity has a sign that it cannot have.
    fn over_limit(&self, p: &[f64], joint: usize, robot: &Robot) -> f64 {
        let _ = (p, joint, robot);
        0.0
    }

    /// Largest share that it can have, in root mean square, of its joint's torque, which where the drive idles is taken for a share of the
    /// drive's limit; that share of the limit it can always have. None where there is no such share.
    fn largest_share(&self) -> Option<f64> {
        None
    }

    /// Least size that a log can show, where the positions of its joint have noise of the standard deviation `position_noise`, whatever its
    /// torque would be.
    fn least_size(&self, position_noise: f64) -> f64 {
        let _ = position_noise;
        0.0
    }

    /// Quantities derived from its parameters by which practitioners call its size, the first that there is; its first parameter where
    /// there is none.
    fn headline(&self) -> &'static [&'static str] {
        &[]
    }

    /// Whether users ask about it first: a summary mentions the least size that would have been found.
    fn is_asked_about(&self) -> bool {
        false
    }

    /// The parameter of a drive that it adds to, where it is one that every drive has.
    fn of_drive(&self) -> Option<DriveParameter> {
        None
    }

    /// The effect on the same joint that motion alone cannot separate from this one: it is this one with one parameter more.
    fn indistinguishable_from(&self) -> Option<&'static str> {
        None
    }

    /// Whether it is a load at the flange, with the ten inertial parameters of a body.
    fn is_load(&self) -> bool {
        false
    }

    /// Whether its parameters are the ten of a body: of a load, or of what a link has in addition to its description.
    fn is_body(&self) -> bool {
        self.is_load()
    }

    /// Whether its torque is the same at all times.
    fn is_constant(&self) -> bool {
        false
    }

    /// Quantities by which practitioners know it.
    fn derived(&self, p: &[f64], joint: usize, robot: &Robot) -> Vec<Derived> {
        let _ = (p, joint, robot);
        Vec::new()
    }
}
