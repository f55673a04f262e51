//! Changes of a description that have a size, which is fitted.
//!
//! | question | module |
//! |---|---|
//! | free directions of gravity | `tilt` |
//! | how well the logs determine one | `spread` |
//! | how large torques are | `scale` |
//! | how large the torque of one joint is | `factors` |
//! | within what these are, with and without a load | `bounds` |
//! | how torques of one scale differ from joint to joint | `unequal` |
//! | whether a torque is beyond its drive | `effort` |
//! | where the zero of a joint is | `zeros` |
//! | the least value of a function | `golden` |

pub(super) mod bounds;
pub(super) mod effort;
pub(super) mod factors;
pub(super) mod golden;
pub(super) mod scale;
pub(super) mod spread;
pub(super) mod tilt;
pub(super) mod unequal;
pub(super) mod zeros;
