//! Constants of every model.

/// Standard gravity of the models here, along -z of the base, m/s2 (Pinocchio's default).
pub const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Numbers beyond this are no arm's, and their squares would leave double precision.
pub const LARGEST: f64 = 1e9;
