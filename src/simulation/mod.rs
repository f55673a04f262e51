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
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Time, s.
    pub time: Vec<f64>,
    /// Positions, velocities, accelerations and motor torques.
    pub signals: Arc<Signals>,
    /// Torque taken by friction, that of sticking joints included.
    pub friction: Channels,
}
