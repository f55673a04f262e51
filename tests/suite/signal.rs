//! The filters against scipy (tests/reference/savitzky_golay.py, low_pass.py, signal.py, butterworth.py) and against exact rational
//! arithmetic.

use serde::Deserialize;
use std::collections::BTreeMap;
use tauscope::channels::Channels;
use tauscope::identification::prepare::{Smoothing, measured, position_cutoff_hz};
use tauscope::identification::smoothing_choice::usual_low_pass;
use tauscope::recording::Recording;
use tauscope::signal::{Edge, SavitzkyGolay, ZeroPhaseLowPass, bandwidth, downsample};

#[derive(Deserialize)]
struct SavitzkyGolayReference {
    input: Vec<f64>,
    filtered: Vec<SavitzkyGolayCase>,
    /// Cases in which scipy itself is off by more than 1e-12, by rational arithmetic instead.
    filtered_exactly: Vec<SavitzkyGolayCase>,
    exact_weights: Vec<ExactWeights>,
}

#[derive(Deserialize)]
struct SavitzkyGolayCase {
    window: usize,
    order: usize,
    derivative: usize,
    sample_period_s: f64,
    edge: String,
    constant: f64,
    output: Vec<f64>,
}

/// Weights in units of the sample period, for the output `position` samples from the window's centre.
#[derive(Deserialize)]
struct ExactWeights {
    window: usize,
    order: usize,
    derivative: usize,
    position: isize,
    weights: Vec<f64>,
}

#[derive(Deserialize)]
struct LowPassReference {
    input: Vec<f64>,
    filtered: Vec<LowPassCase>,
}

#[derive(Deserialize)]
struct LowPassCase {
    order: usize,
    cutoff_hz: f64,
    rate_hz: f64,
    sos: Vec<[f64; 6]>,
    output: Vec<f64>,
}

fn savitzky_golay_reference() -> SavitzkyGolayReference {
    serde_json::from_str(include_str!("../reference/savitzky_golay.json")).unwrap()
}

fn low_pass_reference() -> LowPassReference {
    serde_json::from_str(include_str!("../reference/low_pass.json")).unwrap()
}

/// Greatest difference, relative to the greatest wanted value.
fn relative_error(got: &[f64], want: &[f64]) -> f64 {
    assert_eq!(got.len(), want.len());
    let scale = want.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    got.iter().zip(want).fold(0.0_f64, |m, (g, w)| m.max((g - w).abs())) / scale
}

#[test]
fn savitzky_golay_agrees_with_scipy_edges_included() {
    let reference = savitzky_golay_reference();
    assert_eq!((reference.filtered.len(), reference.filtered_exactly.len()), (40, 4));
    let mut output = vec![0.0; reference.input.len()];
    for case in reference.filtered.iter().chain(&reference.filtered_exactly) {
        let edge = match case.edge.as_str() {
            "interp" => Edge::Polynomial,
            "nearest" => Edge::Nearest,
            "mirror" => Edge::Mirror,
            "constant" => Edge::Constant(case.constant),
            other => panic!("unknown edge {other}"),
        };
        let filter = SavitzkyGolay::new(case.window, case.order, case.derivative, case.sample_period_s, edge).unwrap();
        filter.apply(&reference.input, &mut output).unwrap();
        let error = relative_error(&output, &case.output);
        let SavitzkyGolayCase { window, order, derivative, edge, .. } = case;
        assert!(error < 1e-12, "window {window}, order {order}, derivative {derivative}, {edge}: off by {error:e}");
    }
}

#[test]
fn savitzky_golay_weights_are_exact_up_to_window_201_and_order_12() {
    for exact in savitzky_golay_reference().exact_weights {
        let ExactWeights { window, order, derivative, position, weights: want } = exact;
        let filter = SavitzkyGolay::new(window, order, derivative, 1.0, Edge::Polynomial).unwrap();
        // A unit impulse at sample i of a signal as long as the window brings out weight i at every position.
        let at = (window as isize / 2 + position) as usize;
        let mut output = vec![0.0; window];
        let got: Vec<f64> = (0..window)
            .map(|i| {
                let mut impulse = vec![0.0; window];
                impulse[i] = 1.0;
                filter.apply(&impulse, &mut output).unwrap();
                output[at]
            })
            .collect();
        let error = relative_error(&got, &want);
        assert!(
            error < 1e-13,
            "window {window}, order {order}, derivative {derivative}, position {position}: off by {error:e}"
        );
    }
}

#[test]
fn low_pass_agrees_with_scipy_sosfiltfilt_edges_included() {
    let reference = low_pass_reference();
    assert_eq!(reference.filtered.len(), 16);
    let mut output = vec![0.0; reference.input.len()];
    for case in &reference.filtered {
        let filter = ZeroPhaseLowPass::new(case.order, case.cutoff_hz, case.rate_hz).unwrap();
        filter.apply(&reference.input, &mut output).unwrap();
        let error = relative_error(&output, &case.output);
        assert!(error < 1e-12, "order {}, cut-off {} Hz: off by {error:e}", case.order, case.cutoff_hz);
    }
}

