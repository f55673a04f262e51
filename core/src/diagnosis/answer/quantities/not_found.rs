//! What was looked for and not found, with the size that would have been.

use crate::diagnosis::Options;
use crate::diagnosis::criteria::Gate;
use crate::diagnosis::evidence::{Multiplicity, Sensitivity};
use crate::diagnosis::model::{Family, Session, is_candidate, is_wanted, places};
use crate::diagnosis::relevance::Minor;
use crate::diagnosis::search::{Alternative, Found, Rejected};
use crate::effects::{LIBRARY, Parameter, Placed};
use statrs::distribution::{ContinuousCDF, Normal};
use std::collections::BTreeMap;

/// Probability with which an effect of the minimum detectable size is found.
const POWER: f64 = 0.8;

/// An effect that was looked for and not found.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::NotFound;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple", "joint_spring"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // A spring at the pivot would have been found from some stiffness on.
/// let spring: &NotFound = diagnosis.not_found.iter().find(|one| one.family.effect == "joint_spring").expect("it is not there");
/// assert!(spring.minimum_detectable.is_none_or(|size| size > 0.0) && !spring.unit.is_empty());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct NotFound {
    /// What and where.
    pub family: Family,
    /// The smallest value of its first parameter that would have been found with a probability of 80 % and be large enough to matter, at
    /// the shape to which the logs are most sensitive; None where the logs do not separate it from the baseline, and where it was seen and refused.
    pub minimum_detectable: Option<f64>,
    /// Unit of that.
    pub unit: &'static str,
}

/// What was significant and is not reported: that the logs show it does not mean that it would have been found.
pub(in crate::diagnosis::answer) fn refused(minor: &[Minor], rejected: &[Rejected]) -> Vec<Family> {
    let significant = rejected.iter().filter(|one| one.failed.gate != Gate::FamilyWise);
    let minor = minor.iter().map(|minor| minor.found.member.candidate.family());
    minor.chain(significant.map(|one| one.slot.0)).collect()
}

/// Everything that was looked for and is not among `found`, with the size it would have needed, unless it was `refused`. `multiplicity`
/// holds the number of independent tests, `sensitivity` that to every family.
pub(in crate::diagnosis::answer) fn not_found(
    session: &Session,
    (found, refused): (&[Found], &[Family]),
    multiplicity: &Multiplicity,
    sensitivity: &BTreeMap<Family, Sensitivity>,
    options: &Options,
) -> Vec<NotFound> {
    let normal = Normal::standard();
    let factor = |kind: &str| {
        normal.inverse_cdf(1.0 - options.alpha / (2.0 * multiplicity.tests(kind))) + normal.inverse_cdf(POWER)
    };
    let taken: Vec<Family> = found
        .iter()
        .flat_map(|found| {
            let others = found.alternatives.iter().map(|Alternative { family, .. }| *family);
            [found.member.candidate.family()].into_iter().chain(others)
        })
        .collect();
    let change = session.logs.train.rows.of_change();
    let position_noise = |joint: usize| {
        let logs = session.logs.train.rows.logs.iter();
        logs.map(|log| log.position_noise[joint]).fold(f64::INFINITY, f64::min)
    };
    LIBRARY
        .iter()
        .filter(|effect| {
            is_candidate(**effect, options.trust, &options.candidates)
                || (change && is_wanted(**effect, &options.candidates))
        })
        .flat_map(|effect| {
            places(*effect, session.model.base.robot())
                .into_iter()
                .map(move |joint| (effect, Family { effect: effect.about().name, joint }))
        })
        .filter(|(_, family)| !taken.contains(family))
        .map(|(effect, family)| {
            let seen = sensitivity.get(&family);
            let index = seen.map_or(0, |seen| seen.index);
            let Parameter { lower, upper, .. } = effect.parameters()[index];
            let unit = Placed::typical(*effect, family.joint).unit(index, session.model.base.robot());
            // What no arm can have, no log can show.
            let sizes = 0.0..=upper.max(-lower);
            let minimum_detectable = seen
                .filter(|_| !refused.contains(&family))
                .map(|seen| (factor(family.effect) * seen.std).max(seen.floor))
                .map(|size| size.max(effect.least_size(position_noise(family.joint))))
                .filter(|size| *size > 0.0 && size.is_finite() && sizes.contains(size));
            NotFound { family, minimum_detectable, unit }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::criteria::Judgement;

    #[test]
    fn what_was_significant_and_refused_has_no_least_size() {
        let rejected = |effect: &'static str, gate: Gate| Rejected {
            slot: (Family { effect, joint: 1 }, None),
            failed: Judgement::at_most(gate, 1.0, 0.5),
        };
        let all = [rejected("joint_spring", Gate::FamilyWise), rejected("stribeck_friction", Gate::EveryJoint)];
        assert_eq!(refused(&[], &all), [Family { effect: "stribeck_friction", joint: 1 }]);
    }
}
