//! Harmonics of a joint's position whose strength and phase wander: power at an order, window by window.

use super::column::Column;
use super::rows::Rows;
use super::score::log_survival;
use super::whitening::Whitener;

/// Orders that are tried, per turn, in steps that a motion of a few rad can tell.
const LAST_ORDER: f64 = 64.0;
const ORDER_STEP: f64 = 0.5;

/// Rows in a window (two and a half seconds).
const WINDOW: usize = 125;

/// Rows that must count in a window.
const FEWEST: usize = 25;

/// Share of a wave's norm that must be left beside a constant: below it the joint hardly moves in the window.
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
pub struct Spectrum {
    each: Vec<Power>,
    /// Mean square of a direction at the order in the middle: more than one where the noise is known badly.
    typical: f64,
    /// Sum of squares of the residual.
    all: f64,
}

/// The power at an order, as evidence.
#[derive(Debug, Clone, Copy)]
pub struct Harmonic {
    /// Waves per turn of the joint.
    pub order: f64,
    /// Share of the residual's sum of squares that it takes.
    pub share: f64,
    /// Logarithm of the probability of as much at this order.
    pub log_p: f64,
}

/// All orders that are tried.
fn orders() -> impl Iterator<Item = f64> {
    (0..).map(|k| 1.0 + ORDER_STEP * f64::from(k)).take_while(|order| *order <= LAST_ORDER)
}

impl Spectrum {
    /// That of `joint` in a whitened residual.
    pub fn new(rows: &Rows, whitener: &Whitener, residual: &Column, joint: usize) -> Self {
        let each: Vec<Power> = orders().filter_map(|order| power(rows, whitener, residual, joint, order)).collect();
        let mut sizes: Vec<f64> = each.iter().map(|power| power.statistic / power.freedom as f64).collect();
        sizes.sort_by(f64::total_cmp);
        let typical = sizes.get(sizes.len() / 2).copied().unwrap_or(1.0).max(1.0);
        Spectrum { each, typical, all: residual.only(&[joint]).dot(residual).max(f64::MIN_POSITIVE) }
    }

    /// The likeliest harmonic, its probability that of the best of all orders.
    pub fn strongest(&self) -> Option<Harmonic> {
        let each = self.each.iter().map(|power| self.evidence(power));
        let best = each.min_by(|a, b| a.log_p.total_cmp(&b.log_p))?;
        Some(Harmonic { log_p: (best.log_p + (self.each.len() as f64).ln()).min(0.0), ..best })
    }

    /// The harmonic of one of the orders.
    pub fn at(&self, order: f64) -> Option<Harmonic> {
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

/// The power at one order; None where the joint turns too little for it.
fn power(rows: &Rows, whitener: &Whitener, residual: &Column, joint: usize, order: f64) -> Option<Power> {
    let wave = |f: fn(f64) -> f64| {
        let signal = rows.signal(|log| log.motion.q.channel(joint).iter().map(|q| f(order * q)).collect());
        whitener.apply(&Column::on(joint, signal))
    };
    let waves = [whitener.apply(&Column::on(joint, vec![1.0; rows.len()])), wave(f64::cos), wave(f64::sin)];
    let [constant, cosine, sine] = waves.each_ref().map(|wave| wave.part(joint).unwrap_or_default());
    let residual = residual.part(joint)?;
    let places = whitener.places(joint);
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
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for (index, signal) in [constant, cosine, sine].into_iter().enumerate() {
            let mut rest = signal[window.clone()].to_vec();
            let norm = dot(&rest, &rest).sqrt();
            for direction in &basis {
                let along = dot(direction, &rest);
                rest.iter_mut().zip(direction).for_each(|(x, d)| *x -= along * d);
            }
            let left = dot(&rest, &rest).sqrt();
            if left <= SWINGS * norm || left.is_nan() {
                continue;
            }
            rest.iter_mut().for_each(|x| *x /= left);
            if index > 0 {
                statistic += dot(&rest, &residual[window.clone()]).powi(2);
                freedom += 1;
            }
            basis.push(rest);
        }
    }
    (freedom > 0).then_some(Power { order, statistic, freedom })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
