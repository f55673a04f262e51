//! The study of J. Ogbemhe, K. Mpofu and M. Mokakabye, "Robot dynamic model: freudenstein-based optimal trajectory and
//! parameter identification", done again on a simulated arm, where the truth is known: the 78-parameter model fitted by
//! Levenberg-Marquardt with and without Savitzky-Golay smoothing, compared with the spatial model on the same logs.
//!
//! In: a scenario whose arm has six joints. Out: a [`PaperStudy`], from which the report makes the tables, the figures and
//! the verdict.
//!
//! | file | what |
//! |---|---|
//! | [`equations`] | the 78-parameter model, its misprints and the printed tables |
//! | [`planar`] | that model fitted to a log |
//! | [`quality`] | how well a torque model explains a log |
//! | [`single_move`] | what the paper's own excitation can identify |
//! | [`procedure`] | stages and times |
//! | [`reproduction`] | the whole study |

pub(crate) mod equations;
pub(crate) mod planar;
pub(crate) mod procedure;
pub(crate) mod quality;
pub(crate) mod reproduction;
pub(crate) mod single_move;

pub(crate) use reproduction::{PaperStudy, PlanarModel, SpatialFit, study};
