//! A round's view of the data: the noise, the fit so far, and the tests of all candidates against it.

use super::found::{Found, members};
use crate::diagnosis::Options;
use crate::diagnosis::evidence::Scan;
use crate::diagnosis::model::{
    Candidate, Member, PreparedLogs, Session, acts_upon_arm, all_candidates, carried_on, renewed,
};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection};
use crate::error::Result;

/// Most fits of a model whose columns depend on the arm as found. Of a gain of 0.3 the first finds 0.23, the second 0.299.
const ROUNDS: usize = 6;

/// Share of its torque on a joint by which the arm may change before the candidates that act upon it are worked out anew: their columns
/// change by as much at most, and a test loses the square of that.
const SETTLED: f64 = 0.01;

/// A round of a search.
#[derive(Debug)]
pub(super) struct Round {
    /// The noise under what was found so far.
    pub whitener: Whitener,
    /// The fit of that.
    pub fit: Projection,
    /// All candidates.
    pub all: Vec<Candidate>,
    /// Their tests.
    pub scan: Scan,
    /// Torque of the arm along which those that act upon it were worked out.
    arm: Column,
}

impl Round {
    /// Tests all candidates against a fit of what was found so far, whose estimates are written back.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn first(session: &Session, (whitener, fit): (Whitener, Projection), options: &Options) -> Result<Self> {
        let asked = session.model.asked(&options.candidates);
        let all = all_candidates(&session.model.arm, &session.logs.train.rows, asked)?;
        let arm = session.model.arm.all_torque(&session.logs.train.rows);
        Ok(Self::of(session, (whitener, fit), all, arm))
    }

    /// The same over all logs, of which the first are those that `candidates` are known along.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn over_all_logs(
        session: &mut Session,
        found: &mut [Found],
        candidates: Vec<Candidate>,
        options: &Options,
    ) -> Result<Self> {
        let (whitener, fit) = settled(session, found)?;
        let PreparedLogs { train, test, .. } = &session.logs;
        let later = &test.rows;
        let carried_on = carried_on(candidates, &session.model.arm, train.rows.len() - later.len(), later)?;
        let arm = session.model.arm.all_torque(&session.logs.train.rows);
        let everywhere: Vec<usize> = (0..later.dof()).collect();
        let all = Self::renewed(session, carried_on, options, [&everywhere, &[]])?;
        Ok(Self::of(session, (whitener, fit), all, arm))
    }

    /// Goes on after more was found, where the sign of friction on some joints is `rounded` otherwise since.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn renew(
        &mut self,
        rounded: &[usize],
        session: &mut Session,
        found: &mut [Found],
        options: &Options,
    ) -> Result<()> {
        let settled = settled(session, found)?;
        // The columns of both scans together would take twice the memory.
        self.scan.clear();
        let mut all = std::mem::take(&mut self.all);
        let mut arm = std::mem::take(&mut self.arm);
        let moved = follow(&mut arm, &session.model.arm.all_torque(&session.logs.train.rows), rounded);
        if !moved.is_empty() {
            all = Self::renewed(session, all, options, [&moved, rounded])?;
        }
        *self = Self::of(session, settled, all, arm);
        Ok(())
    }

    /// The candidates for the arm as estimated, whose torque is another on the joints `moved` and whose friction is rounded otherwise on those
    /// `rounded`.
    fn renewed(
        session: &Session,
        candidates: Vec<Candidate>,
        options: &Options,
        [moved, rounded]: [&[usize]; 2],
    ) -> Result<Vec<Candidate>> {
        let asked = session.model.asked(&options.candidates);
        renewed(candidates, &session.model.arm, &session.logs.train.rows, asked, [moved, rounded])
    }

    fn of(session: &Session, (whitener, fit): (Whitener, Projection), all: Vec<Candidate>, arm: Column) -> Self {
        let scan = Scan::new(session, &all, &whitener, &fit);
        Round { whitener, fit, all, scan, arm }
    }
}

