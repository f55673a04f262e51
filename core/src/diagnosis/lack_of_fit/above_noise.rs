//! Residuals well above the noise of a search that was ended before it looked for their structure.

use super::structure::Unexplained;
use crate::diagnosis::criteria::StructureCriteria;

/// What is said of such a joint.
pub(super) const ABOVE_NOISE: &str = "is above the noise";

/// The joints whose held-out residual is well above the noise (root mean squares, `[joint]`, N m), but those on which something is
/// reported already. A search that was ended does not answer that nothing is there.
pub(crate) fn above_noise(
    residual: &[f64],
    noise: &[f64],
    reported: &[Unexplained],
    criteria: &StructureCriteria,
) -> Vec<Unexplained> {
    let is_open = |joint: &usize| {
        residual[*joint] > criteria.above_noise * noise[*joint] && reported.iter().all(|other| other.joint != *joint)
    };
    let unexplained = |joint: usize| Unexplained {
        joint,
        share: 1.0 - (noise[joint] / residual[joint]).powi(2),
        structure: ABOVE_NOISE,
        family_wise_p: None,
        certain: false,
        instead_of: Vec::new(),
    };
    (0..residual.len()).filter(is_open).map(unexplained).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_from_twice_the_noise_are_reported_once() {
        let criteria = StructureCriteria::default();
        let of =
            |residual: f64, reported: &[Unexplained]| above_noise(&[residual, 0.1], &[1.0, 0.1], reported, &criteria);
        assert!(of(criteria.above_noise, &[]).is_empty());
        let found = of(criteria.above_noise + 1e-9, &[]);
        assert!(found.len() == 1 && found[0].joint == 0 && (found[0].share - 0.75).abs() < 1e-6);
        assert!(of(5.0, &found).is_empty());
    }
}
