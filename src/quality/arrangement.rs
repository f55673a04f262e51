//! The order and the signs of columns under which one arm explains them all.
//!
//! Every link loads the joints before it too, so base parameters fitted to all joints at once contradict each other where
//! columns are swapped or turned round. Of the robot description only the geometry is used; that friction takes power
//! tells the sign that all joints share.

use super::BAND;
use crate::channels::Channels;
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::identification::model::Model;
use nalgebra::{DMatrix, DVector};

/// A change of order or sign counts when it leaves less than this share of the sum of squares.
const BETTER: f64 = 0.5;

/// All changes together must leave less than this share.
const CONVINCING: f64 = 0.3;

/// Positions are tried in other orders only where the model leaves more than this, in squares of what a joint's own model
/// leaves of its torque.
const POOR: f64 = 4.0;

/// Shorter logs do not tell friction from what else has a sign, s.
const LONG_ENOUGH_S: f64 = 8.0;

/// Standard deviations by which the power of friction must be negative.
const SURELY: f64 = 10.0;

/// Samples on which other orders of the positions are tried.
const FEW_ROWS: usize = 800;

/// Share of the torque that friction must be, in power over sizes, to tell the sign of a joint, and the mean share to tell
/// that of all.
const TELLS_OWN: f64 = 0.1;
const TELLS_ALL: f64 = 0.03;

/// Mean correlation with the torque of the bodies as described from which the sign that all share is right.
const ALIKE: f64 = 0.3;

/// Rows per base parameter below which nothing is said.
const ROWS_PER_PARAMETER: usize = 4;

/// What explains the columns best.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Arrangement {
    /// Joints whose torques are in each other's columns.
    pub torques: Vec<(usize, usize)>,
    /// Joints whose positions are in each other's columns.
    pub positions: Option<(usize, usize)>,
    /// Joints whose torques have the wrong sign.
    pub flipped: Vec<usize>,
    /// Unexplained part of the torque, root mean square over root mean square, as logged and arranged.
    pub unexplained: [f64; 2],
}

/// The best arrangement of a log of so many seconds; None where there are too few rows or nothing is better than the columns as they are.
pub fn arrangement(model: &Model, motion: &Motion, tau: &Channels, duration_s: f64) -> Option<Arrangement> {
    let tables = Tables::new(model, motion, tau)?;
    let dof = model.dof();
    let start = Order { torques: (0..dof).collect(), signs: vec![1.0; dof] };
    let before = tables.left(&start)?;
    let (mut order, mut after) = (start.clone(), before);
    for _ in 0..2 * dof {
        let best = order.changes().filter_map(|changed| Some((tables.left(&changed)?, changed)));
        let best = best.min_by(|(a, _), (b, _)| a.total_cmp(b)).filter(|(left, _)| *left < BETTER * after);
        let Some((left, changed)) = best else { break };
        (order, after) = (changed, left);
    }
    let convincing = after < CONVINCING * before;
    if !convincing {
        (order, after) = (start, before);
    }
    let positions =
        if !convincing && before > POOR * tables.used as f64 { swapped_positions(model, motion, tau) } else { None };
    if positions.is_none() && duration_s >= LONG_ENOUGH_S {
        let power = tables.friction_power(&order)?;
        let all = power.iter().sum::<f64>() / (dof as f64) < -TELLS_ALL && !is_as_described(model, motion, tau);
        for (sign, own) in order.signs.iter_mut().zip(power) {
            *sign *= if all || own < -TELLS_OWN { -1.0 } else { 1.0 };
        }
    }
    let flipped: Vec<usize> =
        if positions.is_some() { Vec::new() } else { (0..dof).filter(|&j| order.signs[j] < 0.0).collect() };
    let torques: Vec<(usize, usize)> =
        (0..dof).filter(|&j| order.torques[j] > j).map(|j| (j, order.torques[j])).collect();
    let share = |left: f64| (left / tables.total()).max(0.0).sqrt();
    let found = !torques.is_empty() || positions.is_some() || !flipped.is_empty();
    let after = positions.map_or(after, |(_, left)| left * tables.total());
    found.then(|| Arrangement {
        torques,
        positions: positions.map(|(pair, _)| pair),
        flipped,
        unexplained: [share(before), share(after)],
    })
}

