//! Rigid bodies that move as one.

use super::chain::LinkState;
use super::rotation::Rotation;
use super::spatial::{Mat3, Vec3, add, cross, dot, scale, splat3, times, transposed};
use crate::lane::Lane;

/// All bodies from a link outwards as one: mass, first moment and inertia tensor about the link's origin.
#[derive(Clone, Copy)]
pub(super) struct Composite<L> {
    mass: L,
    first: Vec3<L>,
    tensor: Mat3<L>,
}

impl<L: Lane> Composite<L> {
    /// Nothing.
    #[inline(always)]
    pub(super) fn none() -> Self {
        let zero = L::splat(0.0);
        Composite { mass: zero, first: [zero; 3], tensor: [[zero; 3]; 3] }
    }

    /// Adds bodies given about the same origin.
    #[inline(always)]
    pub(super) fn join(&mut self, other: &Composite<L>) {
        self.mass += other.mass;
        self.first = add(self.first, other.first);
        for (row, extra) in self.tensor.iter_mut().zip(other.tensor) {
            *row = add(*row, extra);
        }
    }

    /// Adds a body given about the same origin.
    #[inline(always)]
    pub(super) fn weld(&mut self, body: &[f64]) {
        self.mass += L::splat(body[0]);
        self.first = add(self.first, splat3(&[body[1], body[2], body[3]]));
        let own: Mat3<L> = [
            splat3(&[body[4], body[5], body[7]]),
            splat3(&[body[5], body[6], body[8]]),
            splat3(&[body[7], body[8], body[9]]),
        ];
        for (row, extra) in self.tensor.iter_mut().zip(own) {
            *row = add(*row, extra);
        }
    }

    /// Force and moment of a unit acceleration about or along `axis`.
    #[inline(always)]
    pub(super) fn unit_wrench(&self, axis: Vec3<L>, revolute: bool) -> (Vec3<L>, Vec3<L>) {
        if revolute {
            (cross(axis, self.first), times(&self.tensor, axis))
        } else {
            (scale(axis, self.mass), cross(self.first, axis))
        }
    }

    /// The same about the origin and in the axes of the link before.
    #[inline(always)]
    pub(super) fn seen_from_parent(&self, rotation: &Rotation, link: &LinkState<L>) -> Self {
        let p = link.translation;
        let [first] = rotation.to_parent(link.turn, [self.first]);
        // R I R', by the symmetry of I.
        let half = transposed(rotation.to_parent(link.turn, self.tensor));
        let turned = rotation.to_parent(link.turn, half);
        let twice = dot(p, first) + dot(p, first) + self.mass * dot(p, p);
        let mut tensor = [[L::splat(0.0); 3]; 3];
        for (i, row) in tensor.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                let shifted = first[i].mul_sub_from(p[j], turned[i][j]);
                let shifted = p[i].mul_sub_from(first[j], shifted);
                *value = (self.mass * p[i]).mul_sub_from(p[j], shifted);
            }
            row[i] += twice;
        }
        Composite { mass: self.mass, first: add(first, scale(p, self.mass)), tensor }
    }
}
