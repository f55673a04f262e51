//! Structure of the residual as it is reported: what was found, what it replaces, and what was taken for none.

use crate::diagnosis::criteria::Judgement;

/// Structure that no candidate carries.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Unexplained;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_offset"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // Offsets do not explain the ripple of the pivot: its residual follows something else.
/// let left: &Unexplained = diagnosis.unexplained.first().expect("there is structure");
/// assert!(left.joint == 0 && left.share > 0.5 && !left.structure.is_empty());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Unexplained {
    /// The joint.
    pub joint: usize,
    /// Share of its residual (sum of squares, whitened) that follows the structure.
    pub share: f64,
    /// What it follows.
    pub structure: &'static str,
    /// Probability of as much without structure, on any joint; None where none was worked out.
    pub family_wise_p: Option<f64>,
    /// Whether training and held-out logs each show it with certainty: findings on the joint are compared with it.
    pub certain: bool,
    /// Members of the model that add nothing to the structure: it explains what they were named for.
    pub instead_of: Vec<Replaced>,
    /// The gates that it passed.
    pub passed: Vec<Judgement>,
}

/// Structure that a joint's training rows show, and that failed a gate.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Diagnosis, RejectedStructure};
///
/// // What the residual does not follow after all, and why not.
/// fn refused(diagnosis: &Diagnosis) -> Vec<String> {
///     let line = |one: &RejectedStructure| format!("no {}: {}", one.structure, one.failed.gate.reason());
///     diagnosis.rejected_structure.iter().map(line).collect()
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RejectedStructure {
    /// The joint.
    pub joint: usize,
    /// What its residual would follow.
    pub structure: &'static str,
    /// The gate that it failed.
    pub failed: Judgement,
}

/// What was looked for in the residual: structure, and what was taken for none.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Structure {
    /// That which is reported.
    pub unexplained: Vec<Unexplained>,
    /// That which failed a gate.
    pub rejected: Vec<RejectedStructure>,
}

impl Structure {
    /// Adds what the map of the residual shows. Of a joint the larger is reported, unless what is reported already replaces a finding.
    pub(crate) fn merge(&mut self, of_map: Structure) {
        for mut shown in of_map.unexplained {
            match self.unexplained.iter_mut().find(|left| left.joint == shown.joint) {
                None => self.unexplained.push(shown),
                Some(left) if left.instead_of.is_empty() && left.share < shown.share => {
                    shown.certain |= left.certain;
                    *left = shown;
                }
                Some(_) => {}
            }
        }
        self.rejected.extend(of_map.rejected);
    }
}

impl Extend<Structure> for Structure {
    fn extend<T: IntoIterator<Item = Structure>>(&mut self, more: T) {
        for Structure { unexplained, rejected } in more {
            self.unexplained.extend(unexplained);
            self.rejected.extend(rejected);
        }
    }
}

/// A member of the model that structure replaces.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Diagnosis, Replaced};
///
/// // Findings that structure withdraws: it explains what they were named for.
/// fn withdrawn(diagnosis: &Diagnosis) -> Vec<&'static str> {
///     let replaced = diagnosis.unexplained.iter().flat_map(|left| &left.instead_of);
///     let name = |Replaced { place, .. }: &Replaced| diagnosis.found[*place].member.placed.effect.about().name;
///     replaced.map(name).collect()
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replaced {
    /// Its place in the model.
    pub place: usize,
    /// Share of what it explains by itself that the structure explains beyond it.
    pub beyond: f64,
}
