//! What is left when no more effects pass: generic functions of the motion and of time tell whether it has structure.

use super::column::Column;
use super::session::{Member, Session};
use super::whitening::{Whitener, rich};
use crate::error::Result;

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

/// The blocks of generic columns of a joint.
fn blocks(session: &Session, joint: usize) -> Vec<(&'static str, Vec<Vec<f64>>)> {
    let rows = &session.train.rows;
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
    let fastest = rows.logs.iter().flat_map(|log| log.motion.qd.channel(joint)).fold(0.0f64, |m, v| m.max(v.abs()));
    let width = 2.0 * fastest / (HATS - 1) as f64;
    let hats = (0..HATS).map(|k| -fastest + k as f64 * width);
    let velocity = hats.map(|center| of(joint, &|_, v| (1.0 - ((v - center) / width).abs()).max(0.0))).collect();
    let others = (0..rows.dof()).filter(|&other| other != joint).flat_map(|other| {
        [of(other, &|q, _| q.cos()), of(other, &|q, _| q.sin()), of(other, &|_, v| v), of(other, &|_, v| v.signum())]
    });
    let mut time = Vec::new();
    for log in 0..rows.logs.len() {
        let (start, end) = (rows.starts[log], rows.starts[log + 1]);
        for k in 1..=COSINES {
            let mut column = vec![0.0; rows.len()];
            for (place, value) in column[start..end].iter_mut().enumerate() {
                *value = (std::f64::consts::PI * k as f64 * place as f64 / (end - start) as f64).cos();
            }
            time.push(column);
        }
    }
    vec![
        ("changes with the joint's position", position),
        ("depends on the joint's speed", velocity),
        ("depends on the other joints' positions and speeds", others.collect()),
        ("drifts over time", time),
    ]
}

/// Tests every joint for structure at a family-wise level.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn unexplained(session: &Session, members: &[Member], whitener: &Whitener, alpha: f64) -> Result<Vec<Unexplained>> {
    let columns = session.all_columns(&session.train, members)?;
    let fit = whitener.fit(&columns, &session.train.torque);
    let dof = session.train.rows.dof();
    let mut found = Vec::new();
    for joint in 0..dof {
        let left: f64 = fit.residual.part(joint).unwrap_or_default().iter().map(|r| r * r).sum();
        let blocks = blocks(session, joint);
        let tests = (dof * blocks.len()) as f64;
        let best = blocks
            .into_iter()
            .filter_map(|(structure, block)| {
                let block: Vec<Column> = block
                    .into_iter()
                    .map(|signal| whitener.apply(&Column::on(joint, session.train.rows.since_change(signal))))
                    .collect();
                Some((structure, fit.test(&block)?))
            })
            .min_by(|(_, a), (_, b)| a.log_p().total_cmp(&b.log_p()));
        if let Some((structure, test)) = best {
            let family_wise_p = (tests * test.log_p().exp()).min(1.0);
            if family_wise_p < STRICTER * alpha {
                // The fit minimises over all joints, so that it can give more than this joint has.
                let share = (test.statistic / left.max(f64::MIN_POSITIVE)).min(1.0);
                found.push(Unexplained { joint, share, structure, family_wise_p });
            }
        }
    }
    Ok(found)
}
