//! The residual when no more effects pass: generic functions of the motion, of loads and of time show whether it has
//! structure, and whether a finding is only a part of that.

use super::above_noise::above_sensor;
use super::harmonics::Spectrum;
use super::reported::{RejectedStructure, Replaced, Structure, Unexplained};
use super::structure::{Fitted, Place, Under, is_weighed};
use crate::diagnosis::criteria::{Gate, Judgement};
use crate::diagnosis::evidence::{Block, Reach, blocks, slow_cosines};
use crate::diagnosis::model::{PreparedLogs, Session};
use crate::diagnosis::regression::rms;
use crate::diagnosis::search::Selection;
use crate::error::Result;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::ops::Range;

/// Slow cosines over each log.
const COSINES: usize = 6;

/// Kinds of structure that are tested besides the blocks: drifts, and harmonics that come and go.
const OTHER_KINDS: usize = 2;

/// What a harmonic that is no ripple is.
const HARMONIC: &str = "is a harmonic of the joint's position that comes and goes";

/// Tests every joint for structure at a family-wise level; it must also show in the held-out logs.
///
/// A controller feeds the noise of its encoders back, and the torque that makes goes with the motion. A residual that is no larger than the
/// white noise of the torque has no structure to report; findings are compared with it all the same.
///
/// What training rows show is rejected with the gate that it fails.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn unexplained(session: &Session, selection: &Selection, alpha: f64) -> Result<Structure> {
    let model = Fitted::new(session, selection, alpha)?;
    let PreparedLogs { train, test, .. } = &session.logs;
    let residual = rms(&test.rows.valid, &selection.held_out);
    let above_sensor =
        |joint: usize| above_sensor(residual[joint], session.logs.sensor_noise(joint), &session.criteria);
    let on = |joint: usize| {
        let mut found = model.left_on(joint);
        let failed = above_sensor(joint);
        found.unexplained.iter_mut().for_each(|left| left.passed.push(failed));
        if !failed.passed && found.unexplained.iter().all(|left| left.instead_of.is_empty()) {
            let none = found.unexplained.drain(..);
            found.rejected.extend(none.map(|left| RejectedStructure { joint, structure: left.structure, failed }));
        }
        found
    };
    let each: Vec<Structure> = (0..train.rows.dof()).into_par_iter().map(on).collect();
    let mut all = Structure::default();
    all.extend(each);
    Ok(all)
}

