//! The recursions on a tree whose joints may follow coordinates: q = A x + b, torque = A' tau, regressor Y A.

use super::Motion;
use super::chain::{Branches, Chain, LinkState};
use super::composite::Composite;
use super::spatial::{Vec3, add, add_cross};
use super::wrench::wrench;
use crate::lane::Lane;
use crate::robot::PARAMETERS;
use std::ops::Range;

/// A unit screw in a link frame: angular part, and velocity of the link origin.
pub(super) type Screw<L> = (Vec3<L>, Vec3<L>);

/// Makes `links` the states of all bodies, in their order, for coordinates with the given positions, velocities and
/// accelerations.
#[inline(always)]
fn forward<L: Lane>(chain: &Chain, tree: &Branches, states: &[(L, L, L)], links: &mut Vec<LinkState<L>>) {
    let base = chain.base();
    links.resize(chain.bodies(), base);
    for &body in &tree.order {
        let coupling = &tree.couplings[body];
        let (x, xd, xdd) = states[coupling.coordinate];
        let carrier = tree.parents[body].map_or(base, |parent| links[parent]);
        let (q, qd, qdd) = (coupling.position(x), coupling.rate(xd), coupling.rate(xdd));
        links[body] = chain.next(body, &carrier, q, qd, qdd);
    }
}

/// Inverse dynamics by the recursive Newton-Euler algorithm (Featherstone 2008, chapter 5).
#[inline(always)]
pub(super) fn inverse<L: Lane>(
    chain: &Chain,
    tree: &Branches,
    inertial: &[f64],
    states: &[(L, L, L)],
    links: &mut Vec<LinkState<L>>,
    efforts: &mut [L],
) {
    forward(chain, tree, states, links);
    let zero = [L::splat(0.0); 3];
    let mut wrenches: Vec<Screw<L>> = vec![(zero, zero); chain.bodies()];
    efforts.fill(L::splat(0.0));
    for &body in tree.order.iter().rev() {
        let link = &links[body];
        let (own_force, own_moment) = wrench(&inertial[body * PARAMETERS..][..PARAMETERS], link);
        let (force, moment) = (add(wrenches[body].0, own_force), add(wrenches[body].1, own_moment));
        let coupling = &tree.couplings[body];
        efforts[coupling.coordinate] += coupling.torque(chain.along(body, force, moment));
        if let Some(parent) = tree.parents[body] {
            let (force, moment) = chain.carried(body, link, force, moment);
            wrenches[parent] = (add(wrenches[parent].0, force), add(wrenches[parent].1, moment));
        }
    }
}

/// Mass matrix A' M A with rotors, its lower half row by row, and the torque of `states`, whose accelerations are zero, by composite rigid
/// bodies (Featherstone 2008, chapter 6).
#[inline(always)]
pub(super) fn equations<L: Lane>(
    chain: &Chain,
    tree: &Branches,
    [inertial, armature]: [&[f64]; 2],
    states: &[(L, L, L)],
    [matrix, bias]: [&mut Vec<L>; 2],
    links: &mut Vec<LinkState<L>>,
) {
    inverse(chain, tree, inertial, states, links, bias);
    let dof = tree.coordinates;
    matrix.fill(L::splat(0.0));
    for (coordinate, &rotor) in armature.iter().enumerate() {
        matrix[coordinate * dof + coordinate] = L::splat(rotor);
    }
    let mut composites = vec![Composite::none(); chain.bodies()];
    for &body in tree.order.iter().rev() {
        composites[body].weld(&inertial[body * PARAMETERS..][..PARAMETERS]);
        if let Some(parent) = tree.parents[body] {
            let moved = composites[body].seen_from_parent(chain.rotation(body), &links[body]);
            composites[parent].join(&moved);
        }
        // The wrench that gives the joint alone unit acceleration, walked back to the joints before it.
        let own = &tree.couplings[body];
        let (mut force, mut moment) = composites[body].unit_wrench(chain.axis(body), chain.is_revolute(body));
        let mut at = body;
        loop {
            let other = &tree.couplings[at];
            let entry = other.torque(own.torque(chain.along(at, force, moment)));
            let (row, column) = (own.coordinate.max(other.coordinate), own.coordinate.min(other.coordinate));
            matrix[row * dof + column] += entry;
            if at != body && row == column {
                // Both of the pair of symmetric entries of M fall on the diagonal of A' M A.
                matrix[row * dof + column] += entry;
            }
            let Some(parent) = tree.parents[at] else { break };
            (force, moment) = chain.carried(at, &links[at], force, moment);
            at = parent;
        }
    }
}

/// Gives `visit` the screw of every coordinate in the frame of every body that it moves, with the sample, the body's state,
/// the body and the coordinate; samples lane by lane. The screw of a coordinate is the sum of those of its joints.
#[inline(always)]
pub(super) fn screws<L: Lane>(
    chain: &Chain,
    tree: &Branches,
    motion: &Motion,
    samples: Range<usize>,
    mut visit: impl FnMut(usize, &LinkState<L>, usize, usize, &Screw<L>),
) {
    let dof = tree.coordinates;
    let zero = [L::splat(0.0); 3];
    let mut screws: Vec<Screw<L>> = vec![(zero, zero); chain.bodies() * dof];
    let mut links = Vec::with_capacity(chain.bodies());
    let mut states = vec![(zero[0], zero[0], zero[0]); dof];
    for sample in samples.clone().step_by(L::WIDTH) {
        let here = sample..samples.end.min(sample + L::WIDTH);
        for (coordinate, state) in states.iter_mut().enumerate() {
            *state = motion.lanes(coordinate, here.clone());
        }
        forward(chain, tree, &states, &mut links);
        for &body in &tree.order {
            let (link, coupling) = (&links[body], &tree.couplings[body]);
            for coordinate in (0..dof).filter(|&coordinate| chain.moves(coordinate, body)) {
                let mut screw = (zero, zero);
                if let Some(parent) = tree.parents[body].filter(|&parent| chain.moves(coordinate, parent)) {
                    let (angular, linear) = screws[parent * dof + coordinate];
                    let moved = add_cross(linear, angular, link.translation);
                    let [angular, linear] = chain.rotation(body).to_link(link.turn, [angular, moved]);
                    screw = (angular, linear);
                }
                if coupling.coordinate == coordinate {
                    let axis = chain.axis(body).map(|part| coupling.rate(part));
                    let part = if chain.is_revolute(body) { &mut screw.0 } else { &mut screw.1 };
                    *part = add(*part, axis);
                }
                visit(sample, link, body, coordinate, &screw);
                screws[body * dof + coordinate] = screw;
            }
        }
    }
}
