//! Identification: from a recording to base parameters with standard deviations.
//!
//! | room | in | out |
//! |---|---|---|
//! | `answer` | arm, logs, options | the identified arm, fits, bodies, notes |
//! | `physical` | fitted parameters | the nearest bodies that can exist |
//! | [`fit`] | arm, logs, effects | parameters of arm and effects, residuals |
//! | `estimators` | rows of a simulation | parameters by each estimator |
//! | [`effect_model`] | arm, effects, logs | regressor and residual under effects |
//! | `preparation` | logs | motion, filtered torque, valid samples |
//! | [`model`] | arm, motion | regressor of the base parameters |
//! | `regression` | rows of each joint | parameters, standard deviations |
//! | [`levenberg_marquardt`] | residuals, derivatives | parameters of a nonlinear problem |
//! | `numerics` | tables | Gram matrices, triangles, solutions |
//!
//! Each room imports only from rooms below it.

mod answer;
pub mod effect_model;
pub(crate) mod estimators;
pub mod fit;
pub mod levenberg_marquardt;
pub mod model;
mod numerics;
mod physical;
mod preparation;
mod regression;

pub use answer::{Identification, IdentificationBuilder, Progress, Wanted};
pub use fit::equations;
pub use model::fused;
pub(crate) use model::{linear_model, standard};
pub use numerics::tsqr;
pub(crate) use numerics::{gram, sequences, spectrum};
pub use physical::consistent;
pub(crate) use physical::nearest_body;
pub(crate) use preparation::{equal_states, low_passed};
pub use preparation::{prepare, reversals, smoothing_choice};
pub(crate) use regression::{joint_regression, noise};
pub use regression::{least_squares, linear_problem};
