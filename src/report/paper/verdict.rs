//! Where the paper is right and where it is wrong, in sentences that carry the measured numbers.

use super::{planar, ratios, spatial};
use crate::internal::excitation::PEAK_ACCELERATION;
use crate::paper::PaperStudy;
use crate::paper::equations::tables::{PARAMETERS, PRINTED_TABLE_2, PRINTED_TABLE_3};
use crate::paper::equations::{self, DEPARTURES, GRAVITY, PARAMETER_COUNT};
use crate::report::console::{significant, table};
use crate::scenario::Setup;
use crate::study::testbed::Variant;
use serde::Serialize;
use std::f64::consts::TAU;

/// Why the 78-parameter model fails on a spatial arm.
pub(crate) const PLANAR_CHAIN: &str = "(4)-(9) are the equations of a planar chain in absolute angles: all axes parallel, the \
    coupling of two joints a function of the difference of their angles, the gravity on a joint a function of its angle \
    alone. The arm is spatial: joint 1 turns about the vertical, where gravity does no work, yet (4) gives it g \
    cos(theta1); gravity on joint 3 depends on theta2 + theta3 and on the wrist; the inertia about joint 1 changes with \
    the reach of the arm, yet (4) has a constant; and joints whose axes cross couple by products of sines and cosines \
    that occur nowhere in (4)-(9). No values of X correct that.";

/// Findings, one sentence or a few each.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Verdict {
    /// What the paper claims and the study confirms.
    pub right: Vec<String>,
    /// What does not hold.
    pub wrong: Vec<String>,
}

impl Verdict {
    /// Weighs a study.
    pub(crate) fn new(study: &PaperStudy) -> Self {
        let (smoothing_holds, smoothing) = smoothing(study);
        let (solver_holds, solver) = solver(study);
        let mut verdict = Verdict { right: vec![smooth_motion()], wrong: Vec::new() };
        for (holds, sentence) in [(smoothing_holds, smoothing), (solver_holds, solver)] {
            if holds { &mut verdict.right } else { &mut verdict.wrong }.push(sentence);
        }
        verdict.wrong.extend([
            not_identifiable(study),
            single_move(study),
            planar_chain(study),
            printed_values(study),
            departures(),
        ]);
        verdict
    }

    /// The verdict for a terminal, with the residuals of both models.
    pub(crate) fn console(&self, setup: &Setup, study: &PaperStudy) -> String {
        let consistent = &planar(study, equations::Variant::Consistent, Variant::SavitzkyGolay).quality;
        let printed = &planar(study, equations::Variant::AsPrinted, Variant::SavitzkyGolay).quality;
        let arm = &spatial(study, Variant::SavitzkyGolay).quality;
        let header = [
            "torque residual, rms in % of the torque",
            "78 as printed",
            "78 corrected",
            "spatial",
            "held-out: 78 as printed",
            "78 corrected",
            "spatial",
        ];
        let rows = setup.plant.joint_names().into_iter().enumerate().map(|(joint, name)| {
            let training = [printed, consistent, arm].map(|quality| quality.training.residual_percent[joint]);
            let held_out = [printed, consistent, arm].map(|quality| quality.held_out.residual_percent[joint]);
            [name].into_iter().chain(training.into_iter().chain(held_out).map(significant)).collect()
        });
        let residuals = table(&header, rows.collect());
        let list = |sentences: &[String]| -> String {
            sentences.iter().map(|sentence| format!("\n{}\n", wrapped(sentence, 116))).collect()
        };
        format!("{residuals}\n\nThe paper is right:\n{}\nThe paper is wrong:\n{}", list(&self.right), list(&self.wrong))
    }
}

fn smooth_motion() -> String {
    format!(
        "The Freudenstein 1-3-5 motion is smooth: position, velocity and acceleration start and end at zero and never jump. \
         Its peak acceleration of {PEAK_ACCELERATION:.2} h/T^2 is {:.0} % below a cycloid's {TAU:.2} h/T^2, as claimed.",
        100.0 * (1.0 - PEAK_ACCELERATION / TAU)
    )
}

