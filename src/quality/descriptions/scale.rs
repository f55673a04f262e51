//! The factor by which torques differ from what the described bodies need: another unit, or the motor side of a gear.

use super::physics::{JointTable, Tables};
use super::rows::Rows;
use nalgebra::{DMatrix, DVector};

/// The bodies' torque counts where the residual of a joint's fit is less than this of its torque ..
pub const ALIKE: f64 = 0.35;

/// .. and that of the fit without it is this many times more.
const NEEDED: f64 = 2.0;

/// Masses of a URDF are wrong by less than this factor, unless they are placeholders, whose torque is not alike.
const PLAUSIBLE: f64 = 8.0;

/// Factors of the joints that lie within this of their median are one factor.
const COMMON: f64 = 2.0;

/// How many times larger the logged torque is than that of the bodies, per joint; none where it is not alike.
pub fn factors(tables: &Tables, rows: &Rows) -> Vec<Option<f64>> {
    tables.joints.iter().enumerate().map(|(joint, table)| factor(table, joint, rows)).collect()
}

/// The median of the factors and whether the joints share it, where it is beyond what wrong masses explain and enough joints
/// show it.
pub fn implausible(factors: &[Option<f64>]) -> Option<(f64, bool)> {
    let mut known: Vec<f64> = factors.iter().flatten().map(|factor| factor.abs()).collect();
    if known.len() < factors.len().min(2) || known.len() * 3 < factors.len() {
        return None;
    }
    known.sort_by(f64::total_cmp);
    let median = known[known.len() / 2];
    let shared = known.iter().all(|factor| (1.0 / COMMON..COMMON).contains(&(factor / median)));
    let beyond = |factor: &f64| !(1.0 / PLAUSIBLE..PLAUSIBLE).contains(factor);
    let same_side = |factor: &f64| (*factor > 1.0) == (median > 1.0);
    (beyond(&median) && known.iter().filter(|f| beyond(f)).all(same_side)).then_some((median, shared))
}

fn factor(table: &JointTable, channel: usize, rows: &Rows) -> Option<f64> {
    let width = table.parameters.len();
    let count: usize = table.rows.iter().sum();
    if !rows.measured[channel] || count < 4 * (width + 1) {
        return None;
    }
    let sum = |each: &[f64]| each.iter().sum::<f64>();
    let mut gram = DMatrix::zeros(width + 1, width + 1);
    let mut right = DVector::zeros(width + 1);
    for block in 0..table.rows.len() {
        let mut corner = gram.view_mut((0, 0), (width, width));
        corner += &table.gram[block];
        for place in 0..width {
            gram[(place, width)] += table.with_known[block][place];
            gram[(width, place)] += table.with_known[block][place];
            right[place] += table.with_torque[channel][block][place];
        }
    }
    gram[(width, width)] = sum(&table.known_squares);
    right[width] = sum(&table.known_torque[channel]);
    let squares = sum(&table.squares[channel]);
    let left = |size: usize| -> Option<(f64, f64)> {
        let (gram, right) = (gram.view((0, 0), (size, size)).into_owned(), right.rows(0, size).into_owned());
        let scale = gram.diagonal().map(|v: f64| if v > 0.0 { v.sqrt() } else { 1.0 });
        let unit =
            DMatrix::from_fn(size, size, |r, c| gram[(r, c)] / (scale[r] * scale[c]) + if r == c { 1e-8 } else { 0.0 });
        let solution = unit.cholesky()?.solve(&right.component_div(&scale)).component_div(&scale);
        Some(((squares - solution.dot(&right)).max(0.0), solution[size - 1]))
    };
    let ((with, factor), (without, _)) = (left(width + 1)?, left(width)?);
    let alike = with.sqrt() < ALIKE * squares.sqrt() && without.sqrt() > NEEDED * with.sqrt();
    (alike && factor != 0.0).then_some(factor)
}
