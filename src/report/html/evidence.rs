//! What residuals look like: over time, over velocity and position, and in frequency, joint by joint.

use super::{Block, Section};
use crate::internal::root_mean_square;
use crate::report::console::significant;
use crate::report::svg::Color;
use crate::report::svg::chart::{Chart, Mark, Trace};
use crate::signal::amplitude_density;

/// Bins of the mean residual over velocity and position, and the fewest rows in one.
const BINS: usize = 24;
const FEWEST_IN_BIN: usize = 8;

/// One model's part in the plots.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Contender {
    /// Name in the legend.
    pub name: String,
    /// Its colour.
    pub color: Color,
}

/// The rows of one joint. NaN breaks lines and counts nowhere: between two logs, and where a row does not count.
#[derive(Debug, Clone, Default)]
pub(crate) struct Joint {
    /// Name.
    pub name: String,
    /// Unit of its torque.
    pub effort_unit: &'static str,
    /// Unit of its position.
    pub position_unit: &'static str,
    /// Time, s.
    pub time: Vec<f64>,
    /// Measured torque.
    pub torque: Vec<f64>,
    /// Position.
    pub q: Vec<f64>,
    /// Velocity.
    pub qd: Vec<f64>,
    /// Measured torque less every contender's, all rows.
    pub residuals: Vec<Vec<f64>>,
    /// Valid rows.
    pub valid: Vec<bool>,
    /// Noise floor of the rows.
    pub noise: f64,
}

impl Joint {
    /// A residual where it counts, NaN elsewhere.
    fn counted(&self, contender: usize) -> Vec<f64> {
        self.residuals[contender].iter().zip(&self.valid).map(|(&r, &ok)| if ok { r } else { f64::NAN }).collect()
    }
}

/// The sections on torque and residuals. The last contender is the one the report argues for; `row_s` is the time between
/// two rows.
pub(crate) fn sections(joints: &[Joint], contenders: &[Contender], row_s: f64) -> Vec<Section> {
    let gaps = "Gaps are rows that are not used: near reversals, where the direction of friction is uncertain.";
    vec![
        Section::new(
            "Residuals over time",
            vec![
                Block::text(format!("Measured torque less that of each model. Dashed: the noise floor. {gaps}")),
                Block::Charts {
                    legend: with_noise(legend(contenders, Mark::Line(1.3))),
                    charts: joints.iter().map(|joint| over_time(joint, contenders)).collect(),
                },
            ],
        ),
        Section::new(
            "Torque",
            vec![Block::Charts {
                legend: [("measured".to_owned(), Color::Grey, Mark::Line(2.4))]
                    .into_iter()
                    .chain(legend(contenders, Mark::Line(1.1)))
                    .collect(),
                charts: joints.iter().map(|joint| torque(joint, contenders)).collect(),
            }],
        ),
        Section::new(
            "Residuals over velocity",
            vec![
                Block::text(
                    "Dots: rows. Lines: means over equally many rows. Friction that a model misses bends them.",
                ),
                Block::Charts {
                    legend: legend(contenders, Mark::Line(2.0)),
                    charts: joints.iter().map(|joint| over(joint, contenders, &joint.qd, "velocity", "/s")).collect(),
                },
            ],
        ),
        Section::new(
            "Residuals over position",
            vec![
                Block::text("Springs, balancers, gear ripple and wrong gravity show here."),
                Block::Charts {
                    legend: legend(contenders, Mark::Line(2.0)),
                    charts: joints.iter().map(|joint| over(joint, contenders, &joint.q, "position", "")).collect(),
                },
            ],
        ),
        Section::new(
            "Spectrum of the residuals",
            vec![
                Block::text(
                    "Amplitude density (Welch, windows of up to 256 rows); rows that are not used are taken as zero. What \
                     moves with the arm is at the left, flat noise is flat.",
                ),
                Block::Charts {
                    legend: legend(contenders, Mark::Line(1.3)),
                    charts: joints.iter().map(|joint| spectrum(joint, contenders, row_s)).collect(),
                },
            ],
        ),
    ]
}

