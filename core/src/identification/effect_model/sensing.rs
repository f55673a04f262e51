//! What the torque sensors of one joint make of torque.

use crate::effects::{Placed, Role};

/// Size of the small signal that separates linear sensors from clipping ones, N m.
const SMALL: f64 = 1e-6;

/// Share of the largest torque by which a log must miss the linear response to count as clipped.
const CLIPPED: f64 = 1e-6;

/// The effects in the torque sensor of one joint, in the order in which they act.
pub(super) struct Sensing<'a> {
    sensors: Vec<&'a Placed>,
    period: f64,
}

impl<'a> Sensing<'a> {
    pub(super) fn new(sensors: Vec<&'a Placed>, period: f64) -> Self {
        Sensing { sensors, period }
    }

    /// Whether there are any.
    pub(super) fn acts(&self) -> bool {
        !self.sensors.is_empty()
    }

    /// A torque as it would be logged, with the parameters that `of` gives each sensor.
    fn logged(&self, torque: &[f64], of: impl Fn(&Placed) -> Vec<f64>) -> Vec<f64> {
        let mut logged = torque.to_vec();
        for placed in &self.sensors {
            placed.effect.distort_torque(&of(placed), &mut logged, self.period);
        }
        logged
    }

    /// The linear part of what the sensors do: their response to a signal too small to be clipped.
    pub(super) fn small_signal(&self, signal: &[f64]) -> Vec<f64> {
        let largest = signal.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        if !self.acts() || largest == 0.0 {
            return signal.to_vec();
        }
        let scale = SMALL / largest;
        let small: Vec<f64> = signal.iter().map(|v| v * scale).collect();
        self.logged(&small, without_amplitudes).iter().map(|v| v / scale).collect()
    }

    /// Logged torque per unit of an amplitude of `placed`; None unless it is one of these sensors.
    pub(super) fn amplitude(&self, placed: &Placed, k: usize, samples: usize) -> Option<Vec<f64>> {
        self.sensors.iter().find(|other| std::ptr::eq(**other, placed))?;
        let mut unit = without_amplitudes(placed);
        unit[k] = 1.0;
        let mut column = vec![0.0; samples];
        placed.effect.distort_torque(&unit, &mut column, self.period);
        Some(column)
    }

    /// Where the predicted torque `total` is clipped, the log holds nothing on the parameters: the known torque becomes
    /// what is logged there, and the columns vanish.
    pub(super) fn clip(&self, total: &[f64], known: &mut [f64], columns: &mut [(usize, Vec<f64>)]) {
        let linear = self.small_signal(total);
        let logged = self.logged(total, without_amplitudes);
        let largest = linear.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        for sample in 0..total.len() {
            if (logged[sample] - linear[sample]).abs() > CLIPPED * largest {
                known[sample] = logged[sample];
                columns.iter_mut().for_each(|(_, column)| column[sample] = 0.0);
            }
        }
    }
}

/// Parameters of an effect with its amplitudes at zero.
pub(super) fn without_amplitudes(placed: &Placed) -> Vec<f64> {
    let parameters = placed.effect.parameters().iter().zip(&placed.parameters);
    parameters.map(|(p, &value)| if p.role == Role::Amplitude { 0.0 } else { value }).collect()
}
