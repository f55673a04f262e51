//! Whitened rows of the joints that are not under test, condensed: all that a fit takes from a joint's rows is in the triangular factor of
//! its columns and torque (QR with orthogonal rows left out), which is as long as there are columns.
//!
//! What is tested on one joint needs the rows of that joint. Every test repeats the fit of the model, and most of its rows are those of the
//! others.

use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::Column;
use crate::linear::{OrthonormalBasis, inner_product};
use rayon::prelude::*;

/// Share of its length that a column must keep over those before it for the factor to have a row of its own for it.
const INDEPENDENT: f64 = 1e-9;

/// Columns and torque, and each joint's rows of them whitened and condensed.
#[derive(Debug)]
pub(super) struct Condensed {
    /// The noise under which they are.
    pub whitener: Whitener,
    /// The columns whole, not whitened.
    pub whole: Vec<Column>,
    condensed: Vec<Column>,
}

impl Condensed {
    /// The condensed form of columns, not whitened, the torque among them.
    pub(super) fn new(whitener: &Whitener, whole: Vec<Column>, joints: usize) -> Self {
        let white = whitener.apply_all(&whole);
        let of_joint = |joint: usize| {
            let own: Vec<usize> = (0..white.len()).filter(|&k| white[k].part(joint).is_some()).collect();
            let parts: Vec<&[f64]> = own.iter().filter_map(|&k| white[k].part(joint)).collect();
            let basis = OrthonormalBasis::new(&parts, INDEPENDENT);
            let condensed = |part: &&[f64]| {
                let along = basis.directions.iter().map(|direction| inner_product(direction, part));
                along.collect::<Vec<f64>>()
            };
            own.into_iter().zip(parts.par_iter().map(condensed).collect::<Vec<_>>()).collect::<Vec<_>>()
        };
        let each: Vec<Vec<(usize, Vec<f64>)>> = (0..joints).map(of_joint).collect();
        let mut condensed = vec![Vec::new(); whole.len()];
        for (joint, parts) in each.into_iter().enumerate() {
            parts.into_iter().for_each(|(place, part)| condensed[place].push((joint, part)));
        }
        let condensed = condensed.into_iter().map(Column::of).collect();
        Condensed { whitener: whitener.clone(), whole, condensed }
    }

    /// The columns with the rows of `joint` whole, under a noise that differs on the others by its misfit alone.
    pub(super) fn with_rows_of(&self, joint: usize, whitener: &Whitener) -> Vec<Column> {
        let mixed = |(condensed, column): (&Column, &Column)| {
            let whole = whitener.apply(&column.only(&[joint])).parts.into_iter();
            let others = condensed.parts.iter().filter(|(other, _)| *other != joint).map(|(other, part)| {
                let factor = self.whitener.misfit(*other) / whitener.misfit(*other);
                (*other, part.iter().map(|value| value * factor).collect())
            });
            let mut parts: Vec<(usize, Vec<f64>)> = others.chain(whole).collect();
            parts.sort_by_key(|(joint, _)| *joint);
            Column::of(parts)
        };
        self.condensed.par_iter().zip(&self.whole).map(mixed).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::diagnosis::logs::{FEWEST_ROWS, Rows};
    use crate::diagnosis::regression::Projection;
    use crate::random;
    use crate::recording::Recording;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn a_test_on_one_joint_is_the_same_with_the_rows_of_the_others_condensed() {
        let time: Vec<f64> = (0..6000).map(|k| f64::from(k) / 500.0).collect();
        let mut source = random::stream(4, "condensed", 0);
        let mut noisy = |f: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let noise = |t: &f64| {
                let noise: f64 = StandardNormal.sample(&mut source);
                f(*t) + noise
            };
            time.iter().map(noise).collect()
        };
        let tau = Channels::from_vectors(&[noisy(&|t| 2.0 * t.sin()), noisy(&|t| 3.0 * (2.0 * t).cos())]);
        let wave = |phase: f64| time.iter().map(|t| (1.3 * t + phase).sin()).collect();
        let q = Channels::from_vectors(&[wave(0.0), wave(1.0)]);
        let joints = vec!["a".to_owned(), "b".to_owned()];
        let log = Recording { joints, time: time.clone(), q, tau, ..Default::default() };
        let rows = Rows::new(&[&log], 10.0, FEWEST_ROWS).unwrap();
        let signal = |f: fn(f64) -> f64| rows.signal(|log| log.time.iter().map(|&t| f(t)).collect());
        // Two columns that both joints share, one that is the other twice, and the torque.
        let shared = Column::of(vec![(0, signal(f64::sin)), (1, signal(|t| (2.0 * t).cos()))]);
        let other = Column::of(vec![(0, signal(|t| 0.1 * t)), (1, signal(|t| (0.5 * t).sin()))]);
        let mut twice = shared.clone();
        twice.scale(2.0);
        let torque = Column::new(rows.torque.iter().cloned());
        let columns = [shared, other, twice, torque.clone()];
        let whitener = Whitener::new(&rows, &torque, &columns[..3]);
        let condensed = Condensed::new(&whitener, columns.to_vec(), 2);
        let tested = whitener.apply(&Column::on(1, signal(|t| (0.7 * t).cos())));
        // The noise of the other joint is taken for stronger than when it was condensed.
        let under = whitener.clone().with_misfit(&[1.4, 1.0]);
        let statistic = |columns: &[Column]| {
            let fit = Projection::new(&columns[..3], &columns[3]);
            (fit.test(std::slice::from_ref(&tested)).unwrap().statistic, fit.left())
        };
        let (whole, left) = statistic(&under.apply_all(&columns));
        let mixed = condensed.with_rows_of(1, &under);
        assert!(mixed[0].part(0).unwrap().len() <= 4 && mixed[0].part(1).unwrap().len() > 100);
        let (of_mixed, left_of_mixed) = statistic(&mixed);
        assert!(
            (of_mixed / whole - 1.0).abs() < 1e-9 && (left_of_mixed / left - 1.0).abs() < 1e-9,
            "{of_mixed} {whole}"
        );
    }
}
