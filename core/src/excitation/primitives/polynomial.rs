//! Polynomials on the unit interval, coefficients in ascending order: derivatives and real roots.

/// Value of the polynomial at `s` (Horner).
pub(super) fn value(coefficients: &[f64], s: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * s + c)
}

/// Coefficients of the derivative.
pub(super) fn derivative(coefficients: &[f64]) -> Vec<f64> {
    coefficients.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect()
}

/// The roots in [0, 1] where the polynomial changes sign, ascending. Roots where it only touches zero may be among them.
///
/// Between neighbouring roots of the derivative a polynomial is monotone and has at most one root, which bisection
/// finds to the last bit; the derivative's roots come from the same rule.
pub(super) fn sign_changes(coefficients: &[f64]) -> Vec<f64> {
    if coefficients.len() < 2 {
        return Vec::new();
    }
    let mut bounds = vec![0.0];
    bounds.extend(sign_changes(&derivative(coefficients)));
    bounds.push(1.0);
    bounds.windows(2).filter_map(|pair| bisect(coefficients, pair[0], pair[1])).collect()
}

/// The root of a polynomial that is monotone on [low, high], if it changes sign there.
fn bisect(coefficients: &[f64], mut low: f64, mut high: f64) -> Option<f64> {
    let positive_at_low = value(coefficients, low) > 0.0;
    if positive_at_low == (value(coefficients, high) > 0.0) {
        return None;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return Some(high);
        }
        if (value(coefficients, middle) > 0.0) == positive_at_low {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn value_and_derivative_of_a_cubic() {
        let cubic = [1.0, -2.0, 0.5, 3.0];
        assert_eq!(value(&cubic, 2.0), 23.0);
        assert_eq!(derivative(&cubic), [-2.0, 1.0, 9.0]);
    }

    #[test]
    fn polynomials_that_keep_their_sign_have_none() {
        assert!(sign_changes(&[0.3, -1.0, 1.0]).is_empty());
        assert!(sign_changes(&[0.0, 0.0, 0.0]).is_empty());
        assert!(sign_changes(&[2.0]).is_empty());
    }

    proptest! {
        #[test]
        fn roots_of_a_product_of_linear_factors_are_found(
            mut gaps in prop::collection::vec(0.05_f64..1.0, 5),
            lead in 0.1_f64..10.0,
        ) {
            let total: f64 = gaps.iter().sum();
            gaps.pop();
            let mut position = 0.0;
            let roots: Vec<f64> = gaps.iter().map(|gap| { position += gap / total; position }).collect();
            let mut coefficients = vec![lead];
            for root in &roots {
                let mut next = vec![0.0; coefficients.len() + 1];
                for (k, c) in coefficients.iter().enumerate() {
                    next[k] -= root * c;
                    next[k + 1] += c;
                }
                coefficients = next;
            }
            let found = sign_changes(&coefficients);
            prop_assert_eq!(found.len(), roots.len());
            for (f, r) in found.iter().zip(&roots) {
                prop_assert!((f - r).abs() < 1e-9, "{} against {}", f, r);
            }
        }
    }
}
