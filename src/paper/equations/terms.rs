//! Equations (4)-(9) as data: which X stands where.

use super::departures::{DEPARTURES, Place};
use super::variant::{JOINTS, Variant};
use super::velocity_form::VelocityForm;
use std::ops::RangeInclusive;
use std::sync::LazyLock;

/// What a parameter is multiplied by in a row i. Joint indices count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Factor {
    /// theta_j''.
    Acceleration(usize),
    /// theta_j'' cos(theta_i - theta_j).
    AccelerationCosine(usize),
    /// A sine of the angle between i and j, times velocities.
    VelocitySine(usize, VelocityForm),
    /// g cos(theta_i).
    Gravity,
    /// sgn(theta_i').
    CoulombFriction,
    /// theta_i'.
    ViscousFriction,
}

/// One place at which a parameter occurs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term {
    /// Row, counted from 0.
    pub row: usize,
    /// Number k of X_k, counted from 1 as in print.
    pub parameter: usize,
    pub factor: Factor,
}

/// C_j: the constant that M_ij has for the higher joint j = max(i, j).
const CONSTANT: [usize; JOINTS] = [1, 7, 13, 18, 22, 25];

/// B_ij for i <= j, row by row: the X that the cosine multiplies (on the diagonal, the X next to C_j).
const COUPLING: [&[RangeInclusive<usize>]; JOINTS] = [
    &[2..=6, 8..=12, 14..=17, 19..=21, 23..=24, 26..=26],
    &[30..=34, 35..=38, 39..=41, 42..=43, 44..=44],
    &[48..=51, 52..=54, 55..=56, 57..=57],
    &[61..=63, 64..=65, 66..=66],
    &[70..=70, 71..=71],
    &[75..=75],
];

/// The gravity parameter of each joint; Coulomb and viscous friction follow it.
const GRAVITY_PARAMETER: [usize; JOINTS] = [27, 45, 58, 67, 72, 76];

/// All terms of a variant.
pub(super) fn terms(variant: Variant) -> &'static [Term] {
    static AS_PRINTED: LazyLock<Vec<Term>> = LazyLock::new(|| build(Variant::AsPrinted));
    static CONSISTENT: LazyLock<Vec<Term>> = LazyLock::new(|| build(Variant::Consistent));
    static EULER_LAGRANGE: LazyLock<Vec<Term>> = LazyLock::new(|| build(Variant::EulerLagrange));
    match variant {
        Variant::AsPrinted => &AS_PRINTED,
        Variant::Consistent => &CONSISTENT,
        Variant::EulerLagrange => &EULER_LAGRANGE,
    }
}

/// The consistent equations, with the printed slips put back for [`Variant::AsPrinted`].
fn build(variant: Variant) -> Vec<Term> {
    let printed = |row: usize, column: usize, velocity: bool| {
        DEPARTURES.iter().map(|d| &d.place).find(|place| {
            variant == Variant::AsPrinted
                && match place {
                    Place::Inertia { row: r, column: c, .. } => !velocity && (*r, *c) == (row + 1, column + 1),
                    Place::Velocity { row: r, column: c, .. } => velocity && (*r, *c) == (row + 1, column + 1),
                    Place::Elsewhere => false,
                }
        })
    };
    let mut terms = Vec::new();
    for (i, gravity) in GRAVITY_PARAMETER.into_iter().enumerate() {
        let mut add = |factor, parameters: &[usize]| {
            terms.extend(parameters.iter().map(|&parameter| Term { row: i, parameter, factor }))
        };
        for j in 0..JOINTS {
            let (a, b) = (i.min(j), i.max(j));
            let coupling: Vec<usize> = COUPLING[a][b - a].clone().collect();
            let cosine = if i == j { Factor::Acceleration(j) } else { Factor::AccelerationCosine(j) };
            if let Some(Place::Inertia { constant, cosine: coupling, .. }) = printed(i, j, false) {
                add(Factor::Acceleration(j), constant);
                add(cosine, coupling);
            } else {
                add(Factor::Acceleration(j), &[CONSTANT[b]]);
                add(cosine, &coupling);
            }
            if i == j {
                continue;
            }
            if let Some(Place::Velocity { form, parameters, .. }) = printed(i, j, true) {
                add(Factor::VelocitySine(j, *form), parameters);
            } else {
                let form = match variant {
                    Variant::EulerLagrange => VelocityForm::Centrifugal,
                    _ if i < j => VelocityForm::Lower,
                    _ => VelocityForm::Higher,
                };
                add(Factor::VelocitySine(j, form), &coupling);
            }
        }
        add(Factor::Gravity, &[gravity]);
        add(Factor::CoulombFriction, &[gravity + 1]);
        add(Factor::ViscousFriction, &[gravity + 2]);
    }
    terms
}
