//! What is left when no more effects pass: generic functions of the motion, of loads and of time tell whether it has
//! structure, and whether a name only stands for a part of it.

use super::beside::against_slow_noise;
use super::column::Column;
use super::found::members;
use super::generic::{Block, Reach, blocks, slow_cosines};
use super::harmonics::Spectrum;
use super::held_out::{Gains, SEEN_AGAIN};
use super::score::{Projection, Test, fisher};
use super::selection::Selection;
use super::session::{Member, Session};
use super::solution::solve;
use super::whitening::Whitener;
use crate::error::Result;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::ops::Range;

/// Slow cosines over each log.
const COSINES: usize = 6;

/// Share of the level of named effects at which training and held-out logs together show structure: the columns are many and
/// general, and what they find cannot be checked against a law.
const STRICTER: f64 = 0.2;

/// Probability by chance up to which structure on the training logs is looked for on the held-out logs.
const LOOKED_FOR: f64 = 0.5;

/// Share of the level of named effects at which the training logs by themselves make structure sure.
const SURE: f64 = 0.02;

/// Least share of what is left on a joint that structure must have to be worth telling: with many rows that of any simplification of
/// a simulator or a sensor is sure.
const WORTH_TELLING: f64 = 0.03;

/// Probability below which a harmonic whose phase wanders is sure on the held-out logs too.
const CONFIRMED: f64 = 0.01;

/// A name is empty beside structure when what it adds to that is more likely than this without it.
const EMPTY: f64 = 1e-3;

/// Share of what a name takes by itself that structure must take beyond it to stand for it: less may be any simplification of its law.
const LITTLE: f64 = 0.02;

/// Level, over all kinds of structure of a joint, at which training and held-out logs together show that a name on it is not all: that
/// something is there is known, and what is asked is only whether the name is it.
const NOT_ALL: f64 = 0.01;

/// Probability by chance of what held-out logs alone must say for that.
const LEANS: f64 = 0.2;

/// Kinds of structure that are looked for beside the blocks: drifts, and harmonics that come and go.
const OTHER_KINDS: usize = 2;

/// Structure that no candidate carries.
#[derive(Debug, Clone, PartialEq)]
pub struct Unexplained {
    /// The joint.
    pub joint: usize,
    /// Share of what is left on it (sum of squares, whitened) that follows the structure.
    pub share: f64,
    /// What it follows.
    pub structure: &'static str,
    /// Probability of as much without structure, on any joint.
    pub family_wise_p: f64,
    /// Whether training and held-out logs each show it surely: names on the joint are weighed against it.
    pub sure: bool,
    /// Members of the model that add nothing to the structure, by their place: it explains what they were named for.
    pub instead_of: Vec<usize>,
}

/// Tests every joint for structure at a family-wise level; it must also show in the held-out logs.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn unexplained(session: &Session, selection: &Selection, alpha: f64) -> Result<Vec<Unexplained>> {
    let model = Fitted::new(session, selection, alpha)?;
    let each: Vec<Option<Unexplained>> =
        (0..session.train.rows.dof()).into_par_iter().map(|joint| model.left_on(joint)).collect();
    Ok(each.into_iter().flatten().collect())
}

/// Whether a member may turn out to be structure of `joint`: it acts there alone, and not by its impacts, which the rows do not tell.
fn is_weighed(member: &Member, joint: usize) -> bool {
    !member.held && member.candidate.joints() == [joint]
}

/// Where structure is looked for.
struct Place {
    joint: usize,
    /// What is left on the joint (sum of squares, whitened).
    left: f64,
    /// Number of kinds of blocks there, and of all tests on all joints.
    kinds: f64,
    tests: f64,
    /// Whether a name on the joint may turn out to be structure.
    has_names: bool,
}

impl Place {
    /// The share of what is left that `statistic` is. The fit minimises over all joints, so that it can give more than this joint has.
    fn share(&self, statistic: f64) -> f64 {
        (statistic / self.left.max(f64::MIN_POSITIVE)).min(1.0)
    }
}

/// What the training rows show of a block.
struct Seen {
    whitened: Vec<Column>,
    test: Test,
    /// Probability of as much by chance, and that over all tests.
    p: f64,
    family_wise_p: f64,
}

/// What the held-out rows show of it.
struct Again {
    /// Probability of as much by chance.
    chance: f64,
    /// Whether they gain by it, and surely.
    gained: bool,
    surely: bool,
}

/// The model as found, on training and held-out rows.
struct Fitted<'a> {
    session: &'a Session<'a>,
    members: Vec<Member>,
    whitener: &'a Whitener,
    unseen: Whitener,
    /// Columns of the model, those of the baseline first.
    columns: Vec<Column>,
    unseen_columns: Vec<Column>,
    fit: Projection,
    /// The fit with what errors of the positions put into the torque, and that on the held-out rows.
    beside_errors: Projection,
    unseen_errors: Vec<Column>,
    /// Residual on the held-out rows.
    before: &'a Column,
    /// Level of training and held-out logs together, and that of the training logs from which structure is sure.
    together: f64,
    sure: f64,
}