impl Fitted<'_> {
    /// The likeliest structure of a joint, and what failed a gate.
    fn left_on(&self, joint: usize) -> Structure {
        let PreparedLogs { train, test, .. } = &self.session.logs;
        let reach = Reach::new(&train.rows, joint);
        let again = blocks(self.session, test, joint, reach);
        let mut kinds: Vec<(Block, Block)> = blocks(self.session, train, joint, reach).into_iter().zip(again).collect();
        kinds.extend(self.changing_laws(joint));
        let place = Place {
            joint,
            kinds: kinds.len() as f64,
            tests: train.rows.dof() as f64 * (kinds.len() + OTHER_KINDS) as f64,
            has_names: self.members.iter().any(|member| is_weighed(self.session, member, joint)),
            under: self.under(joint, self.whitener().clone()),
        };
        let (mut best, mut rejected): (Option<Unexplained>, Vec<RejectedStructure>) = Default::default();
        for (block, again) in kinds {
            let Some(seen) = self.seen(&place, &block) else { continue };
            // What replaces a finding comes before what does not, then the likelier.
            let is_weaker = best.as_ref().is_some_and(|best| Some(seen.family_wise_p) >= best.family_wise_p);
            let is_settled = best.as_ref().is_some_and(|best| !place.has_names || !best.instead_of.is_empty());
            if is_weaker && is_settled {
                continue;
            }
            let mut weighed = match self.weighed(&place, &block, &again, seen) {
                Ok(weighed) => weighed,
                Err(failed) => {
                    rejected.push(RejectedStructure { joint, structure: block.structure, failed });
                    continue;
                }
            };
            if weighed.instead_of.is_empty()
                && (is_weaker || best.as_ref().is_some_and(|best| !best.instead_of.is_empty()))
            {
                continue;
            }
            let others = best.into_iter().flat_map(|best| best.instead_of);
            let is_new = |other: &Replaced| weighed.instead_of.iter().all(|own| own.place != other.place);
            let others: Vec<Replaced> = others.filter(is_new).collect();
            weighed.instead_of.extend(others);
            best = Some(weighed);
        }
        let harmonic = match best {
            Some(best) => Some(Ok(best)),
            None => self.wandering_harmonic(&place),
        };
        let of_harmonic = |failed| RejectedStructure { joint, structure: HARMONIC, failed };
        let best = match harmonic {
            Some(Ok(best)) => Some(best),
            none => {
                rejected.extend(none.and_then(std::result::Result::err).map(of_harmonic));
                self.drift(&place)
            }
        };
        Structure { unexplained: best.into_iter().collect(), rejected }
    }

    /// What drifts over each log: the power at the slowest frequencies against that at those above them, since how strong slow noise
    /// is the rows themselves do not determine.
    fn drift(&self, place: &Place) -> Option<Unexplained> {
        let rows = &self.session.logs.train.rows;
        let Under { whitener, fit, .. } = &place.under;
        let cosines = |orders: Range<usize>| whitener.apply_all(&slow_cosines(rows, place.joint, orders));
        let slow = cosines(1..COSINES + 1);
        let test = fit.test(&slow)?;
        let above = fit.with(&slow).test(&cosines(COSINES + 1..3 * COSINES + 1))?;
        let (freedom, above_freedom) = (test.freedom as f64, above.freedom as f64);
        let ratio = test.statistic / freedom / (above.statistic / above_freedom);
        let family_wise_p = place.tests * FisherSnedecor::new(freedom, above_freedom).ok()?.sf(ratio);
        let significant = Judgement::below(Gate::Structure, family_wise_p, self.certain);
        significant.passed.then(|| Unexplained {
            joint: place.joint,
            share: place.under.share(place.joint, test.statistic),
            structure: "drifts over time",
            family_wise_p: Some(family_wise_p),
            certain: true,
            instead_of: Vec::new(),
            passed: vec![significant],
        })
    }

    /// A harmonic of the joint's position that comes and goes, seen in the held-out rows too, or the gate that it failed there. None where
    /// the training rows show none.
    fn wandering_harmonic(&self, place: &Place) -> Option<std::result::Result<Unexplained, Judgement>> {
        let PreparedLogs { train, test, .. } = &self.session.logs;
        let Place { joint, tests, ref under, .. } = *place;
        let Under { whitener, on_held_out, fit, .. } = under;
        let found = Spectrum::new(&train.rows, whitener, &fit.residual, joint).strongest()?;
        let family_wise_p = tests * found.log_p.exp();
        let residual = on_held_out.apply(&self.before.only(&[joint]));
        let significant = Judgement::below(Gate::Structure, family_wise_p, self.certain);
        if !significant.passed {
            return None;
        }
        let again = Spectrum::new(&test.rows, on_held_out, &residual, joint).at(found.order)?;
        tracing::debug!(joint, ?found, ?again, "harmonic");
        let levels = &self.session.criteria.levels;
        let confirmed = Judgement::below(Gate::StructureAgain, again.log_p.exp(), levels.usual_p);
        Some(if confirmed.passed {
            Ok(Unexplained {
                joint,
                share: found.share,
                structure: HARMONIC,
                family_wise_p: Some(family_wise_p),
                certain: again.log_p < levels.strict_p.ln(),
                instead_of: Vec::new(),
                passed: vec![significant, confirmed],
            })
        } else {
            Err(confirmed)
        })
    }
}
