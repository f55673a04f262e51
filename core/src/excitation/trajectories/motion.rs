//! A motion of any parametrisation.

use super::bspline::Bspline;
use super::fourier::FourierSeries;
use super::freudenstein::FreudensteinSequence;
use super::quintic::QuinticSequence;
use crate::channels::Channels;
use crate::excitation::primitives::{Peaks, Reference};
use serde::{Deserialize, Serialize};

/// A motion of any of the four parametrisations, as motion files hold it: `kind` names the parametrisation, `data` holds
/// its unknowns.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::excitation::random_sequence::random_sequence;
/// use tauscope::excitation::{JointLimits, Motion, Reference};
///
/// let limits = [JointLimits { lower: -2.0, upper: 2.0, velocity: 3.0, acceleration: 20.0 }];
/// let draw = |index| random_sequence(1, "motion", index, 3, 5.0, &limits).map(Motion::Freudenstein);
///
/// // One after the other, as one motion.
/// let both = Motion::joined(&[draw(0)?, draw(1)?])?;
/// assert_eq!((both.kind(), both.duration_s()), (Motion::KINDS[0], 10.0));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", content = "data", rename_all = "snake_case")]
pub enum Motion {
    /// Rest-to-rest moves under the Freudenstein 1-3-5 law.
    Freudenstein(FreudensteinSequence),
    /// A finite Fourier series.
    Fourier(FourierSeries),
    /// Quintic segments through via points.
    Quintic(QuinticSequence),
    /// A clamped uniform B-spline.
    Bspline(Bspline),
}

impl Motion {
    /// Names of the parametrisations, as `kind` spells them.
    pub const KINDS: [&'static str; 4] = ["freudenstein", "fourier", "quintic", "bspline"];

    /// The parametrisation, as `kind` spells it.
    pub fn kind(&self) -> &'static str {
        match self {
            Motion::Freudenstein(_) => Self::KINDS[0],
            Motion::Fourier(_) => Self::KINDS[1],
            Motion::Quintic(_) => Self::KINDS[2],
            Motion::Bspline(_) => Self::KINDS[3],
        }
    }

    fn reference(&self) -> &dyn Reference {
        match self {
            Motion::Freudenstein(motion) => motion,
            Motion::Fourier(motion) => motion,
            Motion::Quintic(motion) => motion,
            Motion::Bspline(motion) => motion,
        }
    }
}

impl Reference for Motion {
    fn joints(&self) -> usize {
        self.reference().joints()
    }

    fn duration_s(&self) -> f64 {
        self.reference().duration_s()
    }

    fn at(&self, t_s: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        self.reference().at(t_s, q, qd, qdd);
    }

    fn along(&self, times_s: &[f64], signals: [&mut Channels; 3]) {
        self.reference().along(times_s, signals);
    }

    fn peaks(&self, joint: usize) -> Option<Peaks> {
        self.reference().peaks(joint)
    }
}
