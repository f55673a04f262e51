//! Quantiles of the sizes of samples.

/// The value below which a share of all sizes lies; zero without values.
pub(crate) fn size_quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut sizes: Vec<f64> = values.map(f64::abs).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let place = ((sizes.len() - 1) as f64 * share) as usize;
    *sizes.select_nth_unstable_by(place, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::size_quantile;

    #[test]
    fn the_size_that_a_share_does_not_exceed() {
        let of = |values: &[f64], share: f64| size_quantile(values.iter().copied(), share);
        assert_eq!(
            [of(&[3.0, -1.0, 2.0], 0.5), of(&[-4.0, 1.0], 1.0), of(&[2.0], 0.9), of(&[], 0.5)],
            [2.0, 4.0, 2.0, 0.0]
        );
    }
}
