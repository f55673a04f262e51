//! `tables.md`: Tables 1 to 3 in the paper's layout, ours next to the printed values, and additions of this study.

use super::verdict::sums;
use super::{Verdict, planar, ratios, spatial};
use crate::paper::PaperStudy;
use crate::paper::equations::tables::{
    CORRECTED_TABLE_1, DenavitHartenberg, PARAMETERS, PRINTED_TABLE_1, PRINTED_TABLE_2, PRINTED_TABLE_3,
};
use crate::paper::equations::{self, DEPARTURES, PARAMETER_COUNT};
use crate::paper::procedure::Stage;
use crate::paper::quality::{Quality, TorqueQuality};
use crate::report::console::significant;
use crate::report::markdown::{table, text_table};
use crate::scenario::Setup;
use crate::study::testbed::Variant;

/// Parameters in a row of Table 2.
const PAIRS: usize = 3;

/// The content of `tables.md`.
pub(crate) fn tables(setup: &Setup, study: &PaperStudy, verdict: &Verdict) -> String {
    let sections = [
        format!("# The paper, reproduced and judged: {}\n", setup.scenario.name),
        judgement(verdict),
        table_1(),
        table_2(study),
        table_3(setup, study),
        residuals(setup, study),
        identifiability(study),
        excitation(study),
        departures(),
        procedure(study),
    ];
    sections.join("\n")
}

fn judgement(verdict: &Verdict) -> String {
    let list = |sentences: &[String]| sentences.iter().map(|text| format!("- {text}\n")).collect::<String>();
    format!(
        "## Verdict\n\nThe paper is right:\n\n{}\nThe paper is wrong:\n\n{}",
        list(&verdict.right),
        list(&verdict.wrong)
    )
}

fn table_1() -> String {
    let cells = |row: &DenavitHartenberg| {
        [row.linkage.to_string(), row.alpha_deg.to_string(), row.a_mm.to_string(), row.d_mm.to_string(), theta(row)]
    };
    let rows: Vec<Vec<String>> = PRINTED_TABLE_1
        .iter()
        .zip(&CORRECTED_TABLE_1)
        .map(|(printed, corrected)| cells(printed).into_iter().chain(cells(corrected)).collect())
        .collect();
    let header = [
        "Linkage (printed)",
        "alpha (°)",
        "a (mm)",
        "d (mm)",
        "theta",
        "Linkage (corrected)",
        "alpha (°)",
        "a (mm)",
        "d (mm)",
        "theta",
    ];
    format!(
        "## Table 1. Denavit-Hartenberg parameters of the ABB IRB 1600\n\n{}\nPrinted on the left: row 1 stands twice, \
         475 mm is on the row labelled 3, joint 3 and the 600 mm to the wrist are missing.\n",
        table(&header, &rows)
    )
}

/// "theta2 - 90°".
pub(super) fn theta(row: &DenavitHartenberg) -> String {
    match row.offset_deg {
        0.0 => format!("theta{}", row.joint),
        offset if offset < 0.0 => format!("theta{} - {}°", row.joint, -offset),
        offset => format!("theta{} + {offset}°", row.joint),
    }
}

fn table_2(study: &PaperStudy) -> String {
    let [printed, corrected] = [equations::Variant::AsPrinted, equations::Variant::Consistent]
        .map(|variant| &planar(study, variant, Variant::SavitzkyGolay).fit.parameters);
    let per_column = PARAMETER_COUNT.div_ceil(PAIRS);
    let rows: Vec<Vec<String>> = (0..per_column)
        .map(|row| {
            (row..PARAMETER_COUNT)
                .step_by(per_column)
                .flat_map(|k| {
                    let parameter = &PARAMETERS[k];
                    [
                        format!("{} ({})", parameter.symbol, parameter.unit),
                        significant(printed[k]),
                        significant(corrected[k]),
                        PRINTED_TABLE_2[k].map_or("-".to_owned(), printed_value),
                    ]
                })
                .collect()
        })
        .collect();
    let header = ["Parameter", "as printed", "corrected", "paper"].repeat(PAIRS);
    let model =
        |variant| study.planar.iter().find(|model| model.variant == variant).expect("the study has every variant");
    format!(
        "## Table 2. The estimated dynamic parameters\n\nWith Savitzky-Golay smoothing. *as printed*: equations (4)-(9) to \
         the letter; *corrected*: misprints removed; *paper*: the values in print (X29..X42 are lost in the available text). \
         Units are those that make the equations give N m.\n\n{}\nThe fits start at X = 0, and every step of (12) stays \
         in the space that the torques show, so these are the shortest X of all that fit equally well (share outside: \
         {} as printed, {} corrected). X that only occur in sums get equal shares of the sum: {}.\n",
        table(&header, &rows),
        significant(model(equations::Variant::AsPrinted).fits[1].unseen_share),
        significant(model(equations::Variant::Consistent).fits[1].unseen_share),
        sums(&model(equations::Variant::Consistent).structure.groups)
    )
}

