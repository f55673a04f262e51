//! Hat functions: the basis of piecewise linear functions.

/// Piecewise linear function of `x`, one at `knots[own]` and zero at the other knots, which ascend; constant beyond the ends.
pub(crate) fn hat(knots: &[f64], own: usize, x: f64) -> f64 {
    let x = x.clamp(knots[0], knots[knots.len() - 1]);
    let rise = |from: f64, to: f64| if to > from { (x - from) / (to - from) } else { f64::from(x >= to) };
    if own > 0 && x < knots[own] {
        return rise(knots[own - 1], knots[own]).max(0.0);
    }
    match knots.get(own + 1) {
        Some(&next) if x > knots[own] => (1.0 - rise(knots[own], next)).max(0.0),
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_are_a_partition_of_unity() {
        let knots = [-1.0, -0.2, 0.1, 2.0];
        for x in [-3.0, -1.0, -0.7, 0.0, 0.1, 1.9, 2.0, 5.0] {
            let sum: f64 = (0..knots.len()).map(|k| hat(&knots, k, x)).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{x}: {sum}");
        }
    }
}
