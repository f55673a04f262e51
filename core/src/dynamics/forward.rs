//! Forward dynamics: joint accelerations under given torques, from the composite-rigid-body mass matrix (Walker and Orin
//! 1982, method 3; Featherstone 2008, chapter 6) and the recursive Newton-Euler bias.

use super::branched;
use super::chain::{Chain, LinkState};
use super::composite::Composite;
use super::spatial::{Vec3, add};
use super::wrench::wrench;
use crate::channels::Channels;
use crate::lane::{Kernel, Lane, Lanes};
use crate::robot::PARAMETERS;

/// Equations of motion M qdd + h = tau at one state, M factored as L D L'.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dynamics::{Chain, EquationsOfMotion};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // A pendulum let go at a quarter turn, its motor off: -m g l / (I + Ia).
/// let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let (q, qd) = ([std::f64::consts::FRAC_PI_2], [0.0]);
/// let equations = EquationsOfMotion::new(&Chain::new(&robot), &robot.inertial_parameters(), &[0.1], &q, &qd);
/// let inertia = 0.17 + 2.0 * 0.5 * 0.5 + 0.1;
/// assert!((equations.accelerations(&[0.0])[0] + 2.0 * 9.81 * 0.5 / inertia).abs() < 1e-9);
/// assert!((equations.response(0)[0] - 1.0 / inertia).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct EquationsOfMotion<L = f64> {
    links: Vec<LinkState<L>>,
    /// Positions, velocities and, at zero, accelerations of the coordinates.
    states: Vec<(L, L, L)>,
    /// L below and D on the diagonal, row by row.
    factor: Vec<L>,
    /// Torque at zero acceleration: velocity terms and gravity.
    bias: Vec<L>,
}

impl EquationsOfMotion {
    /// The equations at position `q` and velocity `qd`. `inertial` holds ten parameters per moving body, base to flange, and
    /// `armature` the reflected rotor inertia of each joint. The bodies need not be possible ones, as base parameters on
    /// the columns that carry them are not; what matters is that M is positive definite: see
    /// [`EquationsOfMotion::smallest_pivot`].
    ///
    /// # Panics
    /// If the parameters or the state do not fit the chain.
    pub fn new(chain: &Chain, inertial: &[f64], armature: &[f64], q: &[f64], qd: &[f64]) -> Self {
        let mut equations = Self::empty(chain);
        equations.update(chain, inertial, armature, q, qd);
        equations
    }

    /// Makes these the equations at another state, or of another arm, in the memory they have.
    ///
    /// # Panics
    /// As [`EquationsOfMotion::new`].
    pub fn update(&mut self, chain: &Chain, inertial: &[f64], armature: &[f64], q: &[f64], qd: &[f64]) {
        check(chain, inertial, armature);
        assert_eq!([q.len(), qd.len()], [chain.dof(); 2], "one value per joint is wanted");
        for (state, (&q, &qd)) in self.states.iter_mut().zip(q.iter().zip(qd)) {
            *state = (q, qd, 0.0);
        }
        self.set(chain, inertial, armature);
    }

    /// Accelerations under the joint torques `tau`.
    pub fn accelerations(&self, tau: &[f64]) -> Vec<f64> {
        let mut net: Vec<f64> = tau.iter().zip(&self.bias).map(|(&torque, &bias)| torque - bias).collect();
        self.solve(&mut net);
        net
    }

    /// Accelerations of all joints per unit torque on `joint`: a column of the inverse mass matrix.
    pub fn response(&self, joint: usize) -> Vec<f64> {
        let mut unit = vec![0.0; self.bias.len()];
        unit[joint] = 1.0;
        self.solve(&mut unit);
        unit
    }

    /// The smallest entry of D: not above zero where M is no mass matrix.
    pub fn smallest_pivot(&self) -> f64 {
        let dof = self.bias.len();
        (0..dof).map(|joint| self.factor[joint * dof + joint]).fold(f64::INFINITY, f64::min)
    }
}

fn check(chain: &Chain, inertial: &[f64], armature: &[f64]) {
    assert_eq!(inertial.len(), chain.bodies() * PARAMETERS, "ten inertial parameters a link are wanted");
    assert_eq!(armature.len(), chain.dof(), "one rotor inertia per joint is wanted");
}

/// Joint accelerations, `[joint][time]`, of many states at once: positions, velocities and joint torques `[q, qd, tau]`,
/// each `[joint][time]`, of an arm with `[inertial, armature]` as in [`EquationsOfMotion::new`].
///
/// # Panics
/// If parameters or tables do not fit the chain.
pub fn forward_dynamics(
    lanes: Lanes,
    chain: &Chain,
    [inertial, armature]: [&[f64]; 2],
    state: [&Channels; 3],
    accelerations: &mut Channels,
) {
    check(chain, inertial, armature);
    let samples = state[0].samples();
    for table in state.into_iter().chain([&*accelerations]) {
        assert_eq!([table.channels(), table.samples()], [chain.dof(), samples], "tables differ in size");
    }
    let lanes = lanes.for_positions(state[0], 0..samples);
    lanes.run(Batch { chain, inertial, armature, state, accelerations });
}

