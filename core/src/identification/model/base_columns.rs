//! The regressor's base columns of all joints, made in blocks of samples: the one kernel under identification, diagnosis,
//! Monte Carlo and the search for excitations.
//!
//! Columns that no base parameter stands on are never made, nor those of bodies that cannot act on a joint.

use super::standard::{ROTOR, STANDARD, VISCOUS};
use crate::channels::Channels;
use crate::dynamics::{BaseParameters, Chain, Entries, Motion};
use crate::effects::direction;
use crate::identification::numerics::gram;
use crate::lane::{Aligned, Kernel, Lane, Lanes};
use crate::robot::PARAMETERS;
use std::ops::Range;

/// Samples of a block.
pub(crate) const BLOCK: usize = gram::BLOCK;

/// What a column is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// An entry of the rigid-body regressor.
    Rigid,
    /// The joint's own acceleration, for its rotor inertia.
    Rotor,
    /// Its velocity, for viscous friction.
    Viscous,
    /// The direction of its motion, for Coulomb friction.
    Coulomb,
    /// Nothing of its own: what it is merged into acts on the joint, and it does not.
    Nothing,
}

/// One joint's share of the columns.
#[derive(Debug, Clone)]
struct Share {
    parameters: Vec<usize>,
    kinds: Vec<Kind>,
    /// Place of the first in a table.
    first: usize,
    /// Columns that others are taken off: place of the column, place of the other, its share.
    merged: Vec<(usize, usize, f64)>,
}

/// Which columns act on which joint, and how they are made. A table of them is `[column][sample]`, the columns of a joint
/// one after the other and behind them one place that the caller may put the joint's torque in.
#[derive(Debug, Clone)]
pub struct BaseColumns {
    shares: Vec<Share>,
    entries: Entries,
    places: usize,
}

impl BaseColumns {
    /// For an arm with base parameters of standard ones (13 a body: ten inertial ones, rotor inertia, viscous and Coulomb friction of
    /// its joint). A joint without an equation, whose torque is not known, has no columns.
    pub(crate) fn new(chain: &Chain, equations: &[bool], base: &BaseParameters) -> Self {
        let kept = base.kept();
        let dof = chain.dof();
        let mut shares: Vec<Share> = Vec::with_capacity(dof);
        let mut places = 0;
        for (joint, &has_equation) in equations.iter().enumerate() {
            let acts = |b: usize| {
                let (link, which) = (kept[b] / STANDARD, kept[b] % STANDARD);
                has_equation && if which < PARAMETERS { chain.moves(joint, link) } else { link == joint }
            };
            let of = |b: usize| if acts(b) { kind(kept[b]) } else { Kind::Nothing };
            let with_others = |b: &usize| acts(*b) || base.merged(*b).iter().any(|&(other, _)| acts(other));
            let parameters: Vec<usize> = (0..kept.len()).filter(with_others).collect();
            let kinds = parameters.iter().map(|&b| of(b)).collect();
            let place = |b: usize| parameters.iter().position(|&own| own == b);
            let taken_off = |(own, &b): (usize, &usize)| {
                let others = base.merged(b).iter();
                others.filter_map(|&(other, share)| Some((own, place(other)?, share))).collect::<Vec<_>>()
            };
            let merged = parameters.iter().enumerate().flat_map(taken_off).collect();
            let share = Share { parameters, kinds, first: places, merged };
            places += share.parameters.len() + 1;
            shares.push(share);
        }
        let entries = Entries::new(chain, |link, joint| {
            std::array::from_fn(|parameter| {
                let share = &shares[joint];
                let standard = link * STANDARD + parameter;
                let place = share.parameters.iter().position(|&b| kept[b] == standard);
                place.filter(|&place| share.kinds[place] == Kind::Rigid).map(|place| share.first + place)
            })
        });
        BaseColumns { shares, entries, places }
    }

    /// Places in a table: the columns of all joints, and one behind those of each.
    pub fn places(&self) -> usize {
        self.places
    }

    /// Base parameters that can act on a joint, ascending; the order of its columns.
    pub(crate) fn parameters(&self, joint: usize) -> &[usize] {
        &self.shares[joint].parameters
    }

