//! What an effect takes away on rows that it was not fitted to, with its chance.

use super::blocks::{BLOCK, most_influential_block, row_by_row};
use super::generic::slow_cosines;
use crate::diagnosis::criteria::Levels;
use crate::diagnosis::logs::Rows;
use crate::diagnosis::model::Nuisances;
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection, fisher};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// What is gained of the whitened sum of squares on the joints that an effect acts on.
///
/// With a the residual after and p what the effect predicts, the gain is the sum of p^2 + 2 a p. Only the second part is
/// chance: its scatter is taken over blocks of the rows, within which neither is independent of its past.
#[derive(Debug, Clone)]
pub(crate) struct Gains {
    /// Gain in each row of the logs.
    of_rows: Vec<f64>,
    /// Standard deviation of their sum.
    std: f64,
    /// The same were the residual after white.
    expected_std: f64,
    /// Sum of squares before.
    before: f64,
    /// Probability that noise alone goes with what the effect predicts as well.
    chance: f64,
}

impl Gains {
    /// From residuals before and after over `rows` rows of the logs.
    pub(crate) fn new(on_held_out: &Whitener, before: &Column, after: &Column, joints: &[usize], rows: usize) -> Self {
        Self::of_white(on_held_out, [before, after].map(|residual| on_held_out.apply(&residual.only(joints))), rows)
    }

    /// The same adjusted for a constant torque on every joint of every log: what reads wrong by a constant, as sensors do, hides what
    /// an effect of motion gains.
    pub(crate) fn adjusted_for_constants(
        on_held_out: &Whitener,
        before: &Column,
        after: &Column,
        joints: &[usize],
        rows: &Rows,
    ) -> Self {
        let mut constants = Nuisances::default();
        joints.iter().for_each(|&joint| constants.add(&slow_cosines(rows, joint, 0..1), f64::INFINITY));
        Self::adjusted_for(on_held_out, before, after, joints, &constants, rows.len())
    }

    /// The same adjusted for nuisance regressors.
    pub(crate) fn adjusted_for(
        on_held_out: &Whitener,
        before: &Column,
        after: &Column,
        joints: &[usize],
        others: &Nuisances,
        rows: usize,
    ) -> Self {
        let others = others.only(joints);
        let left = |residual: &Column| {
            let fit = Projection::new(&[], &on_held_out.apply(&residual.only(joints)));
            others.adjust(&fit, on_held_out).residual.only(joints)
        };
        Self::of_white(on_held_out, [left(before), left(after)], rows)
    }

    fn of_white(on_held_out: &Whitener, [before, after]: [Column; 2], rows: usize) -> Self {
        let mut of_rows = vec![0.0; rows];
        let mut chance = vec![0.0; rows / BLOCK + 1];
        let mut scores = vec![None; rows / BLOCK + 1];
        let mut predicted = 0.0;
        for (place, b, a) in row_by_row(on_held_out, &before, &after) {
            of_rows[place] += b * b - a * a;
            chance[place / BLOCK] += 2.0 * a * (b - a);
            *scores[place / BLOCK].get_or_insert(0.0) += b * (b - a);
            predicted += (b - a).powi(2);
        }
        let scores: Vec<f64> = scores.into_iter().flatten().collect();
        let std = chance.iter().map(|sum| sum * sum).sum::<f64>().sqrt();
        let expected_std = 2.0 * predicted.sqrt();
        let before = before.dot(&before).max(f64::MIN_POSITIVE);
        Gains { of_rows, std, expected_std, before, chance: chance_of(&scores, predicted) }
    }

    /// Probability that noise alone goes as well with the torque that the effect predicts, one-sided. The prediction knows
    /// nothing of these rows, so that no choice among candidates enters.
    pub(crate) fn chance(&self) -> f64 {
        self.chance
    }

    /// Probability of that in one of `tries` and of as much as was seen on the training rows, which has a chance of `level` by
    /// itself: the two are independent.
    pub(crate) fn together(&self, level: f64, tries: f64) -> f64 {
        fisher([level, (tries * self.chance).min(1.0)].map(|p| p.max(f64::MIN_POSITIVE).ln())).exp()
    }

    /// The share of the sum of squares that is gained.
    pub(crate) fn share(&self) -> f64 {
        self.of_rows.iter().sum::<f64>() / self.before
    }

    /// Lower bound of the share of the sum of squares that is gained.
    pub(crate) fn lower_bound(&self, levels: &Levels) -> f64 {
        self.share() - levels.bound_std * self.std / self.before
    }

    /// Upper bound of the share of the sum of squares that is gained.
    pub(crate) fn upper_bound(&self, levels: &Levels) -> f64 {
        self.share() + levels.bound_std * self.std / self.before
    }

    /// Whether the rows contradict it: the upper bound of the gain is below zero.
    pub(crate) fn is_contradicted(&self, levels: &Levels) -> bool {
        self.upper_bound(levels) < 0.0
    }

    /// Standard deviations by which the sum of squares grows, by its scatter between blocks (paired t); negative where it falls, zero
    /// where nothing changes. Unlike the bounds of the gain it does not take the residual after for noise.
    pub(crate) fn growth(&self) -> f64 {
        self.paired().0
    }

    /// Probability of that growth or a larger one where the expected sum of squares does not grow (Student, one-sided).
    pub(crate) fn growth_p(&self) -> f64 {
        let (statistic, freedom) = self.paired();
        StudentsT::new(0.0, 1.0, freedom).map_or(1.0, |student| student.sf(statistic))
    }

