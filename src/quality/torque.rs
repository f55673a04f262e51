//! Torque against motion: sign, unit, order of the columns, dead time, excitation.
//!
//! A linear model of every joint is fitted to its torque alone, so that a fault of one joint does not hide behind
//! another. Friction tells the sign: whatever the inertias are, it takes power. So do the URDF's bodies, where they are
//! possible ones. The lag with the smallest residual tells the dead time, where the arm is known: a model of a joint alone
//! would take the pull of the other joints for one.

use super::arrangement::{Arrangement, arrangement};
use super::motion::JointSummary;
use super::velocity::vertex;
use super::{BAND, Finding, Kind, Severity, View, correlation, rms, size_quantile};
use crate::channels::Channels;
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::identification::model::Model;
use crate::robot::{Joint, Robot};
use nalgebra::{DMatrix, DVector};

/// Samples of the log that enter the models.
const ROWS: usize = 4000;

/// Longest dead time looked for, s, and the shortest that is reported.
const REACH_S: f64 = 0.05;
const DEAD_TIME_S: f64 = 0.0015;

/// Mean square that a dead time must cost on a joint, over what is left without it: under slow noise the best lag is not zero
/// either.
const DEAD_TIME_COSTS: f64 = 1.1;

/// Directions of a model's normal matrix weaker than this, of the strongest, are left out.
const WEAK: f64 = 1e-9;

/// A joint must turn back this often before its friction tells the sign of its torque.
const REVERSALS: usize = 4;

/// By how much the residual must grow without friction before friction tells the sign.
const FRICTION_TELLS: f64 = 1.3;

/// Correlation from which on a logged torque is compared with that of the URDF's bodies.
const ALIKE: f64 = 0.6;

/// A condition number above this makes base parameters uncertain.
const POOR: f64 = 2000.0;

/// Fewer rows than this many per column say nothing.
const ROWS_PER_COLUMN: usize = 4;

/// Findings about torque, and the condition number where the arm is known. Fills in what the models of the joints tell.
pub fn findings(view: &View, summaries: &mut [JointSummary], robot: Option<&Robot>) -> (Vec<Finding>, Option<f64>) {
    let reach = ((REACH_S / view.period) as usize).clamp(2, 60);
    let Some(last) = view.log.samples().checked_sub(2 * reach + 1) else { return (Vec::new(), None) };
    let step = last.div_ceil(ROWS).max(1);
    let rows: Vec<usize> = (reach..reach + last).step_by(step).collect();
    let motion = picked(view, &rows);
    let model = robot.map(Model::new);
    let columns = match &model {
        Some(model) => model.columns(&motion, 0.0),
        None => (0..view.dof()).map(|joint| joint_alone(&motion, joint)).collect(),
    };
    let fits: Vec<Option<JointFit>> = (0..view.dof())
        .map(|joint| {
            // Viscous and Coulomb friction are the last two columns of a joint alone, and marked in an arm's.
            let friction = match &model {
                Some(model) => {
                    let active = model.active(joint).into_iter().enumerate();
                    active.filter(|(_, b)| model.is_friction(*b)).map(|(place, _)| place).collect()
                }
                None => vec![4, 5],
            };
            JointFit::new(&columns[joint], &rows, motion.qd.channel(joint), friction)
        })
        .collect();

    let (mut out, mut lags) = (Vec::new(), Vec::new());
    let nominal = robot.and_then(|robot| bodies(robot, &motion));
    let gains = nominal.map_or(vec![None; view.dof()], |nominal| gains(view, &nominal, &rows));
    let against: Vec<bool> = gains.iter().map(|gain| gain.is_some_and(|gain| gain < 0.0)).collect();
    let tau = view.tau.map(|_, signal| rows.iter().map(|&row| signal[row]).collect());
    // A torque that was not logged contradicts all others, whatever the order of the columns is.
    let silent: Vec<bool> =
        (0..view.dof()).map(|j| view.log.tau.channel(j).iter().all(|v| *v == view.log.tau.channel(j)[0])).collect();
    let logged = !silent.contains(&true);
    let best = model
        .as_ref()
        .filter(|_| logged)
        .and_then(|model| arrangement(model, &motion, &tau, view.log.duration()))
        .unwrap_or_default();
    let in_order = best.torques.is_empty() && best.positions.is_none();
    for (joint, fit) in fits.iter().enumerate() {
        let Some(fit) = fit.as_ref().filter(|_| !silent[joint]) else { continue };
        let tau = view.tau.channel(joint);
        let share = fit.unexplained(tau, 0);
        summaries[joint].unexplained = Some(share);
        let power = fit.friction_power(tau).filter(|_| summaries[joint].reversals >= REVERSALS);
        let driven = power.is_some_and(|power| power > 0.0);
        let braked = power.is_some_and(|power| power < 0.0);
        let flipped = best.flipped.contains(&joint);
        // A wrist's torque is mostly friction, and may go against its light bodies by chance.
        if in_order && (driven || (against[joint] && !braked) || flipped) {
            let reason = match (driven, flipped) {
                (true, _) => "friction would have to drive the joint",
                (_, true) => "it contradicts the torques of the other joints or what friction does",
                _ => "it opposes the URDF's bodies",
            };
            let text = format!("{reason}: the torque has the wrong sign; turn it round");
            out.push(Finding::new(Kind::TorqueSign, Severity::Warning, view.place("tau", joint), text));
        }
        if robot.is_some() {
            let lag = fit.lag(tau, reach);
            summaries[joint].dead_time_s = lag.map(|lag| lag.samples * view.period);
            lags.extend(lag);
        }
    }
    out.extend(dead_time(view, &lags));
    if robot.is_some() {
        out.extend(out_of_order(view, &best));
        if in_order && logged {
            out.extend(swapped(view, &fits));
        }
    }
    out.extend(unit(&gains));
    let condition = model.map(|model| condition_number(&model, &columns, rows.len()));
    if let Some(condition) = condition.filter(|c| *c > POOR) {
        let text = format!(
            "the condition number of the base parameters is {condition:.0}: some of them cannot be told apart on this \
             motion; move more joints faster and further"
        );
        out.push(Finding::new(Kind::PoorExcitation, Severity::Note, "motion", text));
    }
    (out, condition)
}

