//! Gram matrices X'X and products X'y of tall tables, summed in lanes while blocks of rows stream by.
//!
//! A table of all rows need never exist: whoever makes rows hands them over block by block, each column of a block one
//! contiguous run. Sums are kept per lane in tiles of 4 x 3 entries, as many as registers hold, and put together in the
//! end.

use crate::channels::Channels;
use crate::lane::{Aligned, Kernel, Lane, Lanes};
use nalgebra::DMatrix;

/// Rows of a block: its columns then stay in the second cache while the tiles pass over them, and a tile's sums are seldom
/// put aside. An odd number of cache lines: columns a power of two apart would crowd into few places of the cache.
pub(crate) const BLOCK: usize = 248;

/// Height and breadth of a tile: its sums, a row's share of its breadth and one more value fill the registers.
const TALL: usize = 4;
const BROAD: usize = 3;

/// Breadth with twice the registers, which come with the widest lanes.
const BROADER: usize = 4;

/// The lower triangle of X'X over the rows seen so far.
#[derive(Debug, Clone)]
pub(crate) struct Gram {
    lanes: Lanes,
    columns: usize,
    /// Tile after tile, row by row; one partial sum per lane for every entry.
    sums: Aligned,
}

impl Gram {
    /// No rows of a table of so many columns.
    pub(crate) fn new(columns: usize) -> Self {
        Gram::new_in(Lanes::best(), columns)
    }

    /// [`Gram::new`] in lanes of one kind.
    pub(crate) fn new_in(lanes: Lanes, columns: usize) -> Self {
        let broad = breadth(lanes.width());
        Gram { lanes, columns, sums: Aligned::zeros(tiles(columns, broad).count() * TALL * broad * lanes.width()) }
    }

    /// Adds `rows` rows given as `[column][row]`.
    ///
    /// # Panics
    /// If the table has another size.
    pub(crate) fn add(&mut self, table: &[f64], rows: usize) {
        assert_eq!(table.len(), self.columns * rows, "a table of all columns is wanted");
        self.lanes.run(Adding { columns: self.columns, sums: &mut self.sums, table, rows });
    }

    /// Adds the rows of a table that are `valid`; the others may hold anything. The table is one or more signals, `[row]`
    /// each, as many as there are columns.
    ///
    /// # Panics
    /// If the table has another number of columns.
    pub(crate) fn add_valid<'t>(&mut self, table: impl Iterator<Item = &'t [f64]> + Clone, valid: &[bool]) {
        assert_eq!(table.clone().count(), self.columns, "a table of all columns is wanted");
        let mut block = Aligned::zeros(self.columns * BLOCK.min(valid.len()));
        for (number, valid) in valid.chunks(BLOCK).enumerate() {
            let block = &mut block[..self.columns * valid.len()];
            valid_block(table.clone(), number * BLOCK, valid, block);
            self.add(block, valid.len());
        }
    }

    /// X'X.
    pub(crate) fn matrix(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.columns, self.columns);
        self.each_entry(|row, column, sum| matrix[(row, column)] = sum);
        matrix.fill_upper_triangle_with_lower_triangle();
        matrix
    }

    /// Tells row, column and value of the entries of X'X on and below the diagonal.
    pub(crate) fn each_entry(&self, mut visit: impl FnMut(usize, usize, f64)) {
        let width = self.lanes.width();
        let broad = breadth(width);
        for ((top, left), tile) in tiles(self.columns, broad).zip(self.sums.chunks_exact(TALL * broad * width)) {
            for (row, entries) in (top..self.columns).zip(tile.chunks_exact(broad * width)) {
                for (column, parts) in (left..=row).zip(entries.chunks_exact(width)) {
                    visit(row, column, sum(parts));
                }
            }
        }
    }
}

/// Fills `block`, `[column][row]`, with the rows of a table from `first` on, one per entry of `valid`, zeros where that is
/// false.
pub(in crate::identification) fn valid_block<'t>(
    table: impl Iterator<Item = &'t [f64]>,
    first: usize,
    valid: &[bool],
    block: &mut [f64],
) {
    let all = valid.iter().all(|&ok| ok);
    for (column, target) in table.zip(block.chunks_exact_mut(valid.len())) {
        let part = &column[first..][..valid.len()];
        if all {
            target.copy_from_slice(part);
        } else {
            for ((target, &x), &ok) in target.iter_mut().zip(part).zip(valid) {
                *target = if ok { x } else { 0.0 };
            }
        }
    }
}

