//! What makes a robot more than a serial arm: branches, and joints that follow others.

use super::joint::Joint;

/// A moving joint without a coordinate of its own: it follows a coordinate, q = multiplier x + offset. Its friction and
/// rotor are part of that coordinate's drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Follower {
    /// The joint and the body it carries.
    pub joint: Joint,
    /// Index of the coordinate that it follows.
    pub coordinate: usize,
    /// dq / dx.
    pub multiplier: f64,
    /// Position at x = 0, rad or m.
    pub offset: f64,
}

/// Structure of a robot that is not a serial chain. Bodies are counted: first one per coordinate, then one per follower.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    /// Joints that follow coordinates.
    pub followers: Vec<Follower>,
    /// The body that carries each body, none for the base.
    pub parents: Vec<Option<usize>>,
    /// The body that carries the flange.
    pub tip: usize,
}
