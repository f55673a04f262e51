//! The regression of one joint on rows of its own: fixed columns, generic functions, torque.

use super::kinds::{Kind, Signals};
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::{Column, is_constant};
use crate::linear::{OrthonormalBasis, gram_matrix, transposed_product};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use std::ops::Range;

/// Rows that are averaged to one: 20 ms become 80 ms, since what generic functions follow is slower than that, and noise that
/// lasts for a few rows is nearly white over them. At least half of them must be valid.
const TOGETHER: usize = 4;

/// Least share of a fixed column orthogonal to the others: a smaller one is rounding.
const ROUNDING: f64 = 1e-5;

/// Share of a law's square, beyond the model, in its mean from which it counts as a constant: the kind of constants is then collinear with
/// it and has no functions. It keeps the regression determined.
const CONSTANT: f64 = 0.9;

/// One joint's regression. All matrices have a row per averaged row.
#[derive(Debug, Clone)]
pub(super) struct Design {
    /// Torque with the fixed columns projected out.
    pub y: DVector<f64>,
    /// Generic functions with the fixed columns projected out, each kind scaled to one squared per row.
    pub z: DMatrix<f64>,
    /// Inner products of the generic functions with each other, and with the torque.
    pub gram: DMatrix<f64>,
    pub right: DVector<f64>,
    /// Columns of each kind; None for those of a law.
    pub kinds: Vec<(Option<Kind>, Range<usize>)>,
    /// An orthonormal basis of the fixed columns.
    pub basis: DMatrix<f64>,
    /// Rows that follow each other without a gap.
    pub runs: Vec<Range<usize>>,
    /// Time of each row since the start of all logs, in averaged rows.
    pub time: Vec<usize>,
    /// Log of each row.
    pub log: Vec<usize>,
    /// Rows of 20 ms in an averaged one.
    pub together: usize,
    /// Whether a function of a law takes the place of the kind of constants, which has none then.
    pub constant: ConstantOfLaw,
    /// Mean square per row of each function, with the noise made white: before and after the fixed columns are projected out.
    pub squares: Vec<[f64; 2]>,
}

/// Whether a law is a constant beyond the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ConstantOfLaw {
    /// None of its functions is one.
    No,
    /// Some of them are: the preload of a spring, a strut of which the bodies take what is not constant.
    Part,
    /// It is nothing else: an offset.
    Whole,
}

impl Design {
    /// Rank of the fixed columns.
    pub(super) fn rank(&self) -> usize {
        self.basis.ncols()
    }

    /// The same without the columns of a law.
    pub(super) fn without_law(mut self) -> Self {
        self.kinds.retain(|(kind, _)| kind.is_some());
        self
    }
}

/// Rows that are averaged to one: [`TOGETHER`], or as many as hold one independent value where torque went through a low-pass before it
/// was logged. Functions could fit what is between these.
pub(super) fn together(rows: &Rows) -> usize {
    TOGETHER.max((1.0 / rows.share_as_logged()).round() as usize)
}

/// Averages over consecutive rows of each log, where enough of them are valid.
struct Averages {
    members: Vec<Vec<usize>>,
    log: Vec<usize>,
    runs: Vec<Range<usize>>,
    time: Vec<usize>,
}

impl Averages {
    fn new(rows: &Rows, joint: usize) -> Self {
        let mut averages = Averages { members: Vec::new(), log: Vec::new(), runs: Vec::new(), time: Vec::new() };
        let (mut clock, mut open, together) = (0, None, together(rows));
        for log in 0..rows.logs.len() {
            let close = |open: &mut Option<usize>, averages: &mut Averages| {
                if let Some(start) = open.take() {
                    averages.runs.push(start..averages.members.len());
                }
            };
            let (start, end) = (rows.starts[log], rows.starts[log + 1]);
            for from in (start..end).step_by(together) {
                let all = from..(from + together).min(end);
                let members: Vec<usize> = all.filter(|&row| rows.valid[joint][row]).collect();
                clock += 1;
                if 2 * members.len() < together {
                    close(&mut open, &mut averages);
                    continue;
                }
                open.get_or_insert(averages.members.len());
                averages.members.push(members);
                averages.log.push(log);
                averages.time.push(clock);
            }
            close(&mut open, &mut averages);
        }
        averages
    }

