//! The report of a run on measured logs.

use super::evidence::{self, Contender, Joint, rms};
use super::{Block, Page, Provenance, Section, Tone};
use crate::identification::fit::{Fitted, Logs};
use crate::recording::Recording;
use crate::report::console::significant;
use crate::report::measured::Compared;
use crate::report::svg::Color;
use crate::robot::Robot;

/// Share of a joint's torque above which an error is reported.
const NOTABLE: f64 = 0.1;

/// The report of an identification from measured logs.
pub(crate) fn page(robot: &Robot, logs: Logs, compared: Compared, notes: &[String], provenance: Provenance) -> Page {
    let best = compared.smoothed;
    let fitted = &best.fitted;
    let rows = rows(robot, fitted);
    let (tone, verdict) = verdict(robot, fitted, &rows);
    let mut sections = vec![scores(robot, compared, &rows)];
    if !rows.is_empty() {
        let contenders = [Contender { name: "identified".into(), color: Color::Orange }];
        sections.extend(evidence::sections(&rows, &contenders, row_period(&fitted.test.time)));
    }
    sections.push(parameters(fitted));
    sections.push(quality(logs, notes));
    let train: f64 = logs.train.iter().map(|log| log.duration()).sum();
    let test: f64 = logs.test.iter().map(|log| log.duration()).sum();
    let judged = match logs.test {
        [] => "no log was held out to judge by".to_owned(),
        _ => format!("judged on another {test:.1} s"),
    };
    Page {
        kind: format!("Identification of {} from measured logs", robot.name),
        verdict,
        tone,
        lead: vec![format!(
            "{} base parameters of {} joints were identified from {train:.1} s of motion with Savitzky-Golay smoothing; {judged}.",
            fitted.fit.estimate.beta.len(),
            robot.dof()
        )],
        next: Some(format!(
            "tauscope diagnose with the same dataset names what the model misses{}.",
            if logs.test.is_empty() { "; hold a log of another motion out first ([[test]])" } else { "" }
        )),
        sections,
        provenance,
    }
}

/// Whether the model explains the held-out torque, in words.
fn verdict(robot: &Robot, fitted: &Fitted, rows: &[Joint]) -> (Tone, String) {
    if rows.is_empty() {
        return (Tone::Warn, "A model was identified; nothing was held out to judge it by.".into());
    }
    let share = |joint: usize| fitted.test_rms[joint] / rms(&counted(&rows[joint]));
    let missed: Vec<String> = (0..robot.dof())
        .filter(|&joint| share(joint) > NOTABLE)
        .map(|joint| format!("{} ({:.0} %)", robot.joints[joint].name, 100.0 * share(joint)))
        .collect();
    match missed.is_empty() {
        true => {
            let worst = (0..robot.dof()).map(share).fold(0.0, f64::max);
            let percent = format!("{:.1}", 100.0 * worst);
            (
                Tone::Good,
                format!(
                    "The identified model misses at most {percent} % of any joint's torque on motion it has not seen."
                ),
            )
        }
        false => (
            Tone::Warn,
            format!(
                "The identified model misses more than 10 % of the torque of an unseen motion on {}.",
                missed.join(", ")
            ),
        ),
    }
}

/// Torque of the valid rows.
fn counted(joint: &Joint) -> Vec<f64> {
    joint.torque.iter().zip(&joint.valid).filter(|(_, ok)| **ok).map(|(&torque, _)| torque).collect()
}

/// The held-out rows of every joint; none where nothing was held out.
fn rows(robot: &Robot, fitted: &Fitted) -> Vec<Joint> {
    let test = &fitted.test;
    let time = continued(&test.time);
    let joint = |(j, torque): (usize, &Vec<f64>)| {
        let about = &robot.joints[j];
        Joint {
            name: about.name.clone(),
            effort_unit: about.effort_unit(),
            position_unit: about.position_unit(),
            time: time.clone(),
            torque: torque.clone(),
            q: test.q[j].clone(),
            qd: test.qd[j].clone(),
            residuals: vec![test.residual[j].iter().map(|left| left.unwrap_or(f64::NAN)).collect()],
            valid: test.residual[j].iter().map(Option::is_some).collect(),
            noise: test.noise[j],
        }
    };
    test.torque.iter().enumerate().map(joint).collect()
}

