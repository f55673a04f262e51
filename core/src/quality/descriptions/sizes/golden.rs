//! The least value of a function of one number.

/// The place between two others at which `value`, which has one valley there, is least, by so many golden sections.
pub(in crate::quality::descriptions) fn golden(
    mut low: f64,
    mut high: f64,
    sections: usize,
    value: impl Fn(f64) -> f64,
) -> f64 {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let mut inner = [high - golden * (high - low), low + golden * (high - low)];
    let mut values = inner.map(&value);
    for _ in 0..sections {
        if values[0] < values[1] {
            high = inner[1];
            inner = [high - golden * (high - low), inner[0]];
            values = [value(inner[0]), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + golden * (high - low)];
            values = [values[1], value(inner[1])];
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::golden;

    #[test]
    fn the_valley_is_found() {
        for at in [-2.9, 0.0, 0.3, 2.9] {
            let found = golden(-3.0, 3.0, 15, |x| (x - at).powi(2));
            assert!((found - at).abs() < 0.01, "{found} {at}");
        }
    }
}
