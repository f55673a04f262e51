//! Forward dynamics: joint accelerations under given torques, from the composite-rigid-body mass matrix (Walker and Orin
//! 1982, method 3; Featherstone 2008, chapter 6) and the recursive Newton-Euler bias.

use super::chain::{Chain, LinkState};
use super::rnea::wrench;
use super::spatial::{Mat3, Vec3, add, cross, dot, scale, times};
use crate::lane::Lane;
use crate::robot::PARAMETERS;

/// Equations of motion M qdd + h = tau at one state, M factored as L D L'.
#[derive(Debug, Clone)]
pub struct EquationsOfMotion<L> {
    dof: usize,
    /// L below and D on the diagonal, row by row.
    factor: Vec<L>,
    /// Torque at zero acceleration: velocity terms and gravity.
    bias: Vec<L>,
}

impl<L: Lane> EquationsOfMotion<L> {
    /// The equations at position `q` and velocity `qd`. `inertial` holds ten parameters per link, base to flange, and
    /// `armature` the reflected rotor inertia of each joint. The bodies need not be possible ones, as base parameters on
    /// the columns that carry them are not; what matters is that M is positive definite: see
    /// [`EquationsOfMotion::smallest_pivot`].
    ///
    /// # Panics
    /// If the parameters or the state do not fit the chain.
    pub fn new(chain: &Chain, inertial: &[f64], armature: &[f64], q: &[L], qd: &[L]) -> Self {
        let dof = chain.dof();
        assert_eq!(inertial.len(), dof * PARAMETERS, "ten inertial parameters a link are wanted");
        assert_eq!([armature.len(), q.len(), qd.len()], [dof; 3], "one value per joint is wanted");
        let mut links: Vec<LinkState<L>> = Vec::with_capacity(dof);
        let base = chain.base();
        for joint in 0..dof {
            let link = chain.next(joint, links.last().unwrap_or(&base), q[joint], qd[joint], L::splat(0.0));
            links.push(link);
        }
        let zero: Vec3<L> = [L::splat(0.0); 3];
        let (mut force, mut moment) = (zero, zero);
        let mut composite = Composite { mass: L::splat(0.0), first: zero, tensor: [zero; 3] };
        let mut bias = vec![L::splat(0.0); dof];
        let mut factor = vec![L::splat(0.0); dof * dof];
        for joint in (0..dof).rev() {
            let link = &links[joint];
            let body = &inertial[joint * PARAMETERS..][..PARAMETERS];
            let (own_force, own_moment) = wrench(body, link);
            force = add(force, own_force);
            moment = add(moment, own_moment);
            composite.weld(body);
            let axis = chain.axis(joint);
            let along = |revolute: bool, axis, f, n| dot(axis, if revolute { n } else { f });
            bias[joint] = along(chain.is_revolute(joint), axis, force, moment);

            // The wrench that gives the joint alone unit acceleration, walked back to the joints before it.
            let (mut f, mut n) = composite.unit_wrench(axis, chain.is_revolute(joint));
            factor[joint * dof + joint] = along(chain.is_revolute(joint), axis, f, n) + L::splat(armature[joint]);
            for before in (0..joint).rev() {
                (f, n) = carried(&links[before + 1], f, n);
                factor[joint * dof + before] = along(chain.is_revolute(before), chain.axis(before), f, n);
            }
            (force, moment) = carried(link, force, moment);
            composite = composite.seen_from_parent(link);
        }
        let mut equations = EquationsOfMotion { dof, factor, bias };
        equations.factorise();
        equations
    }

    fn factorise(&mut self) {
        let n = self.dof;
        for row in 0..n {
            for column in 0..row {
                let mut value = self.factor[row * n + column];
                for k in 0..column {
                    value = value - self.factor[row * n + k] * self.factor[column * n + k] * self.factor[k * n + k];
                }
                self.factor[row * n + column] = value / self.factor[column * n + column];
            }
            let mut pivot = self.factor[row * n + row];
            for k in 0..row {
                let entry = self.factor[row * n + k];
                pivot = pivot - entry * entry * self.factor[k * n + k];
            }
            self.factor[row * n + row] = pivot;
        }
    }