/// Times of several logs one after the other, NaN between them.
fn continued(time: &[f64]) -> Vec<f64> {
    let (mut offset, mut last, mut fresh) = (0.0, None, false);
    time.iter()
        .map(|&t| {
            if t.is_nan() {
                fresh = true;
                return t;
            }
            if let (true, Some(end)) = (fresh, last) {
                offset = end + row_period(time) - t;
            }
            fresh = false;
            last = Some(t + offset);
            t + offset
        })
        .collect()
}

/// Time between two rows, s.
fn row_period(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(1.0)
}

fn scores(robot: &Robot, compared: Compared, rows: &[Joint]) -> Section {
    let Compared { raw, smoothed: best, usual, .. } = compared;
    let at = |values: &[f64], j: usize| values.get(j).map_or("-".to_owned(), |&value| significant(value));
    let table = robot.joints.iter().enumerate().map(|(j, about)| {
        vec![
            format!("{}, {}", about.name, about.effort_unit()),
            rows.get(j).map_or("-".to_owned(), |row| significant(rms(&row.torque))),
            at(&raw.torque_std_held_out_nm, j),
            usual.map_or("-".to_owned(), |usual| at(&usual.torque_std_held_out_nm, j)),
            at(&best.torque_std_held_out_nm, j),
            at(&best.torque_std_training_nm, j),
            at(&best.fitted.test_rms, j),
            at(&best.fitted.test.noise, j),
        ]
    });
    let header = [
        "joint",
        "torque, rms",
        "error, raw signals",
        "error, Butterworth",
        "error, Savitzky-Golay",
        "the same in training",
        "filtered residual, rms",
        "noise floor",
    ];
    Section::new(
        "How good the model is",
        vec![
            Block::text(
                "Errors: standard deviation of predicted minus measured torque on the held-out logs, sensor noise and all, while \
                 the joint moves. The filtered residual is what the fit minimises; the noise floor is the white noise that the \
                 filter lets through.",
            ),
            Block::table(header, table.collect()),
            Block::List(compared.smoothings()),
        ],
    )
}

fn parameters(fitted: &Fitted) -> Section {
    let estimate = &fitted.fit.estimate;
    let (std, intervals) = (estimate.std(), estimate.intervals());
    let rows: Vec<Vec<String>> = fitted
        .fit
        .places
        .iter()
        .enumerate()
        .filter(|(_, place)| place.is_none())
        .map(|(k, _)| {
            let [low, high] = intervals[k];
            let numbers = [estimate.beta[k], std[k], low, high].map(significant);
            [fitted.fit.names[k].clone(), fitted.fit.arm_units[k].to_owned()].into_iter().chain(numbers).collect()
        })
        .collect();
    let header = ["base parameter", "unit", "value", "std", "95 % from", "to"];
    Section::new(
        "Parameters",
        vec![
            Block::text(format!(
                "Condition number of the weighted regression: {}.",
                significant(estimate.condition_number)
            )),
            Block::Folded(format!("All {} base parameters", rows.len()), vec![Block::table(header, rows)]),
        ],
    )
}

fn quality(logs: Logs, notes: &[String]) -> Section {
    let row = |what: &str, log: &Recording| {
        vec![
            what.to_owned(),
            log.samples().to_string(),
            format!("{:.1} s", log.duration()),
            format!("{:.0} Hz", log.rate_hz()),
        ]
    };
    let train = logs.train.iter().map(|log| row("training", log));
    let rows = train.chain(logs.test.iter().map(|log| row("held out", log))).collect();
    let table = Block::table(["log", "samples", "length", "rate"], rows);
    let listed = match notes {
        [] => Block::text("Nothing suspicious was found in the logs."),
        notes => Block::List(notes.to_vec()),
    };
    Section::new("Data quality", vec![table, listed])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_follow_each_other() {
        let time = [0.0, 0.5, 1.0, f64::NAN, f64::NAN, 0.0, 0.5, f64::NAN];
        let all = continued(&time);
        assert_eq!(all[..3], [0.0, 0.5, 1.0]);
        assert!(all[3].is_nan() && all[7].is_nan());
        assert_eq!(all[5..7], [1.5, 2.0]);
        assert_eq!(row_period(&time), 0.5);
    }
}
