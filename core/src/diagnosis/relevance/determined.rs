//! Parameters that the logs do not determine are held, so that those that they do have finite standard deviations.
//!
//! Of a law with several parameters the logs may show that it acts, and not how its parameters share it: the coefficient and the exponent
//! of a power of the speed, the moment and the geometry of a strut. Shapes are then held at their estimates, the least determined first,
//! until an amplitude differs significantly from zero. An amplitude of a sign that cannot be is zero.

use super::elimination::with_scatter;
use crate::diagnosis::criteria::Levels;
use crate::diagnosis::model::{Member, Session, is_level, linear, shapes};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::search::{Found, members};
use crate::effects::{Parameter, Role};
use crate::error::Result;

/// Holds the parameters of the effects `found` that the training logs do not determine, by the scatter between their blocks; returns
/// whether there were any. All standard deviations then hold that scatter.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn hold_undetermined(session: &mut Session, found: &mut [Found], whitener: &Whitener) -> Result<bool> {
    let change = session.logs.train.rows.of_change();
    let mut some = false;
    with_scatter(session, found, whitener)?;
    loop {
        let mut more = false;
        for found in found.iter_mut() {
            if let Some(index) = undetermined(&found.member, change, &session.criteria.levels) {
                tracing::debug!(family = ?found.member.candidate.family(), index, "not determined");
                found.member.fixed.push(index);
                more = true;
            }
        }
        if !more {
            return Ok(some);
        }
        some = true;
        let mut members = members(found);
        session.settle(&mut members, whitener)?;
        found.iter_mut().zip(members).for_each(|(found, member)| found.member = member);
        with_scatter(session, found, whitener)?;
    }
}

/// The next parameter to hold, if any. What a `change` adds to an amplitude may have either sign.
fn undetermined(member: &Member, change: bool, levels: &Levels) -> Option<usize> {
    let effect = member.placed.effect;
    if member.held || is_level(effect) {
        return None;
    }
    let parameters = effect.parameters();
    let is_free = |index: &usize| !member.fixed.contains(index);
    let (value, std) = (|index: usize| member.placed.parameters[index], |index: usize| member.std[index]);
    let amplitudes: Vec<usize> = linear(effect).into_iter().filter(is_free).collect();
    let impossible = |index: &usize| {
        let Parameter { role, lower, upper, .. } = parameters[*index];
        role == Role::Amplitude && ((lower == 0.0 && value(*index) < 0.0) || (upper == 0.0 && value(*index) > 0.0))
    };
    let scale = |index: usize| value(index).abs().max(0.1 * parameters[index].typical.abs());
    let relative = |index: &usize| std(*index) / scale(*index);
    let open = shapes(effect).into_iter().filter(is_free);
    let least = open.max_by(|a, b| relative(a).total_cmp(&relative(b)));
    // One amplitude must stay. A shape that is not determined makes any amplitude out of the others.
    if amplitudes.len() > 1 && !change {
        let surest = |a: &usize, b: &usize| (value(*a) / std(*a)).abs().total_cmp(&(value(*b) / std(*b)).abs());
        if let Some(index) = amplitudes.iter().copied().filter(impossible).max_by(surest) {
            let is_open = |shape: &usize| relative(shape) > 1.0 - levels.most;
            return least.filter(is_open).or(Some(index));
        }
    }
    if member.is_sized(levels) { None } else { least }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::model::Candidate;
    use crate::effects::{Placed, find};

    fn member(effect: &str, values: &[f64], std: &[f64]) -> Member {
        let mut placed = Placed::typical(find(effect).unwrap(), 0);
        placed.parameters[..values.len()].copy_from_slice(values);
        let mut member = Member::new(&Candidate { placed, log: None, columns: Default::default() }, &[]);
        member.std[..std.len()].copy_from_slice(std);
        member
    }

    #[test]
    fn shapes_are_held_until_an_amplitude_is_determined() {
        // Two standard deviations from zero and a little less.
        let criteria = Levels::default();
        assert_eq!(
            undetermined(&member("nonlinear_viscous_friction", &[35.0, 0.7], &[17.0, 0.9]), false, &criteria),
            None
        );
        let mut open = member("nonlinear_viscous_friction", &[35.0, 0.7], &[18.0, 0.9]);
        assert_eq!(undetermined(&open, false, &criteria), Some(1));
        open.fixed.push(1);
        assert_eq!(undetermined(&open, false, &criteria), None);
    }

    #[test]
    fn the_least_determined_shape_is_held_first() {
        let strut = member("gravity_balancer", &[15e3, 16e3, 0.8, -1.68], &[17e3, 11e3, 0.33, 0.01]);
        let criteria = Levels::default();
        assert_eq!(undetermined(&strut, false, &criteria), Some(2));
    }

    #[test]
    fn an_amplitude_of_the_wrong_sign_is_zero_but_for_changes() {
        let strut = member("gravity_balancer", &[86.0, -2e4, 0.05, 1.3], &[1.0, 1e3, 0.006, 0.04]);
        let criteria = Levels::default();
        assert_eq!(undetermined(&strut, false, &criteria), Some(1));
        // A geometry that is not determined is held first: it makes either moment out of the other.
        let mut open = member("gravity_balancer", &[-86.0, 2e4, 0.05, 1.3], &[1.0, 1e3, 0.6, 0.04]);
        assert_eq!(undetermined(&open, false, &criteria), Some(2));
        open.fixed.push(2);
        assert_eq!(undetermined(&open, false, &criteria), Some(0));
        assert_eq!(undetermined(&strut, true, &criteria), None);
        // The only one there is stays.
        let alone = member("nonlinear_viscous_friction", &[-35.0, 0.7], &[3.0, 0.1]);
        assert_eq!(undetermined(&alone, false, &criteria), None);
    }
}
