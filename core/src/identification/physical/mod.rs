//! Physical consistency. Fitted parameters with their normal equations come in; the nearest bodies that can exist go out.

pub mod consistent;
mod consistent_body;
mod plausible;
mod pseudo_inertia;

pub(crate) use consistent_body::nearest_body;
