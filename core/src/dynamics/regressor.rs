//! Torque regressor: tau = Y(q, qd, qdd) phi, with phi ten inertial parameters per link.
//!
//! The screws of all joints are carried forward into each link frame and contracted there with the body's regressor,
//! so no 6x10 block is projected back along the chain. Row i has entries for links k >= i only; on a tree for the bodies that
//! coordinate i moves.

use super::Motion;
use super::branched::{self, Screw};
use super::chain::{Chain, LinkState};
use super::spatial::{Vec3, add_cross, dot};
use crate::channels::Channels;
use crate::lane::{Kernel, Lane, Lanes};
use crate::robot::PARAMETERS;
use std::ops::Range;

/// Row of [`regressor`]'s result that holds d tau_joint / d phi_(link, parameter).
pub fn block_row(dof: usize, link: usize, parameter: usize, joint: usize) -> usize {
    (link * PARAMETERS + parameter) * dof + joint
}

/// Regressor of a motion as channels `[link][parameter][joint]`, each over time; see [`block_row`].
///
/// # Panics
/// If the motion does not fit the chain.
pub fn regressor(chain: &Chain, motion: &Motion) -> Channels {
    regressor_in(Lanes::best(), chain, motion)
}

/// [`regressor`] in lanes of one kind.
///
/// # Panics
/// As [`regressor`].
pub fn regressor_in(lanes: Lanes, chain: &Chain, motion: &Motion) -> Channels {
    let (dof, samples) = (chain.dof(), motion.samples());
    let mut out = Channels::zeros(chain.bodies() * PARAMETERS * dof, samples);
    let places = |link, joint| {
        std::array::from_fn(|p| Some(block_row(dof, link, p, joint)).filter(|_| chain.moves(joint, link)))
    };
    Entries::new(chain, places).write(lanes, chain, motion, 0..samples, out.as_mut_slice());
    out
}

/// Which entries of the regressor are wanted, and in which row of a table they belong.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::channels::Channels;
/// use tauscope::dynamics::{Chain, Entries, Lanes, Motion};
/// use tauscope::robot::{self, InertiaCheck, SYMBOLS};
///
/// // Of a pendulum only the column of mx, the first moment along x, in row 0 of a table.
/// let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let (chain, motion) = (Chain::new(&robot), Motion::at_rest(Channels::from_vectors(&[vec![0.0, 0.5]])));
/// let only = Entries::new(&chain, |_, _| SYMBOLS.map(|symbol| (symbol == "mx").then_some(0)));
/// let mut column = [0.0; 2];
/// only.write(Lanes::best(), &chain, &motion, 0..2, &mut column);
///
/// // Gravity turns it by -g cos q.
/// assert!((column[0] + 9.81).abs() < 1e-9 && (column[1] + 9.81 * 0.5f64.cos()).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Entries {
    /// Rows of the ten parameters, by link and joint.
    places: Vec<[usize; PARAMETERS]>,
    /// Whether any of them is wanted, by link and joint.
    wanted: Vec<bool>,
    /// Rows that a table must have.
    rows: usize,
    dof: usize,
}

/// The place of what is not wanted.
const NOWHERE: usize = usize::MAX;

impl Entries {
    /// The entries for which `place`, given a body and a coordinate, returns a row. It must not where the coordinate does not
    /// move the body.
    pub fn new(chain: &Chain, place: impl Fn(usize, usize) -> [Option<usize>; PARAMETERS]) -> Self {
        let dof = chain.dof();
        let pairs = (0..chain.bodies()).flat_map(|link| (0..dof).map(move |joint| (link, joint)));
        let places: Vec<[usize; PARAMETERS]> =
            pairs.map(|(link, joint)| place(link, joint).map(|row| row.unwrap_or(NOWHERE))).collect();
        let wanted = places.iter().map(|ten| ten.iter().any(|&place| place != NOWHERE)).collect();
        let rows = places.iter().flatten().filter(|&&place| place != NOWHERE).max().map_or(0, |last| last + 1);
        Entries { places, wanted, rows, dof }
    }