/// The smoothed motion at some samples.
fn picked(view: &View, rows: &[usize]) -> Motion {
    let pick = |signals: &Channels| signals.map(|_, signal| rows.iter().map(|&row| signal[row]).collect());
    Motion { q: pick(&view.q), qd: pick(&view.qd), qdd: pick(&view.qdd) }
}

/// Columns of a joint of which nothing is known: offset, gravity on a level axis, rotor, friction.
fn joint_alone(motion: &Motion, joint: usize) -> Channels {
    let (q, qd) = (motion.q.channel(joint), motion.qd.channel(joint));
    let of = |law: fn(f64) -> f64, signal: &[f64]| signal.iter().map(|&x| law(x)).collect::<Vec<f64>>();
    Channels::from_vectors(&[
        vec![1.0; q.len()],
        of(f64::sin, q),
        of(f64::cos, q),
        motion.qdd.channel(joint).to_vec(),
        qd.to_vec(),
        of(f64::signum, qd),
    ])
}

/// The column space of a joint's model over the samples at which its direction is certain.
struct JointFit {
    rows: Vec<usize>,
    velocity: Vec<f64>,
    columns: DMatrix<f64>,
    /// Orthonormal basis of the columns.
    basis: DMatrix<f64>,
    /// Columns from coordinates in the basis.
    solve: DMatrix<f64>,
    friction: Vec<usize>,
}

impl JointFit {
    fn new(columns: &Channels, rows: &[usize], velocity: &[f64], friction: Vec<usize>) -> Option<JointFit> {
        let kept: Vec<usize> = (0..rows.len()).filter(|&row| velocity[row].abs() > BAND).collect();
        if kept.len() < ROWS_PER_COLUMN * columns.channels() {
            return None;
        }
        let mut table = DMatrix::from_fn(kept.len(), columns.channels(), |row, c| columns.channel(c)[kept[row]]);
        let scales: Vec<f64> = (0..table.ncols()).map(|c| table.column(c).norm()).collect();
        for (c, &scale) in scales.iter().enumerate().filter(|(_, scale)| **scale > 0.0) {
            table.column_mut(c).unscale_mut(scale);
        }
        let gram = (table.transpose() * &table).symmetric_eigen();
        let largest = gram.eigenvalues.max();
        let strong: Vec<usize> =
            (0..gram.eigenvalues.len()).filter(|&i| gram.eigenvalues[i] > WEAK * largest).collect();
        let mut solve = DMatrix::zeros(table.ncols(), strong.len());
        for (place, &i) in strong.iter().enumerate() {
            solve.set_column(place, &(gram.eigenvectors.column(i) / gram.eigenvalues[i].sqrt()));
        }
        let basis = &table * &solve;
        Some(JointFit {
            velocity: kept.iter().map(|&row| velocity[row]).collect(),
            rows: kept.iter().map(|&row| rows[row]).collect(),
            columns: table,
            basis,
            solve,
            friction,
        })
    }

