//! What is said of a load.

use super::controllers::Controllers;
use super::equations::Change;
use serde::Serialize;

/// Schema of `payload.json`.
pub const PAYLOAD_SCHEMA: &str = "tauscope.payload/1";

/// What the numbers are as exact as.
pub(crate) const SCALED_BY: &str = "as exact as the torque constants: 1 % of gain is 1 % of mass";

/// A number with its standard error.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::payload::Payload;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::recording;
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/payload/{name}.csv"), None);
///
/// let (before, after) = (log("before")?, log("after")?);
/// let load = Payload::between(&robot).before([&before]).after([&after]).run()?;
///
/// // 1.5 kg were put on the flange, 90 mm in front of it.
/// let [mass, z] = [load.mass_kg, load.center_m[2]].map(|quantity| quantity.expect("the motions determine it"));
/// assert!((mass.value - 1.5).abs() < 3.0 * mass.standard_error);
/// assert!((z.value - 0.09).abs() < 3.0 * z.standard_error);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantity {
    /// The number.
    pub value: f64,
    /// Its standard error, between blocks and logs.
    pub standard_error: f64,
}

/// How the load was found.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::payload::Estimator;
/// # use tauscope::payload::Payload;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::recording;
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/payload/{name}.csv"), None);
///
/// // Both logs follow one motion, so that differences at equal states cancel what no model has.
/// let (before, after) = (log("before")?, log("after")?);
/// let load = Payload::between(&robot).before([&before]).after([&after]).run()?;
/// assert_eq!(load.estimator, Estimator::Difference);
/// assert!(load.matched_share > 0.5);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Estimator {
    /// From differences of torque at equal states.
    Difference,
    /// From one fit of the arm and the load to all logs.
    JointFit,
}

/// Whether there is a load.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::payload::Verdict;
/// # use tauscope::payload::Payload;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::recording;
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/payload/{name}.csv"), None);
///
/// let (before, after, nothing) = (log("before")?, log("after")?, log("nothing")?);
/// let load = |after| Payload::between(&robot).before([&before]).after([after]).run();
/// assert_eq!(load(&after)?.verdict, Verdict::Load);
/// assert_eq!(load(&nothing)?.verdict, Verdict::NoLoad);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// A load with a mass.
    Load,
    /// No load that differs from none.
    NoLoad,
    /// Something was added, and the logs do not determine its mass.
    MassNotDetermined,
    /// A load, or other torque offsets: they explain the logs as well.
    LoadOrOffsets,
    /// What changed is nothing that a body on this link does.
    NoBody,
}

/// What changed at a joint besides the load.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::payload::{Change, Changed, Quantity};
///
/// // As `Payload::changed` has it: between the logs the torque of joint j1 has got an offset, beyond doubt.
/// let (joint, change) = ("j1".to_owned(), Quantity { value: 2.0, standard_error: 0.1 });
/// let changed = Changed { joint, what: Change::Offset, change, unit: "N m" };
/// assert!(changed.change.value > 4.0 * changed.change.standard_error);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Changed {
    /// Name of the joint.
    pub joint: String,
    /// What changed.
    pub what: Change,
    /// By how much.
    pub change: Quantity,
    /// Unit of the change.
    pub unit: &'static str,
}

/// What one joint shows of the load.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::payload::Payload;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::recording;
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/payload/{name}.csv"), None);
///
/// let (before, after) = (log("before")?, log("after")?);
/// let load = Payload::between(&robot).before([&before]).after([&after]).run()?;
///
/// // Joint j2 carries the load: its torque there is far above what stays unexplained, and the share is near one.
/// let shoulder = &load.joints[1];
/// let share = shoulder.share.expect("it is large enough");
/// assert!(shoulder.load > 3.0 * shoulder.residual && (share.value - 1.0).abs() < 0.1);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointShare {
    /// Name of the joint.
    pub joint: String,
    /// Unit of its torque.
    pub unit: &'static str,
    /// Root mean square of the load's torque.
    pub load: f64,
    /// Root mean square of the residual.
    pub residual: f64,
    /// The load's torque at this joint over that of the load found from all; none where it is too small to say.
    pub share: Option<Quantity>,
}

