//! Structure of the residual as it is reported: what was found, what it replaces, and what was taken for none.

use crate::diagnosis::criteria::{Criteria, Gate, Judgement};
use crate::diagnosis::variance::ResidualMap;

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
    /// Adds what the map of the residual shows. Of a joint the larger is reported; a finding that either replaces is replaced.
    pub(crate) fn merge(&mut self, of_map: Structure) {
        for mut shown in of_map.unexplained {
            match self.unexplained.iter_mut().find(|left| left.joint == shown.joint) {
                None => self.unexplained.push(shown),
                Some(left) if left.share < shown.share => {
                    shown.certain |= left.certain;
                    shown.instead_of = std::mem::take(&mut left.instead_of);
                    *left = shown;
                }
                Some(_) => {}
            }
        }
        self.rejected.extend(of_map.rejected);
    }

    /// Takes structure for none whose size is below the floor of its joint's torque, by the `map` of all logs. What replaces a finding stays.
    pub(crate) fn leave_out_small(&mut self, map: &ResidualMap, criteria: &Criteria) {
        let judged = |left: &Unexplained| {
            let own = map.joints.iter().find(|own| own.joint == left.joint)?;
            let size = left.share.sqrt() * own.residual;
            let large = Judgement::at_least(Gate::Size, size / criteria.floor(own.torque), 1.0);
            (!large.passed && left.instead_of.is_empty()).then_some(large)
        };
        let (structure, rejected) = (std::mem::take(&mut self.unexplained), &mut self.rejected);
        self.unexplained = structure
            .into_iter()
            .filter(|left| match judged(left) {
                Some(failed) => {
                    rejected.push(RejectedStructure { joint: left.joint, structure: left.structure, failed });
                    false
                }
                None => true,
            })
            .collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::variance::JointMap;

    #[test]
    fn structure_below_the_floor_of_the_torque_is_none_unless_it_replaces_a_finding() {
        let criteria = Criteria::default();
        let joint = |torque: f64| JointMap {
            joint: 1,
            torque,
            residual: 2.0,
            noise: 1.0,
            correlation: 0.3,
            sensor_noise: 0.1,
            reported_from: 0.25,
            misfit: false,
            parts: Vec::new(),
            lines: Vec::new(),
        };
        // A quarter of the squares of 2 N m is 1 N m: 0.2 % of 500 N m.
        let left = |torque: f64, instead_of: &[Replaced]| {
            let one = Unexplained {
                joint: 1,
                share: 0.25,
                structure: "follows the position",
                family_wise_p: None,
                certain: false,
                instead_of: instead_of.to_vec(),
                passed: Vec::new(),
            };
            let mut structure = Structure { unexplained: vec![one], rejected: Vec::new() };
            structure.leave_out_small(&ResidualMap { joints: vec![joint(torque)] }, &criteria);
            (structure.unexplained.len(), structure.rejected.first().map(|one| one.failed.gate))
        };
        assert_eq!(left(499.9, &[]), (1, None));
        assert_eq!(left(500.1, &[]), (0, Some(Gate::Size)));
        assert_eq!(left(1e4, &[Replaced { place: 0, beyond: 1.0 }]), (1, None));
    }
}
