//! What is left when no more effects pass: generic functions of the motion and of time tell whether it has structure.

use super::column::Column;
use super::held_out::Gains;
use super::rows::Rows;
use super::score::Projection;
use super::session::{Member, Session};
use super::solution::solve;
use super::whitening::{Whitener, rich};
use crate::error::Result;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::ops::Range;

/// Hats over the range of velocities, and slow cosines over each log.
const HATS: usize = 8;
const COSINES: usize = 6;

/// Harmonics of the position.
const HARMONICS: usize = 4;

/// Share of the level of named effects at which structure counts: the columns are many and general, and what they find
/// cannot be checked against a law.
const STRICTER: f64 = 0.02;

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
}

/// A kind of structure, and the generic columns of a joint that show it.
struct Block {
    structure: &'static str,
    signals: Vec<Vec<f64>>,
}

/// Cosines number `orders` over the length of every log, on one joint.
pub fn slow_cosines(rows: &Rows, joint: usize, orders: Range<usize>) -> Vec<Column> {
    let mut cosines = Vec::new();
    for log in 0..rows.logs.len() {
        let (start, end) = (rows.starts[log], rows.starts[log + 1]);
        for k in orders.clone() {
            let mut column = vec![0.0; rows.len()];
            for (place, value) in column[start..end].iter_mut().enumerate() {
                *value = (std::f64::consts::PI * k as f64 * place as f64 / (end - start) as f64).cos();
            }
            cosines.push(Column::on(joint, column));
        }
    }
    cosines
}

/// The share of a joint's residual that drifts over each log, and the probability of as much by chance: the power at the
/// slowest frequencies against that at those above them, since how strong slow noise is the rows themselves do not tell.
fn drift(session: &Session, fit: &Projection, whitener: &Whitener, joint: usize, left: f64) -> Option<(f64, f64)> {
    let rows = &session.train.rows;
    let cosines = |orders: Range<usize>| whitener.apply_all(&slow_cosines(rows, joint, orders));
    let slow = cosines(1..COSINES + 1);
    let test = fit.test(&slow)?;
    let above = fit.with(&slow).test(&cosines(COSINES + 1..3 * COSINES + 1))?;
    let (freedom, above_freedom) = (test.freedom as f64, above.freedom as f64);
    let ratio = test.statistic / freedom / (above.statistic / above_freedom);
    let p = FisherSnedecor::new(freedom, above_freedom).ok()?.sf(ratio);
    Some((test.statistic / left.max(f64::MIN_POSITIVE), p))
}

/// The blocks of generic columns of a joint over `rows`; `fastest` is its top speed in the training logs, rad/s.
fn blocks(rows: &Rows, joint: usize, fastest: f64) -> Vec<Block> {
    let of = |channel: usize, f: &dyn Fn(f64, f64) -> f64| {
        rows.signal(|log| {
            let (q, v) = (log.motion.q.channel(channel), log.motion.qd.channel(channel));
            q.iter().zip(v).map(|(&q, &v)| f(q, v)).collect()
        })
    };
    let mut position = rich(rows, joint);
    for harmonic in 3..=HARMONICS {
        let n = harmonic as f64;
        for shift in [0.0, std::f64::consts::FRAC_PI_2] {
            position.push(of(joint, &|q, _| (n * q - shift).cos()));
            position.push(of(joint, &|q, v| (n * q - shift).cos() * v.signum()));
            position.push(of(joint, &|q, v| (n * q - shift).cos() * v));
        }
    }
    let width = 2.0 * fastest / (HATS - 1) as f64;
    let hats = (0..HATS).map(|k| -fastest + k as f64 * width);
    let velocity = hats.map(|center| of(joint, &|_, v| (1.0 - ((v - center) / width).abs()).max(0.0))).collect();
    let others = (0..rows.dof()).filter(|&other| other != joint).flat_map(|other| {
        [of(other, &|q, _| q.cos()), of(other, &|q, _| q.sin()), of(other, &|_, v| v), of(other, &|_, v| v.signum())]
    });
    vec![
        Block { structure: "changes with the joint's position", signals: position },
        Block { structure: "depends on the joint's speed", signals: velocity },
        Block { structure: "depends on the other joints' positions and speeds", signals: others.collect() },
    ]
}

/// Tests every joint for structure at a family-wise level; what can come again must also show in the held-out logs.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn unexplained(session: &Session, members: &[Member], whitener: &Whitener, alpha: f64) -> Result<Vec<Unexplained>> {
    let (rows, unseen_rows) = (&session.train.rows, &session.test.rows);
    let columns = session.all_columns(&session.train, members)?;
    let unseen_columns = session.all_columns(&session.test, members)?;
    let fit = whitener.fit(&columns, &session.train.torque);
    let before = session.held_out_residual(members, whitener)?;
    let unseen = whitener.on(unseen_rows);
    let dof = rows.dof();
    let mut found = Vec::new();
    for joint in 0..dof {
        let left: f64 = fit.residual.part(joint).unwrap_or_default().iter().map(|r| r * r).sum();
        let velocities = rows.logs.iter().flat_map(|log| log.motion.qd.channel(joint));
        let fastest = velocities.fold(0.0f64, |m, v| m.max(v.abs()));
        let kinds = blocks(rows, joint, fastest);
        let tests = (dof * (kinds.len() + 1)) as f64;
        let mut best: Option<Unexplained> = None;
        for (block, again) in kinds.into_iter().zip(blocks(unseen_rows, joint, fastest)) {
            let on = |signals: Vec<Vec<f64>>| signals.into_iter().map(|signal| Column::on(joint, signal)).collect();
            let seen: Vec<Column> = on(block.signals.into_iter().map(|signal| rows.since_change(signal)).collect());
            let Some(test) = fit.test(&whitener.apply_all(&seen)) else { continue };
            let family_wise_p = (tests * test.log_p().exp()).min(1.0);
            let level = STRICTER * alpha;
            if family_wise_p >= best.as_ref().map_or(level, |best| best.family_wise_p.min(level)) {
                continue;
            }
            let with: Vec<Column> = columns.iter().chain(&seen).cloned().collect();
            let solved = solve(&whitener.apply_all(&with), &whitener.apply(&session.train.torque));
            let again: Vec<Column> = on(again.signals);
            let mut after = session.test.torque.clone();
            for (column, value) in unseen_columns.iter().chain(&again).zip(solved.values) {
                after.add(-value, column);
            }
            if Gains::new(&unseen, &before, &after, &[joint], unseen_rows.len()).lower_bound() <= 0.0 {
                continue;
            }
            // The fit minimises over all joints, so that it can give more than this joint has.
            let share = (test.statistic / left.max(f64::MIN_POSITIVE)).min(1.0);
            best = Some(Unexplained { joint, share, structure: block.structure, family_wise_p });
        }
        if best.is_none()
            && let Some((share, p)) = drift(session, &fit, whitener, joint, left)
            && (tests * p) < STRICTER * alpha
        {
            let family_wise_p = tests * p;
            best = Some(Unexplained { joint, share: share.min(1.0), structure: "drifts over time", family_wise_p });
        }
        found.extend(best);
    }
    Ok(found)
}
