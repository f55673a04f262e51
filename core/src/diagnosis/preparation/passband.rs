//! The low-pass that torque went through before it was logged.
//!
//! Many controllers and many who publish logs smooth the torque. A step of friction at a reversal is then spread over the
//! memory of that filter and rings, which no column of the model does: the residual looks like any friction law. All columns
//! must go through the filter that the torque went through. The logs determine which: zero-phase Butterworth filters are tried,
//! and the one with the smallest residual is taken.

use crate::diagnosis::logs::{LowPass, Rows, inner_power};
use crate::diagnosis::regression::{Column, gram, rms, solve_normal};
use crate::error::Result;
use crate::recording::Recording;
use crate::signal::ZeroPhaseLowPass;
use nalgebra::{DMatrix, DVector};

/// Factor by which the power of the torque must fall from one octave to the next, on every joint, for filters to be tried there: steps of
/// friction fall by two, a motion without friction or noise by more. Whether one is taken is decided by the residual ([`best`]).
const FALL: f64 = 1e3;

/// Lowest frequency that is looked at, and highest as a share of the rate.
const LOWEST_HZ: f64 = 0.5;
const HIGHEST_SHARE: f64 = 0.4;

/// Order of the filters that split the torque into octaves.
const SPLIT_ORDER: usize = 6;

/// Cut-offs that are tried on either side of where the power falls, octaves, and the step between them.
const REACH_OCTAVES: f64 = 1.0;
const STEP_OCTAVES: f64 = 0.25;

/// Halvings of that step around the best.
const HALVINGS: usize = 3;

/// Orders (of one run) that are tried, the most usual first.
const ORDERS: [usize; 6] = [4, 2, 1, 3, 5, 6];

/// Rounds of weighting the joints by their residual.
const ROUNDS: usize = 3;

/// The frequency, Hz, within an octave of which the torque of all joints of all logs ends as no step of friction does; None where it goes
/// on, or where there is noise above it.
///
/// # Errors
/// If a log is too short for the filters.
pub(super) fn edge(recordings: &[&Recording]) -> Result<Option<f64>> {
    let mut edges = Vec::new();
    for recording in recordings {
        // A joint without torque gives no evidence on the filter of the others.
        let logged = |joint: &usize| recording.tau.channel(*joint).iter().any(|torque| torque.is_finite());
        for joint in (0..recording.joints()).filter(logged) {
            match edge_of(recording.tau.channel(joint), recording.rate_hz())? {
                Some(hz) => edges.push(hz),
                None => return Ok(None),
            }
        }
    }
    edges.sort_by(f64::total_cmp);
    Ok(edges.get(edges.len() / 2).copied())
}

fn edge_of(torque: &[f64], rate_hz: f64) -> Result<Option<f64>> {
    if !torque.iter().all(|value| value.is_finite()) {
        return Ok(None);
    }
    let octaves = (0..).map(|k| LOWEST_HZ * f64::from(1 << k)).take_while(|hz| *hz < HIGHEST_SHARE * rate_hz);
    let edges: Vec<f64> = octaves.collect();
    let mut passed = Vec::with_capacity(edges.len());
    for &hz in &edges {
        let mut out = vec![0.0; torque.len()];
        ZeroPhaseLowPass::new(SPLIT_ORDER, hz, rate_hz)?.apply(torque, &mut out)?;
        passed.push(out);
    }
    let powers: Vec<f64> = passed
        .windows(2)
        .map(|pair| {
            let inside: Vec<f64> = pair[1].iter().zip(&pair[0]).map(|(wide, narrow)| wide - narrow).collect();
            inner_power(&inside, rate_hz)
        })
        .collect();
    // Beyond the first fall there is nothing but rounding, which may fall as steeply.
    let first = powers.windows(2).position(|pair| pair[0] > FALL * pair[1]);
    Ok(first.map(|octave| edges[octave]))
}

/// The lowest cut-off that is tried for an edge, Hz.
pub(super) fn lowest(edge_hz: f64) -> f64 {
    edge_hz * (-REACH_OCTAVES).exp2()
}

/// Mean over the joints of the logarithm of the residual of `torque` under `columns`, fitted at once to all joints with each joint's
/// torque in units of its own residual.
pub(super) fn left(rows: &Rows, torque: &Column, columns: &[Column]) -> f64 {
    let columns: Vec<Column> = columns.iter().map(|column| column.masked(&rows.valid)).collect();
    let torque = torque.masked(&rows.valid);
    // The rounds differ in the joints' weights alone.
    let of_joint = |joint: usize| {
        let own: Vec<Column> = columns.iter().map(|column| column.only(&[joint])).collect();
        let torque = torque.only(&[joint]);
        let right = DVector::from_iterator(own.len(), own.iter().map(|column| column.dot(&torque)));
        (gram(&own), right, torque.dot(&torque))
    };
    let products: Vec<_> = (0..rows.dof()).map(of_joint).collect();
    let mut scale = rms(&rows.valid, &torque);
    for _ in 0..ROUNDS {
        let (mut normal, mut right) = (DMatrix::zeros(columns.len(), columns.len()), DVector::zeros(columns.len()));
        for ((own, along, _), unit) in products.iter().zip(&scale) {
            let weight = unit.max(f64::MIN_POSITIVE.sqrt()).powi(-2);
            normal += own * weight;
            right += along * weight;
        }
        let values = DVector::from_vec(solve_normal(normal, right).values);
        for ((scale, (own, along, square)), valid) in scale.iter_mut().zip(&products).zip(&rows.valid) {
            let left = (square - 2.0 * values.dot(along) + values.dot(&(own * &values))).max(0.0);
            *scale = (left / valid.iter().filter(|ok| **ok).count().max(1) as f64).sqrt();
        }
    }
    scale.iter().map(|scale| scale.max(f64::MIN_POSITIVE).ln()).sum::<f64>() / scale.len() as f64
}

