//! Where points on an arm are along a motion.

use super::chain::Chain;
use super::spatial::{Mat3, Vec3, add, splat3, times};
use crate::channels::Channels;
use crate::lane::{Kernel, Lane, Lanes};

/// A point that moves with a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// The link, counted from 0; its frame is that of the joint before it.
    pub link: usize,
    /// Place in the link's frame, m.
    pub place: [f64; 3],
}

/// Coordinates of points in the base frame at positions `q`, `[joint][time]`: x, y and z of one point after the other,
/// `[3 * point + axis][time]`, m. The points are given from the base outwards.
///
/// # Panics
/// If the positions do not fit the chain, a link does not exist, or the points are not in the order of their links.
pub fn coordinates(chain: &Chain, q: &Channels, points: &[Point]) -> Channels {
    coordinates_in(Lanes::best(), chain, q, points)
}

fn coordinates_in(lanes: Lanes, chain: &Chain, q: &Channels, points: &[Point]) -> Channels {
    assert_eq!(q.channels(), chain.dof(), "the motion has another number of joints than the arm");
    assert!(points.is_sorted_by_key(|point| point.link), "points are wanted from the base outwards");
    assert!(points.last().is_none_or(|point| point.link < chain.dof()), "a point is on a link that does not exist");
    let mut out = Channels::zeros(3 * points.len(), q.samples());
    lanes.for_positions(q, 0..q.samples()).run(Placing { chain, q, points, out: &mut out });
    out
}

struct Placing<'a> {
    chain: &'a Chain,
    q: &'a Channels,
    points: &'a [Point],
    out: &'a mut Channels,
}

impl Kernel for Placing<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let samples = self.q.samples();
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut first = 0;
        while first < samples {
            let here = first..samples.min(first + L::WIDTH);
            let mut origin: Vec3<L> = [zero; 3];
            let mut attitude: Mat3<L> = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
            let mut next = 0;
            for link in 0..self.chain.dof() {
                let q = L::load_part(&self.q.channel(link)[here.clone()]);
                let (rotation, translation) = (self.chain.rotation(link), self.chain.translation(link, q));
                origin = add(origin, times(&attitude, translation));
                // Row by row: R R_k = (R_k' R')'.
                attitude = rotation.to_link(rotation.turn(q), attitude);
                while next < self.points.len() && self.points[next].link == link {
                    let place = add(origin, times(&attitude, splat3(&self.points[next].place)));
                    for (axis, value) in place.into_iter().enumerate() {
                        value.store_part(&mut self.out.channel_mut(3 * next + axis)[here.clone()]);
                    }
                    next += 1;
                }
            }
            first = here.end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use crate::robot::{self, InertiaCheck};
    use rand::RngExt;

    #[test]
    fn points_are_where_the_frames_of_the_robot_put_them() {
        for arm in ["urdf/irb1600_6_120.urdf", "tests/reference/skew7.urdf"] {
            let path = format!("{}/{arm}", env!("CARGO_MANIFEST_DIR"));
            let robot = robot::load(path, InertiaCheck::Required).unwrap();
            let (chain, dof) = (Chain::new(&robot), robot.dof());
            let mut source = random::stream(5, "points", 0);
            let mut q = Channels::zeros(dof, 21);
            q.as_mut_slice().fill_with(|| source.random_range(-3.0..3.0));
            let mut points: Vec<Point> = (1..dof).map(|link| Point { link, place: [0.0; 3] }).collect();
            points.push(Point { link: dof - 1, place: robot.flange.translation.into() });
            for lanes in Lanes::available() {
                let made = coordinates_in(lanes, &chain, &q, &points);
                for sample in 0..q.samples() {
                    let frames = robot.frames(&q.at(sample));
                    for (k, frame) in frames[1..].iter().enumerate() {
                        for axis in 0..3 {
                            let own = made.channel(3 * k + axis)[sample];
                            assert!((own - frame.translation[axis]).abs() < 1e-13, "{lanes:?}: {arm}, point {k}");
                        }
                    }
                }
            }
        }
    }
}
