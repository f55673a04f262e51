//! Piecewise cubic interpolation at uneven steps.

/// Value at `t` between the samples `place` and `place + 1`, linear where a step around it is longer than `gap`.
pub(super) fn interpolate(time: &[f64], signal: &[f64], place: usize, t: f64, gap: f64) -> f64 {
    let (t0, t1, x0, x1) = (time[place], time[place + 1], signal[place], signal[place + 1]);
    let (width, s) = (t1 - t0, ((t - t0) / (t1 - t0)).clamp(0.0, 1.0));
    let outer = place > 0 && place + 2 < time.len();
    if width > gap || !outer || t0 - time[place - 1] > gap || time[place + 2] - t1 > gap {
        return x0 + s * (x1 - x0);
    }
    cubic(time, signal, [place - 1, place, place + 1, place + 2], t)
}

/// The same of a smooth signal, which goes on across gaps up to `longest` as its slopes on both sides have it. These are taken over half of
/// the gap's width at least: over a shorter step they are noise.
pub(super) fn across_gaps(time: &[f64], signal: &[f64], place: usize, t: f64, gap: f64, longest: f64) -> f64 {
    let (t0, t1) = (time[place], time[place + 1]);
    let width = t1 - t0;
    let short = |from: usize, to: usize| time[to] - time[from] <= gap;
    let outer = place > 0 && place + 2 < time.len();
    let is_regular = !outer || (width <= gap && short(place - 1, place) && short(place + 1, place + 2));
    if is_regular || width > longest {
        return interpolate(time, signal, place, t, gap);
    }
    let before = (0..place).rev().find(|&row| t0 - time[row] >= 0.5 * width);
    let after = (place + 2..time.len()).find(|&row| time[row] - t1 >= 0.5 * width);
    match before.zip(after) {
        Some((before, after)) if t0 - time[before] <= longest && time[after] - t1 <= longest => {
            cubic(time, signal, [before, place, place + 1, after], t)
        }
        _ => interpolate(time, signal, place, t, gap),
    }
}

/// The cubic between the second and the third of four samples, whose tangents are those of parabolas through three of them.
fn cubic(time: &[f64], signal: &[f64], [first, from, to, last]: [usize; 4], t: f64) -> f64 {
    let (t0, t1, x0, x1) = (time[from], time[to], signal[from], signal[to]);
    let (width, s) = (t1 - t0, ((t - t0) / (t1 - t0)).clamp(0.0, 1.0));
    let slope = (x1 - x0) / width;
    // Tangent at a sample: slopes of both sides, the nearer side weighing more (exact for parabolas).
    let tangent = |side: f64, side_width: f64| (slope * side_width + side * width) / (width + side_width);
    let (before, after) = (t0 - time[first], time[last] - t1);
    let d0 = width * tangent((x0 - signal[first]) / before, before);
    let d1 = width * tangent((signal[last] - x1) / after, after);
    let (s2, s3) = (s * s, s * s * s);
    (2.0 * s3 - 3.0 * s2 + 1.0) * x0 + (s3 - 2.0 * s2 + s) * d0 + (3.0 * s2 - 2.0 * s3) * x1 + (s3 - s2) * d1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows at 8 ms, and a gap of 30 ms after every third: a sine of 1 Hz bends by 4 mm of 1 m in it.
    #[test]
    fn a_smooth_signal_bends_across_gaps_and_a_long_one_is_a_line() {
        let mut time = vec![0.0];
        for row in 1..60 {
            time.push(time[row - 1] + if row % 4 == 0 { 0.030 } else { 0.008 });
        }
        let sine = |t: f64| (std::f64::consts::TAU * t).sin();
        let signal: Vec<f64> = time.iter().map(|&t| sine(t)).collect();
        let worst = |longest: f64| {
            let error = |place: usize| {
                let t = 0.5 * (time[place] + time[place + 1]);
                (across_gaps(&time, &signal, place, t, 0.02, longest) - sine(t)).abs()
            };
            (8..50).map(error).fold(0.0, f64::max)
        };
        assert!(worst(0.05) < 3e-4, "{}", worst(0.05));
        // The error of a line is the eighth of the square of 2 pi 0.03.
        assert!((worst(0.025) - 4.4e-3).abs() < 2e-4, "{}", worst(0.025));
    }
}
