//! Constants of every model.

/// Standard gravity of the models here, along -z of the base, m/s2 (Pinocchio's default).
pub const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// No arm is under more gravity than this, m/s2: twice that of Jupiter.
pub const LARGEST_GRAVITY: f64 = 50.0;

/// Numbers beyond this are no arm's, and their squares would leave double precision.
pub const LARGEST: f64 = 1e9;
