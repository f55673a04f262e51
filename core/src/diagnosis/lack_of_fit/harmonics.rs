//! Harmonics of a joint's position whose strength and phase wander: power at an order, window by window.

use crate::diagnosis::logs::Rows;
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, log_survival};
use crate::linear::{OrthonormalBasis, inner_product};
use nalgebra::Complex;

/// Orders that are tried, per turn, in steps that a motion of a few rad resolves.
const FIRST_ORDER: f64 = 1.0;
const LAST_ORDER: f64 = 64.0;
const ORDER_STEP: f64 = 0.5;

/// Rows in a window (two and a half seconds).
const WINDOW: usize = 125;

/// Rows that must count in a window.
const FEWEST: usize = 25;

/// Share of a wave's norm that must remain orthogonal to a constant: below it the joint hardly moves in the window.
const SWINGS: f64 = 0.5;

/// Power at one order.
#[derive(Debug, Clone, Copy)]
struct Power {
    order: f64,
    statistic: f64,
    freedom: usize,
}

/// Power of a joint's residual at all orders.
#[derive(Debug)]
pub(super) struct Spectrum {
    each: Vec<Power>,
    /// Mean square of a direction at the order in the middle: more than one where the noise is known badly.
    typical: f64,
    /// Sum of squares of the residual.
    all: f64,
}

/// The power at an order, as evidence.
#[derive(Debug, Clone, Copy)]
pub(super) struct Harmonic {
    /// Waves per turn of the joint.
    pub order: f64,
    /// Share of the residual's sum of squares that it takes.
    pub share: f64,
    /// Logarithm of the probability of as much at this order.
    pub log_p: f64,
}

/// All orders that are tried.
fn orders() -> impl Iterator<Item = f64> {
    (0..).map(|k| FIRST_ORDER + ORDER_STEP * f64::from(k)).take_while(|order| *order <= LAST_ORDER)
}

/// Waves of a joint's position at one order after the other, `[log][time]`: each is the one before turned on, since a sine of every sample
/// at every order takes longer than all else of the test.
struct Waves {
    now: Vec<Vec<Complex<f64>>>,
    step: Vec<Vec<Complex<f64>>>,
}

impl Waves {
    /// Those of the first order.
    fn new(rows: &Rows, joint: usize) -> Self {
        let at = |order: f64| -> Vec<Vec<Complex<f64>>> {
            let wave = |q: &f64| Complex::cis(order * q);
            rows.logs.iter().map(|log| log.motion.q.channel(joint).iter().map(wave).collect()).collect()
        };
        Waves { now: at(FIRST_ORDER), step: at(ORDER_STEP) }
    }

    /// Goes on to the next order.
    fn advance(&mut self) {
        for (now, step) in self.now.iter_mut().flatten().zip(self.step.iter().flatten()) {
            *now *= step;
        }
    }

    /// One part of them over the rows.
    fn over(&self, rows: &Rows, part: fn(&Complex<f64>) -> f64) -> Vec<f64> {
        let logs = rows.logs.iter().zip(&self.now);
        logs.flat_map(|(log, now)| log.as_logged(&now.iter().map(part).collect::<Vec<f64>>())).collect()
    }
}

impl Spectrum {
    /// That of `joint` in a whitened residual.
    pub(super) fn new(rows: &Rows, whitener: &Whitener, residual: &Column, joint: usize) -> Self {
        let whitened = |signal| {
            let parts = whitener.apply(&Column::on(joint, signal)).parts;
            parts.into_iter().next().map(|(_, values)| values).unwrap_or_default()
        };
        let constant = whitened(vec![1.0; rows.len()]);
        let mut waves = Waves::new(rows, joint);
        let mut each = Vec::new();
        for order in orders() {
            let signals = [whitened(waves.over(rows, |wave| wave.re)), whitened(waves.over(rows, |wave| wave.im))];
            each.extend(power(
                rows,
                whitener.places(joint),
                residual.part(joint),
                [&constant, &signals[0], &signals[1]],
                order,
            ));
            waves.advance();
        }
        let mut sizes: Vec<f64> = each.iter().map(|power| power.statistic / power.freedom as f64).collect();
        sizes.sort_by(f64::total_cmp);
        let typical = sizes.get(sizes.len() / 2).copied().unwrap_or(1.0).max(1.0);
        Spectrum { each, typical, all: residual.only(&[joint]).dot(residual).max(f64::MIN_POSITIVE) }
    }

