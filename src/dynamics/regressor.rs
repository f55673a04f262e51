//! Torque regressor: tau = Y(q, qd, qdd) phi, with phi ten inertial parameters per link.
//!
//! The screws of all joints are carried forward into each link frame and contracted there with the body's regressor,
//! so no 6x10 block is projected back along the chain. Row i has entries for links k >= i only.

use super::Motion;
use super::chain::{Chain, LinkState};
use super::lane::{Lane, Vec3, add, cross, transpose_times};
use crate::channels::Channels;
use crate::robot::PARAMETERS;

/// Row of [`regressor`]'s result that holds d tau_joint / d phi_(link, parameter).
pub fn block_row(dof: usize, link: usize, parameter: usize, joint: usize) -> usize {
    (link * PARAMETERS + parameter) * dof + joint
}

/// Regressor of a motion as channels `[link][parameter][joint]`, each over time; see [`block_row`].
///
/// # Panics
/// If the motion does not fit the chain.
pub fn regressor(chain: &Chain, motion: &Motion) -> Channels {
    let (dof, samples) = (chain.dof(), motion.samples());
    assert_eq!(motion.joints(), dof, "the motion has another number of joints than the arm");
    let mut out = Channels::zeros(dof * PARAMETERS * dof, samples);
    let data = out.as_mut_slice();
    let mut screws = vec![([0.0; 3], [0.0; 3]); dof];
    for sample in 0..samples {
        let value = |channels: &Channels, joint: usize| channels.channel(joint)[sample];
        entries::<f64>(
            chain,
            |joint| (value(&motion.q, joint), value(&motion.qd, joint), value(&motion.qdd, joint)),
            &mut screws,
            |link, joint, row| {
                for (parameter, &entry) in row.iter().enumerate() {
                    data[block_row(dof, link, parameter, joint) * samples + sample] = entry;
                }
            },
        );
    }
    out
}

/// A joint's unit screw in a link frame: angular part, and velocity of the link origin.
type Screw<L> = (Vec3<L>, Vec3<L>);

/// Walks the chain and hands out, for every link and every joint before it, the ten regressor entries.
#[inline(always)]
fn entries<L: Lane>(
    chain: &Chain,
    state: impl Fn(usize) -> (L, L, L),
    screws: &mut [Screw<L>],
    mut write: impl FnMut(usize, usize, &[L; PARAMETERS]),
) {
    let zero: Vec3<L> = [L::splat(0.0); 3];
    let mut link = chain.base();
    for k in 0..chain.dof() {
        let (q, qd, qdd) = state(k);
        link = chain.next(k, &link, q, qd, qdd);
        for (angular, linear) in screws[..k].iter_mut() {
            let moved = add(*linear, cross(*angular, link.translation));
            *linear = transpose_times(&link.rotation, moved);
            *angular = transpose_times(&link.rotation, *angular);
        }
        screws[k] = if chain.is_revolute(k) { (chain.axis(k), zero) } else { (zero, chain.axis(k)) };
        let gradient = first_moment_gradient(&link);
        for (joint, screw) in screws[..=k].iter().enumerate() {
            write(k, joint, &contract(&link, &gradient, screw));
        }
    }
}

/// Force per unit first moment: [alpha]x + [omega]x [omega]x.
#[inline(always)]
fn first_moment_gradient<L: Lane>(link: &LinkState<L>) -> [Vec3<L>; 3] {
    let ([wx, wy, wz], [ax, ay, az]) = (link.omega, link.alpha);
    let (xx, yy, zz) = (wx * wx, wy * wy, wz * wz);
    let (xy, xz, yz) = (wx * wy, wx * wz, wy * wz);
    [[-(yy + zz), xy - az, xz + ay], [xy + az, -(xx + zz), yz - ax], [xz - ay, yz + ax, -(xx + yy)]]
}

/// Power of the body's wrench per unit parameter along one screw: w . f + u . n.
#[inline(always)]
fn contract<L: Lane>(link: &LinkState<L>, gradient: &[Vec3<L>; 3], (u, w): &Screw<L>) -> [L; PARAMETERS] {
    let (a, omega, alpha) = (link.acceleration, link.omega, link.alpha);
    let mass = w[0] * a[0] + w[1] * a[1] + w[2] * a[2];
    let first = add(transpose_times(gradient, *w), cross(a, *u));
    // u . (omega x I omega) = (u x omega) . I omega
    let z = cross(*u, omega);
    let moment = |i: usize| u[i] * alpha[i] + z[i] * omega[i];
    let product = |i: usize, j: usize| u[i] * alpha[j] + u[j] * alpha[i] + z[i] * omega[j] + z[j] * omega[i];
    [mass, first[0], first[1], first[2], moment(0), product(0, 1), moment(1), product(0, 2), product(1, 2), moment(2)]
}