fn smoothing(study: &PaperStudy) -> (bool, String) {
    let ratio = |smoothed: &[f64], raw: &[f64]| ratios(smoothed, raw);
    let fit = |signals| &planar(study, equations::Variant::Consistent, signals).quality.training.torque_std_nm;
    let paper_model = ratio(fit(Variant::SavitzkyGolay), fit(Variant::Raw));
    let arm = |signals| &spatial(study, signals).quality.training.torque_std_nm;
    let spatial_model = ratio(arm(Variant::SavitzkyGolay), arm(Variant::Raw));
    let printed: Vec<f64> = PRINTED_TABLE_3.iter().map(|[alone, smoothed]| smoothed / alone).collect();
    let worse: Vec<String> = (0..paper_model.len())
        .filter(|&joint| paper_model[joint] >= 1.0 || spatial_model[joint] >= 1.0)
        .map(|joint| (joint + 1).to_string())
        .collect();
    let sizes = format!(
        "times {} for the 78 parameters, times {} for the spatial model (in print: times {})",
        range(&paper_model),
        range(&spatial_model),
        range(&printed)
    );
    match worse.is_empty() {
        true => (
            true,
            format!(
                "Savitzky-Golay smoothing lowers the standard deviation of the torque error on every joint: {sizes}."
            ),
        ),
        false => {
            let joints = worse.join(", ");
            (
                false,
                format!(
                    "Savitzky-Golay smoothing does not lower the torque error on joint {joints}; it changes it {sizes}."
                ),
            )
        }
    }
}

fn solver(study: &PaperStudy) -> (bool, String) {
    let difference = study.spatial.iter().fold(0.0, |most: f64, fit| most.max(fit.solver_difference));
    let fits = study.planar.iter().flat_map(|model| &model.fits);
    let converged = fits.clone().all(|fit| fit.fit.stop.converged());
    let steps = fits.map(|fit| fit.fit.iterations).max().unwrap_or_default();
    let sentence = format!(
        "Levenberg-Marquardt (11)-(12) {}: at most {steps} steps from zero, and on the spatial model the weighted \
         least-squares solution to {difference:.0e}. Both models are linear in their parameters, though, so one linear \
         solve gives the same.",
        if converged { "works" } else { "does not converge on every fit" }
    );
    (converged && difference < 1e-6, sentence)
}

fn not_identifiable(study: &PaperStudy) -> String {
    let model =
        |variant| study.planar.iter().find(|model| model.variant == variant).expect("the study has every variant");
    let (printed, corrected) = (model(equations::Variant::AsPrinted), model(equations::Variant::Consistent));
    let other = study.other_starts.iter().fold((0.0f64, 0.0f64), |(x, torque), start| {
        (x.max(start.largest_x_change), torque.max(start.largest_torque_change_nm))
    });
    format!(
        "{PARAMETER_COUNT} parameters are not identifiable. The torques show {} combinations of them as printed and {} with \
         the misprints corrected, whatever the motion ({} and {} on this one). {} only ever occur in sums. From other \
         starts the fit predicts the same torques to {:.0e} N m with single X that differ by up to {:.0}: Table 2 is one \
         choice out of a space of {} dimensions.",
        printed.structure.rank,
        corrected.structure.rank,
        printed.rank_on_motion,
        corrected.rank_on_motion,
        sums(&corrected.structure.groups),
        other.1,
        other.0,
        corrected.structure.null_dimension
    )
}

fn single_move(study: &PaperStudy) -> String {
    let (single, sequence) = (&study.single_move, &study.sequence);
    format!(
        "One move per joint over a common time, as in print, shows {} of the {} base parameters of the spatial arm: the \
         joints move in proportion, and parallel joints 2 and 3 cannot be separated. The sequence of moves used here \
         shows {}. Taken literally, (17) asks the move to end where it starts, which gives h = 0.",
        single.rank, single.of, sequence.rank
    )
}

