//! Columns through the filter of torque and columns while they are made: the tables at the rate of the log never exist.

use crate::channels::Channels;
use crate::error::Result;
use crate::signal::Filter;
use rayon::prelude::*;
use std::ops::Range;

/// Fewest samples that are made at once; more under a long window, whose samples at both ends are made twice.
const FEWEST: usize = 256;
const WINDOWS: usize = 4;

/// Blocks that one thread does in a row.
const RUN: usize = 16;

/// Values at the rate of the log that are kept at once where a filter sees the whole log.
const KEPT: usize = 1 << 24;

/// What makes columns: for a range of samples a table `[column][sample of the range]`.
pub(super) trait Writer: Sync {
    /// Columns in a table.
    fn places(&self) -> usize;

    /// Writes all columns over a range of samples.
    fn write(&self, samples: Range<usize>, table: &mut [f64]);
}

/// Every `step`-th filtered sample of columns along a log of `samples` samples: for each range of `wanted` columns a table
/// `[column][row]`.
///
/// # Errors
/// Those of the filter: the log is too short for it.
pub(super) fn filtered(
    writer: &impl Writer,
    filter: &Filter,
    step: usize,
    samples: usize,
    wanted: &[Range<usize>],
) -> Result<Vec<Channels>> {
    let rows = samples.div_ceil(step.max(1));
    let mut tables: Vec<Channels> = wanted.iter().map(|range| Channels::zeros(range.len(), rows)).collect();
    match filter.reach() {
        Some(reach) if samples > 2 * reach && step > 0 => {
            in_blocks(writer, filter, step, reach, samples, wanted, &mut tables);
        }
        _ => whole(writer, filter, step, samples, wanted, &mut tables)?,
    }
    Ok(tables)
}

/// Filters whose outputs see a window only: blocks of samples with what the windows at their ends need.
fn in_blocks(
    writer: &impl Writer,
    filter: &Filter,
    step: usize,
    reach: usize,
    samples: usize,
    wanted: &[Range<usize>],
    tables: &mut [Channels],
) {
    let rows = samples.div_ceil(step);
    let of_block = FEWEST.max(WINDOWS * 2 * reach).div_ceil(step);
    let runs: Vec<Range<usize>> =
        (0..rows).step_by(of_block * RUN).map(|row| row..rows.min(row + of_block * RUN)).collect();
    let columns: usize = wanted.iter().map(ExactSizeIterator::len).sum();
    // A few runs at a time: what is not yet in its place stays small.
    for runs in runs.chunks(4 * rayon::current_num_threads()) {
        let made: Vec<Vec<f64>> = runs
            .par_iter()
            .map(|run| {
                let mut out = vec![0.0; columns * run.len()];
                let mut table = Vec::new();
                for first in run.clone().step_by(of_block) {
                    let block = first..run.end.min(first + of_block);
                    // The samples under the windows of these rows, kept within the log.
                    let begin = (block.start * step).saturating_sub(reach).min(samples - 2 * reach - 1);
                    let end = ((block.end - 1) * step + reach + 1).clamp(begin + 2 * reach + 1, samples);
                    let count = end - begin;
                    table.resize(writer.places() * count, 0.0);
                    writer.write(begin..end, &mut table);
                    let columns = wanted.iter().cloned().flatten();
                    for (place, target) in columns.zip(out.chunks_exact_mut(run.len())) {
                        let column = &table[place * count..][..count];
                        let target = &mut target[block.start - run.start..][..block.len()];
                        filter.rows(column, block.start * step - begin, step, target);
                    }
                }
                out
            })
            .collect();
        for (run, made) in runs.iter().zip(&made) {
            let mut parts = made.chunks_exact(run.len());
            for table in tables.iter_mut() {
                for (place, part) in (0..table.channels()).zip(&mut parts) {
                    table.channel_mut(place)[run.clone()].copy_from_slice(part);
                }
            }
        }
    }
}

/// Filters whose outputs see the whole log: some columns at a time at the rate of the log.
fn whole(
    writer: &impl Writer,
    filter: &Filter,
    step: usize,
    samples: usize,
    wanted: &[Range<usize>],
    tables: &mut [Channels],
) -> Result<()> {
    let places: Vec<(usize, usize, usize)> = wanted
        .iter()
        .enumerate()
        .flat_map(|(table, range)| range.clone().enumerate().map(move |(place, column)| (table, place, column)))
        .collect();
    let mut block = vec![0.0; writer.places() * FEWEST.min(samples)];
    for group in places.chunks((KEPT / samples.max(1)).max(1)) {
        let mut full = Channels::zeros(group.len(), samples);
        for start in (0..samples).step_by(FEWEST) {
            let here = start..samples.min(start + FEWEST);
            let block = &mut block[..writer.places() * here.len()];
            writer.write(here.clone(), block);
            for (kept, (_, _, column)) in group.iter().enumerate() {
                let part = &block[column * here.len()..][..here.len()];
                full.channel_mut(kept)[here.clone()].copy_from_slice(part);
            }
        }
        for (kept, &(table, place, _)) in group.iter().enumerate() {
            let thinned = filter.apply_every(full.channel(kept), step)?;
            tables[table].channel_mut(place).copy_from_slice(&thinned);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::{Edge, SavitzkyGolay, ZeroPhaseLowPass};
    use proptest::prelude::*;

    struct Waves;

    impl Waves {
        fn value(column: usize, sample: usize) -> f64 {
            ((column + 1) as f64 * 0.37 * sample as f64).sin()
        }
    }

    impl Writer for Waves {
        fn places(&self) -> usize {
            5
        }

        fn write(&self, samples: Range<usize>, table: &mut [f64]) {
            for (column, row) in table.chunks_exact_mut(samples.len()).enumerate() {
                row.iter_mut().zip(samples.clone()).for_each(|(x, sample)| *x = Waves::value(column, sample));
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn blocks_are_what_the_whole_log_gives(samples in 60usize..20_000, half in 3usize..30, step in 1usize..40) {
            let smoother = SavitzkyGolay::new(2 * half + 1, 4, 0, 0.01, Edge::Polynomial).unwrap();
            let low_pass = ZeroPhaseLowPass::new(4, 10.0, 100.0).unwrap();
            for filter in
                [Filter::None, Filter::SavitzkyGolay(smoother), Filter::LowPass(low_pass), Filter::Means(half)]
            {
                let wanted = [0..2, 3..5];
                let tables = filtered(&Waves, &filter, step, samples, &wanted).unwrap();
                for (table, range) in tables.iter().zip(wanted) {
                    for (column, made) in range.zip(table.iter()) {
                        let full: Vec<f64> = (0..samples).map(|sample| Waves::value(column, sample)).collect();
                        let expected = filter.apply_every(&full, step).unwrap();
                        prop_assert_eq!(made.len(), expected.len());
                        for (x, y) in made.iter().zip(&expected) {
                            prop_assert!((x - y).abs() < 1e-12, "{x} {y}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_log_shorter_than_the_window_is_refused() {
        let smoother = SavitzkyGolay::new(31, 4, 0, 0.01, Edge::Polynomial).unwrap();
        let wanted = std::slice::from_ref(&(0..5));
        let problem = filtered(&Waves, &Filter::SavitzkyGolay(smoother), 2, 20, wanted).unwrap_err().to_string();
        assert!(problem.contains("20 samples") && problem.contains("window of 31"), "{problem}");
    }
}
