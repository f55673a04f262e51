//! MuJoCo's MJCF.
//!
//! In: the text of a model, with the files it includes and the models it attaches. Out: its description ([`read`]): bodies, joints,
//! inertials or solid shapes, drives, linear equalities of joints. A robot is written as one ([`to_mjcf`]).

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
mod write;

pub(crate) use reader::read;
pub use write::to_mjcf;