    /// The mean of a signal; zero of none.
    fn of(&self, signal: Option<&[f64]>) -> DVector<f64> {
        let mean = |members: &Vec<usize>| match signal {
            Some(signal) => members.iter().map(|&row| signal[row]).sum::<f64>() / members.len() as f64,
            None => 0.0,
        };
        DVector::from_iterator(self.members.len(), self.members.iter().map(mean))
    }
}

/// What a regression is made of.
pub(super) struct Source<'a> {
    /// The rows of all logs.
    pub rows: &'a Rows,
    /// Torque to be explained.
    pub torque: &'a Column,
    /// Columns of the model.
    pub fixed: &'a [Column],
    /// Torque of the arm as identified, `[joint][row]`, N m.
    pub arm: &'a [Vec<f64>],
}

/// Fixed columns, generic functions and torque before any projection.
#[derive(Debug, Clone)]
pub(super) struct Raw {
    pub(super) y: DVector<f64>,
    pub(super) x: DMatrix<f64>,
    pub(super) z: DMatrix<f64>,
    pub(super) kinds: Vec<(Option<Kind>, Range<usize>)>,
    pub(super) runs: Vec<Range<usize>>,
    pub(super) time: Vec<usize>,
    pub(super) log: Vec<usize>,
    pub(super) together: usize,
}

impl Raw {
    /// The regression of `joint`.
    pub(super) fn new(source: &Source, joint: usize) -> Self {
        let averages = Averages::new(source.rows, joint);
        let signals = Signals { rows: source.rows, torque: source.arm, joint };
        let (mut columns, mut kinds) = (Vec::new(), Vec::new());
        for kind in Kind::ALL {
            let start = columns.len();
            columns.extend(signals.functions(kind).iter().map(|signal| averages.of(Some(signal))));
            kinds.push((Some(kind), start..columns.len()));
        }
        let fixed: Vec<DVector<f64>> = source
            .fixed
            .iter()
            .filter_map(|column| column.part(joint))
            .map(|signal| averages.of(Some(signal)))
            .filter(|column| column.norm() > 0.0)
            .collect();
        let matrix = |columns: &[DVector<f64>]| match columns.is_empty() {
            true => DMatrix::zeros(averages.members.len(), 0),
            false => DMatrix::from_columns(columns),
        };
        Raw {
            y: averages.of(source.torque.part(joint)),
            x: matrix(&fixed),
            z: matrix(&columns),
            kinds,
            runs: averages.runs,
            time: averages.time,
            log: averages.log,
            together: together(source.rows),
        }
    }

    /// With the columns of a law as one more kind, and the share of their square that is left in the means.
    pub(super) fn with_law(mut self, source: &Source, law: &[Column], joint: usize) -> (Self, f64) {
        let averages = Averages::new(source.rows, joint);
        let start = self.z.ncols();
        let (mut left, mut all) = (0.0, 0.0);
        for signal in law.iter().filter_map(|column| column.part(joint)) {
            let mean = averages.of(Some(signal));
            let squares = |members: &Vec<usize>| {
                members.iter().map(|&row| signal[row].powi(2)).sum::<f64>() / members.len() as f64
            };
            let square: f64 = averages.members.iter().map(squares).sum();
            if square > 0.0 {
                left += mean.norm_squared() / square;
                all += 1.0;
                let place = self.z.ncols();
                self.z = self.z.insert_column(place, 0.0);
                self.z.set_column(place, &(mean / square.sqrt()));
            }
        }
        self.kinds.push((None, start..self.z.ncols()));
        (self, if all > 0.0 { left / all } else { 0.0 })
    }

    /// The same with functions of position that resemble each other within so many knots: a Gaussian process with a squared-exponential
    /// covariance, which is smooth, where hats that do not resemble each other are rough. A smooth friction over position is a law of the
    /// library: that kind stays rough.
    pub(super) fn smooth(mut self, knots: f64) -> Self {
        for (_, columns) in self.kinds.iter().filter(|(kind, _)| *kind == Some(Kind::Position)) {
            let mut part = self.z.columns_mut(columns.start, columns.len());
            let smooth = &part * smoothing(columns.len(), knots);
            part.copy_from(&smooth);
        }
        self
    }