fn planar_chain(study: &PaperStudy) -> String {
    let corrected = &planar(study, equations::Variant::Consistent, Variant::SavitzkyGolay).quality;
    let arm = &spatial(study, Variant::SavitzkyGolay).quality;
    let percent = |values: &[f64]| values[..3].iter().map(|value| significant(*value)).collect::<Vec<_>>().join(", ");
    format!(
        "The best fit of the 78 parameters leaves {} % of the torque of joints 1 to 3 unexplained ({} % on the held-out \
         motion), {} % when joint 3 is read in absolute angles; the spatial model leaves {} % ({} %) on the same logs. \
         {PLANAR_CHAIN}",
        percent(&corrected.training.residual_percent),
        percent(&corrected.held_out.residual_percent),
        percent(&study.absolute_angles.training.residual_percent),
        percent(&arm.training.residual_percent),
        percent(&arm.held_out.residual_percent)
    )
}

/// Friction that drives, and gravity that an arm of this size cannot have.
fn printed_values(study: &PaperStudy) -> String {
    let negative: Vec<&str> = PARAMETERS
        .iter()
        .zip(PRINTED_TABLE_2)
        .filter(|(parameter, value)| parameter.unit.starts_with("N m") && value.is_some_and(|value| value < 0.0))
        .map(|(parameter, _)| parameter.symbol)
        .collect();
    let gravity = PRINTED_TABLE_2[44].map_or(0.0, |value| GRAVITY * value.abs());
    let found =
        GRAVITY * planar(study, equations::Variant::Consistent, Variant::SavitzkyGolay).fit.parameters[44].abs();
    format!(
        "Table 2 is not the physics of an arm: the friction coefficients {} are negative (friction that drives), and X45 \
         puts at most {} N m of gravity on joint 2, where the same model finds {} N m here.",
        negative.join(", "),
        significant(gravity),
        significant(found)
    )
}

fn departures() -> String {
    format!(
        "There are {} places at which the code departs from the print, from a lost plus sign in (13) to a row of Table 1 \
         printed twice; tables.md lists each with the reason.",
        DEPARTURES.len()
    )
}

/// "X1..X6, X8..X12": the groups of more than one.
pub(super) fn sums(groups: &[Vec<usize>]) -> String {
    let name = |group: &Vec<usize>| {
        let (first, last) = (group[0], group[group.len() - 1]);
        if last - first + 1 == group.len() && group.len() > 2 {
            format!("X{first}..X{last}")
        } else {
            group.iter().map(|k| format!("X{k}")).collect::<Vec<_>>().join("+")
        }
    };
    groups.iter().filter(|group| group.len() > 1).map(name).collect::<Vec<_>>().join(", ")
}

fn range(values: &[f64]) -> String {
    let (low, high) = values.iter().fold((f64::INFINITY, 0.0f64), |(low, high), &v| (low.min(v), high.max(v)));
    format!("{} to {}", significant(low), significant(high))
}

/// A list entry in lines of at most `width` characters.
fn wrapped(sentence: &str, width: usize) -> String {
    let mut lines = vec![String::from("-")];
    for word in sentence.split_whitespace() {
        let line = lines.last_mut().expect("starts with one");
        if line.chars().count() + 1 + word.chars().count() > width {
            lines.push(format!("  {word}"));
        } else {
            line.push(' ');
            line.push_str(word);
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_named_by_their_ends() {
        assert_eq!(sums(&[vec![1, 2, 3], vec![7], vec![23, 24], vec![30, 31, 35]]), "X1..X3, X23+X24, X30+X31+X35");
    }

    #[test]
    fn long_sentences_are_wrapped() {
        assert_eq!(wrapped("one two three four", 11), "- one two\n  three\n  four");
    }

    #[test]
    fn ranges_have_three_digits() {
        assert_eq!(range(&[0.923, 0.806]), "0.806 to 0.923");
    }
}