    /// Writes the wanted entries for a range of samples into `table`, `[row][sample of the range]`.
    ///
    /// # Panics
    /// If the motion does not fit the chain, or the table is too small.
    pub fn write(&self, lanes: Lanes, chain: &Chain, motion: &Motion, samples: Range<usize>, table: &mut [f64]) {
        assert_eq!(
            [motion.joints(), self.dof],
            [chain.dof(); 2],
            "the motion has another number of joints than the arm"
        );
        assert!(self.rows * samples.len() <= table.len(), "the table has too few rows");
        let lanes = lanes.for_positions(&motion.q, samples.clone());
        lanes.run(Writing { entries: self, chain, motion, samples, table });
    }
}

struct Writing<'a> {
    entries: &'a Entries,
    chain: &'a Chain,
    motion: &'a Motion,
    samples: Range<usize>,
    table: &'a mut [f64],
}

impl Kernel for Writing<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let Writing { entries, chain, motion, samples, table } = self;
        let rows = samples.len();
        let whole = rows - rows % L::WIDTH;
        let (middle, past) = (samples.start + whole, samples.end);
        // What is left over fills a lane of a table of its own, so that whole lanes are all that is ever written.
        let mut rest = if past > middle { vec![0.0; entries.rows * L::WIDTH] } else { Vec::new() };
        for (samples, table, stride) in
            [(samples.start..middle, &mut *table, rows), (middle..past, &mut rest, L::WIDTH)]
        {
            match &chain.branches {
                None => entries.write_lanes::<L>(chain, motion, samples, table, stride),
                Some(tree) => {
                    let offset = |place: usize| if place == NOWHERE { NOWHERE } else { place * stride };
                    let offsets: Vec<[usize; PARAMETERS]> = entries.places.iter().map(|ten| ten.map(offset)).collect();
                    let first = samples.start;
                    branched::screws::<L>(chain, tree, motion, samples, |sample, link, body, coordinate, screw| {
                        let own = body * entries.dof + coordinate;
                        if entries.wanted[own] {
                            store(&Body::new(link).contract(screw), &offsets[own], &mut table[sample - first..]);
                        }
                    });
                }
            }
        }
        if past > middle {
            for &place in entries.places.iter().flatten().filter(|&&place| place != NOWHERE) {
                let rest = &rest[place * L::WIDTH..][..past - middle];
                table[place * rows + whole..][..rest.len()].copy_from_slice(rest);
            }
        }
    }
}

impl Entries {
    /// Writes lanes of samples into a table with `stride` places in a row. Walks the chain, and for every link contracts the
    /// screws of the joints before it.
    #[inline(always)]
    fn write_lanes<L: Lane>(
        &self,
        chain: &Chain,
        motion: &Motion,
        samples: Range<usize>,
        table: &mut [f64],
        stride: usize,
    ) {
        let dof = chain.dof();
        let zero = [L::splat(0.0); 3];
        let mut screws = vec![(zero, zero); dof];
        let mut turns = vec![(zero[0], zero[0]); dof];
        let offset = |place: usize| if place == NOWHERE { NOWHERE } else { place * stride };
        let offsets: Vec<[usize; PARAMETERS]> = self.places.iter().map(|ten| ten.map(offset)).collect();
        for sample in samples.clone().step_by(L::WIDTH) {
            let here = sample..samples.end.min(sample + L::WIDTH);
            let table = &mut table[sample - samples.start..];
            // All of them first: none waits for another, while along the chain each link waits for the one before.
            for (joint, turn) in turns.iter_mut().enumerate() {
                *turn = chain.rotation(joint).turn(L::load_part(&motion.q.channel(joint)[here.clone()]));
            }
            let mut link = chain.base();
            for k in 0..dof {
                let (q, qd, qdd) = motion.lanes(k, here.clone());
                link = chain.next_turned(k, &link, [q, qd, qdd], turns[k]);
                let body = Body::new(&link);
                let (offsets, wanted) = (&offsets[k * dof..][..=k], &self.wanted[k * dof..][..=k]);
                for ((screw, offsets), &wanted) in screws[..k].iter_mut().zip(offsets).zip(wanted) {
                    let (angular, linear) = *screw;
                    let moved = add_cross(linear, angular, link.translation);
                    let [angular, linear] = chain.rotation(k).to_link(link.turn, [angular, moved]);
                    *screw = (angular, linear);
                    if wanted {
                        store(&body.contract(screw), offsets, table);
                    }
                }
                screws[k] = if chain.is_revolute(k) { (chain.axis(k), zero) } else { (zero, chain.axis(k)) };
                if wanted[k] {
                    let own = match chain.coordinate_axis(k) {
                        Some(axis) => body.contract_axis(axis),
                        None => body.contract(&screws[k]),
                    };
                    store(&own, &offsets[k], table);
                }
            }
        }
    }
}

