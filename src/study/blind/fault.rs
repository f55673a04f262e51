//! Faults put into logs: what goes wrong between the arm and the file.

use crate::channels::Channels;
use crate::quality::Kind;
use crate::random;
use crate::recording::Recording;
use rand::RngExt;

/// Share of the largest torque at which it is clipped.
const CLIPPED_AT: f64 = 0.6;

/// Length of a gap and of a frozen interval, s.
const GAP_S: f64 = 0.6;
const FROZEN_S: f64 = 0.4;

/// A fault of the data.
///
/// ```
/// use tauscope::quality::Kind;
/// use tauscope::recording;
/// use tauscope::study::blind::fault::Fault;
///
/// // A fault put into a log, and what an examination must call it.
/// let before = recording::load("tests/reference/payload/before.csv", None)?;
/// let mut logs = [before.clone()];
/// Fault::Degrees.put_into(&mut logs, 1);
/// assert!((logs[0].q.channel(0)[0] - before.q.channel(0)[0].to_degrees()).abs() < 1e-9);
/// assert_eq!(Fault::Degrees.kind(), Kind::PositionUnit);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// Two columns of torque change places.
    SwappedTorques,
    /// Two columns of position change places, with their velocities.
    SwappedPositions,
    /// Positions and velocities in degrees.
    Degrees,
    /// The torque of one joint has the wrong sign.
    TorqueSign,
    /// Rows are missing.
    ClockGap,
    /// One column of position or torque stands still for a while.
    FrozenChannel,
    /// The torque of one joint is cut off.
    ClippedTorque,
}

impl Fault {
    /// All of them.
    pub const ALL: [Fault; 7] = [
        Fault::SwappedTorques,
        Fault::SwappedPositions,
        Fault::Degrees,
        Fault::TorqueSign,
        Fault::ClockGap,
        Fault::FrozenChannel,
        Fault::ClippedTorque,
    ];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Fault::SwappedTorques => "swapped_torques",
            Fault::SwappedPositions => "swapped_positions",
            Fault::Degrees => "degrees",
            Fault::TorqueSign => "torque_sign",
            Fault::ClockGap => "clock_gap",
            Fault::FrozenChannel => "frozen_channel",
            Fault::ClippedTorque => "clipped_torque",
        }
    }

    /// What the diagnosis has to call it.
    pub fn kind(self) -> Kind {
        match self {
            Fault::SwappedTorques | Fault::SwappedPositions => Kind::Swapped,
            Fault::Degrees => Kind::PositionUnit,
            Fault::TorqueSign => Kind::TorqueSign,
            Fault::ClockGap => Kind::Gap,
            Fault::FrozenChannel => Kind::Frozen,
            Fault::ClippedTorque => Kind::Clipped,
        }
    }

    /// Puts it into the logs, at a place drawn from `seed`: into all of them what is wrong with the wiring, into the first
    /// what happens once.
    pub fn put_into(self, logs: &mut [Recording], seed: u64) {
        let mut source = random::stream(seed, "blind fault", 0);
        let dof = logs[0].joints();
        let joint = source.random_range(0..dof);
        let other = (joint + source.random_range(1..dof)) % dof;
        let share = source.random_range(0.2..0.7);
        match self {
            Fault::SwappedTorques => logs.iter_mut().for_each(|log| exchange(&mut log.tau, joint, other)),
            Fault::SwappedPositions => {
                for log in logs {
                    exchange(&mut log.q, joint, other);
                    log.qd.iter_mut().for_each(|qd| exchange(qd, joint, other));
                }
            }
            Fault::Degrees => {
                for log in logs {
                    let tables = [Some(&mut log.q), log.qd.as_mut()];
                    let values = tables.into_iter().flatten().flat_map(Channels::as_mut_slice);
                    values.for_each(|value| *value = value.to_degrees());
                }
            }
            Fault::TorqueSign => {
                let signals = logs.iter_mut().flat_map(|log| log.tau.channel_mut(joint));
                signals.for_each(|value| *value = -*value);
            }
            Fault::ClockGap => {
                let start = (share * logs[0].samples() as f64) as usize;
                logs[0] = without(&logs[0], start, (GAP_S * logs[0].rate_hz()) as usize);
            }
            Fault::FrozenChannel => freeze(&mut logs[0], joint, share, source.random_bool(0.5)),
            Fault::ClippedTorque => {
                for log in logs {
                    let signal = log.tau.channel_mut(joint);
                    let level = CLIPPED_AT * signal.iter().fold(0.0f64, |most, value| most.max(value.abs()));
                    signal.iter_mut().for_each(|value| *value = value.clamp(-level, level));
                }
            }
        }
    }
}

fn exchange(table: &mut Channels, a: usize, b: usize) {
    let (first, second) = (table.channel(a).to_vec(), table.channel(b).to_vec());
    table.channel_mut(a).copy_from_slice(&second);
    table.channel_mut(b).copy_from_slice(&first);
}

/// The log without `count` rows from `start`.
fn without(log: &Recording, start: usize, count: usize) -> Recording {
    let (head, tail) = (log.slice(0..start), log.slice(start + count..log.samples()));
    let join = |a: &Channels, b: &Channels| a.map(|joint, signal| [signal, b.channel(joint)].concat());
    Recording {
        time: [head.time, tail.time].concat(),
        q: join(&head.q, &tail.q),
        qd: head.qd.zip(tail.qd).map(|(a, b)| join(&a, &b)),
        qdd: None,
        truth: None,
        tau: join(&head.tau, &tail.tau),
        ..log.clone()
    }
}

/// Holds a column for a while from where the joint is fastest after `share` of the log: what stands still there does not
/// come from the arm.
fn freeze(log: &mut Recording, joint: usize, share: f64, torque: bool) {
    let count = (FROZEN_S * log.rate_hz()) as usize;
    let from = (share * log.samples() as f64) as usize;
    let q = log.q.channel(joint);
    let moved = |start: usize| (q[start + count] - q[start]).abs();
    let start = (from..log.samples() - count - 1).max_by(|a, b| moved(*a).total_cmp(&moved(*b))).unwrap_or(from);
    let table = if torque { &mut log.tau } else { &mut log.q };
    let column = table.channel_mut(joint);
    let held = column[start];
    column[start..start + count].fill(held);
}