impl<'a> Fitted<'a> {
    fn new(session: &'a Session, selection: &'a Selection, alpha: f64) -> Result<Self> {
        let (members, whitener) = (members(&selection.found), &selection.whitener);
        let columns = session.all_columns(&session.train, &members)?;
        let fit = whitener.fit(&columns, &session.train.torque);
        Ok(Fitted {
            beside_errors: fit.with(&whitener.apply_all(&session.train.errors.all())),
            unseen_errors: session.test.errors.all(),
            unseen: whitener.on(&session.test.rows),
            unseen_columns: session.all_columns(&session.test, &members)?,
            fit,
            before: &selection.held_out,
            together: STRICTER * alpha,
            sure: SURE * alpha,
            session,
            members,
            whitener,
            columns,
        })
    }

    /// The likeliest structure of a joint.
    fn left_on(&self, joint: usize) -> Option<Unexplained> {
        let Session { train, test, .. } = self.session;
        let reach = Reach::new(&train.rows, joint);
        let kinds = blocks(self.session, train, joint, reach);
        let place = Place {
            joint,
            left: self.fit.residual.part(joint).unwrap_or_default().iter().map(|r| r * r).sum(),
            kinds: kinds.len() as f64,
            tests: train.rows.dof() as f64 * (kinds.len() + OTHER_KINDS) as f64,
            has_names: self.members.iter().any(|member| is_weighed(member, joint)),
        };
        let mut best: Option<Unexplained> = None;
        for (block, again) in kinds.into_iter().zip(blocks(self.session, test, joint, reach)) {
            let Some(seen) = self.seen(&place, &block) else { continue };
            // What stands for a name comes before what does not, then the likelier.
            let is_weaker = best.as_ref().is_some_and(|best| seen.family_wise_p >= best.family_wise_p);
            let is_settled = best.as_ref().is_some_and(|best| !place.has_names || !best.instead_of.is_empty());
            if is_weaker && is_settled {
                continue;
            }
            let Some(mut told) = self.told(&place, &block, &again, seen) else { continue };
            if told.instead_of.is_empty()
                && (is_weaker || best.as_ref().is_some_and(|best| !best.instead_of.is_empty()))
            {
                continue;
            }
            let others = best.into_iter().flat_map(|best| best.instead_of);
            let others: Vec<usize> = others.filter(|place| !told.instead_of.contains(place)).collect();
            told.instead_of.extend(others);
            best = Some(told);
        }
        best.or_else(|| self.wandering_harmonic(&place)).or_else(|| self.drift(&place))
    }

    /// What the training rows show of a block; None where that is no more than chance brings.
    fn seen(&self, place: &Place, block: &Block) -> Option<Seen> {
        let rows = &self.session.train.rows;
        let whitened = self.whitener.apply_all(&block.columns);
        let test = self.beside_errors.test(&whitened)?;
        // Slow noise only adds to what chance alone brings.
        if place.tests * test.log_p().exp() > LOOKED_FOR {
            return None;
        }
        let p = against_slow_noise(rows, self.whitener, &self.beside_errors, &whitened, &test).exp();
        let family_wise_p = (place.tests * p).min(1.0);
        tracing::debug!(place.joint, block.structure, family_wise_p, plain = test.log_p(), "structure");
        (family_wise_p <= LOOKED_FOR).then_some(Seen { whitened, test, p, family_wise_p })
    }

    /// A block as the structure of its joint, if the held-out rows show it too, and it is worth telling or stands for a name.
    fn told(&self, place: &Place, block: &Block, again: &Block, seen: Seen) -> Option<Unexplained> {
        let (joint, structure) = (place.joint, block.structure);
        let Seen { whitened, test, p, family_wise_p } = seen;
        let Again { chance, gained, surely } =
            if block.over_time { self.seen_again(again)? } else { self.gained(joint, block, again) };
        let with = |level: f64| fisher([level.min(1.0), chance].map(|p| p.max(f64::MIN_POSITIVE).ln())).exp();
        tracing::debug!(joint, structure, chance, gained, surely, "structure on held-out rows");
        let sure = gained && family_wise_p < self.sure && surely;
        let shown = sure || (gained && with(family_wise_p) < self.together && chance < SEEN_AGAIN);
        let is_not_all = place.has_names && chance < LEANS && with(place.kinds * p) < NOT_ALL;
        let share = place.share(test.statistic);
        let weighs = sure || is_not_all;
        let instead_of = if weighs { self.empty_beside(joint, &whitened, &test) } else { Vec::new() };
        tracing::debug!(joint, structure, share, shown, ?instead_of, "structure weighed");
        let told = (shown && share > WORTH_TELLING) || !instead_of.is_empty();
        told.then_some(Unexplained { joint, share, structure, family_wise_p, sure, instead_of })
    }