/// The filter with the smallest residual, if that is smaller by the share `clearly` than without any. `left` gives the mean over the joints
/// of the logarithm of the residual; None where the filter cannot be.
pub(super) fn best(
    edge_hz: f64,
    clearly: f64,
    mut left: impl FnMut(Option<LowPass>) -> Option<f64>,
) -> Option<LowPass> {
    let without = left(None)?;
    let mut least: Option<(f64, LowPass)> = None;
    let mut try_one = |low_pass: LowPass, least: &mut Option<(f64, LowPass)>| {
        if let Some(value) = left(Some(low_pass))
            && least.as_ref().is_none_or(|(before, _)| value < *before)
        {
            *least = Some((value, low_pass));
        }
    };
    let steps = (REACH_OCTAVES / STEP_OCTAVES) as i32;
    for step in -steps..=steps {
        let hz = edge_hz * (f64::from(step) * STEP_OCTAVES).exp2();
        try_one(LowPass { order: ORDERS[0], hz }, &mut least);
    }
    let mut octaves = STEP_OCTAVES;
    for _ in 0..HALVINGS {
        octaves *= 0.5;
        let (_, middle) = least?;
        for shift in [-octaves, octaves] {
            try_one(LowPass { hz: middle.hz * shift.exp2(), ..middle }, &mut least);
        }
    }
    let (_, of_usual_order) = least?;
    for &order in &ORDERS[1..] {
        // A steeper filter that passes as much cuts off a little higher or lower.
        for shift in [-octaves, 0.0, octaves] {
            try_one(LowPass { order, hz: of_usual_order.hz * shift.exp2() }, &mut least);
        }
    }
    let (value, low_pass) = least?;
    tracing::debug!(?low_pass, left = value, without, "low-pass of the logged torque");
    (value < without + (-clearly).ln_1p()).then_some(low_pass)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    const RATE: f64 = 200.0;

    /// Torque of a joint with friction that swings, under white noise.
    fn torque(noise: f64) -> Vec<f64> {
        let mut source = random::stream(4, "passband", 0);
        (0..6000)
            .map(|k| {
                let t = f64::from(k) / RATE;
                let v = (TAU * 0.31 * t).cos() + 0.6 * (TAU * 0.47 * t).sin();
                let drawn: f64 = StandardNormal.sample(&mut source);
                20.0 * (TAU * 0.2 * t).sin() + 3.0 * v + 5.0 * v.signum() + noise * drawn
            })
            .collect()
    }

    fn filtered(low_pass: LowPass, signal: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; signal.len()];
        low_pass.at_rate(RATE).unwrap().apply(signal, &mut out).unwrap();
        out
    }

    #[test]
    fn torque_as_it_is_has_no_edge_and_filtered_torque_has_one() {
        assert_eq!(edge_of(&torque(0.0), RATE).unwrap(), None);
        assert_eq!(edge_of(&torque(0.5), RATE).unwrap(), None);
        let low_pass = LowPass { order: 4, hz: 2.7 };
        let found = edge_of(&filtered(low_pass, &torque(0.5)), RATE).unwrap().unwrap();
        assert!((1.0..8.0).contains(&found), "{found}");
        // Noise that was added after the filter shows that torque is logged as it is read.
        let noisy: Vec<f64> = filtered(low_pass, &torque(0.0))
            .iter()
            .zip(torque(0.5))
            .zip(torque(0.0))
            .map(|((f, n), c)| f + n - c)
            .collect();
        assert_eq!(edge_of(&noisy, RATE).unwrap(), None);
    }

    #[test]
    fn the_filter_is_found_by_what_it_leaves() {
        let truth = LowPass { order: 5, hz: 1.83 };
        let plain = torque(0.0);
        let logged = filtered(truth, &plain);
        let left = |low_pass: Option<LowPass>| {
            let model = low_pass.map_or_else(|| plain.clone(), |low_pass| filtered(low_pass, &plain));
            let inner = 600..5400;
            let sum: f64 = inner.clone().map(|k| (model[k] - logged[k]).powi(2)).sum();
            Some(0.5 * (sum / inner.len() as f64).ln())
        };
        let found = best(edge_of(&logged, RATE).unwrap().unwrap(), 0.05, left).unwrap();
        assert!(found.order == 5 && (found.hz / truth.hz - 1.0).abs() < 0.03, "{found:?}");
        assert_eq!(best(2.0, 0.05, |_| Some(1.0)), None);
    }
}