/// A printed number, short.
fn printed_value(value: f64) -> String {
    if value.abs() < 1e-3 { format!("{value:e}") } else { value.to_string() }
}

fn table_3(setup: &Setup, study: &PaperStudy) -> String {
    let both = [Variant::Raw, Variant::SavitzkyGolay];
    let paper_model = both.map(|signals| &planar(study, equations::Variant::Consistent, signals).quality);
    let arm = both.map(|signals| &spatial(study, signals).quality);
    let rows: Vec<Vec<String>> = setup
        .plant
        .joint_names()
        .into_iter()
        .zip(PRINTED_TABLE_3)
        .enumerate()
        .map(|(joint, (name, printed))| {
            let cells = |[raw, smoothed]: [&Quality; 2]| {
                let [raw, smoothed] = [raw, smoothed].map(|quality| quality.training.torque_std_nm[joint]);
                [significant(raw), significant(smoothed), format!("{:.3}", smoothed / raw)]
            };
            let printed = [printed[0].to_string(), printed[1].to_string(), format!("{:.2}", printed[1] / printed[0])];
            [name].into_iter().chain(cells(paper_model)).chain(cells(arm)).chain(printed).collect()
        })
        .collect();
    let header = [
        "Joint",
        "78: NLS",
        "78: S-G",
        "ratio",
        "spatial: raw",
        "spatial: S-G",
        "ratio",
        "paper: NLS",
        "paper: S-G",
        "ratio",
    ];
    let held_out = ratios(&arm[1].held_out.torque_std_nm, &arm[0].held_out.torque_std_nm);
    let held_out: Vec<String> = held_out.into_iter().map(|ratio| format!("{ratio:.3}")).collect();
    format!(
        "## Table 3. The standard deviation of the estimated torque\n\nOurs in N m: predicted minus noise-free torque on \
         the training motion, over the samples at which the joint moves; *78* is the corrected 78-parameter model by \
         nonlinear least squares (NLS). The paper prints no unit.\n\n{}\nHeld out, the ratios of the spatial model are {}. \
         How much smoothing gains depends on how noisy the differences of the encoder signals are.\n",
        table(&header, &rows),
        held_out.join(", ")
    )
}

fn residuals(setup: &Setup, study: &PaperStudy) -> String {
    let fits: Vec<(&str, &Quality)> = equations::Variant::ALL
        .into_iter()
        .map(|variant| {
            let name = match variant {
                equations::Variant::AsPrinted => "78 as printed",
                equations::Variant::Consistent => "78 corrected",
                equations::Variant::EulerLagrange => "78 Euler-Lagrange",
            };
            (name, &planar(study, variant, Variant::SavitzkyGolay).quality)
        })
        .chain([
            ("78 in absolute angles", &study.absolute_angles),
            ("spatial", &spatial(study, Variant::SavitzkyGolay).quality),
        ])
        .collect();
    let part = |motion: &dyn Fn(&Quality) -> &TorqueQuality| {
        let header: Vec<&str> = ["Joint", "torque rms"].into_iter().chain(fits.iter().map(|(name, _)| *name)).collect();
        let rows: Vec<Vec<String>> = setup
            .plant
            .joint_names()
            .into_iter()
            .enumerate()
            .map(|(joint, name)| {
                let torque = significant(motion(fits[0].1).torque_rms_nm[joint]);
                let cells = fits.iter().map(|(_, quality)| {
                    let torque = motion(quality);
                    format!(
                        "{} ({} %)",
                        significant(torque.residual_rms_nm[joint]),
                        significant(torque.residual_percent[joint])
                    )
                });
                [name, torque].into_iter().chain(cells).collect()
            })
            .collect();
        table(&header, &rows)
    };
    format!(
        "## What the 78-parameter model cannot do\n\nTorque residual, rms in N m and in % of the torque's rms, with smoothing, \
         next to the spatial model with its {} base parameters on the same logs.\n\nTraining motion:\n\n{}\nHeld-out \
         motion:\n\n{}\n{}\n",
        study.model.base().len(),
        part(&|quality| &quality.training),
        part(&|quality| &quality.held_out),
        super::verdict::PLANAR_CHAIN
    )
}