#[test]
fn low_pass_gain_is_the_squared_magnitude_of_scipys_sections() {
    for case in low_pass_reference().filtered {
        let filter = ZeroPhaseLowPass::new(case.order, case.cutoff_hz, case.rate_hz).unwrap();
        for hz in [0.0, 0.3 * case.cutoff_hz, case.cutoff_hz, 0.45 * case.rate_hz] {
            let (sin, cos) = (-std::f64::consts::TAU * hz / case.rate_hz).sin_cos();
            // |c0 + c1 z + c2 z^2|^2 on the unit circle.
            let power = |c: &[f64]| {
                let re = c[0] + c[1] * cos + c[2] * (cos * cos - sin * sin);
                let im = c[1] * sin + c[2] * 2.0 * sin * cos;
                re * re + im * im
            };
            let want: f64 = case.sos.iter().map(|s| power(&s[..3]) / power(&s[3..])).product();
            assert!((filter.gain(hz) - want).abs() < 1e-12, "order {}, {hz} Hz", case.order);
        }
    }
}

#[derive(Deserialize)]
struct SignalReference {
    rate_hz: f64,
    input: Vec<f64>,
    low_pass: Vec<FiltfiltCase>,
}

#[derive(Deserialize)]
struct FiltfiltCase {
    order: usize,
    cutoff_hz: f64,
    filtfilt_padlen: usize,
    filtfilt: Vec<f64>,
}

#[test]
fn low_pass_agrees_with_scipy_filtfilt_edges_included() {
    let reference: SignalReference = serde_json::from_str(include_str!("../reference/signal.json")).unwrap();
    assert_eq!(reference.low_pass.len(), 7);
    let mut output = vec![0.0; reference.input.len()];
    for case in &reference.low_pass {
        let filter = ZeroPhaseLowPass::new(case.order, case.cutoff_hz, reference.rate_hz).unwrap();
        assert_eq!(filter.padding(), case.filtfilt_padlen);
        filter.apply(&reference.input, &mut output).unwrap();
        let error = relative_error(&output, &case.filtfilt);
        // One polynomial of fourth order instead of sections loses three digits in scipy.
        assert!(error < 1e-10, "order {}, cut-off {} Hz: off by {error:e}", case.order, case.cutoff_hz);
    }
}

#[derive(Deserialize)]
struct ButterworthReference {
    rate_hz: f64,
    cutoff_hz: f64,
    decimation: usize,
    q: Vec<f64>,
    tau: Vec<f64>,
    q_filtered: Vec<f64>,
    qd: Vec<f64>,
    qdd_inside: Vec<f64>,
    tau_rows: Vec<f64>,
    motion_hz: f64,
}

/// The usual way as a whole: positions filtered, central differences, torque filtered and decimated, and how the cut-off is chosen.
#[test]
fn the_usual_low_pass_agrees_with_filtfilt_and_central_differences() {
    let reference: ButterworthReference = serde_json::from_str(include_str!("../reference/butterworth.json")).unwrap();
    let ButterworthReference { rate_hz, cutoff_hz, decimation, .. } = reference;
    let samples = reference.q.len();
    let log = Recording {
        robot: String::new(),
        joints: vec!["slide".into()],
        time: (0..samples).map(|k| k as f64 / rate_hz).collect(),
        q: Channels::from_vectors(std::slice::from_ref(&reference.q)),
        qd: None,
        qdd: None,
        tau: Channels::from_vectors(std::slice::from_ref(&reference.tau)),
        truth: None,
        provenance: BTreeMap::new(),
    };
    let prepared = measured(&log, Smoothing::LowPass { cutoff_hz, decimation }, 0.03).unwrap();
    assert_eq!(position_cutoff_hz(cutoff_hz, rate_hz), 4.0 * cutoff_hz);
    for (got, want) in [
        (prepared.motion.q.channel(0), &reference.q_filtered[..]),
        (prepared.motion.qd.channel(0), &reference.qd),
        (&prepared.motion.qdd.channel(0)[1..samples - 1], &reference.qdd_inside),
        (&downsample(prepared.filtered_torque().unwrap().channel(0), decimation).unwrap(), &reference.tau_rows),
    ] {
        let error = relative_error(got, want);
        assert!(error < 1e-9, "off by {error:e}");
    }

    let found = bandwidth(&reference.q, rate_hz).unwrap().unwrap();
    assert!((found.hz / reference.motion_hz - 1.0).abs() < 1e-9, "{found:?}");
    // Eight times that for the positions; the log is too short to keep fewer rows.
    let usual = usual_low_pass(&[&log]).unwrap();
    let Smoothing::LowPass { cutoff_hz, decimation } = usual else { panic!("{usual:?}") };
    assert!((position_cutoff_hz(cutoff_hz, rate_hz) / (8.0 * reference.motion_hz) - 1.0).abs() < 1e-9, "{usual:?}");
    assert_eq!(decimation, 2);
    // Of ten such logs as few are kept as hold the torque's band.
    let Smoothing::LowPass { decimation, .. } = usual_low_pass(&[&log; 10]).unwrap() else { panic!("{usual:?}") };
    let half_rate = 0.5 * rate_hz / decimation as f64;
    assert!(0.8 * half_rate >= cutoff_hz && 0.7 * half_rate < cutoff_hz, "{decimation}, {usual:?}");
}
