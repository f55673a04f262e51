//! One blind run as it is drawn, before anything is simulated.

use super::fault::Fault;
use crate::effects::{Effect, LIBRARY, Placed, Role};
use crate::identification::effect_model::Trust;
use crate::internal::diagnosis::{is_candidate, places};
use crate::random;
use crate::scenario::Setup;
use chacha20::ChaCha8Rng;
use rand::RngExt;

/// Shapes are drawn within this factor of their typical size.
const SHAPE_FACTOR: f64 = 1.4;

/// What a run hides.
///
/// ```
/// use tauscope::study::blind::{Class, Plan};
///
/// // A first look of the study: 8 runs hide one effect as large as the noise, 4 a fainter one.
/// let cases = Plan::SMALL.cases(1, 6);
/// let of = |class| cases.iter().filter(|case| case.class == class).count();
/// assert_eq!((of(Class::Single), of(Class::Faint)), (8, 4));
/// assert!(cases.iter().all(|case| (case.class == Class::Quiet) <= case.hidden.is_empty()));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum Class {
    /// No effect is hidden.
    Quiet,
    /// One effect of the library that adds as much as the noise.
    Single,
    /// One effect of the library that adds 0.3 times as much as the noise.
    Faint,
    /// Two effects of the library.
    Pair,
    /// A law that the library does not have.
    Outside,
    /// A fault of the data.
    Fault,
    /// What was asked for on the command line.
    #[value(hide = true)]
    Asked,
}

/// The arm of a run.
///
/// ```
/// use tauscope::study::blind::{ArmKind, Plan};
///
/// // Most arms of the study are drawn at random; some are the scenario's own.
/// let cases = Plan::FULL.cases(1, 6);
/// let own = cases.iter().filter(|case| case.arm == ArmKind::Scenario).count();
/// assert!(own > 0 && 2 * own < cases.len());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmKind {
    /// That of the scenario.
    Scenario,
    /// One drawn at random with this number of turning joints.
    Random(usize),
}

/// The motions of a run.
///
/// ```
/// use tauscope::study::blind::{MotionKind, Plan};
///
/// // Both kinds of motions have their share of the study.
/// let cases = Plan::FULL.cases(1, 6);
/// let fourier = cases.iter().filter(|case| case.motion == MotionKind::Fourier).count();
/// assert!(fourier > cases.len() / 4 && fourier < 3 * cases.len() / 4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MotionKind {
    /// Freudenstein sequences.
    Freudenstein,
    /// Fourier series.
    Fourier,
}

/// A blind run to be made.
///
/// ```
/// use tauscope::identification::effect_model::Trust;
/// use tauscope::scenario::Setup;
/// use tauscope::study::blind::{self, Case};
///
/// // One effect of the library, drawn with its place and shape, three times as large as the noise.
/// let setup = Setup::load("tests/scenarios/short.toml", None)?;
/// let case = blind::draw(&setup, 7, 3.0, 0.0, Trust::Structure);
/// assert_eq!((case.hidden.len(), case.severity), (1, 3.0));
/// assert!(Case::plain(7).hidden.is_empty());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Case {
    /// Its place in the plan.
    pub index: usize,
    /// What kind of thing it hides.
    pub class: Class,
    /// Seed of arm, motions, noise and all else that is drawn.
    pub seed: u64,
    /// The effects that are hidden; their amplitudes and departures are scaled to the severity.
    pub hidden: Vec<Placed>,
    /// The fault that is put into the logs.
    pub fault: Option<Fault>,
    /// Root mean square of what each effect adds beyond the baseline on its worst joint, over that of the torque noise.
    pub severity: f64,
    /// Correlation time of the torque noise, s.
    pub correlation_s: f64,
    /// Whether the inertias are estimated or taken from the URDF.
    pub trust: Trust,
    /// The arm.
    pub arm: ArmKind,
    /// Its motions.
    pub motion: MotionKind,
    /// Whether the logs are cut out of the middle of longer motions.
    pub cut: bool,
}

impl Case {
    /// A case that hides nothing in logs of the scenario's own arm, from rest to rest, its inertias trusted.
    pub fn plain(seed: u64) -> Self {
        Case {
            index: 0,
            class: Class::Quiet,
            seed,
            hidden: Vec::new(),
            fault: None,
            severity: 1.0,
            correlation_s: 0.0,
            trust: Trust::Nominal,
            arm: ArmKind::Scenario,
            motion: MotionKind::Freudenstein,
            cut: false,
        }
    }
}

impl Case {
    /// The same once more with another seed, and what it hides at other places with other shapes: what was drawn cannot be
    /// simulated. The first attempt is the case itself.
    pub fn again(&self, attempt: u64, own_dof: usize) -> Self {
        if attempt == 0 {
            return self.clone();
        }
        let mut source = random::stream(self.seed, "drawn again", attempt);
        let dof = match self.arm {
            ArmKind::Scenario => own_dof,
            ArmKind::Random(dof) => dof,
        };
        let hidden = self.hidden.iter().map(|placed| drawn(placed.effect, dof, &mut source)).collect();
        Case { seed: source.random(), hidden, ..self.clone() }
    }
}

/// A case on the scenario's own arm: any effect of the library that `trust` lets one see, at any of its places.
pub fn draw(setup: &Setup, seed: u64, severity: f64, correlation_s: f64, trust: Trust) -> Case {
    let mut source = random::stream(seed, "blind case", 0);
    let effects = visible(trust);
    let effect = effects[source.random_range(0..effects.len())];
    let places = places(effect, &setup.known);
    let joint = places[source.random_range(0..places.len())];
    let hidden = vec![Placed::typical(effect, joint)];
    Case { class: Class::Asked, hidden, severity, correlation_s, trust, ..Case::plain(seed) }
}

/// Effects of the library that are separable from the baseline under `trust`.
pub(crate) fn visible(trust: Trust) -> Vec<&'static dyn Effect> {
    LIBRARY.iter().copied().filter(|effect| is_candidate(*effect, trust, &[])).collect()
}

/// `effect` on a place drawn out of all on an arm of `dof` joints, with drawn shapes and signs. Whether it can be there shows the arm.
pub(crate) fn drawn(effect: &'static dyn Effect, dof: usize, source: &mut ChaCha8Rng) -> Placed {
    let joint = source.random_range(effect.about().scope.places(dof));
    let mut placed = Placed::typical(effect, joint);
    let factor = SHAPE_FACTOR.powf(source.random_range(-1.0..1.0));
    for (parameter, value) in effect.parameters().iter().zip(&mut placed.parameters) {
        match parameter.role {
            Role::Shape => *value = (*value * factor).clamp(parameter.lower, parameter.upper),
            Role::Amplitude | Role::Departure if -parameter.lower >= value.abs() => {
                *value *= if source.random_bool(0.5) { -1.0 } else { 1.0 };
            }
            Role::Amplitude | Role::Departure | Role::Held => {}
        }
    }
    placed
}