/// Breadth of a tile in lanes of so many numbers.
const fn breadth(width: usize) -> usize {
    if width >= 8 { BROADER } else { BROAD }
}

/// First row and column of the tiles that cover the lower triangle.
fn tiles(columns: usize, broad: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..columns)
        .step_by(TALL)
        .flat_map(move |top| (0..columns.min(top + TALL)).step_by(broad).map(move |left| (top, left)))
}

/// The sum of a lane's numbers: by halves for the widest lanes, so that one addition seldom waits for another.
fn sum(parts: &[f64]) -> f64 {
    match parts {
        [a, b, c, d, e, f, g, h] => ((a + b) + (c + d)) + ((e + f) + (g + h)),
        _ => parts.iter().sum(),
    }
}

struct Adding<'a> {
    columns: usize,
    sums: &'a mut [f64],
    table: &'a [f64],
    rows: usize,
}

impl Kernel for Adding<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        if breadth(L::WIDTH) == BROADER { self.tile_by_tile::<L, BROADER>() } else { self.tile_by_tile::<L, BROAD>() }
    }
}

impl Adding<'_> {
    #[inline(always)]
    fn tile_by_tile<L: Lane, const BROAD: usize>(self) {
        let Adding { columns, sums, table, rows } = self;
        let whole = rows - rows % L::WIDTH;
        // The remainder fills lanes of its own with zeros behind it, once for all tiles.
        let mut rest = Vec::new();
        if whole < rows {
            rest.resize(columns * L::WIDTH, 0.0);
            for (lane, column) in rest.chunks_exact_mut(L::WIDTH).zip(table.chunks_exact(rows)) {
                lane[..rows - whole].copy_from_slice(&column[whole..]);
            }
        }
        for (table, stride, rows) in [(table, rows, whole), (&rest, L::WIDTH, L::WIDTH)] {
            if table.is_empty() {
                continue;
            }
            let column = |index: usize| &table[index.min(columns - 1) * stride..][..rows];
            let mut tile = sums.chunks_exact_mut(TALL * BROAD * L::WIDTH);
            let mut top = 0;
            while top < columns {
                let mut left = 0;
                while left < columns.min(top + TALL) {
                    let Some(sums) = tile.next() else { break };
                    // A tile that sticks out repeats the last column; what it gathers there is not read.
                    let (mut tall, mut broad): ([&[f64]; TALL], [&[f64]; BROAD]) = ([&[]; TALL], [&[]; BROAD]);
                    for (k, signal) in tall.iter_mut().enumerate() {
                        *signal = column(top + k);
                    }
                    for (k, signal) in broad.iter_mut().enumerate() {
                        *signal = column(left + k);
                    }
                    match columns - top {
                        _ if BROAD == TALL && left == top => add_tile::<L, TALL, BROAD, true>(tall, broad, rows, sums),
                        1 => add_tile::<L, 1, BROAD, false>([tall[0]], broad, rows, sums),
                        2 => add_tile::<L, 2, BROAD, false>([tall[0], tall[1]], broad, rows, sums),
                        3 => add_tile::<L, 3, BROAD, false>([tall[0], tall[1], tall[2]], broad, rows, sums),
                        _ => add_tile::<L, TALL, BROAD, false>(tall, broad, rows, sums),
                    }
                    left += BROAD;
                }
                top += TALL;
            }
        }
    }
}

