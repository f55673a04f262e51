//! Positions of joints behind the errors of their encoders.

use super::placed::Placed;

/// Rounds in which an encoder's error is taken out of what it reads: errors are small and smooth, each round leaves their slope's share.
const ROUNDS: usize = 4;

/// Where a joint is whose encoder reads `measured` with the errors that `placed` effects make, rad or m: q of measured = q + error(q). None
/// where they make none.
pub(crate) fn behind_encoder<'a>(
    placed: impl Iterator<Item = &'a Placed> + Clone,
    measured: &[f64],
) -> Option<Vec<f64>> {
    let mut joint = measured.to_vec();
    for _ in 0..ROUNDS {
        let mut read = joint.clone();
        placed.clone().for_each(|one| one.effect.distort_position(&one.parameters, &mut read));
        joint.iter_mut().zip(&read).zip(measured).for_each(|((q, read), seen)| *q += seen - read);
    }
    (joint != measured).then_some(joint)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;

    #[test]
    fn an_encoder_reads_what_was_behind_it() {
        let placed = Placed { effect: find("encoder_eccentricity").unwrap(), joint: 0, parameters: vec![0.01, -0.02] };
        let position: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.06).collect();
        let mut read = position.clone();
        placed.effect.distort_position(&placed.parameters, &mut read);
        let found = behind_encoder(std::iter::once(&placed), &read).unwrap();
        assert!(found.iter().zip(&position).all(|(found, q)| (found - q).abs() < 1e-8));
        assert_eq!(behind_encoder(std::iter::once(&placed.absent()), &read), None);
    }
}
