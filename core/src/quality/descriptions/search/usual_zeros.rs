//! Zeros near those of a convention.
//!
//! Conventions of zero differ by an eighth of a turn or a multiple of that. A fit comes near such an offset, and offsets of parallel axes make
//! up for each other. So one near it is taken as that, unless the logs tell it from the fitted one.

use super::found::Found;
use crate::quality::descriptions::compare::compare;
use crate::quality::descriptions::fitting::{Physics, Rows};
use crate::quality::descriptions::shares::ALIKE;
use crate::quality::descriptions::sizes::zeros::convention_near;
use crate::quality::descriptions::tried::Tried;

/// Offsets within this of a convention may be that, degrees: those of parallel axes are known no better.
const PERHAPS_DEG: f64 = 8.0;

/// What was found, with the zeros of conventions, all of them or one, where neither the model of the search nor the described bodies, as far
/// as these explain the torques, leave clearly more of these on blocks held out than with the fitted ones.
pub(super) fn with_usual_zeros(physics: &Physics, bodies: Option<&Physics>, rows: &Rows, mut found: Found) -> Found {
    let of_bodies = bodies.filter(|bodies| !std::ptr::eq(*bodies, physics));
    for own in std::iter::once(&mut found.best).chain(&mut found.rivals) {
        if let Some(usual) = usual(physics, of_bodies, rows, own) {
            *own = usual;
        }
    }
    found
}

fn usual(physics: &Physics, bodies: Option<&Physics>, rows: &Rows, own: &Tried) -> Option<Tried> {
    let fitted = &own.description.position_offset;
    let near = |joint: usize| convention_near(fitted[joint], PERHAPS_DEG).filter(|near| *near != fitted[joint]);
    let with = |joints: &[usize]| -> Vec<f64> {
        let mut offsets = fitted.clone();
        joints.iter().for_each(|&joint| offsets[joint] = near(joint).unwrap_or(offsets[joint]));
        offsets
    };
    let joints: Vec<usize> = (0..fitted.len()).filter(|&joint| near(joint).is_some()).collect();
    let all = (joints.len() > 1).then(|| with(&joints));
    let under_bodies = bodies.and_then(|bodies| {
        let own = Tried::new(bodies, rows, own.description.clone()).filter(|own| own.share() < ALIKE)?;
        Some((bodies, own))
    });
    let is_told = |fitted: &Tried, usual: &Tried| {
        compare(&usual.evaluation, &fitted.evaluation, &rows.log).is_none_or(|gain| gain.is_distinct())
    };
    let fits = |offsets: Vec<f64>| {
        let description = own.description.with_zeros(&offsets);
        let usual = Tried::new(physics, rows, description.clone()).filter(|usual| !is_told(own, usual))?;
        let denied = under_bodies.as_ref().is_some_and(|(bodies, fitted)| {
            Tried::new(bodies, rows, description).is_none_or(|usual| is_told(fitted, &usual))
        });
        (!denied).then_some(usual)
    };
    all.into_iter().chain(joints.iter().map(|&joint| with(&[joint]))).find_map(fits)
}