/// Whether the torque is much like that of the bodies as described: then its sign is right, whatever friction seems to do.
fn is_as_described(model: &Model, motion: &Motion, tau: &Channels) -> bool {
    let robot = model.robot();
    let described = inverse_dynamics(&Chain::new(robot), &robot.inertial_parameters(), motion);
    let alike = (0..model.dof()).map(|joint| {
        let (a, b) = (tau.channel(joint), described.channel(joint));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let sizes = (dot(a, a) * dot(b, b)).sqrt();
        if sizes > 0.0 { dot(a, b) / sizes } else { 0.0 }
    });
    alike.sum::<f64>() / model.dof() as f64 > ALIKE
}

/// The pair of positions whose exchange explains the torques, with or without that of their torques, and the share of the
/// sum of squares that is left.
fn swapped_positions(model: &Model, motion: &Motion, tau: &Channels) -> Option<((usize, usize), f64)> {
    let step = motion.samples().div_ceil(FEW_ROWS).max(1);
    let thin = |signals: &Channels| signals.map(|_, signal| signal.iter().copied().step_by(step).collect());
    let (motion, tau) = (Motion { q: thin(&motion.q), qd: thin(&motion.qd), qdd: thin(&motion.qdd) }, thin(tau));
    let dof = model.dof();
    let straight = Order { torques: (0..dof).collect(), signs: vec![1.0; dof] };
    let before = Tables::new(model, &motion, &tau)?;
    let before = before.left(&straight)? / before.total();
    let pairs = (0..dof).flat_map(|a| (a + 1..dof).map(move |b| (a, b)));
    let tried = pairs.filter_map(|(a, b)| {
        let place = |joint: usize| {
            if joint == a {
                b
            } else if joint == b {
                a
            } else {
                joint
            }
        };
        let swap = |signals: &Channels| signals.map(|joint, _| signals.channel(place(joint)).to_vec());
        let other = Motion { q: swap(&motion.q), qd: swap(&motion.qd), qdd: swap(&motion.qdd) };
        let tables = Tables::new(model, &other, &tau)?;
        let mut crossed = straight.clone();
        crossed.torques.swap(a, b);
        Some((tables.left(&straight)?.min(tables.left(&crossed)?) / tables.total(), (a, b)))
    });
    let (left, pair) = tried.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    (left < CONVINCING * before).then_some((pair, left))
}

/// Which torque each joint is given, and with which sign.
#[derive(Debug, Clone)]
struct Order {
    torques: Vec<usize>,
    signs: Vec<f64>,
}

impl Order {
    /// Every single exchange and change of sign.
    fn changes(&self) -> impl Iterator<Item = Order> + '_ {
        let dof = self.torques.len();
        let swaps = (0..dof).flat_map(move |a| (a + 1..dof).map(move |b| (a, b))).map(|(a, b)| {
            let mut changed = self.clone();
            changed.torques.swap(a, b);
            changed
        });
        // Turning one joint of two round is turning the other round, up to the sign of all.
        let flips = (0..if dof > 2 { dof } else { 0 }).map(|joint| {
            let mut changed = self.clone();
            changed.signs[joint] = -changed.signs[joint];
            changed
        });
        swaps.chain(flips)
    }
}

/// Inner products of the base columns of every joint with each other and with all torques, over the samples at which the
/// joint's direction is certain.
struct Tables {
    gram: Vec<DMatrix<f64>>,
    right: Vec<Vec<DVector<f64>>>,
    squares: Vec<Vec<f64>>,
    /// One over the mean square of what the joint's own model that suits it best leaves of every torque.
    weights: Vec<f64>,
    /// Viscous and Coulomb friction among the base parameters of every joint, with the sums of squares of the velocity and of
    /// its size.
    friction: Vec<Vec<(usize, f64)>>,
    scale: Vec<f64>,
    /// Samples of all joints.
    used: usize,
}