/// Writes those of the ten entries that have a place.
#[inline(always)]
fn store<L: Lane>(entries: &[L; PARAMETERS], offsets: &[usize; PARAMETERS], table: &mut [f64]) {
    for (entry, &offset) in entries.iter().zip(offsets) {
        if offset != NOWHERE {
            entry.store(&mut table[offset..]);
        }
    }
}

/// What a link's motion makes of its parameters.
struct Body<L> {
    acceleration: Vec3<L>,
    /// Force per unit first moment: [alpha]x + [omega]x [omega]x.
    gradient: [Vec3<L>; 3],
    /// Moments per unit inertia: of the axes x, y and z.
    moments: [Vec3<L>; 3],
    /// Differences of squared velocities, xx - yy, zz - xx, yy - zz.
    differences: Vec3<L>,
}

impl<L: Lane> Body<L> {
    #[inline(always)]
    fn new(link: &LinkState<L>) -> Self {
        let ([wx, wy, wz], [ax, ay, az]) = (link.omega, link.alpha);
        let (xx, yy, zz) = (wx * wx, wy * wy, wz * wz);
        let (xy, xz, yz) = (wx * wy, wx * wz, wy * wz);
        Body {
            acceleration: link.acceleration,
            gradient: [[-(yy + zz), xy - az, xz + ay], [xy + az, -(xx + zz), yz - ax], [xz - ay, yz + ax, -(xx + yy)]],
            moments: [[ax, xz, xy], [yz, ay, xy], [yz, xz, az]],
            differences: [xx - yy, zz - xx, yy - zz],
        }
    }

    /// Power of the body's wrench per unit parameter along one screw: w . f + u . n.
    ///
    /// A first moment c takes the moment c x a, an inertia E the moment E alpha + omega x E omega: sorted by u, its factors are
    /// those of the force but for signs and differences of squares.
    #[inline(always)]
    fn contract(&self, (u, w): &Screw<L>) -> [L; PARAMETERS] {
        let Body { acceleration: a, gradient: g, moments: [x, y, z], differences: d } = self;
        [
            dot(*w, *a),
            u[2].mul_add(a[1], u[1].mul_sub_from(a[2], dot([g[0][0], g[1][0], g[2][0]], *w))),
            u[0].mul_add(a[2], u[2].mul_sub_from(a[0], dot([g[0][1], g[1][1], g[2][1]], *w))),
            u[1].mul_add(a[0], u[0].mul_sub_from(a[1], dot([g[0][2], g[1][2], g[2][2]], *w))),
            u[2].mul_sub_from(x[2], u[1].mul_add(x[1], u[0] * x[0])),
            u[0].mul_sub_from(g[2][0], u[1].mul_add(g[2][1], u[2] * d[0])),
            u[0].mul_sub_from(y[0], u[2].mul_add(y[2], u[1] * y[1])),
            u[2].mul_sub_from(g[1][2], u[0].mul_add(g[1][0], u[1] * d[1])),
            u[1].mul_sub_from(g[0][1], u[2].mul_add(g[0][2], u[0] * d[2])),
            u[1].mul_sub_from(z[1], u[0].mul_add(z[0], u[2] * z[2])),
        ]
    }

    /// [`Body::contract`] with the screw about an axis of the link frame.
    #[inline(always)]
    fn contract_axis(&self, axis: usize) -> [L; PARAMETERS] {
        let Body { acceleration: a, gradient: g, moments: [x, y, z], differences: d } = self;
        let zero = L::splat(0.0);
        match axis {
            0 => [zero, zero, a[2], -a[1], x[0], -g[2][0], -y[0], g[1][0], d[2], z[0]],
            1 => [zero, -a[2], zero, a[0], x[1], g[2][1], y[1], d[1], -g[0][1], -z[1]],
            _ => [zero, a[1], -a[0], zero, -x[2], d[0], y[2], -g[1][2], g[0][2], z[2]],
        }
    }
}
