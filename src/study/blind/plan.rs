//! What the runs of a study hide.

use super::case::{ArmKind, Case, Class, MotionKind, drawn, visible};
use super::fault::Fault;
use super::outside::OUTSIDE;
use crate::effects::Effect;
use crate::identification::effect_model::Trust;
use crate::internal::diagnosis::is_candidate;
use crate::random;
use chacha20::ChaCha8Rng;
use rand::RngExt;

/// Correlation times of the torque noise, s: white, and two that are slow.
pub(crate) const CORRELATIONS_S: [f64; 3] = [0.0, 0.13, 0.5];

const TRUSTS: [Trust; 2] = [Trust::Nominal, Trust::Structure];

/// Severity of [`Class::Faint`].
const FAINT: f64 = 0.3;

/// Shares of the runs on the scenario's own arm, along Fourier series, and cut out of longer motions.
const OWN_ARM: f64 = 0.25;
const FOURIER: f64 = 0.5;
const CUT: f64 = 0.3;

/// Runs of each class.
///
/// ```
/// use tauscope::study::blind::Plan;
///
/// // The cases of a study, the same for the same seed, on an arm of six joints.
/// let cases = Plan::SMALL.cases(1, 6);
/// let again = Plan::SMALL.cases(1, 6);
/// assert!(cases.iter().zip(&again).all(|(a, b)| a.seed == b.seed && a.hidden == b.hidden));
/// assert!(Plan::FULL.cases(1, 6).len() > 10 * cases.len());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Plan {
    /// Runs that hide nothing, for each trust and colour of the noise.
    pub quiet: usize,
    /// Runs that hide one effect at the noise's size: so many of each effect, or so many in all where `every` is false.
    pub single: usize,
    /// The same at 0.3 times the noise.
    pub faint: usize,
    /// Whether every effect of the library gets its turn.
    pub every: bool,
    /// Runs that hide two effects.
    pub pairs: usize,
    /// Runs with each law outside the library.
    pub outside: usize,
    /// Runs with each fault of the data.
    pub faults: usize,
}

impl Plan {
    /// The whole study: 100 runs and more with nothing hidden, every effect three times at each size.
    pub const FULL: Plan = Plan { quiet: 20, single: 3, faint: 3, every: true, pairs: 60, outside: 6, faults: 4 };

    /// A first look: some of everything.
    pub const SMALL: Plan = Plan { quiet: 1, single: 8, faint: 4, every: false, pairs: 3, outside: 1, faults: 1 };

    /// Classes of all runs, in order, with their number within the class.
    fn runs(&self) -> Vec<(Class, usize)> {
        let effects = if self.every { visible(Trust::Nominal).len() } else { 1 };
        let counts = [
            (Class::Quiet, self.quiet * TRUSTS.len() * CORRELATIONS_S.len()),
            (Class::Single, self.single * effects),
            (Class::Faint, self.faint * effects),
            (Class::Pair, self.pairs),
            (Class::Outside, self.outside * OUTSIDE.len()),
            (Class::Fault, self.faults * Fault::ALL.len()),
        ];
        counts.into_iter().flat_map(|(class, count)| (0..count).map(move |number| (class, number))).collect()
    }

    /// All cases of the study with that seed; `own_dof` is the number of joints of the scenario's arm.
    pub fn cases(&self, seed: u64, own_dof: usize) -> Vec<Case> {
        let runs = self.runs().into_iter().enumerate();
        runs.map(|(index, (class, number))| self.case(seed, own_dof, index, class, number)).collect()
    }

    fn case(&self, seed: u64, own_dof: usize, index: usize, class: Class, number: usize) -> Case {
        let mut source = random::stream(seed, &format!("blind {class:?}"), number as u64);
        let arm = match source.random::<f64>() {
            share if share < OWN_ARM => ArmKind::Scenario,
            share if share < 0.5 * (1.0 + OWN_ARM) => ArmKind::Random(6),
            _ => ArmKind::Random(7),
        };
        let dof = match arm {
            ArmKind::Scenario => own_dof,
            ArmKind::Random(dof) => dof,
        };
        let mut case = Case {
            index,
            class,
            seed: source.random(),
            correlation_s: CORRELATIONS_S[number % CORRELATIONS_S.len()],
            trust: TRUSTS[number / CORRELATIONS_S.len() % TRUSTS.len()],
            arm,
            motion: if source.random_bool(FOURIER) { MotionKind::Fourier } else { MotionKind::Freudenstein },
            cut: source.random_bool(CUT),
            ..Case::plain(0)
        };
        match class {
            Class::Quiet | Class::Asked => {}
            Class::Single | Class::Faint => {
                case.severity = if class == Class::Faint { FAINT } else { 1.0 };
                let all = visible(Trust::Nominal);
                let effect = if self.every { all[number % all.len()] } else { pick(&all, &mut source) };
                if self.every {
                    // All colours and both trusts for every effect; what free inertias hide takes trusted ones.
                    let round = number / all.len() + number;
                    case.correlation_s = CORRELATIONS_S[round % CORRELATIONS_S.len()];
                    case.trust = TRUSTS[round / CORRELATIONS_S.len() % TRUSTS.len()];
                }
                if !is_candidate(effect, case.trust, &[]) {
                    case.trust = Trust::Nominal;
                }
                case.hidden.push(drawn(effect, dof, &mut source));
            }
            Class::Pair => {
                let mut all = visible(case.trust);
                for _ in 0..2 {
                    let effect = pick(&all, &mut source);
                    all.retain(|other| other.about().name != effect.about().name);
                    case.hidden.push(drawn(effect, dof, &mut source));
                }
            }
            Class::Outside => case.hidden.push(drawn(OUTSIDE[number % OUTSIDE.len()], dof, &mut source)),
            Class::Fault => case.fault = Some(Fault::ALL[number % Fault::ALL.len()]),
        }
        case
    }
}

fn pick(effects: &[&'static dyn Effect], source: &mut ChaCha8Rng) -> &'static dyn Effect {
    effects[source.random_range(0..effects.len())]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_full_study_has_every_effect_three_times_at_both_sizes() {
        let cases = Plan::FULL.cases(5, 6);
        for class in [Class::Single, Class::Faint] {
            for effect in visible(Trust::Nominal) {
                let name = effect.about().name;
                let own: Vec<&Case> =
                    cases.iter().filter(|c| c.class == class && c.hidden[0].effect.about().name == name).collect();
                assert_eq!(own.len(), 3, "{name}");
                assert!(own.iter().all(|case| is_candidate(effect, case.trust, &[])), "{name}");
            }
        }
        assert!(cases.iter().filter(|case| case.class == Class::Quiet).count() >= 100);
        assert!(cases.iter().enumerate().all(|(index, case)| case.index == index));
    }

    #[test]
    fn what_a_run_hides_depends_on_its_class_and_number_alone() {
        let few = Plan { quiet: 2, ..Plan::SMALL }.cases(9, 6);
        let more = Plan::SMALL.cases(9, 6);
        let pairs = |cases: &[Case]| {
            let pairs = cases.iter().filter(|case| case.class == Class::Pair);
            pairs.map(|case| format!("{} {:?}", case.seed, case.hidden)).collect::<Vec<_>>()
        };
        assert_eq!(pairs(&few), pairs(&more));
        assert_ne!(pairs(&few), pairs(&Plan::SMALL.cases(10, 6)));
    }
}