    /// Places of a joint's columns in a table; the next one is the caller's.
    pub(crate) fn of(&self, joint: usize) -> Range<usize> {
        let share = &self.shares[joint];
        share.first..share.first + share.parameters.len()
    }

    /// Writes all columns over a range of samples into `table`, `[column][sample of the range]`: inertial columns along
    /// `link`, those of rotors and friction along `motor`. `width` is the velocity over which the sign in dry friction is
    /// smoothed, rad/s. What the caller's places hold afterwards is unspecified.
    ///
    /// # Panics
    /// If the motions do not fit the chain, or the table has another size.
    pub fn write(
        &self,
        lanes: Lanes,
        chain: &Chain,
        [motor, link]: [&Motion; 2],
        width: f64,
        samples: Range<usize>,
        table: &mut [f64],
    ) {
        let rows = samples.len();
        assert_eq!(table.len(), self.places * rows, "a table of all columns is wanted");
        self.entries.write(lanes, chain, link, samples.clone(), table);
        for (joint, share) in self.shares.iter().enumerate() {
            let velocity = &motor.qd.channel(joint)[samples.clone()];
            for (place, kind) in share.kinds.iter().enumerate().filter(|(_, kind)| **kind != Kind::Rigid) {
                let column = &mut table[(share.first + place) * rows..][..rows];
                match kind {
                    Kind::Rigid => {}
                    Kind::Rotor => column.copy_from_slice(&motor.qdd.channel(joint)[samples.clone()]),
                    Kind::Viscous => column.copy_from_slice(velocity),
                    Kind::Coulomb => lanes.run(Directions { velocity, width, column }),
                    Kind::Nothing => column.fill(0.0),
                }
            }
            self.take_off(joint, &mut table[share.first * rows..], rows);
        }
    }

    /// Takes off the columns of a joint, `[column][row]`, their shares of those that they are merged into.
    pub(crate) fn take_off(&self, joint: usize, table: &mut [f64], rows: usize) {
        for &(own, other, share) in &self.shares[joint].merged {
            let ranges = [own * rows..(own + 1) * rows, other * rows..(other + 1) * rows];
            // Two columns of one table are never the same.
            if let Ok([column, other]) = table.get_disjoint_mut(ranges) {
                column.iter_mut().zip(other).for_each(|(x, y)| *x -= share * *y);
            }
        }
    }

    /// All columns along a motion: for every joint a table `[its column][time]`.
    pub(crate) fn tables(&self, chain: &Chain, motions: [&Motion; 2], width: f64) -> Vec<Channels> {
        let samples = motions[0].samples();
        let mut tables: Vec<Channels> =
            self.shares.iter().map(|share| Channels::zeros(share.parameters.len(), samples)).collect();
        let mut block = Aligned::zeros(self.places * BLOCK.min(samples));
        for start in (0..samples).step_by(BLOCK) {
            let here = start..samples.min(start + BLOCK);
            let rows = here.len();
            let block = &mut block[..self.places * rows];
            self.write(Lanes::best(), chain, motions, width, here.clone(), block);
            for (share, table) in self.shares.iter().zip(&mut tables) {
                for place in 0..share.parameters.len() {
                    let column = &block[(share.first + place) * rows..][..rows];
                    table.channel_mut(place)[here.clone()].copy_from_slice(column);
                }
            }
        }
        tables
    }
}

fn kind(standard: usize) -> Kind {
    match standard % STANDARD {
        inertial if inertial < PARAMETERS => Kind::Rigid,
        ROTOR => Kind::Rotor,
        VISCOUS => Kind::Viscous,
        _ => Kind::Coulomb,
    }
}

/// Directions of motion; a loop over plain numbers, which the compiler makes lanes of.
struct Directions<'a> {
    velocity: &'a [f64],
    width: f64,
    column: &'a mut [f64],
}

impl Kernel for Directions<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        // The plain sign apart: it has no branches.
        if self.width == 0.0 {
            for (x, &v) in self.column.iter_mut().zip(self.velocity) {
                *x = direction(v, 0.0);
            }
        } else {
            for (x, &v) in self.column.iter_mut().zip(self.velocity) {
                *x = direction(v, self.width);
            }
        }
    }
}