fn legend(contenders: &[Contender], mark: Mark) -> Vec<(String, Color, Mark)> {
    contenders.iter().map(|one| (one.name.clone(), one.color, mark)).collect()
}

fn with_noise(mut legend: Vec<(String, Color, Mark)>) -> Vec<(String, Color, Mark)> {
    legend.push(("noise floor".into(), Color::Ink, Mark::Dashed(0.9)));
    legend
}

fn over_time(joint: &Joint, contenders: &[Contender]) -> Chart {
    let line = |(index, one): (usize, &Contender)| Trace {
        mark: Mark::Line(if index + 1 == contenders.len() { 1.2 } else { 1.0 }),
        color: one.color,
        x: joint.time.clone(),
        y: joint.counted(index),
    };
    let times = || joint.time.iter().filter(|t| t.is_finite());
    let ends: Vec<f64> = times().next().into_iter().chain(times().next_back()).copied().collect();
    let noise = [1.0, -1.0].map(|sign| Trace {
        mark: Mark::Dashed(0.9),
        color: Color::Ink,
        x: ends.clone(),
        y: vec![sign * joint.noise; ends.len()],
    });
    let last = rms(&joint.counted(contenders.len() - 1));
    Chart {
        title: format!("{}, {}", joint.name, joint.effort_unit),
        note: format!("rms {}, noise {}", significant(last), significant(joint.noise)),
        x_label: "time (s)".into(),
        traces: contenders.iter().enumerate().map(line).chain(noise).collect(),
        log_y: false,
    }
}

fn torque(joint: &Joint, contenders: &[Contender]) -> Chart {
    let measured = Trace { mark: Mark::Line(2.4), color: Color::Grey, x: joint.time.clone(), y: joint.torque.clone() };
    let model = |(index, one): (usize, &Contender)| {
        let left = joint.counted(index);
        let y = joint.torque.iter().zip(left).map(|(tau, left)| tau - left).collect();
        Trace { mark: Mark::Line(1.1), color: one.color, x: joint.time.clone(), y }
    };
    Chart {
        title: format!("{}, {}", joint.name, joint.effort_unit),
        note: format!("rms {}", significant(rms(&joint.torque))),
        x_label: "time (s)".into(),
        traces: [measured].into_iter().chain(contenders.iter().enumerate().map(model)).collect(),
        log_y: false,
    }
}

/// Rows and their binned means over `abscissa`.
fn over(joint: &Joint, contenders: &[Contender], abscissa: &[f64], what: &str, per: &str) -> Chart {
    let rows: Vec<Vec<f64>> = (0..contenders.len()).map(|index| joint.counted(index)).collect();
    let clouds = contenders.iter().zip(&rows).map(|(one, y)| Trace {
        mark: Mark::Points,
        color: one.color,
        x: abscissa.to_vec(),
        y: y.clone(),
    });
    let means = contenders.iter().zip(&rows).map(|(one, y)| {
        let (x, y) = binned(abscissa, y);
        Trace { mark: Mark::Line(2.0), color: one.color, x, y }
    });
    Chart {
        title: format!("{}, {}", joint.name, joint.effort_unit),
        note: String::new(),
        x_label: format!("{what} ({}{per})", joint.position_unit),
        traces: clouds.chain(means).collect(),
        log_y: false,
    }
}

/// Means of `x` and `y` over bins of equally many rows along `x`; nothing for too few rows.
fn binned(x: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut rows: Vec<(f64, f64)> =
        x.iter().copied().zip(y.iter().copied()).filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = rows.len().div_ceil(BINS).max(FEWEST_IN_BIN);
    let mean = |bin: &[(f64, f64)]| {
        let (x, y) = bin.iter().fold((0.0, 0.0), |sum, row| (sum.0 + row.0, sum.1 + row.1));
        (x / bin.len() as f64, y / bin.len() as f64)
    };
    rows.chunks(size).filter(|bin| bin.len() >= FEWEST_IN_BIN).map(mean).unzip()
}

