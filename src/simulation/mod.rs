//! The arm in the loop: rapier as forward dynamics, friction and drives, controller, sensors.

mod balance;
pub(crate) mod controller;
pub mod engine;
pub(crate) mod following;
pub mod integrator;
pub(crate) mod measured_motion;
pub mod plant;
pub mod rapier_arm;
pub(crate) mod sensors;

use crate::channels::Channels;
use crate::recording::Signals;
use std::sync::Arc;

/// The exact log of a run: what really happened at every sample.
///
/// ```
/// use tauscope::scenario::{Setup, simulate};
///
/// // What happened along a motion of 4 s, 500 times a second, friction apart.
/// let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// let truth = simulate(&setup, &setup.held_out, &mut |_| ())?;
/// assert_eq!((truth.time.len(), truth.signals.tau.channels()), (2001, 1));
///
/// // Viscous and Coulomb friction of the drive at the fastest instant.
/// let speed = truth.signals.qd.channel(0).iter().fold(0f64, |most, speed| most.max(speed.abs()));
/// let most = truth.friction.channel(0).iter().fold(0f64, |most, torque| most.max(torque.abs()));
/// assert!((most - (0.6 + 0.4 * speed)).abs() < 1e-6);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Time, s.
    pub time: Vec<f64>,
    /// Positions, velocities, accelerations and motor torques.
    pub signals: Arc<Signals>,
    /// Torque taken by friction, that of sticking joints included.
    pub friction: Channels,
}
