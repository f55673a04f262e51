//! How close an identification came to the truth.

use crate::channels::Channels;

/// Distance of estimated from true parameters, d_beta = (2 / p) sum |beta - est| / (|beta| + |est|): 0 is perfect, 2 the
/// worst. Parameters that are zero in both count as right; zero to rounding, a share of 1e-9 of the largest true one, is
/// zero.
pub(crate) fn parameter_distance(truth: &[f64], estimate: &[f64]) -> f64 {
    let rounding = 1e-9 * truth.iter().fold(0.0f64, |most, b| most.max(b.abs()));
    let sum: f64 = truth
        .iter()
        .zip(estimate)
        .map(|(b, e)| {
            let size = b.abs() + e.abs();
            if size > rounding { (b - e).abs() / size } else { 0.0 }
        })
        .sum();
    2.0 * sum / truth.len() as f64
}

/// Relative error of each parameter, (estimate - truth) / |truth|; infinite for a true zero that is estimated otherwise.
pub(crate) fn relative_errors(truth: &[f64], estimate: &[f64]) -> Vec<f64> {
    truth.iter().zip(estimate).map(|(b, e)| if e == b { 0.0 } else { (e - b) / b.abs() }).collect()
}

/// Standard deviation of the torque error of each joint over the samples that count.
pub(crate) fn torque_std(predicted: &Channels, truth: &Channels, counts: impl Fn(usize) -> Vec<bool>) -> Vec<f64> {
    (0..truth.channels())
        .map(|joint| {
            let errors: Vec<f64> = predicted
                .channel(joint)
                .iter()
                .zip(truth.channel(joint))
                .zip(counts(joint))
                .filter(|(_, ok)| *ok)
                .map(|((p, t), _)| p - t)
                .collect();
            standard_deviation(&errors)
        })
        .collect()
}

/// Standard deviation about the mean.
pub(crate) fn standard_deviation(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_by_hand() {
        // |1-3|/4 = .5, |2-2| = 0, 0 and 0: 0; sum .5, times 2/3.
        assert!((parameter_distance(&[1.0, 2.0, 0.0], &[3.0, 2.0, 0.0]) - 1.0 / 3.0).abs() < 1e-15);
        assert_eq!(parameter_distance(&[1.0], &[-1.0]), 2.0);
        // A true zero found to rounding is found; one found otherwise is not.
        assert_eq!(parameter_distance(&[5.0, 0.0], &[5.0, 1e-13]), 0.0);
        assert_eq!(parameter_distance(&[5.0, 0.0], &[5.0, 1e-3]), 1.0);
    }

    #[test]
    fn torque_error_leaves_out_what_does_not_count_and_the_mean() {
        let truth = Channels::from_vectors(&[vec![0.0; 4]]);
        let predicted = Channels::from_vectors(&[vec![1.0, 3.0, 1.0, 99.0]]);
        let std = torque_std(&predicted, &truth, |_| vec![true, true, false, false]);
        assert_eq!(std, [1.0]);
    }

    #[test]
    fn relative_errors_have_a_sign() {
        assert_eq!(relative_errors(&[-2.0, 0.0], &[-1.0, 0.0]), [0.5, 0.0]);
    }
}
