//! Where a residual lives: against position, velocity, acceleration, torque and time, and in which second of the motion.

use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::Column;

/// Bins of a variable, equally filled.
const BINS: usize = 20;

/// Rows in a block (one second).
const BLOCK: usize = 50;

/// Share from which on the console reports another variable than time. No finding or verdict depends on it.
const WORTH_NAMING: f64 = 0.2;

/// Where the residual of one joint lives.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // As described, the held-out residual follows the position of the pivot; with what was found, it does not.
/// let [described, extended] = &diagnosis.errors.structure;
/// assert!(extended[0].rms_nm < 0.1 * described[0].rms_nm);
/// assert!(described[0].follows.position > 0.8 && extended[0].follows.position < 0.1);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ResidualStructure {
    /// Root mean square, N m.
    pub rms_nm: f64,
    /// Share of its sum of squares that follows each variable, whatever the law, beyond what noise would.
    pub follows: Follows,
    /// The second in which it is largest.
    pub worst: Option<Worst>,
}

/// Shares of a residual that follow a variable of its own joint.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Diagnosis, Follows};
///
/// // Of the arm as described, the first joint.
/// fn of_first(diagnosis: &Diagnosis) -> Follows {
///     diagnosis.errors.structure[0][0].follows
/// }
///
/// let follows = Follows { position: 0.8, velocity: 0.1, ..Follows::default() };
/// assert_eq!(follows.most(), ("position", 0.8));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Follows {
    pub position: f64,
    pub velocity: f64,
    pub acceleration: f64,
    pub torque: f64,
    pub time: f64,
}

/// The second of the logs in which a residual is largest.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Diagnosis, Worst};
///
/// // Where to look first: the second in which the extended model is farthest off on the first joint.
/// fn at(diagnosis: &Diagnosis) -> Option<String> {
///     let Worst { log, from_s, to_s, rms_nm } = diagnosis.errors.structure[1][0].worst?;
///     Some(format!("held-out log {log}, {from_s} to {to_s} s: {rms_nm} N m"))
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Worst {
    /// Number of the log, from 0.
    pub log: usize,
    /// Start, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Root mean square there, N m.
    pub rms_nm: f64,
}

impl Follows {
    /// The variable that the most follows, in words, with the share. Along one motion all that is slow follows time, so time
    /// is named only where none of the others is worth naming.
    pub fn most(&self) -> (&'static str, f64) {
        let all = [
            ("position", self.position),
            ("velocity", self.velocity),
            ("acceleration", self.acceleration),
            ("torque", self.torque),
        ];
        let most = all.into_iter().max_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap_or(all[0]);
        if most.1 < WORTH_NAMING && self.time > most.1 { ("time", self.time) } else { most }
    }
}

/// The structure of a residual over `rows`, of every joint.
pub(in crate::diagnosis::answer) fn residual_structure(rows: &Rows, residual: &Column) -> Vec<ResidualStructure> {
    (0..rows.dof())
        .map(|joint| {
            let kept: Vec<usize> = (0..rows.len()).filter(|&row| rows.valid[joint][row]).collect();
            let values: Vec<f64> = kept.iter().map(|&row| residual.part(joint).map_or(0.0, |part| part[row])).collect();
            let share = |signal: Vec<f64>| {
                let own: Vec<f64> = kept.iter().map(|&row| signal[row]).collect();
                follows(&own, &values)
            };
            let motion = |which: fn(&crate::dynamics::Motion) -> &crate::channels::Channels| {
                share(rows.means(|log| which(&log.motion).channel(joint).to_vec()))
            };
            ResidualStructure {
                rms_nm: (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt(),
                follows: Follows {
                    position: motion(|motion| &motion.q),
                    velocity: motion(|motion| &motion.qd),
                    acceleration: motion(|motion| &motion.qdd),
                    torque: share(rows.torque[joint].clone()),
                    time: share((0..rows.len()).map(|row| row as f64).collect()),
                },
                worst: worst(rows, &kept, &values),
            }
        })
        .collect()
}

/// Share of the variance of `values` between bins of `variable`, less what noise would give.
fn follows(variable: &[f64], values: &[f64]) -> f64 {
    let count = values.len();
    if count < 4 * BINS {
        return 0.0;
    }
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| variable[a].total_cmp(&variable[b]));
    let mean = values.iter().sum::<f64>() / count as f64;
    // A residual of one sign follows no variable, but is structure all the same: shares are of the mean square.
    let total: f64 = values.iter().map(|v| v * v).sum();
    let within: f64 = (0..BINS)
        .map(|bin| {
            let own = &order[bin * count / BINS..(bin + 1) * count / BINS];
            let middle = own.iter().map(|&k| values[k]).sum::<f64>() / own.len() as f64;
            own.iter().map(|&k| (values[k] - middle).powi(2)).sum::<f64>()
        })
        .sum();
    let about_mean = total - count as f64 * mean * mean;
    if total <= 0.0 {
        return 0.0;
    }
    let expected = within / (count - BINS) as f64 * (count - 1) as f64;
    ((about_mean - expected) / total).max(0.0)
}

fn worst(rows: &Rows, kept: &[usize], values: &[f64]) -> Option<Worst> {
    let mut blocks: Vec<(usize, usize, f64, usize)> = Vec::new();
    for (&row, value) in kept.iter().zip(values) {
        let log = rows.starts.partition_point(|&start| start <= row) - 1;
        let block = (row - rows.starts[log]) / BLOCK;
        match blocks.last_mut().filter(|last| (last.0, last.1) == (log, block)) {
            Some(last) => (last.2, last.3) = (last.2 + value * value, last.3 + 1),
            None => blocks.push((log, block, value * value, 1)),
        }
    }
    let mean = |&(.., sum, count): &(usize, usize, f64, usize)| sum / count as f64;
    let long = blocks.iter().filter(|(.., count)| *count >= BLOCK / 4);
    let (log, block, sum, count) = *long.max_by(|a, b| mean(a).total_cmp(&mean(b)))?;
    let times = rows.logs[log].blocks(&rows.logs[log].time);
    let at = |row: usize| times.get(row.min(times.len().max(1) - 1)).copied().unwrap_or(0.0);
    Some(Worst { log, from_s: at(block * BLOCK), to_s: at((block + 1) * BLOCK), rms_nm: (sum / count as f64).sqrt() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_of_the_variable_is_seen_and_noise_is_not() {
        let count = 2000;
        let variable: Vec<f64> = (0..count).map(|k| (0.37 * f64::from(k)).sin()).collect();
        let law: Vec<f64> = variable.iter().map(|x| x * x - 0.5).collect();
        assert!(follows(&variable, &law) > 0.95);
        let other: Vec<f64> = (0..count).map(|k| (1.618 * f64::from(k * k)).sin()).collect();
        assert!(follows(&variable, &other) < 0.05);
        assert_eq!(follows(&variable, &vec![0.0; count as usize]), 0.0);
    }
}
