//! The likeliest form and width of the sign of Coulomb friction, joint by joint.
//!
//! The width of one joint is decided with those of the others in the model: joints share parameters, and what the friction of one misses
//! pulls at the friction of another. The torque of friction is linear in its size, so that a form and a width compare by what one column
//! explains.

use crate::diagnosis::logs::Rows;
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection};
use crate::effects::Rounding;
use crate::identification::effect_model::Arm;
use crate::identification::model::Model;
use rayon::prelude::*;

/// Widths that are tried, rad/s or m/s, of a fast joint; those of a slow one, which some sliding joints are, are less by the share of
/// its speed. Narrower ones end within the rows that are left out.
const WIDTHS: [f64; 8] = [0.01, 0.015, 0.02, 0.03, 0.04, 0.05, 0.07, 0.1];

/// The same of a ramp, which ends at its width. A solver makes it wider than most speeds of a link whose inertia is small for its
/// friction, ..
const RAMPS: [f64; 8] = [0.03, 0.05, 0.08, 0.14, 0.25, 0.45, 0.8, 1.5];
/// .. and of a root, whose tails reach far where it is narrow.
const ROOTS: [f64; 5] = [0.004, 0.007, 0.012, 0.02, 0.04];

/// Factor on the best width that is tried next to it, and how often its square root takes its place: to half a percent of the width.
const FINER: f64 = 1.2;
const ROOTS_OF_FINER: usize = 5;

/// Rounding of the joints and by how much more likely, in its logarithm, the torque is than with a plain sign there.
pub(super) type Tried = Vec<(Rounding, f64)>;

/// What forms and widths are compared on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Forms<'a> {
    /// The arm and its base parameters.
    pub arm: &'a Arm,
    pub model: &'a Model,
    /// The rows, and their noise.
    pub rows: &'a Rows,
    pub whitener: &'a Whitener,
    /// The fit of all but Coulomb friction.
    pub others: &'a Projection,
    /// Share of each joint's speed in that of a fast joint.
    pub shares: &'a [f64],
    /// By how much likelier, in its logarithm, another form than tanh must be.
    pub odds: f64,
}

impl Forms<'_> {
    /// The likeliest rounding of each joint, with those of the others as `given`.
    pub(super) fn likeliest(&self, given: &[Rounding]) -> Tried {
        self.compared(given, |joint, gain| self.likeliest_of(joint, gain))
    }

    /// Gain of each joint by its rounding of `these`, with the others as `given`.
    pub(super) fn each(&self, given: &[Rounding], these: Vec<Rounding>) -> Tried {
        self.compared(given, |joint, gain| (these[joint], gain(these[joint])))
    }

    /// Whitened sums of squares of each joint's residual with such roundings.
    pub(super) fn left(&self, rounding: &[Rounding]) -> Vec<f64> {
        let fit = self.others.with(&self.whitened(rounding));
        let of_joint = |joint| fit.residual.part(joint).unwrap_or_default().iter().map(|r| r * r).sum();
        (0..self.model.dof()).map(of_joint).collect()
    }

    /// The likeliest rounding of one joint and its `gain`.
    fn likeliest_of(&self, joint: usize, gain: &dyn Fn(Rounding) -> f64) -> (Rounding, f64) {
        let share = self.shares[joint];
        let tried = |own: Rounding| (own, gain(own));
        let forms: [(Rounding, &[f64]); 4] = [
            (Rounding::Tanh(share), &WIDTHS),
            (Rounding::Ramp(share), &RAMPS),
            (Rounding::Constraint(share), &RAMPS),
            (Rounding::Root(share), &ROOTS),
        ];
        let likelier = |a: &(Rounding, f64), b: &(Rounding, f64)| a.1.total_cmp(&b.1);
        let mut best = (Rounding::Sharp, 0.0);
        for (form, (unit, widths)) in forms.into_iter().enumerate() {
            let of_form = widths.iter().map(|&width| tried(unit.scaled(width))).max_by(likelier);
            let Some(mut own) = of_form else { continue };
            let mut factor = FINER;
            for _ in 0..=ROOTS_OF_FINER {
                let sides = [factor, 1.0 / factor].map(|factor| tried(own.0.scaled(factor)));
                own = sides.into_iter().chain([own]).max_by(likelier).unwrap_or(own);
                factor = factor.sqrt();
            }
            let by = if form == 0 { 0.0 } else { self.odds };
            if own.1 > best.1 + by {
                best = own;
            }
        }
        best
    }

    /// What `found` makes of each joint's gain over a plain sign, with the rounding of the others as `given`.
    fn compared<T: Send>(
        &self,
        given: &[Rounding],
        found: impl Fn(usize, &dyn Fn(Rounding) -> f64) -> T + Sync,
    ) -> Vec<T> {
        let columns = self.whitened(given);
        let of_joint = |joint: usize| {
            let others: Vec<Column> = columns.iter().filter(|column| column.part(joint).is_none()).cloned().collect();
            let fit = self.others.with(&others);
            let explained = |own: Rounding| {
                let mut rounding = given.to_vec();
                rounding[joint] = own;
                let column = self.arm.dry_columns_on(joint, self.model, self.rows, &rounding);
                fit.test(&self.whitener.apply_all(&column)).map_or(0.0, |test| test.statistic)
            };
            let plain = explained(Rounding::Sharp);
            found(joint, &|own| 0.5 * (explained(own) - plain))
        };
        (0..self.model.dof()).into_par_iter().map(of_joint).collect()
    }

    /// Whitened columns of Coulomb friction.
    fn whitened(&self, rounding: &[Rounding]) -> Vec<Column> {
        let dry = self.arm.dry_columns(self.model, self.rows, rounding).into_iter();
        self.whitener.apply_all(&dry.map(|(_, column)| column).collect::<Vec<_>>())
    }
}
