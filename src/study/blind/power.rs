//! How often what is hidden could be named at all: the power of a test that knows the noise, the law, its shape and its sign, and
//! only not which of all effects and joints it is.
//!
//! A diagnosis knows none of these, so that no test which treats all effects and joints alike names more. The difference shows what
//! better statistics could gain, and what only longer logs would.

use super::case::{Case, visible};
use super::sizing::{references, session};
use crate::effects::Placed;
use crate::error::Result;
use crate::excitation::Motion;
use crate::identification::model::Model;
use crate::internal::diagnosis::{Column, DataSet, Session, Whitener, places};
use crate::internal::identification::AutoregressiveNoise;
use crate::recording::Recording;
use crate::scenario::Setup;
use crate::simulation::sensors::JointSensors;
use statrs::distribution::{ContinuousCDF, Normal};

/// Family-wise level of the test.
const LEVEL: f64 = 0.05;

/// Lags of the noise of the rows that are matched: means over blocks of a first-order autoregression are one with a moving average.
const LAGS: usize = 6;

/// Probability that what is hidden along `motions`, held-out ones too, exceeds what a level of 5 % among all places of all effects
/// needs. What play does within a few milliseconds is not in the rows.
///
/// # Errors
/// If a log is too short.
pub fn power(setup: &Setup, placed: &Placed, case: &Case, motions: &[Motion]) -> Result<f64> {
    let model = Model::new(&setup.known);
    let logs = references(setup, case, motions);
    let session = session(setup, &model, &logs, case)?;
    let rows = &session.logs.train.rows;
    let added = session.model.arm.added(std::slice::from_ref(placed), rows)?.swap_remove(0);
    let noises = setup.sensors.iter().map(|sensor| of_rows(sensor, rows.logs[0].period, rows.logs[0].block)).collect();
    Ok(in_noise(&session, &Whitener::of_known(rows, noises), &added, case))
}

/// The same for a test that has the measured positions of `logs`, smooth enough to serve the torque, and knows the noise that
/// is in the rows then; all that is `hidden` in the logs is known to it.
///
/// # Errors
/// If a log is too short.
pub fn power_as_measured(setup: &Setup, hidden: &[Placed], case: &Case, logs: &[Recording]) -> Result<Vec<f64>> {
    let model = Model::new(&setup.known);
    let session = session(setup, &model, logs, case)?;
    let DataSet { rows, baseline, torque, .. } = &session.logs.train;
    let added = session.model.arm.added(hidden, rows)?;
    let mut noise = torque.clone();
    added.iter().for_each(|added| noise.add(-1.0, added));
    let whitener = Whitener::new(rows, &noise, baseline);
    Ok(added.iter().map(|added| in_noise(&session, &whitener, added, case)).collect())
}

/// Probability that a torque on top of the baseline is seen in noise that `whitener` makes white.
fn in_noise(session: &Session, whitener: &Whitener, added: &Column, case: &Case) -> f64 {
    let noncentrality = whitener.fit(&session.logs.train.baseline, added).left();
    let tests: usize = visible(case.trust).iter().map(|effect| places(*effect, session.model.base.robot()).len()).sum();
    tracing::debug!(noncentrality, tests, new = ?whitener.innovation_std(), rows = ?whitener.rows(), "power");
    of(noncentrality, tests)
}

/// Power of a one-sided test of a normal deviate with a mean square of `noncentrality`, at the level among so many tests.
fn of(noncentrality: f64, tests: usize) -> f64 {
    let normal = Normal::standard();
    normal.cdf(noncentrality.max(0.0).sqrt() - normal.inverse_cdf(1.0 - LEVEL / tests.max(1) as f64))
}

/// Noise of a joint's torque as means over blocks of samples.
fn of_rows(sensor: &JointSensors, period_s: f64, block: usize) -> AutoregressiveNoise {
    let memory = |samples: f64| match sensor.torque_correlation_s > 0.0 {
        true => (-samples * period_s / sensor.torque_correlation_s).exp(),
        false => f64::from(samples == 0.0),
    };
    let within = |lag: usize| -> f64 {
        let pairs = (0..block).flat_map(|i| (0..block).map(move |j| (lag * block + i).abs_diff(j) as f64));
        pairs.map(memory).sum::<f64>() / (block * block) as f64
    };
    let covariance: Vec<f64> = (0..=LAGS).map(|lag| sensor.torque_noise.powi(2) * within(lag)).collect();
    AutoregressiveNoise::from_autocovariance(&covariance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::random;
    use crate::simulation::sensors::torque;

    #[test]
    fn power_of_a_normal_deviate() {
        // 2.5758 is the 99.5 % point: 5 % among ten tests.
        assert!((of(2.575_829_3f64.powi(2), 10) - 0.5).abs() < 1e-6);
        assert!((of((2.575_829_3f64 + 1.644_853_6).powi(2), 10) - 0.95).abs() < 1e-6);
        assert!((of(0.0, 1) - 0.05).abs() < 1e-9);
    }

    #[test]
    fn noise_of_rows_is_that_of_the_sensor_in_means() {
        for correlation in [0.0, 0.13] {
            let sensor = JointSensors { torque_noise: 2.0, torque_correlation_s: correlation, ..Default::default() };
            let noise = of_rows(&sensor, 0.002, 10);
            let made = torque(&Channels::zeros(1, 400_000), &[sensor], 0.002, 1, 0);
            let means: Vec<f64> = made.channel(0).chunks(10).map(|block| block.iter().sum::<f64>() / 10.0).collect();
            let next =
                |lag: usize| means.iter().zip(&means[lag..]).map(|(a, b)| a * b).sum::<f64>() / means.len() as f64;
            assert!(
                (noise.std() / next(0).sqrt() - 1.0).abs() < 0.05,
                "{correlation}: {} against {}",
                noise.std(),
                next(0)
            );
            let simulated = noise.simulate(40_000, &mut random::stream(2, "means", 0));
            let of_model = simulated.iter().zip(&simulated[1..]).map(|(a, b)| a * b).sum::<f64>() / 40_000.0;
            assert!((of_model - next(1)).abs() < 0.1 * next(0), "{correlation}");
        }
    }
}