    /// The same without the functions of a law.
    pub(super) fn without_law(mut self) -> Self {
        self.kinds.retain(|(kind, _)| kind.is_some());
        let generic = self.kinds.last().map_or(0, |(_, columns)| columns.end);
        self.z = self.z.columns(0, generic).into_owned();
        self
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.y.len()
    }

    /// The regression with noise of first-order correlation `rho` between rows made white, and the fixed columns projected out.
    pub(super) fn design(&self, rho: f64) -> Design {
        let x = self.whitened(&self.x, rho);
        let basis = basis(&x);
        let complement = |columns: DMatrix<f64>| &columns - &basis * transposed_product(&basis, &columns);
        let y = complement(self.whitened(&DMatrix::from_columns(std::slice::from_ref(&self.y)), rho));
        let z = self.whitened(&self.z, rho);
        let rows = self.len().max(1) as f64;
        let squares =
            |z: &DMatrix<f64>| z.column_iter().map(|column| column.norm_squared() / rows).collect::<Vec<f64>>();
        let all = squares(&z);
        let mut z = complement(z);
        let squares = all.into_iter().zip(squares(&z)).map(|(all, left)| [all, left]).collect();
        let offset = z.columns(self.kinds[0].1.start, self.kinds[0].1.len()).normalize();
        for (_, columns) in self.kinds[1..].iter().filter(|(kind, _)| kind.is_some()) {
            let mut part = z.columns_mut(columns.start, columns.len());
            let along = offset.tr_mul(&part);
            part -= &offset * along;
        }
        // A law that is a constant beyond the model must not share it with the kind of constants.
        let laws = self.kinds.iter().filter(|(kind, _)| kind.is_none()).flat_map(|(_, columns)| columns.clone());
        let is_offset = |column: usize| {
            let law = z.column(column);
            offset.column(0).dot(&law).powi(2) > CONSTANT * law.norm_squared()
        };
        let constant = match laws.clone().any(is_offset) {
            false => ConstantOfLaw::No,
            true if laws.clone().all(|column| is_constant(self.z.column(column).as_slice())) => ConstantOfLaw::Whole,
            true => ConstantOfLaw::Part,
        };
        if constant != ConstantOfLaw::No {
            z.column_mut(self.kinds[0].1.start).fill(0.0);
        }
        for (_, columns) in &self.kinds {
            let mut part = z.columns_mut(columns.start, columns.len());
            let mean = part.norm_squared() / self.len().max(1) as f64;
            if mean > 0.0 {
                part /= mean.sqrt();
            }
        }
        let y = y.column(0).into_owned();
        Design {
            gram: gram_matrix(&z),
            right: z.tr_mul(&y),
            y,
            z,
            kinds: self.kinds.clone(),
            basis,
            runs: self.runs.clone(),
            time: self.time.clone(),
            log: self.log.clone(),
            together: self.together,
            constant,
            squares,
        }
    }

    fn whitened(&self, columns: &DMatrix<f64>, rho: f64) -> DMatrix<f64> {
        let mut white = columns.clone();
        let first = (1.0 - rho * rho).sqrt();
        for run in &self.runs {
            for row in run.clone().skip(1) {
                for column in 0..columns.ncols() {
                    white[(row, column)] = columns[(row, column)] - rho * columns[(row - 1, column)];
                }
            }
            white.row_mut(run.start).scale_mut(first);
        }
        white
    }
}

/// Combinations of so many hats over position of which independent factors make a Gaussian process with a squared-exponential covariance
/// over so many knots.
pub(super) fn smoothing(hats: usize, knots: f64) -> DMatrix<f64> {
    let covariance = DMatrix::from_fn(hats, hats, |i, j| (-0.5 * ((i as f64 - j as f64) / knots).powi(2)).exp());
    let SymmetricEigen { eigenvectors, eigenvalues } = covariance.symmetric_eigen();
    eigenvectors * DMatrix::from_diagonal(&eigenvalues.map(|value| value.max(0.0).sqrt()))
}

/// An orthonormal basis of the column space.
fn basis(columns: &DMatrix<f64>) -> DMatrix<f64> {
    let slices: Vec<&[f64]> = columns.as_slice().chunks_exact(columns.nrows().max(1)).collect();
    let directions = OrthonormalBasis::new(&slices, ROUNDING).directions;
    DMatrix::from_vec(columns.nrows(), directions.len(), directions.concat())
}
