//! Generic functions of a joint's motion, of loads and of time: what no law of the library need be for structure to show.

use crate::diagnosis::logs::{Log, Rows};
use crate::diagnosis::model::{DataSet, Session};
use crate::diagnosis::noise::rich;
use crate::diagnosis::regression::Column;
use crate::signal::first_order_lag;
use std::f64::consts::PI;
use std::ops::Range;

/// Hats over the range of velocities, and of positions.
const HATS: usize = 8;
const PLACES: usize = 10;

/// Hats over the range of positions that find friction at a spot.
const SPOTS: usize = 30;

/// Harmonics of the position.
const HARMONICS: usize = 4;

/// Cosines over each log with which torque or friction may drift: half a period of the first is the log, and so on.
const DRIFTS: usize = 8;

/// Cosines over each log with which the strength of a law may change.
const SLOW_CHANGES: usize = 4;

/// Delays with which something may follow the motion, s.
pub(crate) const DELAYS_S: [f64; 3] = [0.05, 0.15, 0.5];

/// A kind of structure, and the generic columns of a joint that show it.
#[derive(Debug)]
pub(crate) struct Block {
    /// What it follows, as the end of a sentence on the residual.
    pub structure: &'static str,
    /// Its columns.
    pub columns: Vec<Column>,
    /// Whether it goes with time, which predicts nothing for other logs.
    pub over_time: bool,
}

/// Ranges of a joint's motion in the training logs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach {
    fastest: f64,
    lowest: f64,
    highest: f64,
}

