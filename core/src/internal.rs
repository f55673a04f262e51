//! What `tauscope` uses and no user should, by room.

pub use crate::linear::root_mean_square;
pub use crate::output::{json, measured, pretty, significant};

pub mod design {
    pub use crate::design::comparison::{Comparison, Judge, Row, compare};
    pub use crate::design::envelope::{CHECK_RATE_HZ, Clearance};
    pub use crate::design::excite::{Outcome, Request, excite};
    pub use crate::design::families::Family;
}

pub mod diagnosis {
    pub use crate::diagnosis::answer::words::notices::{effort, remedy, shown, with_unit};
    pub use crate::diagnosis::answer::{NOT_SIZED, finding, findings, joints};
    pub use crate::diagnosis::model::{DataSet, Session, is_candidate, is_level, places};
    pub use crate::diagnosis::noise::Whitener;
    pub use crate::diagnosis::regression::{Column, Projection, rms};
}

pub mod excitation {
    pub use crate::excitation::encoding::{FourierEncoding, random_point};
    pub use crate::excitation::freudenstein::{Move, PEAK_ACCELERATION, PEAK_VELOCITY};
    pub use crate::excitation::limits::check_kinds;
}

pub mod identification {
    pub use crate::identification::estimators::{Data, Estimator, SimulatedRows, find as estimator};
    pub use crate::identification::joint_regression::JointRegression;
    pub use crate::identification::linear_model::LinearModel;
    pub use crate::identification::noise::AutoregressiveNoise;
    pub use crate::identification::standard::STANDARD;
}

pub mod lane {
    pub use crate::lane::dispatch::Kernel;
}

pub mod quality {
    pub use crate::quality::torque::excitation;
}

pub mod random {
    pub use crate::random::fnv1a;
}
