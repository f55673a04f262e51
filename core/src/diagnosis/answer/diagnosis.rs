//! The answer with its evidence: which names stand, what was not found, and what to do next.

use super::inertias::Gain;
use super::quantities::{Derived, Evidence, NotFound, ResidualStructure, Share};
use crate::diagnosis::criteria::{Criteria, Gate, Judgement};
use crate::diagnosis::lack_of_fit::{RejectedStructure, Unexplained};
use crate::diagnosis::logs::LowPass;
use crate::diagnosis::model::{Member, Session};
use crate::diagnosis::regression::rms;
use crate::diagnosis::relevance::{Minor, nearest};
use crate::diagnosis::search::{Found, Rejected, Verdict};
use crate::diagnosis::variance::ResidualMap;
use crate::effects::{Nature, Rounding};
use crate::error::Result;
use crate::payload::Payload;

/// A delay or lag of the torque that is of the sampling.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Diagnosis, OfSampling};
///
/// // Lines on what sampling makes late: the whole torque, or that of a joint.
/// fn late(diagnosis: &Diagnosis) -> Vec<String> {
///     let line = |OfSampling { joint, seconds: [late, std] }: &OfSampling| format!("{joint:?}: {late} +- {std} s");
///     diagnosis.of_sampling.iter().map(line).collect()
/// }
/// ```
#[derive(Debug, Clone, Copy)]
pub struct OfSampling {
    /// The joint of a lag; None for a delay, which is of all joints.
    pub joint: Option<usize>,
    /// How long, and its standard deviation, s.
    pub seconds: [f64; 2],
}

impl OfSampling {
    /// The figures of a delay or a lag, as it was found.
    pub(super) fn new(member: &Member) -> Self {
        let Member { placed, std, .. } = member;
        let joint = (placed.effect.about().nature == Nature::Lag).then_some(placed.joint);
        OfSampling { joint, seconds: [placed.amount(), std[placed.amount_index()]] }
    }
}

/// What was looked for.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// assert_eq!((diagnosis.scope.alpha, &diagnosis.scope.candidates[..]), (0.05, &["torque_ripple".to_owned()][..]));
/// assert!(!diagnosis.scope.against_reference && diagnosis.scope.effective_tests > 1.0);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scope {
    /// Family-wise false-alarm rate.
    pub alpha: f64,
    /// Names of the effects that were looked for; all of the library where empty.
    pub candidates: Vec<String>,
    /// Whether the question is what changed since reference logs.
    pub against_reference: bool,
    /// Share of the rows that have an equal state in the reference logs, where differences from these are diagnosed.
    pub equal_states: Option<f64>,
    /// Number of independent tests that the scan is worth.
    pub effective_tests: f64,
    /// What decides whether an effect found is reported.
    pub criteria: Criteria,
}

/// What the logs are, and how they were filtered.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // Both logs were sampled at 50 Hz, and the pivot has an equation.
/// assert!(diagnosis.logs.rates_hz.iter().all(|rate| (rate - 50.0).abs() < 1e-6));
/// assert_eq!((&diagnosis.logs.equations[..], diagnosis.logs.held_out_from_training), (&[true][..], false));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct LogSummary {
    /// Rates at which the logs were sampled, Hz, each once, the lowest first.
    pub rates_hz: Vec<f64>,
    /// Cut-off of the low-pass of each joint's positions, Hz.
    pub cutoffs_hz: Vec<f64>,
    /// The low-pass that torque went through before it was logged, if any.
    pub passband: Option<LowPass>,
    /// How the sign of friction is rounded on each joint: its form and the Coulomb smoothing velocity, rad/s or m/s.
    pub coulomb_rounding: Vec<Rounding>,
    /// Whether each joint has an equation: its torque is logged, and it moves. The numbers of a joint without one
    /// mean nothing.
    pub equations: Vec<bool>,
    /// Whether parts of the training logs were held out for want of test logs.
    pub held_out_from_training: bool,
}