/// The load found by the other estimator.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::payload::Estimator;
/// # use tauscope::payload::Payload;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::recording;
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/payload/{name}.csv"), None);
///
/// // The load was found from differences at equal states; a fit of arm and load to all rows finds the same mass.
/// let (before, after) = (log("before")?, log("after")?);
/// let load = Payload::between(&robot).before([&before]).after([&after]).run()?;
/// let other = load.other.expect("there are data for both");
/// assert_eq!(other.estimator, Estimator::JointFit);
/// let mass = other.mass_kg.expect("it determines the mass");
/// assert!((mass.value - 1.5).abs() < 0.1);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Other {
    /// Which one.
    pub estimator: Estimator,
    /// Its mass, kg, where it determines one.
    pub mass_kg: Option<Quantity>,
    /// Root mean square of the uncertainty of the load's torque, N m (N).
    pub uncertainty: f64,
}

/// The load found compared with the one expected.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::payload::Expected;
/// # use tauscope::payload::Payload;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::recording;
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/payload/{name}.csv"), None);
///
/// let (before, after) = (log("before")?, log("after")?);
/// let load = Payload::between(&robot).before([&before]).after([&after]).expected(Expected::mass(2.5)?).run()?;
/// let comparison = load.expected.as_ref().expect("a mass was expected");
/// assert!(!comparison.agrees && !load.is_as_expected());
/// assert_eq!(comparison.mass_kg, 2.5);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Expected mass, kg.
    pub mass_kg: f64,
    /// By how much the mass may differ, kg.
    pub tolerance_kg: f64,
    /// Whether the load found agrees with all that was expected.
    pub agrees: bool,
    /// Why, a sentence each.
    pub reasons: Vec<String>,
}

/// The load added between logs. What the logs do not determine is none here, and a sentence of `not_determined`.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::payload::Verdict;
/// # use tauscope::payload::Payload;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::recording;
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/payload/{name}.csv"), None);
///
/// let (before, after) = (log("before")?, log("after")?);
/// let load = Payload::between(&robot).before([&before]).after([&after]).run()?;
/// assert_eq!((load.verdict, &load.frame[..]), (Verdict::Load, "flange"));
/// assert!(load.center_m.iter().flatten().count() == 3 && load.is_as_expected());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Payload {
    /// Name of the robot.
    pub robot: String,
    /// The link whose frame the numbers are in.
    pub frame: String,
    /// Logs before and after.
    pub logs: [usize; 2],
    /// Whether there is a load.
    pub verdict: Verdict,
    /// How it was found.
    pub estimator: Estimator,
    /// Share of the rows after for which there is an equal state before.
    pub matched_share: f64,
    /// Blocks of about a second that standard errors are between.
    pub blocks: usize,
    /// Root mean square of the uncertainty of the load's torque, N m (N).
    pub uncertainty: f64,
    /// Mass.
    pub mass_kg: Option<Quantity>,
    /// Where no load is found: what is heavier than this would have been, kg.
    pub mass_below_kg: Option<f64>,
    /// Centre of mass along the axes of the frame.
    pub center_m: [Option<Quantity>; 3],
    /// Inertia about the centre of mass in the axes of the frame: xx, xy, yy, xz, yz, zz.
    pub inertia_kg_m2: [Option<Quantity>; 6],
    /// Mass times centre.
    pub first_moment_kg_m: [Option<Quantity>; 3],
    /// Inertia about the origin of the frame.
    pub inertia_about_frame_kg_m2: [Option<Quantity>; 6],
    /// What is not determined, a sentence each.
    pub not_determined: Vec<String>,
    /// What else changed between the logs beyond doubt.
    pub changed: Vec<Changed>,
    /// Joint by joint.
    pub joints: Vec<JointShare>,
    /// Mass with a free torque offset at every joint; none where that leaves it open.
    pub mass_with_free_offsets_kg: Option<Quantity>,
    /// The other estimator, where there are data for it.
    pub other: Option<Other>,
    /// What the numbers are as exact as.
    pub scaled_by: &'static str,
    /// Remarks on data and result, a sentence each.
    pub notes: Vec<String>,
    /// The load against the one that was expected.
    pub expected: Option<Comparison>,
    /// The load as controllers take it, where mass and centre are determined.
    pub controllers: Option<Controllers>,
    /// Mass before anything is left out, for comparison with an expectation.
    #[serde(skip)]
    pub(super) raw_mass: Option<Quantity>,
}

impl Payload {
    /// Whether nothing contradicts what was expected; true where nothing was.
    pub fn is_as_expected(&self) -> bool {
        self.expected.as_ref().is_none_or(|comparison| comparison.agrees)
    }
}
