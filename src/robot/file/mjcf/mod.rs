//! MuJoCo's MJCF.
//!
//! In: the text of a model, with the files it includes and the models it attaches. Out: its description ([`read`]): bodies, joints,
//! inertials or solid shapes, drives, linear equalities of joints.

mod bodies;
mod compiler;
mod couplings;
mod defaults;
mod drives;
mod element;
mod models;
mod names;
mod reader;
mod replicate;
mod shapes;
#[cfg(test)]
mod tests;

pub use reader::read;