/// Residuals of the models. Root mean squares are of means over 20 ms, per joint, N m (N).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // The held-out residual of the model with the ripple is the noise; that of the baseline is ten times as large.
/// let errors = &diagnosis.errors;
/// let [_, baseline] = &errors.baseline_rms;
/// assert!((errors.extended_test_rms[0] / errors.noise_floor[0] - 1.0).abs() < 0.2);
/// assert!(errors.extended_test_rms[0] < 0.1 * baseline[0] && baseline[0] < errors.test_torque_rms[0]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Errors {
    /// Standard deviation of the torque's noise, as estimated from the residual: what no test separates from noise is part of it.
    pub noise_floor: Vec<f64>,
    /// White noise of the measured torque: what its sensors account for.
    pub sensor_noise: Vec<f64>,
    /// Torque of the held-out logs.
    pub test_torque_rms: Vec<f64>,
    /// Residual of the arm as described on the held-out logs.
    pub simulation_test_rms: Vec<f64>,
    /// Residual of the fitted baseline on the training logs and on the held-out logs.
    pub baseline_rms: [Vec<f64>; 2],
    /// Residual of the model with all effects found on the held-out logs.
    pub extended_test_rms: Vec<f64>,
    /// Standard deviation of the extended model's prediction of the held-out torque, from the covariance of its parameters,
    /// root mean square over the rows; infinite where the training logs do not determine it.
    pub prediction_std: Vec<f64>,
    /// Share of the gap between baseline and noise floor that the effects found close on the held-out logs.
    pub gap_closed: Share,
    /// What the held-out residual of the arm as described follows, and that of the extended model.
    pub structure: [Vec<ResidualStructure>; 2],
}

impl Errors {
    /// Whether the training logs determine the held-out torque of a joint: its prediction is uncertain by less than the torque itself.
    /// Else the residuals of fitted models say nothing of the arm there.
    pub fn are_determined(&self, joint: usize) -> bool {
        self.prediction_std[joint] <= self.test_torque_rms[joint]
    }
}

/// What was found.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Diagnosis, Verdict};
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
///
/// // A pendulum with a ripple of seven periods a turn, which no description of an arm has.
/// let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// let diagnosis = answer.diagnosis().expect("the logs are good");
/// assert_eq!(diagnosis.verdict, Verdict::Named);
/// assert!(diagnosis.found.len() == 1 && !diagnosis.next_experiment.is_empty());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug)]
pub struct Diagnosis {
    /// The answer in a word.
    pub verdict: Verdict,
    /// What was looked for.
    pub scope: Scope,
    /// What the logs are, and how they were filtered.
    pub logs: LogSummary,
    /// Residuals of the models.
    pub errors: Errors,
    /// Effects that were there before the change in question: found in the reference logs, part of the model since.
    pub before: Vec<Found>,
    /// Effects found.
    pub found: Vec<Found>,
    /// What derives from the parameters of each.
    pub derived: Vec<Vec<Derived>>,
    /// Delays and lags of the torque that are of the sampling: in the model, and no effects.
    pub of_sampling: Vec<OfSampling>,
    /// Effects found that do not matter, each with the gate that it failed: not in the model.
    pub minor: Vec<Minor>,
    /// The best candidates of rounds of the search that failed a gate.
    pub rejected: Vec<Rejected>,
    /// What re-identified inertias gain, where those of the description were trusted and are wrong as a whole.
    pub inertias: Option<Gain>,
    /// The gate at which it was refused that they are wrong as a whole, where that was asked.
    pub rejected_inertias: Option<Judgement>,
    /// What the residual of the baseline follows in all logs, whether or not a law of the library explains it.
    pub map: ResidualMap,
    /// The load that was added since the reference logs, weighed by itself, where one was found.
    pub load: Option<Payload>,
    /// Whether the search was ended before it was done: effects may be missing, and rivals of names.
    pub unfinished: bool,
    /// Whether it ended with as many findings as were asked for: more may act.
    pub is_full: bool,
    /// Structure without a name.
    pub unexplained: Vec<Unexplained>,
    /// Structure of joints without any that is reported, each with the gate that it failed.
    pub rejected_structure: Vec<RejectedStructure>,
    /// Effects not found.
    pub not_found: Vec<NotFound>,
    /// What to do next.
    pub next_experiment: String,
    /// What the answer rests on, row by row.
    pub evidence: Evidence,
}

