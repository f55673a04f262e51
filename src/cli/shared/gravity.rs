//! The option `--gravity`: a vector as `x,y,z`.

use crate::robot::LARGEST_GRAVITY;
use nalgebra::Vector3;

/// A vector from three numbers with commas between, m/s2.
///
/// # Errors
/// If there are not three numbers, or they are no gravity.
pub(super) fn parse(text: &str) -> Result<Vector3<f64>, String> {
    let number = |text: &str| match text.trim().parse::<f64>() {
        Ok(value) if value.abs() <= LARGEST_GRAVITY => Ok(value),
        _ => Err(format!("`{text}` must be a number in m/s2 between -{LARGEST_GRAVITY} and {LARGEST_GRAVITY}")),
    };
    match text.split(',').map(number).collect::<Result<Vec<f64>, String>>()?[..] {
        [x, y, z] => Ok(Vector3::new(x, y, z)),
        _ => Err("give three numbers with commas between, as in 0,0,-9.81".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_numbers_make_a_vector() {
        assert_eq!(parse("0, -1.5,-9.81"), Ok(Vector3::new(0.0, -1.5, -9.81)));
        for (bad, word) in [
            ("0,0", "three"),
            ("0,0,1,2", "three"),
            ("nan,0,0", "nan"),
            ("0,0,1e300", "1e300"),
            ("0,0,-981", "m/s2"),
            ("", "``"),
        ] {
            assert!(parse(bad).unwrap_err().contains(word), "{bad}");
        }
    }
}