impl Reach {
    /// The ranges of a joint over `rows`.
    pub(crate) fn new(rows: &Rows, joint: usize) -> Self {
        let all = |of: fn(&Log) -> &crate::channels::Channels| {
            rows.logs.iter().flat_map(move |log| of(log).channel(joint)).copied()
        };
        Reach {
            fastest: all(|log| &log.motion.qd).fold(0.0, |m, v| m.max(v.abs())),
            lowest: all(|log| &log.motion.q).fold(f64::INFINITY, f64::min),
            highest: all(|log| &log.motion.q).fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

/// Fewest rows in a period of a slow cosine: half a second.
const SHORTEST_SWING: usize = 25;

/// Cosines number `orders` over the length of every log, on one joint; those that would not be slow over a short log are left out.
pub(crate) fn slow_cosines(rows: &Rows, joint: usize, orders: Range<usize>) -> Vec<Column> {
    let mut cosines = Vec::new();
    for log in 0..rows.logs.len() {
        let (start, end) = (rows.starts[log], rows.starts[log + 1]);
        for k in orders.clone().filter(|k| k * SHORTEST_SWING <= 2 * (end - start)) {
            let mut column = vec![0.0; rows.len()];
            for (place, value) in column[start..end].iter_mut().enumerate() {
                *value = (PI * k as f64 * place as f64 / (end - start) as f64).cos();
            }
            cosines.push(Column::on(joint, column));
        }
    }
    cosines
}

/// The blocks of a joint over the rows of `data`.
pub(crate) fn blocks(session: &Session, data: &DataSet, joint: usize, reach: Reach) -> Vec<Block> {
    let rows = &data.rows;
    let of = |channel: usize, f: &dyn Fn(f64, f64) -> f64| {
        rows.signal(|log| {
            let (q, v) = (log.motion.q.channel(channel), log.motion.qd.channel(channel));
            q.iter().zip(v).map(|(&q, &v)| f(q, v)).collect()
        })
    };
    let own = |f: &dyn Fn(f64, f64) -> f64| of(joint, f);
    let torques = session.model.arm.all_torque(rows);
    let torque = |joint: usize| torques.part(joint).map(<[f64]>::to_vec).unwrap_or_default();
    let others = || (0..rows.dof()).filter(|&other| other != joint);

    let mut smooth = rich(rows, joint);
    for harmonic in 3..=HARMONICS {
        let n = harmonic as f64;
        for shift in [0.0, 0.5 * PI] {
            smooth.push(own(&|q, _| (n * q - shift).cos()));
            smooth.push(own(&|q, v| (n * q - shift).cos() * v.signum()));
            smooth.push(own(&|q, v| (n * q - shift).cos() * v));
        }
    }
    let width = 2.0 * reach.fastest / (HATS - 1) as f64;
    let hats = (0..HATS).map(|k| -reach.fastest + k as f64 * width);
    let speed = hats.map(|center| own(&|_, v| hat(v, center, width))).collect();
    let width = (reach.highest - reach.lowest) / (PLACES - 1) as f64;
    let places = (0..PLACES).map(|k| reach.lowest + k as f64 * width);
    let place =
        places.flat_map(|center| [own(&|q, _| hat(q, center, width)), own(&|q, v| hat(q, center, width) * v.signum())]);
    let damping = [f64::cos, f64::sin].map(|f| own(&|q, v| f(q) * v));
    let followed = DELAYS_S.map(|delay| {
        let late = move |f: fn(f64) -> f64| {
            rows.signal(|log| {
                let speed = log.motion.qd.channel(joint).iter().map(|&v| f(v));
                first_order_lag(speed, log.period / delay)
            })
        };
        vec![late(|v| v.max(0.0)), late(|v| v.min(0.0)), late(|v| v.max(0.0).powi(2)), late(|v| v.min(0.0).powi(2))]
    });
    let elsewhere = others().flat_map(|other| {
        [of(other, &|q, _| q.cos()), of(other, &|q, _| q.sin()), of(other, &|_, v| v), of(other, &|_, v| v.signum())]
    });
    let own_torque = torque(joint);
    let torque_sign: Vec<f64> = own_torque.iter().map(|torque| torque.signum()).collect();
    let own_sign = own(&|_, v| v.signum());
    let along = |other: usize| -> Vec<f64> {
        rows.signal(|log| {
            let (own, others) = (log.motion.qd.channel(joint), log.motion.qd.channel(other));
            own.iter().zip(others).map(|(own, other)| own.signum() * other.abs()).collect()
        })
    };
    let spot_width = (reach.highest - reach.lowest) / (SPOTS - 1) as f64;
    let spots = (0..SPOTS).map(|k| reach.lowest + k as f64 * spot_width);
    let spots = spots.map(|center| own(&|q, v| hat(q, center, spot_width) * v.signum())).collect();
    let drifting = |structure, signal: Vec<f64>| {
        let mut columns = slow_cosines(rows, joint, 1..DRIFTS + 1);
        for (_, values) in columns.iter_mut().flat_map(|column| &mut column.parts) {
            values.iter_mut().zip(rows.since_change(signal.clone())).for_each(|(slow, x)| *slow *= x);
        }
        Block { structure, columns, over_time: true }
    };
    let block = |structure, signals: Vec<Vec<f64>>| Block {
        structure,
        columns: signals.into_iter().map(|signal| Column::on(joint, rows.since_change(signal))).collect(),
        over_time: false,
    };
    let mut blocks = vec![
        block("is damping that changes with the joint's position", damping.into()),
        block("changes with the joint's position", smooth),
        block("sits at places of the joint's range", place.collect()),
        block("is friction at places of the joint's range", spots),
        block("depends on the joint's speed", speed),
        block("depends on the other joints' positions and speeds", elsewhere.collect()),
        block("depends on the joint's torque", powers(&own_torque, &torque_sign)),
        block("is friction that depends on the joint's torque", powers(&own_torque, &own_sign)),
        block("goes with the torque of other joints", others().map(torque).collect()),
        block("is friction that changes with the speed of other joints", others().map(along).collect()),
        drifting("goes with the joint's torque, more or less so over each log", own_torque),
        drifting("is friction that changes over each log", own_sign),
    ];
    // All delays together replace a finding better than one; and what follows with one is lost among the columns of all.
    let follows = |signals| block("follows the joint's speed with a delay", signals);
    blocks.push(follows(followed.concat()));
    blocks.extend(followed.map(follows));
    blocks
}

/// Generic changes of the strength of `law`, a torque of a joint: with the joint's load and position, and over time.
pub(crate) fn modulated(session: &Session, data: &DataSet, joint: usize, law: &[Column]) -> [Block; 2] {
    let rows = &data.rows;
    // Not with speed: smooth positions and means over rows take more of what swings faster.
    let of = |f: fn(f64) -> f64| rows.means(|log| log.motion.q.channel(joint).iter().map(|&q| f(q)).collect());
    let load = session.model.arm.all_torque(rows).part(joint).map_or_else(|| vec![0.0; rows.len()], <[f64]>::to_vec);
    let strengths = [vec![1.0; rows.len()], load, of(f64::cos), of(f64::sin)];
    let slow = slow_cosines(rows, joint, 0..SLOW_CHANGES + 1);
    let slow: Vec<Vec<f64>> = slow.into_iter().flat_map(|column| column.parts).map(|(_, values)| values).collect();
    let block = |structure, strengths: &[Vec<f64>], over_time| {
        let laws = law.iter().map(|law| law.part(joint).map_or_else(|| vec![0.0; rows.len()], <[f64]>::to_vec));
        let columns = laws.flat_map(|law| {
            let changing = |strength: &Vec<f64>| law.iter().zip(strength).map(|(x, s)| x * s).collect();
            strengths.iter().map(|strength| Column::on(joint, changing(strength))).collect::<Vec<Column>>()
        });
        Block { structure, columns: columns.collect(), over_time }
    };
    [
        block("follows a law of the library whose strength changes with torque or position", &strengths, false),
        block("follows a law of the library whose strength changes over each log", &slow, true),
    ]
}

/// The first three powers of the size of a torque, with `sign`.
fn powers(torque: &[f64], sign: &[f64]) -> Vec<Vec<f64>> {
    let power = |exponent: i32| torque.iter().zip(sign).map(|(x, sign)| x.abs().powi(exponent) * sign).collect();
    (1..=3).map(power).collect()
}

fn hat(x: f64, center: f64, width: f64) -> f64 {
    (1.0 - ((x - center) / width).abs()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::recording::Recording;

    #[test]
    fn short_logs_hold_few_slow_cosines() {
        let time: Vec<f64> = (0..2_000).map(|k| f64::from(k) / 500.0).collect();
        let q = Channels::from_vectors(&[time.iter().map(|t| (3.0 * t).sin()).collect()]);
        let tau = Channels::zeros(1, 2_000);
        let log = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        let part = log.slice(0..500);
        let rows = Rows::new(&[&log, &part], 10.0, 1).unwrap();
        // 200 rows of four seconds hold eight full swings of half a second, 50 rows of one second two; each has two halves.
        assert_eq!((rows.starts[1], rows.len()), (200, 250));
        assert_eq!(slow_cosines(&rows, 0, 1..41).len(), 16 + 4);
        assert_eq!(slow_cosines(&rows, 0, 0..1).len(), 2);
    }

    #[test]
    fn hats_add_up_to_one() {
        let sum: f64 = (0..8).map(|k| hat(0.37, -1.0 + 2.0 * f64::from(k) / 7.0, 2.0 / 7.0)).sum();
        assert!((sum - 1.0).abs() < 1e-12);
    }
}
