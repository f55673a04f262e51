//! Parameters that the logs do not determine are held, so that those that they do have finite standard deviations.
//!
//! Of a law with several parameters the logs may show that it acts, and not how its parameters share it: the coefficient and the exponent
//! of a power of the speed, the moment and the geometry of a strut. Shapes are then held, the least determined first: at the value that is
//! typical of the law where the logs do not exclude it, since amplitudes are given for it, else at their estimates;
//! until an amplitude differs significantly from zero. An amplitude of a sign that cannot be is zero.

use super::elimination::with_scatter;
use crate::diagnosis::criteria::Levels;
use crate::diagnosis::model::{Candidate, Member, Session, is_level, linear, shapes};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::Column;
use crate::diagnosis::search::{Found, members};
use crate::effects::Search;
use crate::error::Result;

/// Holds the parameters of the effects `found` that the training logs do not determine, by the scatter between their blocks; returns
/// whether there were any. All standard deviations then hold that scatter.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn hold_undetermined(session: &mut Session, found: &mut [Found], whitener: &Whitener) -> Result<bool> {
    let mut some = false;
    with_scatter(session, found, whitener)?;
    loop {
        let now = members(found);
        let next = |place: usize| -> Result<Option<usize>> {
            match wrong_sign(&now[place], &now[place].placed.parameters, session).is_some() {
                true => of_wrong_sign(session, &now, place, whitener),
                false => Ok(undetermined(&now[place], &session.criteria.levels)),
            }
        };
        let held = (0..now.len()).map(next).collect::<Result<Vec<Option<usize>>>>()?;
        if held.iter().all(Option::is_none) {
            return Ok(some);
        }
        some = true;
        for (place, index) in held.into_iter().enumerate().filter_map(|(place, index)| Some((place, index?))) {
            let typical = at_typical(session, &members(found), place, index, whitener)?;
            let member = &mut found[place].member;
            tracing::debug!(family = ?member.candidate.family(), index, moved = typical.is_some(), "not determined");
            member.fixed.push(index);
            if let Some(candidate) = typical {
                member.candidate = candidate;
            }
        }
        let mut members = members(found);
        session.settle(&mut members, whitener)?;
        found.iter_mut().zip(members).for_each(|(found, member)| found.member = member);
        with_scatter(session, found, whitener)?;
    }
}

/// The candidate of the member at `place` with a shape at the value that is typical of its law, where the training logs do not exclude it;
/// None of an amplitude and of a time.
fn at_typical(
    session: &Session,
    members: &[Member],
    place: usize,
    index: usize,
    whitener: &Whitener,
) -> Result<Option<Candidate>> {
    let train = &session.logs.train;
    let candidate = &members[place].candidate;
    let effect = candidate.placed.effect;
    if !shapes(effect).contains(&index) || effect.search(index) == Search::Instant {
        return Ok(None);
    }
    let mut placed = candidate.placed.clone();
    placed.parameters[index] = effect.parameters()[index].typical;
    let Some(typical) = session.candidate_at(placed, &members[place])? else { return Ok(None) };
    let others: Vec<Member> =
        members.iter().enumerate().filter(|(k, _)| *k != place).map(|(_, member)| member.clone()).collect();
    let fit = whitener.fit(&session.model.columns(train, &others)?, &train.torque);
    let explained = |columns: &[Column]| fit.test(&whitener.apply_all(columns)).map_or(0.0, |test| test.statistic);
    let lost = explained(&candidate.columns) - explained(&typical.columns);
    Ok((lost <= session.criteria.at_bound()).then_some(typical))
}

/// The amplitude of a sign that cannot be with these values of all parameters, the surest first. One amplitude must stay, and what a change
/// adds may have either sign.
fn wrong_sign(member: &Member, values: &[f64], session: &Session) -> Option<usize> {
    let effect = member.placed.effect;
    if member.held || is_level(effect) || session.logs.train.rows.of_change() {
        return None;
    }
    surest_of_wrong_sign(member, values)
}