    /// The torque of the samples, `lag` samples later.
    fn torque(&self, tau: &[f64], lag: isize) -> DVector<f64> {
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(|&row| tau[row.saturating_add_signed(lag)]))
    }

    /// Part of a torque that the model leaves, root mean square over root mean square.
    fn unexplained(&self, tau: &[f64], lag: isize) -> f64 {
        let torque = self.torque(tau, lag);
        let rest = &torque - &self.basis * (self.basis.transpose() * &torque);
        rest.norm() / torque.norm().max(f64::MIN_POSITIVE)
    }

    /// Power with which the friction that fits drives the joint (negative where it brakes it, as friction does), as a share of
    /// the most that so large a torque could; None where the fit does not tell.
    fn friction_power(&self, tau: &[f64]) -> Option<f64> {
        let torque = self.torque(tau, 0);
        let beta = &self.solve * (self.basis.transpose() * &torque);
        let rest = &torque - &self.columns * &beta;
        let friction = self.friction.iter().fold(DVector::zeros(torque.len()), |sum: DVector<f64>, &column| {
            sum + self.columns.column(column) * beta[column]
        });
        let power: f64 = friction.iter().zip(&self.velocity).map(|(t, v)| t * v).sum::<f64>();
        let size = rms(friction.as_slice());
        let other: Vec<usize> = (0..self.columns.ncols()).filter(|column| !self.friction.contains(column)).collect();
        let gained = self.without(&other, &torque) / rest.norm().max(f64::MIN_POSITIVE);
        let most = friction.norm() * self.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
        let clear = gained > FRICTION_TELLS && power.abs() > 0.5 * most && size > 0.05 * rms(torque.as_slice());
        // The torque that overcomes friction goes with the motion.
        clear.then(|| -power / most)
    }

    /// Length of what some of the columns leave of a torque.
    fn without(&self, columns: &[usize], torque: &DVector<f64>) -> f64 {
        let table = DMatrix::from_fn(torque.len(), columns.len(), |row, c| self.columns[(row, columns[c])]);
        let gram = (table.transpose() * &table).symmetric_eigen();
        let largest = gram.eigenvalues.max();
        let projected = gram.eigenvectors.transpose() * (table.transpose() * torque);
        let explained: f64 = (0..projected.len())
            .filter(|&i| gram.eigenvalues[i] > WEAK * largest)
            .map(|i| projected[i] * projected[i] / gram.eigenvalues[i])
            .sum();
        (torque.norm_squared() - explained).max(0.0).sqrt()
    }

    /// By how much the torque comes behind the motion; None where the residual does not depend on it.
    fn lag(&self, tau: &[f64], reach: usize) -> Option<Lag> {
        let reach = reach as isize;
        let left: Vec<f64> = (-reach..=reach).map(|lag| self.unexplained(tau, lag).powi(2)).collect();
        let best = (0..left.len()).min_by(|&a, &b| left[a].total_cmp(&left[b]))?;
        let worst = left[0].max(left[left.len() - 1]);
        let inside = best > 0 && best + 1 < left.len();
        (inside && left[best] < 0.5 * worst && left[best] < 0.25).then(|| Lag {
            samples: best as f64 - reach as f64 + vertex(&left, best),
            cost: left[reach as usize] / left[best].max(f64::MIN_POSITIVE),
        })
    }
}

/// The lag of a joint's torque behind its motion.
#[derive(Debug, Clone, Copy)]
struct Lag {
    samples: f64,
    /// Mean square that the model leaves without a lag over that with it.
    cost: f64,
}

/// A dead time that the joints agree on.
fn dead_time(view: &View, lags: &[Lag]) -> Option<Finding> {
    let costly = lags.iter().filter(|lag| lag.cost > DEAD_TIME_COSTS).count();
    if lags.len() * 2 < view.dof() || costly * 2 < lags.len() {
        return None;
    }
    let mut lags: Vec<f64> = lags.iter().map(|lag| lag.samples * view.period).collect();
    lags.sort_by(f64::total_cmp);
    let median = lags[lags.len() / 2];
    let agree = lags.iter().filter(|lag| (*lag - median).abs() < 0.3 * median.abs() + view.period).count();
    if median.abs() < DEAD_TIME_S.max(1.5 * view.period) || agree * 3 < lags.len() * 2 {
        return None;
    }
    let text = format!(
        "the torque {} the motion by {:.1} ms (median of {} joints): the signals are not taken at the same time, or one \
         is filtered; shift or filter the other",
        if median > 0.0 { "comes behind" } else { "comes ahead of" },
        1e3 * median.abs(),
        lags.len()
    );
    Some(Finding::new(Kind::DeadTime, Severity::Warning, "tau", text))
}

