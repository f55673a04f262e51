//! The load that was added to an arm between logs: mass, centre, inertia, with standard errors.
//!
//! Two estimators answer. Where the logs after pass states that the logs before pass too, the difference of the torques at
//! equal states is the load's alone: friction, cables and all that a model lacks cancel. Else one fit takes the arm from all logs
//! and the load from those after. The one whose load torque scatters less between blocks of the logs is given.
//!
//! | file | in | out |
//! |---|---|---|
//! | `builder` | arm, logs | the answer |
//! | `determined` | estimate | numbers that the logs determine, words for the rest |
//! | `shares` | estimate | what each joint shows of the load |
//! | `estimate` | equations | the load, what else changed, covariance between blocks |
//! | `equations` | rows, pairs | the rows of either estimator |
//! | `sums` | rows | normal equations by blocks, jackknife |
//! | `rows`, `load_columns` | recording | states, torque, columns |
//! | `expected`, `controllers`, `answer` | | what is asked and said |

mod answer;
mod builder;
mod controllers;
mod determined;
mod equations;
mod estimate;
mod expected;
mod load_columns;
mod rows;
mod shares;
mod sums;

pub use answer::{Changed, Comparison, Estimator, JointShare, Other, PAYLOAD_SCHEMA, Payload, Quantity, Verdict};
pub use builder::PayloadBuilder;
pub use controllers::Controllers;
pub use equations::Change;
pub use expected::Expected;
