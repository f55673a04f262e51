//! Piecewise cubic interpolation at uneven steps.

/// Value at `t` between the samples `place` and `place + 1`, linear where a step around it is longer than `gap`.
pub(super) fn interpolate(time: &[f64], signal: &[f64], place: usize, t: f64, gap: f64) -> f64 {
    let (t0, t1, x0, x1) = (time[place], time[place + 1], signal[place], signal[place + 1]);
    let (width, s) = (t1 - t0, ((t - t0) / (t1 - t0)).clamp(0.0, 1.0));
    let outer = place > 0 && place + 2 < time.len();
    if width > gap || !outer || t0 - time[place - 1] > gap || time[place + 2] - t1 > gap {
        return x0 + s * (x1 - x0);
    }
    let slope = (x1 - x0) / width;
    // Tangent at a sample: slopes of both sides, the nearer side weighing more (exact for parabolas).
    let tangent = |side: f64, side_width: f64| (slope * side_width + side * width) / (width + side_width);
    let (before, after) = (t0 - time[place - 1], time[place + 2] - t1);
    let d0 = width * tangent((x0 - signal[place - 1]) / before, before);
    let d1 = width * tangent((signal[place + 2] - x1) / after, after);
    let (s2, s3) = (s * s, s * s * s);
    (2.0 * s3 - 3.0 * s2 + 1.0) * x0 + (s3 - 2.0 * s2 + s) * d0 + (3.0 * s2 - 2.0 * s3) * x1 + (s3 - s2) * d1
}