    /// The paired t statistic of the growth between blocks, and its degrees of freedom.
    fn paired(&self) -> (f64, f64) {
        let blocks = self.of_rows.chunks(BLOCK).map(|rows| rows.iter().sum::<f64>());
        let blocks: Vec<f64> = blocks.filter(|gain| *gain != 0.0).collect();
        let (sum, count) = (blocks.iter().sum::<f64>(), blocks.len() as f64);
        let scatter: f64 = blocks.iter().map(|gain| (gain - sum / count).powi(2)).sum();
        let statistic = if scatter > 0.0 { -sum / (scatter * count / (count - 1.0)).sqrt() } else { 0.0 };
        (statistic, count - 1.0)
    }

    /// Whether the scatter of the gain between blocks is that of the noise: the residual holds little else.
    pub(crate) fn is_of_noise(&self, levels: &Levels) -> bool {
        self.std < levels.misfit * self.expected_std
    }

    /// The share that is gained outside the block that gains most.
    pub(crate) fn without_most_influential_block(&self) -> f64 {
        let best: f64 = self.of_rows[most_influential_block(&self.of_rows, BLOCK)].iter().sum();
        self.share() - best / self.before
    }
}

/// Probability of the sum of `scores` without the effect: their variance as the noise has it, or as they scatter (Student),
/// whichever is larger.
fn chance_of(scores: &[f64], variance: f64) -> f64 {
    let sum: f64 = scores.iter().sum();
    let count = scores.len() as f64;
    let (Ok(normal), Ok(student)) = (Normal::new(0.0, 1.0), StudentsT::new(0.0, 1.0, count - 1.0)) else { return 1.0 };
    let scatter: f64 = scores.iter().map(|score| (score - sum / count).powi(2)).sum::<f64>() * count / (count - 1.0);
    if !(variance > 0.0 && scatter > 0.0) {
        return 1.0;
    }
    normal.sf(sum / variance.sqrt()).max(student.sf(sum / scatter.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::diagnosis::logs::FEWEST_ROWS;
    use crate::random;
    use crate::recording::Recording;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn the_chance_of_scores_is_the_larger_of_two() {
        // Sum 6 of variance 4: 3 standard deviations; scatter 2/3 of 4 scores around 1.5: Student's t of 6 / sqrt(20 / 3), 3 degrees.
        let scores = [0.0, 1.0, 2.0, 3.0];
        let t: f64 = 6.0 / (5.0 * 4.0 / 3.0f64).sqrt();
        let expected = StudentsT::new(0.0, 1.0, 3.0).unwrap().sf(t);
        assert!((chance_of(&scores, 4.0) - expected).abs() < 1e-15 && expected > 0.03);
        // A variance that is larger than the scatter.
        assert!((chance_of(&scores, 36.0) - 0.158_655_253_931_457).abs() < 1e-9);
        assert!(chance_of(&[-1.0, -2.0, -1.5], 3.0) > 0.9);
        assert_eq!(chance_of(&[1.0], 1.0), 1.0);
    }

    #[test]
    fn an_offset_hides_no_gain_adjusted_for_constants() {
        let time: Vec<f64> = (0..10_000).map(|k| f64::from(k) / 500.0).collect();
        let mut source = random::stream(1, "offset", 0);
        let noise: Vec<f64> = (0..10_000).map(|_| StandardNormal.sample(&mut source)).collect();
        let log = Recording {
            joints: vec!["a".into()],
            q: Channels::from_vectors(&[time.iter().map(|t| t.sin()).collect()]),
            tau: Channels::from_vectors(&[noise]),
            time,
            ..Default::default()
        };
        let rows = Rows::new(&[&log], 10.0, FEWEST_ROWS).unwrap();
        let left = Column::new(rows.torque.iter().cloned());
        let on_held_out = Whitener::new(&rows, &left, &[]);
        // An effect with a mean, all of which is there, and an offset against it.
        let effect = Column::on(0, rows.signal(|log| log.time.iter().map(|t| 0.5 + (0.7 * t).sin()).collect()));
        let mut after = left;
        after.add(1.0, &Column::on(0, vec![-1.5; rows.len()]));
        let mut before = after.clone();
        before.add(1.0, &effect);
        let plain = Gains::new(&on_held_out, &before, &after, &[0], rows.len());
        let adjusted = Gains::adjusted_for_constants(&on_held_out, &before, &after, &[0], &rows);
        let levels = Levels::default();
        assert!(plain.lower_bound(&levels) < 0.0, "{plain:?}");
        assert!(adjusted.lower_bound(&levels) > 0.5, "{}", adjusted.lower_bound(&levels));
        assert!(!adjusted.is_contradicted(&levels));
        // What predicts what is not there is contradicted, what predicts nothing is not.
        let noise = Column::new(rows.torque.iter().cloned());
        let mut wrong = noise.clone();
        wrong.add(1.0, &effect);
        assert!(Gains::new(&on_held_out, &noise, &wrong, &[0], rows.len()).is_contradicted(&levels));
        assert!(!Gains::new(&on_held_out, &noise, &noise, &[0], rows.len()).is_contradicted(&levels));
        // The same in standard deviations of the blocks.
        assert!(Gains::new(&on_held_out, &noise, &wrong, &[0], rows.len()).growth() > 3.0);
        assert!(Gains::new(&on_held_out, &wrong, &noise, &[0], rows.len()).growth() < -3.0);
        assert_eq!(Gains::new(&on_held_out, &noise, &noise, &[0], rows.len()).growth(), 0.0);
        let p = |before: &Column, after: &Column| Gains::new(&on_held_out, before, after, &[0], rows.len()).growth_p();
        assert!(p(&noise, &wrong) < 0.01 && p(&wrong, &noise) > 0.99 && p(&noise, &noise) == 1.0);
    }
}
