//! Generic functions of a joint as structure of the residual: what training and held-out rows show of them, and which names on
//! the joint they replace.

use super::condensed::Condensed;
use super::reported::{Replaced, Unexplained};
use crate::diagnosis::criteria::{Gate, Judgement, Levels};
use crate::diagnosis::evidence::{Block, Gains, against_slow_noise, modulated};
use crate::diagnosis::model::{DataSet, Member, Nuisances, PreparedLogs, Session};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection, Test, fisher, rms};
use crate::diagnosis::search::{Selection, members};
use crate::error::Result;
use std::borrow::Cow;
use std::ops::Range;

/// Whether a member may turn out to be structure of `joint`: it sits there alone, and is not shown by its impacts, which the rows do not
/// show, nor what the sampling makes, which is no finding that structure could replace.
pub(super) fn is_weighed(session: &Session, member: &Member, joint: usize) -> bool {
    !member.held && member.placed.joints() == [joint] && !session.sampling_makes(&member.placed)
}

/// Where structure is looked for.
#[derive(Debug)]
pub(super) struct Place {
    /// The joint.
    pub joint: usize,
    /// Number of kinds of blocks there.
    pub kinds: f64,
    /// Number of all tests on all joints.
    pub tests: f64,
    /// Whether a name on the joint may turn out to be structure.
    pub has_names: bool,
    /// The model in the noise under it, for tests there.
    pub under: Under,
}

/// The noise on training and held-out rows, and the fit of the model in it, for tests on one joint: the rows of the others are condensed.
#[derive(Debug, Clone)]
pub(super) struct Under {
    /// Makes the noise of the training rows white.
    pub whitener: Whitener,
    /// Makes that of the held-out rows white.
    pub on_held_out: Whitener,
    /// The fit to the training rows.
    pub fit: Projection,
    /// The fit with what errors of the positions put into the torque.
    pub adjusted_for_errors: Projection,
}

/// What the training rows show of a block.
#[derive(Debug)]
pub(super) struct Seen<'a> {
    /// The noise in which they show it.
    under: Cow<'a, Under>,
    whitened: Vec<Column>,
    test: Test,
    /// Probability of as much by chance.
    p: f64,
    /// The same over all tests.
    pub family_wise_p: f64,
}

/// What the held-out rows show of it.
#[derive(Debug)]
struct Again {
    /// Probability of as much by chance.
    chance: f64,
    /// Whether they gain by it, and also without the block that gains most.
    gained: [Judgement; 2],
    /// Whether that is significant: by its lower bound, or by chance where it is fitted to them.
    significant: Judgement,
}

/// Places of the columns of a regression.
#[derive(Debug)]
struct Places {
    model: Range<usize>,
    errors: Range<usize>,
    torque: usize,
}

/// The model as found, on training and held-out rows.
#[derive(Debug)]
pub(super) struct Fitted<'a> {
    /// Logs and arm.
    pub session: &'a Session<'a>,
    /// The effects in it.
    pub members: Vec<Member>,
    /// Which of them have no rivals.
    named: Vec<bool>,
    /// Its columns, those of the baseline first; columns of what errors of the positions put into the torque; and the torque.
    condensed: Condensed,
    /// Places of the columns of the model, of those of the errors, and of the torque.
    places: Places,
    /// Prior standard deviations of the factors of the errors.
    spread: Vec<f64>,
    /// The columns on the held-out rows, and those of the errors there.
    held_out_columns: Vec<Column>,
    held_out_errors: Nuisances,
    /// Residual on the held-out rows.
    pub before: &'a Column,
    /// Level of training and held-out logs together.
    together: f64,
    /// Level of the training logs from which structure is certain.
    pub certain: f64,
}

impl Under {
    /// The share of a joint's residual that `statistic` is. The fit minimises over all joints, so that it can give more than this
    /// joint has.
    pub(super) fn share(&self, joint: usize, statistic: f64) -> f64 {
        let left: f64 = self.fit.residual.part(joint).unwrap_or_default().iter().map(|r| r * r).sum();
        (statistic / left.max(f64::MIN_POSITIVE)).min(1.0)
    }

    /// Columns whitened, and their test adjusted for errors in variables.
    fn test(&self, columns: &[Column]) -> Option<(Vec<Column>, Test)> {
        let whitened = self.whitener.apply_all(columns);
        let test = self.adjusted_for_errors.test(&whitened)?;
        Some((whitened, test))
    }
}