    /// What the held-out rows say of a block that goes with time: fitted to them by themselves, as far as the model leaves it.
    fn seen_again(&self, again: &Block) -> Option<Again> {
        let Session { test, .. } = self.session;
        let model = [self.unseen_columns.as_slice(), &self.unseen_errors].concat();
        let fit = self.unseen.fit(&model, &test.torque);
        let whitened = self.unseen.apply_all(&again.columns);
        let found = fit.test(&whitened)?;
        let chance = against_slow_noise(&test.rows, &self.unseen, &fit, &whitened, &found).exp();
        Some(Again { chance, gained: true, surely: chance < CONFIRMED })
    }

    /// What the held-out rows say of a block that follows from the motion, as fitted to the training rows.
    fn gained(&self, joint: usize, block: &Block, again: &Block) -> Again {
        let gains = self.gains(joint, block, again);
        let gained = gains.share() > 0.0 && gains.without_best_stretch() > 0.0;
        Again { chance: gains.chance(), gained, surely: gains.lower_bound() > 0.0 }
    }

    /// How much better the held-out rows are predicted with a block.
    fn gains(&self, joint: usize, block: &Block, again: &Block) -> Gains {
        let Session { train, test, .. } = self.session;
        let with: Vec<Column> = self.columns.iter().chain(&block.columns).cloned().collect();
        let solved = solve(&self.whitener.apply_all(&with), &self.whitener.apply(&train.torque));
        let mut after = test.torque.clone();
        for (column, value) in self.unseen_columns.iter().chain(&again.columns).zip(solved.values) {
            after.add(-value, column);
        }
        Gains::beside(&self.unseen, self.before, &after, &[joint], &self.unseen_errors, test.rows.len())
    }

    /// Members on this joint alone that add nothing to a block, which itself adds `more` than little to them.
    fn empty_beside(&self, joint: usize, block: &[Column], more: &Test) -> Vec<usize> {
        let more = more.statistic - more.freedom as f64;
        let mut first = self.session.train.baseline.len();
        let mut empty = Vec::new();
        for (place, member) in self.members.iter().enumerate() {
            let own = first..first + member.columns();
            first = own.end;
            if !is_weighed(member, joint) {
                continue;
            }
            let others: Vec<Column> =
                self.columns[..own.start].iter().chain(&self.columns[own.end..]).cloned().collect();
            let fit = self.whitener.fit(&others, &self.session.train.torque);
            let own = self.whitener.apply_all(&self.columns[own]);
            let alone = fit.test(&own).map_or(0.0, |test| test.statistic);
            let beside = fit.with(block).test(&own).map_or(0.0, |test| test.log_p());
            tracing::debug!(joint, family = ?member.candidate.family(), alone, beside, "name beside structure");
            if beside > EMPTY.ln() && more > LITTLE * alone {
                empty.push(place);
            }
        }
        empty
    }

    /// What drifts over each log: the power at the slowest frequencies against that at those above them, since how strong slow noise
    /// is the rows themselves do not tell.
    fn drift(&self, place: &Place) -> Option<Unexplained> {
        let rows = &self.session.train.rows;
        let cosines = |orders: Range<usize>| self.whitener.apply_all(&slow_cosines(rows, place.joint, orders));
        let slow = cosines(1..COSINES + 1);
        let test = self.fit.test(&slow)?;
        let above = self.fit.with(&slow).test(&cosines(COSINES + 1..3 * COSINES + 1))?;
        let (freedom, above_freedom) = (test.freedom as f64, above.freedom as f64);
        let ratio = test.statistic / freedom / (above.statistic / above_freedom);
        let family_wise_p = place.tests * FisherSnedecor::new(freedom, above_freedom).ok()?.sf(ratio);
        (family_wise_p < self.sure).then(|| Unexplained {
            joint: place.joint,
            share: place.share(test.statistic),
            structure: "drifts over time",
            family_wise_p,
            sure: true,
            instead_of: Vec::new(),
        })
    }

    /// A harmonic of the joint's position that comes and goes, seen in the held-out rows too.
    fn wandering_harmonic(&self, place: &Place) -> Option<Unexplained> {
        let Session { train, test, .. } = self.session;
        let Place { joint, tests, .. } = *place;
        let found = Spectrum::new(&train.rows, self.whitener, &self.fit.residual, joint).strongest()?;
        let family_wise_p = tests * found.log_p.exp();
        let residual = self.unseen.apply(&self.before.only(&[joint]));
        let again = (family_wise_p < self.sure)
            .then(|| Spectrum::new(&test.rows, &self.unseen, &residual, joint).at(found.order))
            .flatten()?;
        tracing::debug!(joint, ?found, ?again, "harmonic");
        (again.log_p < CONFIRMED.ln()).then_some(Unexplained {
            joint,
            share: found.share,
            structure: "is a harmonic of the joint's position that comes and goes",
            family_wise_p,
            sure: true,
            instead_of: Vec::new(),
        })
    }
}