impl Diagnosis {
    /// The law that comes nearest to what stays unexplained on a joint: one that was found there and explains no more than generic
    /// functions do.
    pub fn nearest(&self, joint: usize) -> Option<&Minor> {
        nearest(&self.minor, joint)
    }
}

/// The answer in a word; `inertias`: whether those of the description are wrong as a whole.
pub(super) fn verdict(found: &[Found], inertias: bool, unexplained: &[Unexplained]) -> Verdict {
    let some = |verdict: Verdict| found.iter().any(|found| found.verdict == verdict);
    match (some(Verdict::OneOf), some(Verdict::Named) || inertias) {
        (true, _) => Verdict::OneOf,
        (false, true) => Verdict::Named,
        _ if found.is_empty() && unexplained.is_empty() => Verdict::None,
        _ => Verdict::Unexplained,
    }
}

/// Withdraws the findings that unexplained structure replaces, and those on joints of which much stays unexplained with certainty.
/// `residuals` are the root mean squares of the held-out residuals of baseline and extended model, `noise` the floor's,
/// `[joint]`. What impacts show does not rest on residuals and stays.
pub(super) fn withdraw(
    found: &mut [Found],
    unexplained: &[Unexplained],
    residuals: [&[f64]; 2],
    noise: &[f64],
    criteria: &Criteria,
) {
    for replaced in unexplained.iter().flat_map(|left| &left.instead_of) {
        found[replaced.place].withdraw(Judgement::at_most(Gate::Replaced, replaced.beyond, criteria.levels.minor));
    }
    let [before, after] = residuals;
    let certain: Vec<usize> = unexplained.iter().filter(|left| left.certain).map(|left| left.joint).collect();
    let explained = |joint: usize| {
        let excess = |rms: &[f64]| (rms[joint].powi(2) - noise[joint].powi(2)).max(0.0);
        // A finding that only comes near the law leaves a tenth of a strong one.
        let least = match excess(after) > noise[joint].powi(2) {
            true => 1.0 - criteria.levels.minor,
            false => criteria.verdict.explained,
        };
        // Where nothing is left there is nothing to explain.
        Judgement::at_least(Gate::Explained, 1.0 - excess(after) / excess(before), least).or(excess(after) == 0.0)
    };
    for one in found.iter_mut().filter(|one| one.impacts.is_none()) {
        let joints = one.member.candidate.joints();
        // An effect on many joints does not fall with one of them, and what happened in one log is not in the others.
        let on_joints = joints.iter().map(|joint| certain.contains(joint).then(|| explained(*joint)));
        let on_joints: Option<Vec<Judgement>> = on_joints.collect();
        let open = on_joints.filter(|_| one.member.candidate.log.is_none()).unwrap_or_default();
        if let Some(failed) = open.first().filter(|_| open.iter().all(|judgement| !judgement.passed)) {
            one.withdraw(*failed);
        }
    }
}

/// Whether a delay or a lag is more than sampling makes: torque that is held over a step is half a sample late, and read at the other end
/// of it than the positions it is another half sample away. Logs may be slower than the loop that holds the torque: what is longer than
/// half a servo cycle is of the sampling as long as it adds less than the `noise` to the held-out torque of every joint, root mean square.
/// None for all other effects.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn beyond_sampling(session: &Session, found: &Found, noise: &[f64]) -> Result<Option<Judgement>> {
    let Member { placed, .. } = &found.member;
    if !matches!(placed.effect.about().nature, Nature::Delay | Nature::Lag) {
        return Ok(None);
    }
    let test = &session.logs.test.rows;
    let added = session.model.arm.added_throughout(std::slice::from_ref(placed), test)?;
    let size = rms(&test.valid, &added[0]).iter().zip(noise).map(|(added, noise)| added / noise).fold(0.0, f64::max);
    Ok(Some(exceeds_sampling(placed.amount().abs(), session.sample_s(), size, &session.criteria)))
}