fn spectrum(joint: &Joint, contenders: &[Contender], row_s: f64) -> Chart {
    let line = |(index, one): (usize, &Contender)| {
        let rows: Vec<f64> = joint.counted(index).into_iter().map(|r| if r.is_finite() { r } else { 0.0 }).collect();
        let (frequency, density) = amplitude_density(&rows, 1.0 / row_s);
        // The mean of every window is taken off, so there is nothing at zero.
        let x = frequency.into_iter().skip(1).collect();
        Trace { mark: Mark::Line(1.3), color: one.color, x, y: density.into_iter().skip(1).map(f64::log10).collect() }
    };
    Chart {
        title: format!("{}, {}/√Hz", joint.name, joint.effort_unit),
        note: String::new(),
        x_label: "frequency (Hz)".into(),
        traces: contenders.iter().enumerate().map(line).collect(),
        log_y: true,
    }
}

/// Root mean square of the finite values.
pub(super) fn rms(values: &[f64]) -> f64 {
    root_mean_square(&values.iter().copied().filter(|value| value.is_finite()).collect::<Vec<f64>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_over_bins() {
        let x: Vec<f64> = (0..240).rev().map(|k| f64::from(k) * 0.1).collect();
        let y: Vec<f64> = x.iter().map(|&x| if x < 11.95 { 1.0 } else { -2.0 }).collect();
        let (centres, means) = binned(&x, &y);
        assert_eq!(centres.len(), BINS);
        assert!((centres[0] - 0.45).abs() < 1e-12, "{}", centres[0]);
        assert_eq!((means[2], means[20]), (1.0, -2.0));
        assert!(binned(&[0.0, 1.0, f64::NAN], &[1.0, 1.0, 1.0]).1.is_empty());
    }

    #[test]
    fn rows_that_do_not_count_are_gaps() {
        let joint = Joint {
            residuals: vec![vec![1.0, 100.0, -1.0]],
            valid: vec![true, false, true],
            torque: vec![0.0; 3],
            time: vec![0.0, 1.0, 2.0],
            ..Default::default()
        };
        assert_eq!(rms(&joint.counted(0)), 1.0);
    }

    #[test]
    fn a_minute_of_noise_stays_small() {
        let rows = 3000;
        let noise = |seed: u32| -> Vec<f64> {
            (0..rows).map(|k: u32| f64::from((k ^ seed).wrapping_mul(2_654_435_761) >> 12) / 1e6).collect()
        };
        let time: Vec<f64> = (0..rows).map(|k| f64::from(k) * 0.02).collect();
        let joint = |index: u32| Joint {
            name: format!("joint_{index}"),
            time: time.clone(),
            torque: noise(index),
            q: noise(index + 10),
            qd: noise(index + 20),
            residuals: (0..3).map(|k| noise(100 * k + index)).collect(),
            valid: vec![true; rows as usize],
            ..Default::default()
        };
        let joints: Vec<Joint> = (0..6).map(joint).collect();
        let one = |name: &str, color| Contender { name: name.into(), color };
        let contenders = [one("a", Color::Green), one("b", Color::Blue), one("c", Color::Orange)];
        let sections = sections(&joints, &contenders, 0.02);
        let charts = |block: &Block| match block {
            Block::Charts { charts, .. } => charts.iter().map(|chart| chart.to_svg().len()).sum(),
            _ => 0,
        };
        let size: usize = sections.iter().flat_map(|section| &section.blocks).map(charts).sum();
        assert!(size < 4_000_000, "{size}");
        assert!(size > 100_000, "{size}");
    }
}