    /// Accelerations under the joint torques `tau`.
    pub fn accelerations(&self, tau: &[L]) -> Vec<L> {
        let net: Vec<L> = tau.iter().zip(&self.bias).map(|(&torque, &bias)| torque - bias).collect();
        self.solve(net)
    }

    /// Accelerations of all joints per unit torque on `joint`: a column of the inverse mass matrix.
    pub fn response(&self, joint: usize) -> Vec<L> {
        let mut unit = vec![L::splat(0.0); self.dof];
        unit[joint] = L::splat(1.0);
        self.solve(unit)
    }

    fn solve(&self, mut x: Vec<L>) -> Vec<L> {
        let n = self.dof;
        for row in 0..n {
            for k in 0..row {
                x[row] = x[row] - self.factor[row * n + k] * x[k];
            }
        }
        for (row, value) in x.iter_mut().enumerate() {
            *value = *value / self.factor[row * n + row];
        }
        for row in (0..n).rev() {
            for k in row + 1..n {
                x[row] = x[row] - self.factor[k * n + row] * x[k];
            }
        }
        x
    }
}

impl EquationsOfMotion<f64> {
    /// The smallest entry of D: not above zero where M is no mass matrix.
    pub fn smallest_pivot(&self) -> f64 {
        (0..self.dof).map(|joint| self.factor[joint * self.dof + joint]).fold(f64::INFINITY, f64::min)
    }
}

/// A wrench about a link's origin as the link before it sees it.
#[inline(always)]
fn carried<L: Lane>(link: &LinkState<L>, force: Vec3<L>, moment: Vec3<L>) -> (Vec3<L>, Vec3<L>) {
    let turned = times(&link.rotation, force);
    (turned, add(times(&link.rotation, moment), cross(link.translation, turned)))
}

/// All bodies from a link outwards as one: mass, first moment and inertia tensor about the link's origin.
struct Composite<L> {
    mass: L,
    first: Vec3<L>,
    tensor: Mat3<L>,
}

impl<L: Lane> Composite<L> {
    /// Adds a body given about the same origin.
    fn weld(&mut self, body: &[f64]) {
        let p = |index: usize| L::splat(body[index]);
        self.mass += p(0);
        self.first = add(self.first, [p(1), p(2), p(3)]);
        let own = [[p(4), p(5), p(7)], [p(5), p(6), p(8)], [p(7), p(8), p(9)]];
        for (row, extra) in self.tensor.iter_mut().zip(own) {
            *row = add(*row, extra);
        }
    }

    /// Force and moment of a unit acceleration about or along `axis`.
    fn unit_wrench(&self, axis: Vec3<L>, revolute: bool) -> (Vec3<L>, Vec3<L>) {
        if revolute {
            (cross(axis, self.first), times(&self.tensor, axis))
        } else {
            (scale(axis, self.mass), cross(self.first, axis))
        }
    }

    /// The same about the origin and in the axes of the link before.
    fn seen_from_parent(&self, link: &LinkState<L>) -> Self {
        let (r, p) = (&link.rotation, link.translation);
        let first = times(r, self.first);
        // R I R', by the symmetry of I: rows of R I first, then their products with the rows of R.
        let half = [times(&self.tensor, r[0]), times(&self.tensor, r[1]), times(&self.tensor, r[2])];
        let twice = dot(p, first) + dot(p, first) + self.mass * dot(p, p);
        let mut tensor = [[L::splat(0.0); 3]; 3];
        for (i, row) in tensor.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value = dot(half[i], r[j]) - first[i] * p[j] - p[i] * first[j] - self.mass * p[i] * p[j];
            }
            row[i] += twice;
        }
        Composite { mass: self.mass, first: add(first, scale(p, self.mass)), tensor }
    }
}
