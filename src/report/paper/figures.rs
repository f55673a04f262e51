//! Figures 4 to 7: position, velocity, acceleration and torque of every joint; reference, disturbed, smoothed.

use crate::channels::Channels;
use crate::internal::root_mean_square;
use crate::paper::PaperStudy;
use crate::report::console::significant;
use crate::report::svg::{Color, Curve, Figure, Panel, Series};
use crate::scenario::Setup;

/// File name and content of each figure.
pub(crate) fn figures(setup: &Setup, study: &PaperStudy) -> Vec<(&'static str, String)> {
    let signals = &study.signals;
    let (reference, disturbed, smoothed) = (&signals.reference, &signals.disturbed, &signals.smoothed);
    let run = &study.runs.training;
    let truth = &run.truth.signals;
    let followed = "Reference: what the controller was asked to follow. Errors: against what the arm really did.";
    let torque = "Reference: the torque of the motors without noise, which the errors are against too.";
    let differences = "Disturbed: encoder signal, and its differences. Smoothed: Savitzky-Golay.";
    let torques = "Disturbed: torque as measured. Smoothed: the same after Savitzky-Golay.";
    [
        (
            "figure_4_position.svg",
            "Figure 4. Position",
            "position",
            "rad",
            [&reference.q, &disturbed.q, &smoothed.q],
            &truth.q,
        ),
        (
            "figure_5_velocity.svg",
            "Figure 5. Velocity",
            "velocity",
            "rad/s",
            [&reference.qd, &disturbed.qd, &smoothed.qd],
            &truth.qd,
        ),
        (
            "figure_6_acceleration.svg",
            "Figure 6. Acceleration",
            "acceleration",
            "rad/s²",
            [&reference.qdd, &disturbed.qdd, &smoothed.qdd],
            &truth.qdd,
        ),
        (
            "figure_7_torque.svg",
            "Figure 7. Torque",
            "torque",
            "N m",
            [&truth.tau, &run.recording.tau, &signals.smoothed_torque],
            &truth.tau,
        ),
    ]
    .into_iter()
    .map(|(file, title, quantity, unit, lines, exact)| {
        let caption = if unit == "N m" { [torque, torques] } else { [followed, differences] };
        let figure = Figure {
            title: title.to_owned(),
            caption: caption.map(str::to_owned).to_vec(),
            x_label: "time (s)".to_owned(),
            y_label: format!("{quantity} ({unit})"),
            series: series(),
            panels: panels(setup, &run.truth.time, lines, exact, unit),
            columns: 2,
        };
        (file, figure.to_svg())
    })
    .collect()
}

const REFERENCE: usize = 0;
const DISTURBED: usize = 1;
const SMOOTHED: usize = 2;

fn series() -> Vec<Series> {
    [
        ("reference", Color::Blue, 1.3, true),
        ("disturbed", Color::Grey, 0.8, false),
        ("smoothed", Color::Orange, 1.6, false),
    ]
    .into_iter()
    .map(|(name, color, width, dashed)| Series { name: name.to_owned(), color, width, dashed })
    .collect()
}

fn panels<'a>(
    setup: &Setup,
    time: &'a [f64],
    [reference, disturbed, smoothed]: [&'a Channels; 3],
    exact: &Channels,
    unit: &str,
) -> Vec<Panel<'a>> {
    setup
        .plant
        .joint_names()
        .into_iter()
        .enumerate()
        .map(|(joint, title)| {
            let error = |signal: &Channels| significant(rms_difference(signal.channel(joint), exact.channel(joint)));
            let curve = |series, signal: &'a Channels| Curve { series, x: time, y: signal.channel(joint) };
            Panel {
                title: title.replace('_', " "),
                note: format!("rms error: disturbed {}, smoothed {} {unit}", error(disturbed), error(smoothed)),
                curves: vec![curve(DISTURBED, disturbed), curve(SMOOTHED, smoothed), curve(REFERENCE, reference)],
            }
        })
        .collect()
}

fn rms_difference(a: &[f64], b: &[f64]) -> f64 {
    root_mean_square(&a.iter().zip(b).map(|(x, y)| x - y).collect::<Vec<f64>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn root_mean_square_by_hand() {
        assert_eq!(rms_difference(&[1.0, 5.0], &[4.0, 1.0]), 12.5f64.sqrt());
        assert_eq!(rms_difference(&[], &[]), 0.0);
    }
}
