//! What an identification found.

use crate::identification::consistent::Consistent;
use crate::identification::effect_model::{Preparation, Trust};
use crate::identification::fit::Fitted;
use crate::identification::model::Model;
use crate::robot::Robot;
use serde::Serialize;

/// An identified arm: parameters with their standard deviations, residuals per joint, and the arm that has them.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::Identification;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/payload/{name}.csv"), None);
/// # let (monday, tuesday) = (log("before")?, log("nothing")?);
///
/// let found = Identification::of(&robot).train([&monday]).test([&tuesday]).run()?;
/// assert_eq!((found.joints.len(), found.effort_units[0]), (5, "N m"));
///
/// // The logs were made with 2.5 N m of Coulomb friction on joint j2.
/// assert!((found.robot.joints[1].drive.coulomb - 2.5).abs() < 0.3);
/// assert!(found.fitted().test_rms.iter().all(|rms| *rms < 2.0));
///
/// let json = serde_json::to_value(&found).expect("it has a JSON form");
/// assert_eq!(json["joints"][1], "j2");
/// assert!(json["consistent"]["standard"].is_array() && json["with_effects"].is_null());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Identification {
    /// Names of the joints from base to flange: the order of all that is per joint.
    pub joints: Vec<String>,
    /// Units of their efforts and residuals: N m, or N of a joint that slides.
    pub effort_units: Vec<&'static str>,
    /// Whether the inertias of the description were believed, or estimated.
    pub trust: Trust,
    /// Joints and effects that were left out, and why; a line each.
    pub notes: Vec<String>,
    /// The fit without effects.
    pub without_effects: Fitted,
    /// The fit with effects, in the same rows; None where none were asked for.
    pub with_effects: Option<Fitted>,
    /// Bodies that can exist and come nearest to the fit without effects; None where inertias were believed.
    pub consistent: Option<Consistent>,
    /// The identified arm: the bodies and drives of `consistent`; where inertias were believed, described bodies with fitted drives. Not
    /// serialised: [`crate::robot::with_parameters`] and [`crate::robot::to_mjcf`] write it.
    #[serde(skip)]
    pub robot: Robot,
    /// The model that was fitted: its base parameters, and which joints have an equation. Not serialised.
    #[serde(skip)]
    pub model: Model,
    /// How the logs were smoothed. Not serialised.
    #[serde(skip)]
    pub preparation: Preparation,
}

impl Identification {
    /// The fit with effects where they were asked for, else the one without.
    pub fn fitted(&self) -> &Fitted {
        self.with_effects.as_ref().unwrap_or(&self.without_effects)
    }
}

/// What an identification begins to do.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::{Identification, Progress};
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
///
/// let mut begun = Vec::new();
/// Identification::of(&robot).train([&log]).progress(|now| begun.push(now)).run()?;
/// assert_eq!(begun, [Progress::Arm, Progress::Bodies]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Progress {
    /// The joints that have an equation are known; the fit without effects begins.
    Arm,
    /// The fit with effects begins; it takes the longest.
    Effects,
    /// The search for bodies that can exist begins.
    Bodies,
}