/// Adds whole lanes of rows to the sums of a tile; of one on the DIAGONAL only to those on and below it.
#[inline(always)]
fn add_tile<L: Lane, const TALL: usize, const BROAD: usize, const DIAGONAL: bool>(
    tall: [&[f64]; TALL],
    broad: [&[f64]; BROAD],
    rows: usize,
    sums: &mut [f64],
) {
    // Said once, these lengths need no asking at every load.
    let sums = &mut sums[..TALL * BROAD * L::WIDTH];
    let (mut tall, mut broad) = (tall, broad);
    for column in &mut tall {
        *column = &column[..rows];
    }
    for column in &mut broad {
        *column = &column[..rows];
    }
    let mut entries = [[L::splat(0.0); BROAD]; TALL];
    for (k, entries) in entries.iter_mut().enumerate() {
        for (c, entry) in entries.iter_mut().enumerate().take(if DIAGONAL { k + 1 } else { BROAD }) {
            *entry = L::load(&sums[(k * BROAD + c) * L::WIDTH..][..L::WIDTH]);
        }
    }
    let mut row = 0;
    while row + L::WIDTH <= rows {
        // Loops instead of closures: one that hands on loads may be left out of line, compiled for the oldest machines.
        let mut x = [L::splat(0.0); BROAD];
        for (x, signal) in x.iter_mut().zip(broad) {
            *x = L::load(&signal[row..row + L::WIDTH]);
        }
        for (k, (signal, entries)) in tall.iter().zip(&mut entries).enumerate() {
            let y = if DIAGONAL { x[k] } else { L::load(&signal[row..row + L::WIDTH]) };
            for (entry, x) in entries.iter_mut().zip(x).take(if DIAGONAL { k + 1 } else { BROAD }) {
                *entry = x.mul_add(y, *entry);
            }
        }
        row += L::WIDTH;
    }
    for (k, entries) in entries.iter().enumerate() {
        for (c, entry) in entries.iter().enumerate().take(if DIAGONAL { k + 1 } else { BROAD }) {
            entry.store(&mut sums[(k * BROAD + c) * L::WIDTH..][..L::WIDTH]);
        }
    }
}

/// X'y for a table `[column][row]`.
///
/// # Panics
/// If the signal has another number of rows.
pub(crate) fn products(table: &Channels, signal: &[f64]) -> Vec<f64> {
    products_in(Lanes::best(), table, signal)
}

fn products_in(lanes: Lanes, table: &Channels, signal: &[f64]) -> Vec<f64> {
    assert_eq!(table.samples(), signal.len(), "one value per row is wanted");
    lanes.run(Products { table, signal })
}

struct Products<'a> {
    table: &'a Channels,
    signal: &'a [f64],
}

impl Kernel for Products<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Vec<f64> {
        /// Sums side by side, so that one does not wait for itself.
        const TOGETHER: usize = 4;
        let mut out = Vec::with_capacity(self.table.channels());
        for column in self.table.iter() {
            let mut sums = [L::splat(0.0); TOGETHER];
            let (mut xs, mut ys) =
                (column.chunks_exact(TOGETHER * L::WIDTH), self.signal.chunks_exact(TOGETHER * L::WIDTH));
            for (x, y) in (&mut xs).zip(&mut ys) {
                for (k, sum) in sums.iter_mut().enumerate() {
                    *sum = L::load(&x[k * L::WIDTH..]).mul_add(L::load(&y[k * L::WIDTH..]), *sum);
                }
            }
            let rest: f64 = xs.remainder().iter().zip(ys.remainder()).map(|(x, y)| x * y).sum();
            out.push(((sums[0] + sums[1]) + (sums[2] + sums[3])).sum() + rest);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn table(columns: usize, rows: usize, seed: u64) -> Channels {
        use rand::RngExt;
        let mut source = crate::random::stream(seed, "table", 0);
        let mut table = Channels::zeros(columns, rows);
        table.as_mut_slice().fill_with(|| source.random_range(-1.0..1.0));
        table
    }

    proptest! {
        #[test]
        fn any_table_in_any_lanes(columns in 0usize..17, rows in 0usize..300, seed in 0u64..1000) {
            let table = table(columns, rows, seed);
            let valid: Vec<bool> = (0..rows).map(|row| row % 7 != 3).collect();
            let x = DMatrix::from_fn(rows, columns, |r, c| if valid[r] { table.channel(c)[r] } else { 0.0 });
            let y: Vec<f64> = (0..rows).map(|r| (r as f64).sin()).collect();
            let mut poisoned = table.clone();
            for c in 0..columns {
                poisoned.channel_mut(c).iter_mut().zip(&valid).for_each(|(v, ok)| if !ok { *v = f64::NAN });
            }
            let full = DMatrix::from_fn(rows, columns, |r, c| table.channel(c)[r]);
            let expected = full.transpose() * nalgebra::DVector::from_column_slice(&y);
            for lanes in Lanes::available() {
                let mut gram = Gram::new_in(lanes, columns);
                gram.add_valid(poisoned.iter(), &valid);
                prop_assert!(columns == 0 || (gram.matrix() - x.transpose() * &x).amax() < 1e-12);
                for (own, other) in products_in(lanes, &table, &y).iter().zip(&expected) {
                    prop_assert!((own - other).abs() < 1e-12, "{own} {other}");
                }
            }
        }
    }
}