/// The joints on which the torque of the arm changed by more than [`SETTLED`] of it, or whose friction is `rounded` otherwise: `arm` becomes
/// what it is `now` there.
fn follow(arm: &mut Column, now: &Column, rounded: &[usize]) -> Vec<usize> {
    let square = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>();
    let mut change = now.clone();
    change.add(-1.0, arm);
    let has_moved = |(joint, change): &&(usize, Vec<f64>)| {
        let before = arm.part(*joint).map_or(0.0, square);
        rounded.contains(joint) || square(change) > SETTLED * SETTLED * before
    };
    let moved: Vec<usize> = change.parts.iter().filter(has_moved).map(|(joint, _)| *joint).collect();
    let parts = change.parts.iter().filter_map(|(joint, _)| {
        let own = if moved.contains(joint) { now } else { &*arm };
        Some((*joint, own.part(*joint)?.to_vec()))
    });
    *arm = Column::of(parts.collect());
    moved
}

/// The noise under what was `found` and the fit of that, with estimates written back.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn settled(session: &mut Session, found: &mut [Found]) -> Result<(Whitener, Projection)> {
    let mut members = members(found);
    let present = session.model.columns(&session.logs.train, &members)?;
    let whitener = session.noise_under(&present);
    session.settle(&mut members, &whitener)?;
    found.iter_mut().zip(members.clone()).for_each(|(found, member)| found.member = member);
    let columns = session.model.columns(&session.logs.train, &members)?;
    let fit = whitener.fit(&columns, &session.logs.train.torque);
    Ok((whitener, fit))
}

/// Fits what was `found` until the sizes of gears and sensors and the shapes of laws no longer change, with estimates written back, and
/// returns the noise under that; None where nothing acts upon the arm and no shape moves. Columns of what acts upon the arm are those along
/// the arm as found, which holds a part of what an effect does until that is in the model, and those of departures belong to one size.
/// Bodies weigh under a gravity that is turned what no base parameter holds: that is fitted with it.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn converged(session: &mut Session, found: &mut [Found], whitener: &Whitener) -> Result<Option<Whitener>> {
    let mut members = members(found);
    let unseen = session.unseen(&members);
    let may_move = |member: &Member| !member.held && (acts_upon_arm(member.placed.effect) || member.has_shift());
    if unseen.is_empty() && !members.iter().any(may_move) {
        return Ok(None);
    }
    session.go_on_with(unseen.free_in(&session.logs));
    for _ in 0..ROUNDS {
        members.iter_mut().for_each(Member::take_departures_at_estimates);
        let before: Vec<Vec<f64>> = members.iter().map(|member| member.factors.clone()).collect();
        session.settle(&mut members, whitener)?;
        if members.iter().zip(&before).all(|(member, before)| member.has_converged(before)) {
            break;
        }
    }
    if !unseen.is_empty() {
        let solved = session.solved(&members, whitener)?;
        session.describe_change(&unseen.change(&solved.values));
        session.settle(&mut members, whitener)?;
    }
    session.move_shapes(&mut members, whitener)?;
    let columns = session.model.columns(&session.logs.train, &members)?;
    found.iter_mut().zip(members).for_each(|(found, member)| found.member = member);
    Ok(Some(session.noise_under(&columns)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_that_changes_by_one_percent_on_a_joint_is_another_there() {
        let arm = |torques: [f64; 2]| Column::new(torques.map(|torque| vec![torque, -torque]));
        let moved = |before: [f64; 2], after: [f64; 2], rounded: &[usize]| {
            let mut followed = arm(before);
            let moved = follow(&mut followed, &arm(after), rounded);
            let expected = [0, 1].map(|joint| if moved.contains(&joint) { after[joint] } else { before[joint] });
            assert_eq!(followed, arm(expected));
            moved
        };
        assert_eq!(moved([100.0, 1.0], [100.99, 1.0099], &[]), [0; 0]);
        assert_eq!(moved([100.0, 1.0], [101.01, 1.0], &[]), [0]);
        assert_eq!(moved([100.0, 1.0], [100.0, 0.9899], &[]), [1]);
        assert_eq!(moved([0.0, 0.0], [0.0, 1e-9], &[]), [1]);
        // Friction that is rounded otherwise changes what depends on it by more than the torque of the arm.
        assert_eq!(moved([100.0, 1.0], [100.0, 1.0], &[0]), [0]);
    }
}