    /// The likeliest harmonic, its probability that of the best of all orders.
    pub(super) fn strongest(&self) -> Option<Harmonic> {
        let each = self.each.iter().map(|power| self.evidence(power));
        let best = each.min_by(|a, b| a.log_p.total_cmp(&b.log_p))?;
        Some(Harmonic { log_p: (best.log_p + (self.each.len() as f64).ln()).min(0.0), ..best })
    }

    /// The harmonic of one of the orders.
    pub(super) fn at(&self, order: f64) -> Option<Harmonic> {
        self.each.iter().find(|power| power.order == order).map(|power| self.evidence(power))
    }

    fn evidence(&self, power: &Power) -> Harmonic {
        Harmonic {
            order: power.order,
            share: (power.statistic / self.all).min(1.0),
            log_p: log_survival(power.statistic / self.typical, power.freedom),
        }
    }
}

/// The power at one order in the residual of a joint at `places` of the rows, by a constant, the cosine and the sine there, all whitened;
/// None where the joint turns too little for it.
fn power(rows: &Rows, places: &[usize], residual: Option<&[f64]>, signals: [&[f64]; 3], order: f64) -> Option<Power> {
    let residual = residual?;
    let (mut statistic, mut freedom) = (0.0, 0);
    let mut first = 0;
    while first < places.len() {
        let log = rows.starts.partition_point(|start| *start <= places[first]);
        let end = (places[first] + WINDOW).min(rows.starts.get(log).copied().unwrap_or(usize::MAX));
        let last = first + places[first..].partition_point(|place| *place < end);
        let window = first..last;
        first = last;
        if window.len() < FEWEST {
            continue;
        }
        let basis = OrthonormalBasis::new(&signals.map(|signal| &signal[window.clone()]), SWINGS);
        // The first signal is the constant, which is adjusted for.
        let waves = basis.kept.iter().zip(&basis.directions).filter(|(signal, _)| **signal > 0);
        for (_, wave) in waves {
            statistic += inner_product(wave, &residual[window.clone()]).powi(2);
            freedom += 1;
        }
    }
    (freedom > 0).then_some(Power { order, statistic, freedom })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::diagnosis::logs::FEWEST_ROWS;
    use crate::random;
    use crate::recording::Recording;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    /// A joint that swings for forty seconds under white noise and a harmonic that swells and fades.
    fn spectrum(size: f64) -> Spectrum {
        let mut source = random::stream(8, "harmonics", 0);
        let time: Vec<f64> = (0..20_000).map(|k| f64::from(k) / 500.0).collect();
        let q: Vec<f64> = time.iter().map(|t| 1.2 * (TAU * 0.23 * t).sin() + 0.4 * (TAU * 0.31 * t).cos()).collect();
        let torque = |(t, q): (&f64, &f64)| {
            let noise: f64 = StandardNormal.sample(&mut source);
            noise + size * (TAU * t / 7.0).cos() * (17.0 * q).cos()
        };
        let tau = time.iter().zip(&q).map(torque).collect();
        let (q, tau) = (Channels::from_vectors(&[q]), Channels::from_vectors(&[tau]));
        let log = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        let rows = Rows::new(&[&log], 10.0, FEWEST_ROWS).unwrap();
        let torque = Column::new(rows.torque.iter().cloned());
        let whitener = Whitener::new(&rows, &torque, &[]);
        Spectrum::new(&rows, &whitener, &whitener.apply(&torque), 0)
    }

    #[test]
    fn a_harmonic_that_comes_and_goes_is_found_at_its_order() {
        let found = spectrum(0.5).strongest().unwrap();
        assert!((found.order - 17.0).abs() <= 0.5 && found.log_p < 1e-6f64.ln(), "{found:?}");
        assert!(spectrum(0.5).at(17.0).unwrap().log_p < 1e-6f64.ln());
        let nothing = spectrum(0.0).strongest().unwrap();
        assert!(nothing.log_p > 1e-3f64.ln(), "{nothing:?}");
    }
}