/// Pairs of joints whose torques fit each other's models much better.
fn swapped(view: &View, fits: &[Option<JointFit>]) -> Vec<Finding> {
    let mut out = Vec::new();
    for a in 0..view.dof() {
        for b in a + 1..view.dof() {
            let (Some(first), Some(second)) = (&fits[a], &fits[b]) else { continue };
            let left = |fit: &JointFit, joint: usize| fit.unexplained(view.tau.channel(joint), 0);
            let (straight, crossed) = ([left(first, a), left(second, b)], [left(first, b), left(second, a)]);
            if straight[1] > 0.3 && crossed[1] < 0.5 * straight[1] && crossed[0] < straight[0].max(0.2) {
                let text = format!(
                    "the torques of {} and {} fit the model of the other joint far better ({:.0} % and {:.0} % unexplained \
                     instead of {:.0} % and {:.0} %): the columns are swapped; put them in order",
                    view.log.joints[a],
                    view.log.joints[b],
                    100.0 * crossed[0],
                    100.0 * crossed[1],
                    100.0 * straight[0],
                    100.0 * straight[1]
                );
                out.push(Finding::new(Kind::Swapped, Severity::Warning, view.place("tau", a), text));
            }
        }
    }
    out
}

/// Columns that one arm explains only in another order.
fn out_of_order(view: &View, best: &Arrangement) -> Vec<Finding> {
    let [before, after] = best.unexplained.map(|share| 100.0 * share);
    let told = |what: &str, quantity: &str, (a, b): (usize, usize)| {
        let (first, second) = (&view.log.joints[a], &view.log.joints[b]);
        let text = format!(
            "the {what} of {first} and {second} are in each other's columns: exchanged, {after:.0} % of the torque stays \
             unexplained instead of {before:.0} %; put the columns in order"
        );
        Finding::new(Kind::Swapped, Severity::Warning, view.place(quantity, a), text)
    };
    let torques = best.torques.iter().map(|&pair| told("torques", "tau", pair));
    torques.chain(best.positions.map(|pair| told("positions", "q", pair))).collect()
}

/// Torque that the URDF's bodies need; None where it does not give possible ones.
fn bodies(robot: &Robot, motion: &Motion) -> Option<Channels> {
    let possible = |joint: &Joint| joint.inertia.mass() > 0.0 && joint.inertia.physical_fault(1e-3).is_none();
    let parameters = robot.inertial_parameters();
    robot.joints.iter().all(possible).then(|| inverse_dynamics(&Chain::new(robot), &parameters, motion))
}

/// Logged torque over that of the bodies, per joint; None where the two are not alike.
fn gains(view: &View, bodies: &Channels, rows: &[usize]) -> Vec<Option<f64>> {
    let of_joint = |joint: usize| {
        let tau: Vec<f64> = rows.iter().map(|&row| view.tau.channel(joint)[row]).collect();
        let own = bodies.channel(joint);
        let like = correlation(own, &tau);
        (like.abs() > ALIKE).then(|| rms(&tau) / rms(own) * like.signum())
    };
    (0..view.dof()).map(of_joint).collect()
}

/// Torque in another unit: a factor of a thousand to what the URDF's bodies need, on most joints.
fn unit(gains: &[Option<f64>]) -> Option<Finding> {
    if gains.iter().flatten().count() < gains.len().min(2) {
        return None;
    }
    let gain = size_quantile(gains.iter().flatten().copied(), 0.5);
    let units = [(1e3, "mN m", "Divide them by 1000"), (1e-3, "kN m", "Multiply them by 1000")];
    let (_, name, mend) = units.into_iter().find(|(factor, ..)| (0.2..5.0).contains(&(gain / factor)))?;
    let text =
        format!("the torques are about {gain:.3e} times what the URDF's bodies need: are they in {name}? {mend}");
    Some(Finding::new(Kind::TorqueUnit, Severity::Warning, "tau", text))
}

/// Condition number of all base columns, each of unit length.
fn condition_number(model: &Model, columns: &[Channels], rows: usize) -> f64 {
    let mut gram = DMatrix::<f64>::zeros(model.base().len(), model.base().len());
    for (joint, table) in columns.iter().enumerate() {
        let active = model.active(joint);
        let own = DMatrix::from_fn(rows, table.channels(), |row, c| table.channel(c)[row]);
        let part = own.transpose() * &own;
        for (i, &a) in active.iter().enumerate() {
            for (j, &b) in active.iter().enumerate() {
                gram[(a, b)] += part[(i, j)];
            }
        }
    }
    let scale: Vec<f64> = gram.diagonal().iter().map(|v| v.sqrt().max(f64::MIN_POSITIVE)).collect();
    let unit = DMatrix::from_fn(scale.len(), scale.len(), |i, j| gram[(i, j)] / (scale[i] * scale[j]));
    let eigenvalues = unit.symmetric_eigen().eigenvalues;
    (eigenvalues.max() / eigenvalues.min().max(f64::MIN_POSITIVE)).sqrt()
}
