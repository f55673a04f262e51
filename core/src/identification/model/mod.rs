//! The inverse dynamic model, linear in its parameters. An arm and its motion come in; regressor columns of the base parameters go
//! out, also filtered or summed while they are made.

pub(crate) mod base_columns;
pub mod fused;
mod inverse_dynamics;
pub(crate) mod linear_model;
pub(crate) mod standard;
mod streamed;

pub use inverse_dynamics::Model;
