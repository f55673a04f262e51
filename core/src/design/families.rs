//! The parametrisations at a given length, as encodings to search in.
//!
//! Their numbers of unknowns grow with the length: so many moves, segments, harmonics or control points a second, chosen so
//! that all parametrisations have about equally many (1.7 a second and joint).

use crate::error::{Error, Result};
use crate::excitation::bspline::DEGREE;
use crate::excitation::encoding::{BsplineEncoding, Encoding, FourierEncoding, QuinticEncoding};
use crate::excitation::random_sequence::FreudensteinEncoding;
use crate::excitation::{JointLimits, Motion};

/// A parametrisation of motions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// Rest-to-rest moves under the Freudenstein 1-3-5 law.
    Freudenstein,
    /// Finite Fourier series.
    Fourier,
    /// Quintic segments with free via velocities and accelerations.
    Quintic,
    /// Clamped uniform B-splines.
    Bspline,
}

impl Family {
    /// All of them, in the order of [`Motion::KINDS`].
    pub const ALL: [Family; 4] = [Family::Freudenstein, Family::Fourier, Family::Quintic, Family::Bspline];

    /// Its name, as motion files spell it.
    pub fn name(self) -> &'static str {
        Motion::KINDS[self as usize]
    }

    /// The family called `name`.
    ///
    /// # Errors
    /// Lists the names there are.
    pub fn named(name: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|family| family.name() == name).ok_or_else(|| {
            Error::request(
                "kind",
                format!("there is no parametrisation `{name}`; choose from {}", Motion::KINDS.join(", ")),
            )
        })
    }

    /// Moves, harmonics, segments or free control points for `duration_s`, unless another number is asked for.
    pub fn usual_size(self, duration_s: f64) -> usize {
        let per_second = match self {
            Family::Freudenstein => 0.9,
            Family::Fourier => 0.8,
            Family::Quintic => 0.5,
            Family::Bspline => 1.7,
        };
        ((per_second * duration_s).round() as usize).max(2)
    }

    /// Motions of `size` moves, harmonics, segments or control points per joint that last `duration_s`, inside `limits`.
    ///
    /// # Errors
    /// Those of the encodings: limits that no motion can keep, a size that is too small.
    pub fn encoding(self, limits: &[JointLimits], duration_s: f64, size: usize) -> Result<Box<dyn Encoding>> {
        Ok(match self {
            Family::Freudenstein => Box::new(FreudensteinEncoding::new(limits, size, duration_s)?),
            Family::Fourier => Box::new(FourierEncoding::new(limits, size, duration_s, 1)?),
            Family::Quintic => Box::new(QuinticEncoding::new(limits, size, duration_s, true)?),
            Family::Bspline => Box::new(BsplineEncoding::new(limits, size, DEGREE, duration_s)?),
        })
    }
}
