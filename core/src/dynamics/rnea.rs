//! Inverse dynamics by the recursive Newton-Euler algorithm (Luh, Walker and Paul 1980), batched over samples.

use super::Motion;
use super::branched;
use super::chain::{Chain, LinkState};
use super::spatial::{Vec3, add};
use super::wrench::wrench;
use crate::channels::Channels;
use crate::lane::{Kernel, Lane, Lanes};
use crate::robot::PARAMETERS;

/// Rigid-body joint torques, `[joint][time]`, of a motion. `inertial` holds ten parameters per moving body, base to flange.
/// Friction and rotor inertia are not included.
///
/// # Panics
/// If the motion or the parameters do not fit the chain.
pub fn inverse_dynamics(chain: &Chain, inertial: &[f64], motion: &Motion) -> Channels {
    inverse_dynamics_in(Lanes::best(), chain, inertial, motion)
}

/// [`inverse_dynamics`] in lanes of one kind.
///
/// # Panics
/// As [`inverse_dynamics`].
pub fn inverse_dynamics_in(lanes: Lanes, chain: &Chain, inertial: &[f64], motion: &Motion) -> Channels {
    let mut torque = Channels::zeros(chain.dof(), motion.samples());
    inverse_dynamics_into(lanes, chain, inertial, motion, &mut torque);
    torque
}

/// [`inverse_dynamics_in`] into a table of the same size as the motion's.
///
/// # Panics
/// As [`inverse_dynamics`]; if the table has another size.
pub fn inverse_dynamics_into(lanes: Lanes, chain: &Chain, inertial: &[f64], motion: &Motion, torque: &mut Channels) {
    let (dof, samples) = (chain.dof(), motion.samples());
    assert_eq!(motion.joints(), dof, "the motion has another number of joints than the arm");
    assert_eq!(inertial.len(), chain.bodies() * PARAMETERS, "ten inertial parameters a link are wanted");
    assert_eq!([torque.channels(), torque.samples()], [dof, samples], "the torque has another size than the motion");
    lanes.for_positions(&motion.q, 0..samples).run(Batch { chain, inertial, motion, torque });
}

struct Batch<'a> {
    chain: &'a Chain,
    inertial: &'a [f64],
    motion: &'a Motion,
    torque: &'a mut Channels,
}

impl Kernel for Batch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let samples = self.motion.samples();
        let torque = self.torque.as_mut_slice();
        let (mut scratch, zero) = (Vec::with_capacity(self.chain.bodies()), L::splat(0.0));
        let (mut states, mut efforts) = (vec![(zero, zero, zero); self.chain.dof()], vec![zero; self.chain.dof()]);
        for sample in (0..samples).step_by(L::WIDTH) {
            let here = sample..samples.min(sample + L::WIDTH);
            for (joint, state) in states.iter_mut().enumerate() {
                *state = self.motion.lanes(joint, here.clone());
            }
            recursion::<L>(self.chain, self.inertial, &states, &mut scratch, &mut efforts);
            for (joint, effort) in efforts.iter().enumerate() {
                effort.store_part(&mut torque[joint * samples + sample..][..here.len()]);
            }
        }
    }
}

/// Rigid-body joint torques at one state.
pub fn inverse_dynamics_at(chain: &Chain, inertial: &[f64], q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
    let mut tau = vec![0.0; chain.dof()];
    let mut scratch = Vec::with_capacity(chain.bodies());
    let states: Vec<(f64, f64, f64)> = (0..chain.dof()).map(|joint| (q[joint], qd[joint], qdd[joint])).collect();
    recursion::<f64>(chain, inertial, &states, &mut scratch, &mut tau);
    tau
}

/// Joint-space mass matrix at `q`, column by column from inverse dynamics at unit accelerations without gravity.
pub fn mass_matrix(chain: &Chain, inertial: &[f64], q: &[f64]) -> nalgebra::DMatrix<f64> {
    let dof = chain.dof();
    let weightless = chain.clone().with_gravity([0.0; 3]);
    let still = vec![0.0; dof];
    let mut matrix = nalgebra::DMatrix::zeros(dof, dof);
    for column in 0..dof {
        let mut unit = vec![0.0; dof];
        unit[column] = 1.0;
        matrix.set_column(column, &inverse_dynamics_at(&weightless, inertial, q, &still, &unit).into());
    }
    matrix
}

/// Forward pass over motion, then wrenches carried back from the flange.
#[inline(always)]
fn recursion<L: Lane>(
    chain: &Chain,
    inertial: &[f64],
    states: &[(L, L, L)],
    scratch: &mut Vec<LinkState<L>>,
    efforts: &mut [L],
) {
    if let Some(tree) = &chain.branches {
        return branched::inverse(chain, tree, inertial, states, scratch, efforts);
    }
    let mut link = chain.base();
    scratch.resize(chain.dof(), link);
    let links = &mut scratch[..chain.dof()];
    for (joint, (place, &(q, qd, qdd))) in links.iter_mut().zip(states).enumerate() {
        link = chain.next(joint, &link, q, qd, qdd);
        *place = link;
    }
    let zero: Vec3<L> = [L::splat(0.0); 3];
    let (mut force, mut moment) = (zero, zero);
    for joint in (0..chain.dof()).rev() {
        let link = &links[joint];
        let (own_force, own_moment) = wrench(&inertial[joint * PARAMETERS..][..PARAMETERS], link);
        force = add(force, own_force);
        moment = add(moment, own_moment);
        efforts[joint] = chain.along(joint, force, moment);
        (force, moment) = chain.carried(joint, link, force, moment);
    }
}