struct Batch<'a> {
    chain: &'a Chain,
    inertial: &'a [f64],
    armature: &'a [f64],
    state: [&'a Channels; 3],
    accelerations: &'a mut Channels,
}

impl Kernel for Batch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let (dof, samples) = (self.chain.dof(), self.state[0].samples());
        let [q, qd, tau] = self.state;
        let mut equations = EquationsOfMotion::<L>::empty(self.chain);
        let mut net = vec![L::splat(0.0); dof];
        for sample in (0..samples).step_by(L::WIDTH) {
            let here = sample..samples.min(sample + L::WIDTH);
            for (joint, state) in equations.states.iter_mut().enumerate() {
                let part = |table: &Channels| L::load_part(&table.channel(joint)[here.clone()]);
                *state = (part(q), part(qd), L::splat(0.0));
            }
            equations.set(self.chain, self.inertial, self.armature);
            for (joint, value) in net.iter_mut().enumerate() {
                *value = L::load_part(&tau.channel(joint)[here.clone()]) - equations.bias[joint];
            }
            equations.solve(&mut net);
            for (joint, value) in net.iter().enumerate() {
                value.store_part(&mut self.accelerations.channel_mut(joint)[here.clone()]);
            }
        }
    }
}

impl<L: Lane> EquationsOfMotion<L> {
    /// The memory for the equations of an arm.
    #[inline(always)]
    fn empty(chain: &Chain) -> Self {
        let (dof, zero) = (chain.dof(), L::splat(0.0));
        EquationsOfMotion {
            links: vec![chain.base(); chain.bodies()],
            states: vec![(zero, zero, zero); dof],
            factor: vec![zero; dof * dof],
            bias: vec![zero; dof],
        }
    }

    /// Makes these the equations at `states`.
    #[inline(always)]
    fn set(&mut self, chain: &Chain, inertial: &[f64], armature: &[f64]) {
        let dof = chain.dof();
        let EquationsOfMotion { links, states, factor, bias } = self;
        if let Some(tree) = &chain.branches {
            branched::equations(chain, tree, [inertial, armature], states, [factor, bias], links);
            return self.factorise();
        }
        let mut link = chain.base();
        for (joint, (place, &(q, qd, _))) in links.iter_mut().zip(&*states).enumerate() {
            link = chain.next(joint, &link, q, qd, L::splat(0.0));
            *place = link;
        }
        let zero: Vec3<L> = [L::splat(0.0); 3];
        let (mut force, mut moment) = (zero, zero);
        let mut composite = Composite::none();
        for joint in (0..dof).rev() {
            let link = &links[joint];
            let body = &inertial[joint * PARAMETERS..][..PARAMETERS];
            let (own_force, own_moment) = wrench(body, link);
            force = add(force, own_force);
            moment = add(moment, own_moment);
            composite.weld(body);
            bias[joint] = chain.along(joint, force, moment);

            // The wrench that gives the joint alone unit acceleration, walked back to the joints before it.
            let (mut f, mut n) = composite.unit_wrench(chain.axis(joint), chain.is_revolute(joint));
            factor[joint * dof + joint] = chain.along(joint, f, n) + L::splat(armature[joint]);
            for before in (0..joint).rev() {
                (f, n) = chain.carried(before + 1, &links[before + 1], f, n);
                factor[joint * dof + before] = chain.along(before, f, n);
            }
            (force, moment) = chain.carried(joint, link, force, moment);
            composite = composite.seen_from_parent(chain.rotation(joint), link);
        }
        self.factorise();
    }

    #[inline(always)]
    fn factorise(&mut self) {
        let n = self.bias.len();
        let factor = &mut self.factor[..n * n];
        for row in 0..n {
            for column in 0..row {
                let mut value = factor[row * n + column];
                for k in 0..column {
                    value = (factor[row * n + k] * factor[column * n + k]).mul_sub_from(factor[k * n + k], value);
                }
                factor[row * n + column] = value / factor[column * n + column];
            }
            let mut pivot = factor[row * n + row];
            for k in 0..row {
                let entry = factor[row * n + k];
                pivot = (entry * entry).mul_sub_from(factor[k * n + k], pivot);
            }
            factor[row * n + row] = pivot;
        }
    }

    #[inline(always)]
    fn solve(&self, x: &mut [L]) {
        let n = self.bias.len();
        let (factor, x) = (&self.factor[..n * n], &mut x[..n]);
        for row in 0..n {
            for k in 0..row {
                x[row] = factor[row * n + k].mul_sub_from(x[k], x[row]);
            }
        }
        for row in 0..n {
            x[row] = x[row] / factor[row * n + row];
        }
        for row in (0..n).rev() {
            for k in row + 1..n {
                x[row] = factor[k * n + row].mul_sub_from(x[k], x[row]);
            }
        }
    }
}