/// The same of an effect that is no change.
fn surest_of_wrong_sign(member: &Member, values: &[f64]) -> Option<usize> {
    let effect = member.placed.effect;
    let amplitudes: Vec<usize> = linear(effect).into_iter().filter(|index| !member.fixed.contains(index)).collect();
    let impossible = |index: &usize| effect.parameters()[*index].has_wrong_sign(values[*index]);
    let sure = |index: usize| (values[index] / member.std[index]).abs();
    let wrong = amplitudes.iter().copied().filter(impossible).max_by(|&a, &b| sure(a).total_cmp(&sure(b)));
    wrong.filter(|_| amplitudes.len() > 1)
}

/// What to hold of a member with an amplitude of a sign that cannot be: such an amplitude, if it is one with all shapes held too; else the
/// least determined shape, which makes any amplitude out of the others.
fn of_wrong_sign(session: &Session, members: &[Member], place: usize, whitener: &Whitener) -> Result<Option<usize>> {
    let mut held = members.to_vec();
    let member = &members[place];
    held[place].fixed.extend(shapes(member.placed.effect));
    let solved = session.solved(&held, whitener)?;
    let mut values = member.placed.parameters.clone();
    let amplitudes = session.blocks(&held).members[place].amplitudes.clone();
    for (index, at) in linear(member.placed.effect).into_iter().zip(amplitudes) {
        values[index] = solved.values[at];
    }
    Ok(wrong_sign(&held[place], &values, session).or_else(|| least_determined(member)))
}

/// The free shape with the largest standard deviation relative to its size.
fn least_determined(member: &Member) -> Option<usize> {
    let parameters = member.placed.effect.parameters();
    let scale = |index: usize| member.placed.parameters[index].abs().max(0.1 * parameters[index].typical.abs());
    let open = shapes(member.placed.effect).into_iter().filter(|index| !member.fixed.contains(index));
    open.max_by(|&a, &b| (member.std[a] / scale(a)).total_cmp(&(member.std[b] / scale(b))))
}

/// The next shape to hold, if no amplitude differs significantly from zero.
fn undetermined(member: &Member, levels: &Levels) -> Option<usize> {
    let is_settled = member.held || is_level(member.placed.effect) || member.is_sized(levels);
    if is_settled { None } else { least_determined(member) }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let levels = Levels::default();
        assert_eq!(undetermined(&member("nonlinear_viscous_friction", &[35.0, 0.7], &[17.0, 0.9]), &levels), None);
        let mut open = member("nonlinear_viscous_friction", &[35.0, 0.7], &[18.0, 0.9]);
        assert_eq!(undetermined(&open, &levels), Some(1));
        open.fixed.push(1);
        assert_eq!(undetermined(&open, &levels), None);
    }

    #[test]
    fn the_least_determined_shape_is_held_first() {
        let strut = member("gravity_balancer", &[15e3, 16e3, 0.8, -1.68], &[17e3, 11e3, 0.33, 0.01]);
        assert_eq!(undetermined(&strut, &Levels::default()), Some(2));
    }

    #[test]
    fn the_surest_amplitude_of_a_wrong_sign_is_zero() {
        let of = |member: &Member| surest_of_wrong_sign(member, &member.placed.parameters);
        let strut = member("gravity_balancer", &[86.0, -2e4, 0.05, 1.3], &[1.0, 1e3, 0.6, 0.04]);
        assert_eq!(of(&strut), Some(1));
        let both = member("gravity_balancer", &[-86.0, -2e4, 0.05, 1.3], &[1.0, 1e3, 0.6, 0.04]);
        assert_eq!(of(&both), Some(0));
        assert_eq!(of(&member("gravity_balancer", &[86.0, 2e4, 0.05, 1.3], &[1.0; 4])), None);
        // The only one there is stays.
        let mut last = both.clone();
        last.fixed.push(1);
        assert_eq!(of(&last), None);
        assert_eq!(of(&member("nonlinear_viscous_friction", &[-35.0, 0.7], &[3.0, 0.1])), None);
    }
}