impl<'a> Fitted<'a> {
    /// The model that a search came to; `alpha` is the level of named effects.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn new(session: &'a Session, selection: &'a Selection, alpha: f64) -> Result<Self> {
        let members = members(&selection.found);
        let columns = session.model.columns(&session.logs.train, &members)?;
        let errors = |data: &DataSet| {
            let mut errors = session.errors(data).all();
            errors.add(&data.bands, f64::INFINITY);
            errors
        };
        let train_errors = errors(&session.logs.train);
        let model = 0..columns.len();
        let errors_end = model.end + train_errors.columns().len();
        let torque = session.logs.train.torque.clone();
        let regression = [columns, train_errors.columns().to_vec(), vec![torque]].concat();
        Ok(Fitted {
            places: Places { errors: model.end..errors_end, model, torque: errors_end },
            condensed: Condensed::new(&selection.whitener, regression, session.logs.train.rows.dof()),
            spread: train_errors.spread().to_vec(),
            held_out_columns: session.model.columns(&session.logs.test, &members)?,
            held_out_errors: errors(&session.logs.test),
            before: &selection.held_out,
            together: session.criteria.structure.together * alpha,
            certain: session.criteria.levels.certain * alpha,
            session,
            named: selection.found.iter().map(|found| found.alternatives.is_empty()).collect(),
            members,
        })
    }

    /// Columns of the model, those of the baseline first.
    fn columns(&self) -> &[Column] {
        &self.condensed.whole[self.places.model.clone()]
    }

    /// The noise under the model.
    pub(super) fn whitener(&self) -> &Whitener {
        &self.condensed.whitener
    }

    /// The model in a noise that differs on the other joints from that of the search by its misfit alone, for tests on one joint.
    pub(super) fn under(&self, joint: usize, whitener: Whitener) -> Under {
        let columns = self.condensed.with_rows_of(joint, &whitener);
        let Places { model, errors, torque } = &self.places;
        let fit = Projection::new(&columns[model.clone()], &columns[*torque]);
        let adjusted_for_errors = fit.with_prior(&columns[errors.clone()], &self.spread);
        Under { on_held_out: whitener.on(&self.session.logs.test.rows), whitener, fit, adjusted_for_errors }
    }

    /// The laws that were named on this joint alone, without a rival that may explain the same, of a strength that changes, on training
    /// and held-out rows.
    pub(super) fn changing_laws(&self, joint: usize) -> Vec<(Block, Block)> {
        let PreparedLogs { train, test, .. } = &self.session.logs;
        let blocks = self.session.blocks(&self.members).members;
        let mut changing = Vec::new();
        for ((member, is_named), block) in self.members.iter().zip(&self.named).zip(blocks) {
            let own = block.amplitudes;
            // What happened in one log is not in others.
            if *is_named && is_weighed(self.session, member, joint) && member.candidate.log.is_none() {
                let on = |data, columns: &[Column]| modulated(self.session, data, joint, &columns[own.clone()]);
                changing.extend(on(train, self.columns()).into_iter().zip(on(test, &self.held_out_columns)));
            }
        }
        changing
    }

    /// What the training rows show of a block; None where that is no more than chance brings.
    pub(super) fn seen<'s>(&self, place: &'s Place, block: &Block) -> Option<Seen<'s>> {
        let rows = &self.session.logs.train.rows;
        let plain = place.under.test(&block.columns)?;
        if plain.1.log_p() > self.session.criteria.levels.open_p.ln() {
            return None;
        }
        let mut all = vec![(Cow::Borrowed(&place.under), plain)];
        // What stands out from the motion for moments only is taken for noise where nothing in the model is like it.
        if !block.over_time {
            let own = self.noise_with(place.joint, block);
            let tested = own.test(&block.columns);
            all.extend(tested.map(|tested| (Cow::Owned(own), tested)));
        }
        let seen = all.into_iter().filter_map(|(under, (whitened, test))| {
            // On a joint with a finding only the kinds of this joint count. Slow noise only adds to what chance alone brings.
            let tries = if place.has_names { place.kinds } else { place.tests };
            let p = (tries * test.log_p().exp() <= self.session.criteria.levels.even_p).then(|| {
                against_slow_noise(rows, &under.whitener, &under.adjusted_for_errors, &whitened, &test).exp()
            })?;
            tracing::debug!(place.joint, block.structure, p, plain = test.log_p(), "structure");
            let family_wise_p = (place.tests * p).min(1.0);
            (tries * p <= self.session.criteria.levels.even_p).then_some(Seen {
                under,
                whitened,
                test,
                p,
                family_wise_p,
            })
        });
        seen.min_by(|a, b| a.p.total_cmp(&b.p))
    }

    /// The noise with a block in the model, and the fit of the model without it in that.
    fn noise_with(&self, joint: usize, block: &Block) -> Under {
        let with: Vec<Column> = self.columns().iter().chain(&block.columns).cloned().collect();
        self.under(joint, self.session.noise_with_more_on(joint, self.whitener(), &with))
    }

    /// A block as the structure of its joint, if the held-out rows show it too, and it is large enough or replaces a finding; else the
    /// gate that it failed.
    pub(super) fn weighed(
        &self,
        place: &Place,
        block: &Block,
        again: &Block,
        seen: Seen,
    ) -> std::result::Result<Unexplained, Judgement> {
        let (joint, structure) = (place.joint, block.structure);
        let Seen { under, whitened, test, p, family_wise_p } = seen;
        let Again { chance, gained, significant } =
            if block.over_time { self.seen_again(&under, again) } else { self.gained(&under, joint, block, again) };
        let with = |level: f64| fisher([level.min(1.0), chance].map(|p| p.max(f64::MIN_POSITIVE).ln())).exp();
        tracing::debug!(joint, structure, chance, ?gained, ?significant, "structure on held-out rows");
        let levels = &self.session.criteria.levels;
        let surely = Judgement::below(Gate::Structure, family_wise_p, self.certain);
        let again = |level: f64| Judgement::below(Gate::StructureAgain, chance, level);
        // A place may be passed once, and what was fitted to few rows goes the right way without a gain.
        let ways = [
            vec![surely, gained[0], gained[1], significant],
            vec![surely, again(levels.strict_p)],
            vec![
                Judgement::below(Gate::Structure, with(family_wise_p), self.together),
                gained[0],
                gained[1],
                again(levels.usual_p),
            ],
        ];
        let failures = |way: &Vec<Judgement>| way.iter().filter(|judgement| !judgement.passed).count();
        let way = ways.iter().find(|way| failures(way) == 0);
        let certain = failures(&ways[0]) == 0;
        let of_finding =
            [again(levels.leaning_p), Judgement::below(Gate::Structure, with(place.kinds * p), levels.strict_p)];
        let is_not_all = place.has_names && Judgement::first_failed(of_finding).is_none();
        let share = under.share(joint, test.statistic);
        let large = Judgement::above(Gate::StructureShare, share, self.session.criteria.structure.share_of_residual());
        let weighs = certain || is_not_all;
        let instead_of = if weighs { self.made_superfluous(&under, joint, block, &whitened) } else { Vec::new() };
        tracing::debug!(joint, structure, share, ?way, ?instead_of, "structure weighed");
        let passed = match way {
            Some(way) if large.passed => way.iter().copied().chain([large]).collect(),
            _ if instead_of.is_empty() => {
                // The way that comes nearest: of those that fail fewest gates the first.
                let nearest = ways.iter().min_by_key(|way| failures(way)).filter(|_| way.is_none());
                let failed = nearest.and_then(|way| Judgement::first_failed(way.iter().copied()));
                return Err(failed.unwrap_or(large));
            }
            _ => of_finding.to_vec(),
        };
        Ok(Unexplained { joint, share, structure, family_wise_p: Some(family_wise_p), certain, instead_of, passed })
    }

    /// Evidence of the held-out rows for a block that goes with time: fitted to the residual of these alone. Rows
    /// that do not determine it show nothing.
    fn seen_again(&self, under: &Under, again: &Block) -> Again {
        let PreparedLogs { test, .. } = &self.session.logs;
        let model = [self.held_out_columns.as_slice(), self.held_out_errors.columns()].concat();
        let fit = under.on_held_out.fit(&model, &test.torque);
        let whitened = under.on_held_out.apply_all(&again.columns);
        let slow = |found: Test| against_slow_noise(&test.rows, &under.on_held_out, &fit, &whitened, &found).exp();
        let chance = fit.test(&whitened).map_or(1.0, slow);
        let significant = Judgement::below(Gate::StructureAgain, chance, self.session.criteria.levels.strict_p);
        Again { chance, gained: [significant; 2], significant }
    }

    /// Evidence of the held-out rows for a block that follows from the motion, as fitted to the training rows.
    fn gained(&self, under: &Under, joint: usize, block: &Block, again: &Block) -> Again {
        let gains = self.gains(under, joint, block, again);
        let gained = [gains.share(), gains.without_most_influential_block()];
        let gained = gained.map(|gain| Judgement::above(Gate::StructureGain, gain, 0.0));
        let lower_bound = gains.lower_bound(&self.session.criteria.levels);
        Again { chance: gains.chance(), gained, significant: Judgement::above(Gate::StructureGain, lower_bound, 0.0) }
    }

    /// How much better the held-out rows are predicted with a block.
    fn gains(&self, under: &Under, joint: usize, block: &Block, again: &Block) -> Gains {
        let PreparedLogs { train, test, .. } = &self.session.logs;
        let with: Vec<Column> = self.columns().iter().chain(&block.columns).cloned().collect();
        let solved = under.whitener.solve(&with, &train.torque);
        let mut after = test.torque.clone();
        for (column, value) in self.held_out_columns.iter().chain(&again.columns).zip(solved.values) {
            after.add(-value, column);
        }
        Gains::adjusted_for(&under.on_held_out, self.before, &after, &[joint], &self.held_out_errors, test.rows.len())
    }

    /// Members on this joint alone that add nothing to a block, on any joint, which itself explains more than a minor share of their torque
    /// beyond them: generic functions of the position hold every law of the position, and a law need not explain all that its joint has.
    fn made_superfluous(&self, under: &Under, joint: usize, block: &Block, whitened: &[Column]) -> Vec<Replaced> {
        let weighed = |&place: &usize| is_weighed(self.session, &self.members[place], joint);
        let weighed: Vec<usize> = (0..self.members.len()).filter(weighed).collect();
        if weighed.is_empty() {
            return Vec::new();
        }
        // In squares of the torque: noise that is slow weighs laws that are slow less, and their torque is missed all the same.
        let left = self.left_after(under, joint, self.columns());
        let with: Vec<Column> = self.columns().iter().chain(&block.columns).cloned().collect();
        let more = left - self.left_after(under, joint, &with);
        let blocks = self.session.blocks(&self.members).members;
        let replaced = |place: usize| {
            let own = blocks[place].all();
            let others: Vec<Column> =
                self.columns()[..own.start].iter().chain(&self.columns()[own.end..]).cloned().collect();
            let fit = under.whitener.fit(&others, &self.session.logs.train.torque).with(whitened);
            let own = under.whitener.apply_all(&self.columns()[own]);
            let log_p = fit.test(&own).map_or(0.0, |test| test.log_p());
            let explained = self.left_after(under, joint, &others) - left;
            let beyond = if explained > 0.0 { more / explained } else { f64::INFINITY };
            let family = self.members[place].candidate.family();
            tracing::debug!(joint, ?family, log_p, explained, beyond, "name in the presence of structure");
            is_superfluous(log_p, beyond, &self.session.criteria.levels).then_some(Replaced { place, beyond })
        };
        weighed.into_iter().filter_map(replaced).collect()
    }

    /// Mean square of the residual of a joint's training rows after a fit of `columns`, (N m)^2.
    fn left_after(&self, under: &Under, joint: usize, columns: &[Column]) -> f64 {
        let train = &self.session.logs.train;
        let mut left = train.torque.only(&[joint]);
        let values = under.whitener.solve(columns, &train.torque).values;
        columns.iter().zip(values.iter()).for_each(|(column, value)| left.add(-value, &column.only(&[joint])));
        rms(&train.rows.valid, &left)[joint].powi(2)
    }
}

/// Whether a law is superfluous in the presence of structure, by the logarithm of the p-value of what it adds to that, and by what the
/// structure explains `beyond` it, over what it explains by itself.
fn is_superfluous(log_p: f64, beyond: f64, levels: &Levels) -> bool {
    log_p > levels.sure_p.ln() && beyond > levels.minor
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_that_adds_nothing_to_structure_stays_where_that_is_minor() {
        let levels = Levels::default();
        let log_p = levels.sure_p.ln();
        assert!(is_superfluous(log_p + 1e-9, levels.minor + 1e-9, &levels));
        assert!(!is_superfluous(log_p, 1.0, &levels) && !is_superfluous(0.0, levels.minor, &levels));
    }
}
