//! Force and moment that a moving body takes: Newton's and Euler's equations.

use super::chain::LinkState;
use super::spatial::{Vec3, add, cross, scale, times};
use crate::lane::Lane;

/// Force and moment about the link origin that move the link's body as `link` says.
#[inline(always)]
pub(super) fn wrench<L: Lane>(body: &[f64], link: &LinkState<L>) -> (Vec3<L>, Vec3<L>) {
    let p = |index: usize| L::splat(body[index]);
    let first = [p(1), p(2), p(3)];
    let inertia = [[p(4), p(5), p(7)], [p(5), p(6), p(8)], [p(7), p(8), p(9)]];
    let swing = add(cross(link.alpha, first), cross(link.omega, cross(link.omega, first)));
    let force = add(scale(link.acceleration, p(0)), swing);
    let spin = add(times(&inertia, link.alpha), cross(link.omega, times(&inertia, link.omega)));
    (force, add(spin, cross(first, link.acceleration)))
}