impl Tables {
    fn new(model: &Model, motion: &Motion, tau: &Channels) -> Option<Tables> {
        let (dof, base) = (model.dof(), model.base().len());
        let columns = model.columns(motion, 0.0);
        let mut tables = Tables {
            gram: Vec::new(),
            right: Vec::new(),
            squares: Vec::new(),
            weights: Vec::new(),
            friction: Vec::new(),
            scale: Vec::new(),
            used: 0,
        };
        let mut own_left = vec![f64::INFINITY; dof];
        for (joint, table) in columns.iter().enumerate() {
            let velocity = motion.qd.channel(joint);
            let kept: Vec<usize> = (0..velocity.len()).filter(|&row| velocity[row].abs() > BAND).collect();
            tables.used += kept.len();
            let active = model.active(joint);
            let own = DMatrix::from_fn(kept.len(), active.len(), |row, c| table.channel(c)[kept[row]]);
            let part = own.tr_mul(&own);
            let mut gram = DMatrix::zeros(base, base);
            for (i, &a) in active.iter().enumerate() {
                for (j, &b) in active.iter().enumerate() {
                    gram[(a, b)] = part[(i, j)];
                }
            }
            tables.gram.push(gram);
            let torques: Vec<DVector<f64>> = (0..dof)
                .map(|k| DVector::from_iterator(kept.len(), kept.iter().map(|&row| tau.channel(k)[row])))
                .collect();
            let rows = kept.len().saturating_sub(active.len()).max(1) as f64;
            for (torque, least) in torques.iter().zip(&mut own_left) {
                let right = own.tr_mul(torque);
                let left = torque.norm_squared() - fitted(&part, &right)?.dot(&right);
                *least = least.min(left.max(1e-12 * torque.norm_squared()) / rows);
            }
            let spread = |torque: &DVector<f64>| {
                let part = own.tr_mul(torque);
                let mut right = DVector::zeros(base);
                active.iter().zip(part.iter()).for_each(|(&b, &value)| right[b] = value);
                right
            };
            tables.right.push(torques.iter().map(spread).collect());
            tables.squares.push(torques.iter().map(|torque| torque.norm_squared()).collect());
            let sum = |f: fn(f64) -> f64| kept.iter().map(|&row| f(velocity[row])).sum::<f64>();
            let power = |b: usize| match model.drive_of(b)? {
                (own, 1) if own == joint => Some((b, sum(|v| v * v))),
                (own, 2) if own == joint => Some((b, sum(f64::abs))),
                _ => None,
            };
            tables.friction.push((0..base).filter_map(power).collect());
            tables.scale.push(sum(|v| v * v).sqrt() * torques[joint].norm());
        }
        tables.weights = own_left.into_iter().map(|left| 1.0 / left).collect();
        let usable = tables.used > ROWS_PER_PARAMETER * base && tables.weights.iter().all(|w| w.is_finite());
        usable.then_some(tables)
    }

    /// Weighted sum of squares of all torques.
    fn total(&self) -> f64 {
        (0..self.gram.len()).map(|joint| self.weights[joint] * self.squares[joint][joint]).sum()
    }

    /// Parameters that fit an order best, with the right side they belong to.
    fn solve(&self, order: &Order) -> Option<(DVector<f64>, DVector<f64>)> {
        let mut right = DVector::zeros(self.gram.first()?.nrows());
        for (joint, &torque) in order.torques.iter().enumerate() {
            right += self.weights[torque] * order.signs[joint] * &self.right[joint][torque];
        }
        Some((fitted(&self.gram(order), &right)?, right))
    }

    /// Weighted normal matrix of an order.
    fn gram(&self, order: &Order) -> DMatrix<f64> {
        let weighted = order.torques.iter().zip(&self.gram).map(|(&torque, gram)| self.weights[torque] * gram);
        weighted.reduce(|sum, gram| sum + gram).unwrap_or_default()
    }

    /// Weighted sum of squares that the best parameters leave.
    fn left(&self, order: &Order) -> Option<f64> {
        let (solution, right) = self.solve(order)?;
        let torques = order.torques.iter().enumerate();
        let all: f64 = torques.map(|(joint, &torque)| self.weights[torque] * self.squares[joint][torque]).sum();
        Some((all - solution.dot(&right)).max(0.0))
    }

    /// Power that friction takes over the sizes of torque and velocity, of each joint; zero where it is not certain.
    fn friction_power(&self, order: &Order) -> Option<Vec<f64>> {
        let (solution, _) = self.solve(order)?;
        let gram = self.gram(order);
        let each = self.friction.iter().zip(&self.scale).map(|(friction, scale)| {
            let mut along = DVector::zeros(solution.len());
            friction.iter().for_each(|&(b, sum)| along[b] = sum / scale.max(f64::MIN_POSITIVE));
            let (power, variance) = (along.dot(&solution), fitted(&gram, &along)?.dot(&along));
            Some(if power.abs() > SURELY * variance.max(0.0).sqrt() { power } else { 0.0 })
        });
        each.collect()
    }
}

/// Solves normal equations, held in place where they are singular.
fn fitted(gram: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let scale = gram.diagonal().map(|v: f64| if v > 0.0 { v.sqrt() } else { 1.0 });
    let unit = DMatrix::from_fn(gram.nrows(), gram.ncols(), |r, c| {
        gram[(r, c)] / (scale[r] * scale[c]) + if r == c { 1e-10 } else { 0.0 }
    });
    Some(unit.cholesky()?.solve(&right.component_div(&scale)).component_div(&scale))
}
