//! Where points on an arm are along a motion.

use super::chain::Chain;
use super::spatial::{Mat3, Vec3, add, splat3, times};
use crate::channels::Channels;
use crate::lane::{Kernel, Lane, Lanes};

/// A point that moves with a link.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::channels::Channels;
/// use tauscope::dynamics::{Chain, Point, coordinates};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // The end of a rod of 1 m: below the pivot at zero, to its side after a quarter turn.
/// let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let q = Channels::from_vectors(&[vec![0.0, std::f64::consts::FRAC_PI_2]]);
/// let end = coordinates(&Chain::new(&robot), &q, &[Point { link: 0, place: [0.0, 0.0, -1.0] }]);
/// assert!((end.channel(2)[0] + 1.0).abs() < 1e-12);
/// assert!((end.channel(0)[1].abs() - 1.0).abs() < 1e-12);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// The body, counted from 0 in the order of [`crate::robot::Robot::body`]; its frame is that of the joint that carries it.
    pub link: usize,
    /// Place in the link's frame, m.
    pub place: [f64; 3],
}

/// Coordinates of points in the base frame at positions `q`, `[joint][time]`: x, y and z of one point after the other,
/// `[3 * point + axis][time]`, m.
///
/// # Panics
/// If the positions do not fit the chain or a body does not exist.
pub fn coordinates(chain: &Chain, q: &Channels, points: &[Point]) -> Channels {
    coordinates_in(Lanes::best(), chain, q, points)
}

fn coordinates_in(lanes: Lanes, chain: &Chain, q: &Channels, points: &[Point]) -> Channels {
    assert_eq!(q.channels(), chain.dof(), "the motion has another number of joints than the arm");
    assert!(points.iter().all(|point| point.link < chain.bodies()), "a point is on a body that does not exist");
    let mut out = Channels::zeros(3 * points.len(), q.samples());
    lanes.for_positions(q, 0..q.samples()).run(Placing { chain, q, points, out: &mut out });
    out
}

/// Origin and attitude of a link.
type Frame<L> = (Vec3<L>, Mat3<L>);

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
        let mut frames: Vec<Frame<L>> = Vec::with_capacity(self.chain.bodies());
        let mut first = 0;
        while first < samples {
            let here = first..samples.min(first + L::WIDTH);
            let base: Frame<L> = ([zero; 3], [[one, zero, zero], [zero, one, zero], [zero, zero, one]]);
            frames.resize(self.chain.bodies(), base);
            for place in 0..self.chain.bodies() {
                let link = self.chain.branches.as_ref().map_or(place, |tree| tree.order[place]);
                let (parent, coupling) = self.chain.hangs(link);
                let x = L::load_part(&self.q.channel(coupling.coordinate)[here.clone()]);
                let q = coupling.position(x);
                let (origin, attitude) = parent.map_or(base, |parent| frames[parent]);
                let (rotation, translation) = (self.chain.rotation(link), self.chain.translation(link, q));
                // Row by row: R R_k = (R_k' R')'.
                frames[link] =
                    (add(origin, times(&attitude, translation)), rotation.to_link(rotation.turn(q), attitude));
            }
            for (index, point) in self.points.iter().enumerate() {
                let (origin, attitude) = &frames[point.link];
                let place = add(*origin, times(attitude, splat3(&point.place)));
                for (axis, value) in place.into_iter().enumerate() {
                    value.store_part(&mut self.out.channel_mut(3 * index + axis)[here.clone()]);
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
            let path = format!("{}/../{arm}", env!("CARGO_MANIFEST_DIR"));
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