fn identifiability(study: &PaperStudy) -> String {
    let rows: Vec<Vec<String>> = study
        .planar
        .iter()
        .map(|model| {
            vec![
                model.variant.name().replace('_', " "),
                format!("{} of {PARAMETER_COUNT}", model.structure.rank),
                format!("{} of {PARAMETER_COUNT}", model.rank_on_motion),
                sums(&model.structure.groups),
            ]
        })
        .collect();
    let ranks = text_table(&["Variant", "rank, any motion", "rank, this motion", "only in sums"], &rows);
    let rows: Vec<Vec<String>> = study
        .other_starts
        .iter()
        .map(|start| {
            vec![
                start.start.to_owned(),
                format!("{:e}", start.initial_lambda),
                start.iterations.to_string(),
                format!("{:.1e}", start.chi2_change.abs()),
                significant(start.largest_x_change),
                format!("{:.1e}", start.largest_torque_change_nm),
            ]
        })
        .collect();
    let header =
        ["Start", "first lambda", "steps", "change of chi2 (relative)", "largest change of an X", "of a torque (N m)"];
    format!(
        "## Rank of the 78-parameter regressor\n\n{ranks}\nThe corrected fit of Table 2, from other starts (lambda in units \
         of the largest entry of diag(J'WJ)). The predictions do not depend on the start, X does:\n\n{}",
        table(&header, &rows)
    )
}

fn excitation(study: &PaperStudy) -> String {
    let rows: Vec<Vec<String>> =
        [("one move per joint, common time", &study.single_move), ("sequence of moves", &study.sequence)]
            .into_iter()
            .map(|(name, motion)| {
                vec![
                    name.to_owned(),
                    significant(motion.duration_s),
                    format!("{} of {}", motion.rank, motion.of),
                    format!("{:.1e}", motion.smallest_counted),
                    motion.largest_left_out.map_or("-".to_owned(), |value| format!("{value:.1e}")),
                ]
            })
            .collect();
    let header = ["Motion", "length (s)", "rank", "smallest singular value", "first left out"];
    format!(
        "## What the excitation shows of the spatial arm\n\nRank of the base regressor; singular values over the largest, \
         columns of unit length.\n\n{}",
        table(&header, &rows)
    )
}

fn departures() -> String {
    let rows: Vec<Vec<String>> = DEPARTURES
        .iter()
        .map(|departure| {
            let variants = if departure.variants.len() == equations::Variant::ALL.len() {
                "all".to_owned()
            } else {
                departure.variants.iter().map(|variant| variant.name().replace('_', " ")).collect::<Vec<_>>().join(", ")
            };
            [departure.equation, departure.printed, departure.used, &variants, departure.why]
                .map(str::to_owned)
                .to_vec()
        })
        .collect();
    format!("## Departures from print\n\n{}", text_table(&["Place", "printed", "used", "by", "why"], &rows))
}

fn procedure(study: &PaperStudy) -> String {
    let rows: Vec<Vec<String>> = Stage::ALL
        .into_iter()
        .enumerate()
        .map(|(index, stage)| {
            vec![
                format!("{}. {}", index + 1, stage.name().replace('_', " ")),
                stage.what().to_owned(),
                format!("{:.1} ms", 1e3 * study.procedure.seconds(stage)),
            ]
        })
        .collect();
    format!(
        "## Figure 3. The procedure of the parameter identification method\n\nThe stages that ran, in the order of the data \
         flow; a stage that runs several times is added up.\n\n{}",
        text_table(&["Stage", "what is done", "time"], &rows)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_with_their_offset() {
        assert_eq!(theta(&CORRECTED_TABLE_1[1]), "theta2 - 90°");
        assert_eq!(theta(&PRINTED_TABLE_1[5]), "theta6");
    }

    #[test]
    fn the_first_table_shows_both_readings_of_a_row() {
        assert!(
            table_1().contains("| 2 | -90 | 150 | 486.5 | theta1 | 2 | 0 | 475 | 0 | theta2 - 90° |"),
            "{}",
            table_1()
        );
    }
}
