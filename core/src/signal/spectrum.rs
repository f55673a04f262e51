//! Spectrum of a residual: where in frequency its power is.

use std::f64::consts::TAU;

/// Most samples in a segment, and fewest: shorter signals take the largest power of two that fits.
const LONGEST: usize = 256;
const SHORTEST: usize = 64;

/// Amplitude spectral density after Welch (1967): Hann windows over half-overlapping segments of 256 samples (fewer for a
/// shorter signal), each less its mean. Returns frequencies, Hz, and densities, unit of the signal per root Hz; nothing for a signal of
/// fewer than 64 samples. Samples that are not finite, as between two logs, must be replaced before.
pub fn amplitude_density(signal: &[f64], rate_hz: f64) -> (Vec<f64>, Vec<f64>) {
    if signal.len() < SHORTEST {
        return (Vec::new(), Vec::new());
    }
    let segment = LONGEST.min(1 << signal.len().ilog2());
    let window: Vec<f64> = (0..segment).map(|k| 0.5 - 0.5 * (TAU * k as f64 / segment as f64).cos()).collect();
    let power: f64 = window.iter().map(|w| w * w).sum();
    let turn: Vec<(f64, f64)> = (0..segment).map(|k| (TAU * k as f64 / segment as f64).sin_cos()).collect();
    let bins = segment / 2 + 1;
    let mut density = vec![0.0; bins];
    let starts: Vec<usize> = (0..(signal.len() + 1).saturating_sub(segment)).step_by(segment / 2).collect();
    for &start in &starts {
        let part = &signal[start..start + segment];
        let mean = part.iter().sum::<f64>() / segment as f64;
        for (bin, sum) in density.iter_mut().enumerate() {
            let (mut re, mut im) = (0.0, 0.0);
            for (k, (x, w)) in part.iter().zip(&window).enumerate() {
                let (sin, cos) = turn[bin * k % segment];
                re += (x - mean) * w * cos;
                im -= (x - mean) * w * sin;
            }
            // One-sided: all but the two ends stand for a negative frequency as well.
            let sides = if bin == 0 || bin == bins - 1 { 1.0 } else { 2.0 };
            *sum += sides * (re * re + im * im) / (power * rate_hz);
        }
    }
    let frequency = (0..bins).map(|bin| bin as f64 * rate_hz / segment as f64).collect();
    (frequency, density.into_iter().map(|sum| (sum / starts.len() as f64).sqrt()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(serde::Deserialize)]
    struct Reference {
        rate_hz: f64,
        signal: Vec<f64>,
        frequency: Vec<f64>,
        density: Vec<f64>,
    }

    #[test]
    fn agrees_with_scipy() {
        let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/reference/spectrum.json"));
        let reference: Reference = serde_json::from_str(&text.unwrap()).unwrap();
        let (frequency, density) = amplitude_density(&reference.signal, reference.rate_hz);
        assert_eq!(frequency, reference.frequency);
        for (own, scipy) in density.iter().zip(&reference.density) {
            assert!((own - scipy).abs() < 1e-12, "{own} {scipy}");
        }
    }

    #[test]
    fn too_short_has_none() {
        assert!(amplitude_density(&[1.0; 63], 50.0).0.is_empty());
        assert_eq!(amplitude_density(&[1.0; 200], 50.0).0.len(), 65);
        assert_eq!(amplitude_density(&[1.0; 256], 50.0).0.len(), 129);
    }
}
