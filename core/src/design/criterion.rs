//! Criteria for excitation motions: one number from the information matrix G of p base parameters, less is better.
//!
//! | criterion | value |
//! |---|---|
//! | condition number | kappa of the regressor, rows divided by sigma, columns of unit length (Gautier and Khalil 1992) |
//! | D | -ln det G / (2 p): mean of the logarithm of the half axes of the confidence ellipsoid, nats a parameter |
//! | Hadamard | -ln(det G / prod G_ii) / (2 p), from Hadamard's inequality det G <= prod G_ii; zero for orthogonal columns |
//! | worst deviation | largest standard deviation of a parameter over its size |
//! | compromise | D + w ln kappa, w = 0.15 unless another weight is asked for |
//!
//! kappa and Hadamard's ratio do not see how large the torques are, only how alike the columns are: a small slow motion
//! can score well. D sees both, and orders motions much as the torque error on other motions does; the compromise keeps
//! kappa small at little cost in D, and is the default.
//!
//! M. Gautier and W. Khalil, Exciting trajectories for the identification of base inertial parameters of robots, Int. J.
//! Robotics Research 11(4), 1992; J. Swevers et al., Optimal robot excitation and identification, IEEE Trans. Robotics
//! and Automation 13(5), 1997 (D); J. Jin and N. Gans, Parameter identification for industrial robots with a fast and
//! robust trajectory design approach, Robotics and Computer-Integrated Manufacturing 31, 2015 (Hadamard's inequality).

use super::information::{Information, SINGULAR};
use crate::error::{Error, Result};
use crate::identification::spectrum::Spectrum;

/// Default weight of ln kappa in the compromise.
pub const KAPPA_WEIGHT: f64 = 0.15;

/// Base parameters smaller than this share of the largest in the same unit count as this large in relative deviations.
const SMALL: f64 = 1e-2;

/// What a motion is judged by; see the module for the definitions.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::design::Criterion;
/// use tauscope::design::information::Experiment;
/// use tauscope::excitation::{JointLimits, random_sequence::random_sequence};
/// use tauscope::robot::{self, InertiaCheck};
/// # let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let limits = |velocity| [JointLimits { lower: -2.0, upper: 2.0, velocity, acceleration: 20.0 }];
///
/// // A motion ten times slower determines the inertia less well: the worst standard deviation is larger.
/// let experiment = Experiment::new(&pendulum, &[0.5], 100.0)?;
/// let sizes = tauscope::design::criterion::sizes(experiment.beta(), &[""; 5]);
/// let worst = |velocity| {
///     let motion = random_sequence(1, "motion", 0, 4, 8.0, &limits(velocity))?;
///     let information = experiment.information(&motion, 100.0);
///     Ok::<_, tauscope::error::Error>(Criterion::WorstDeviation.value(&information, &sizes))
/// };
/// assert!(worst(0.3)? > worst(3.0)?);
/// assert_eq!(Criterion::named("hadamard", 0.0)?, Criterion::Hadamard);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// D + w ln kappa.
    Compromise {
        /// The weight w.
        kappa_weight: f64,
    },
    /// Condition number of the weighted regressor with columns of unit length.
    ConditionNumber,
    /// D, from the determinant of the information matrix.
    LogDeterminant,
    /// Hadamard's ratio of the determinant to the product of the squared column lengths.
    Hadamard,
    /// Largest relative standard deviation of a parameter.
    WorstDeviation,
}

impl Default for Criterion {
    fn default() -> Self {
        Criterion::Compromise { kappa_weight: KAPPA_WEIGHT }
    }
}

impl Criterion {
    /// Names of all criteria, as the command line and results spell them.
    pub const NAMES: [&'static str; 5] =
        ["compromise", "condition-number", "log-determinant", "hadamard", "worst-deviation"];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Criterion::Compromise { .. } => Self::NAMES[0],
            Criterion::ConditionNumber => Self::NAMES[1],
            Criterion::LogDeterminant => Self::NAMES[2],
            Criterion::Hadamard => Self::NAMES[3],
            Criterion::WorstDeviation => Self::NAMES[4],
        }
    }

    /// The criterion called `name`; the compromise gets the weight given.
    ///
    /// # Errors
    /// Lists the names there are.
    pub fn named(name: &str, kappa_weight: f64) -> Result<Self> {
        [
            Criterion::Compromise { kappa_weight },
            Criterion::ConditionNumber,
            Criterion::LogDeterminant,
            Criterion::Hadamard,
            Criterion::WorstDeviation,
        ]
        .into_iter()
        .find(|criterion| criterion.name() == name)
        .ok_or_else(|| {
            Error::request(
                "criterion",
                format!("there is no criterion `{name}`; choose from {}", Self::NAMES.join(", ")),
            )
        })
    }

    /// The value for `information` on parameters of the given sizes; infinite when a parameter is not excited.
    pub fn value(self, information: &Information, sizes: &[f64]) -> f64 {
        match self {
            Criterion::Compromise { kappa_weight } => {
                let (d, kappa) = both(information);
                d + kappa_weight * kappa.ln()
            }
            Criterion::ConditionNumber => condition_number(information),
            Criterion::LogDeterminant => log_determinant(information),
            Criterion::Hadamard => hadamard(information),
            Criterion::WorstDeviation => relative_deviations(information, sizes).into_iter().fold(0.0, f64::max),
        }
    }
}

/// kappa, from the eigenvalues of the normalised information matrix.
pub fn condition_number(information: &Information) -> f64 {
    ratio_of_ends(&information.normalised_spectrum())
}

/// D in nats a parameter.
pub fn log_determinant(information: &Information) -> f64 {
    -information.log_determinant() / (2.0 * information.parameters() as f64)
}

/// Hadamard's ratio in nats a parameter, zero or more.
pub fn hadamard(information: &Information) -> f64 {
    let excess = information.log_determinant() - information.log_diagonal();
    if excess.is_nan() { f64::INFINITY } else { -excess / (2.0 * information.parameters() as f64) }
}

/// Standard deviation of every parameter over its size.
pub(crate) fn relative_deviations(information: &Information, sizes: &[f64]) -> Vec<f64> {
    information.standard_deviations().iter().zip(sizes).map(|(deviation, size)| deviation / size).collect()
}

/// What base parameters of the values `beta` are held against in relative deviations: their magnitude, but at least a
/// hundredth of the largest in the same unit, as a parameter may happen to be zero.
pub fn sizes(beta: &[f64], units: &[&str]) -> Vec<f64> {
    let largest = |unit: &str| {
        beta.iter().zip(units).filter(|(_, u)| **u == unit).fold(0.0f64, |most, (value, _)| most.max(value.abs()))
    };
    beta.iter().zip(units).map(|(value, unit)| value.abs().max(SMALL * largest(unit))).collect()
}

/// D and kappa from one spectrum.
fn both(information: &Information) -> (f64, f64) {
    let spectrum = information.normalised_spectrum();
    let kappa = ratio_of_ends(&spectrum);
    if kappa.is_infinite() {
        return (f64::INFINITY, f64::INFINITY);
    }
    let logarithm = spectrum.log_determinant() + information.log_diagonal();
    (-logarithm / (2.0 * information.parameters() as f64), kappa)
}

/// Square root of the largest over the smallest eigenvalue; infinite when the smallest is zero to rounding.
fn ratio_of_ends(spectrum: &Spectrum) -> f64 {
    let [least, most] = spectrum.ends();
    if least > SINGULAR * most { (most / least).sqrt() } else { f64::INFINITY }
}