/// Whether a time, s, is more than that of a sample, or more than sampling makes and its torque, of a `size` over the noise, no less than
/// that.
fn exceeds_sampling(time_s: f64, sample_s: f64, size: f64, Criteria { levels, verdict, .. }: &Criteria) -> Judgement {
    let is_felt = time_s > verdict.sampling_s && size >= levels.bound_std;
    Judgement::above(Gate::Sampling, time_s / sample_s, 1.0).or(is_felt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::model::Candidate;
    use crate::diagnosis::search::Accepted;
    use crate::effects::{Placed, find};

    #[test]
    fn either_side_of_what_sampling_makes() {
        let criteria = Criteria::default();
        let exceeds = |time_s: f64, size: f64| exceeds_sampling(time_s, 5e-3, size, &criteria).passed;
        // By the sample; or by half a servo cycle and the noise together.
        assert!(exceeds(5e-3 + 1e-9, 0.0) && !exceeds(5e-3, 0.0));
        let (longest, noise) = (criteria.verdict.sampling_s, criteria.levels.bound_std);
        assert!(exceeds(longest + 1e-9, noise) && !exceeds(longest, noise) && !exceeds(longest + 1e-9, noise - 1e-9));
    }

    /// A spring on the first joint with held-out residuals of two joints, before and after.
    fn spring(before: [f64; 2], after: [f64; 2]) -> Found {
        let placed = Placed::typical(find("joint_spring").unwrap(), 0);
        let member = Member::new(&Candidate { placed, log: None, columns: Default::default() }, &[]);
        let mut found = Found::new(Accepted { member, gain_lower_bound: 0.1, level: 1e-6 }, Vec::new());
        found.rms = [before.to_vec(), after.to_vec()];
        found
    }

    #[test]
    fn a_name_that_leaves_much_is_taken_back() {
        // Of an excess of 15 in units of the noise, 1.6 are left, or 1.4; without structure a name stands all the same.
        let structure = |certain| {
            let (family_wise_p, instead_of) = (Some(1e-6), Vec::new());
            Unexplained {
                joint: 0,
                share: 0.3,
                structure: "follows the speed",
                family_wise_p,
                certain,
                instead_of,
                passed: Vec::new(),
            }
        };
        let left = |excess: f64, left: f64, unexplained: &[Unexplained]| {
            let [before, after] = [excess, left].map(|excess| (1.0 + excess).sqrt());
            let mut found = [spring([before, 1.0], [after, 1.0])];
            withdraw(&mut found, unexplained, [&[before, 1.0], &[after, 1.0]], &[1.0, 1.0], &Criteria::default());
            found[0].verdict
        };
        assert_eq!(left(15.0, 1.6, &[structure(true)]), Verdict::Unexplained);
        assert_eq!(left(15.0, 1.4, &[structure(true)]), Verdict::Named);
        assert_eq!(left(15.0, 1.6, &[structure(false)]), Verdict::Named);
        assert_eq!(left(15.0, 1.6, &[]), Verdict::Named);
        // Of 3, 0.95 or 0.85: less than the noise.
        assert_eq!(left(3.0, 0.95, &[structure(true)]), Verdict::Unexplained);
        assert_eq!(left(3.0, 0.85, &[structure(true)]), Verdict::Named);
        // Without an excess there is nothing to explain.
        assert_eq!(left(0.0, 0.0, &[structure(true)]), Verdict::Named);
    }

    #[test]
    fn the_nearest_law_is_the_largest_that_smooth_functions_replace() {
        let minor = |gate, size: f64| Minor {
            found: spring([1.0, 1.0], [1.0, 1.0]),
            failed: Judgement::at_most(gate, 1.0, 0.0),
            size: vec![size, size],
        };
        let all = [minor(Gate::BeyondStructure, 0.2), minor(Gate::Size, 0.9), minor(Gate::Strength, 0.4)];
        assert_eq!(nearest(&all, 0).unwrap().size[0], 0.4);
        assert!(nearest(&all, 1).is_none(), "a spring acts on its joint alone");
        assert!(nearest(&all[1..2], 0).is_none());
    }
}
