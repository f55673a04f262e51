//! Which column of a table is which signal of which joint.

use super::names::Unit;
use crate::channels::Channels;
use crate::recording::{Recording, Signals};
use std::collections::BTreeMap;
use std::sync::Arc;

/// In place of a column that the file has not.
pub(crate) const ABSENT: usize = usize::MAX;

/// Which column of a file is which signal; every table holds one column index per joint.
#[derive(Debug)]
pub(crate) struct Layout {
    pub(super) joints: Vec<String>,
    /// [`ABSENT`] where the rows come at a rate that is given.
    pub(super) time: usize,
    /// Nanoseconds of the second, where `time` is in whole seconds.
    pub(super) nanoseconds: Option<usize>,
    pub(super) time_factor: Option<f64>,
    /// The name of the column of time does not give its unit.
    pub open_unit: bool,
    /// Time may be the index of the rows.
    pub time_is_index: bool,
    pub(super) q: Vec<usize>,
    /// [`ABSENT`] for joints without, as the two below.
    pub(super) qd: Option<Vec<usize>>,
    pub(super) qdd: Option<Vec<usize>>,
    pub(super) tau: Vec<usize>,
    pub(super) truth: Option<[Vec<usize>; 4]>,
    /// Units of columns, where their names give them.
    pub(super) units: BTreeMap<usize, Unit>,
    /// Torques are motor currents.
    pub currents: bool,
    /// Torques are shares of a rated torque.
    pub of_rated: bool,
    /// The first column of torque, where a controller wanted or computed the torques.
    pub of_controller: Option<String>,
    /// Torques are called for the motors of the robot's file.
    pub of_motors: bool,
    /// What the file has and the recording will not.
    pub notes: Vec<String>,
    /// Joints of columns that are not used, by their names.
    pub unknown_joints: Vec<String>,
    /// How the columns were understood where that is not obvious.
    pub understood: Vec<String>,
    /// Columns in use, each with another of the same name.
    pub(super) twice: Vec<[usize; 2]>,
}

/// The first value that cannot be used.
#[derive(Debug)]
pub(crate) struct Fault {
    /// Counted from 0.
    pub row: usize,
    /// Index of the column.
    pub column: usize,
    /// What is wrong.
    pub problem: String,
}

impl Layout {
    /// Indices of the columns that make the recording, increasing.
    pub(crate) fn used(&self) -> Vec<usize> {
        let mut used = vec![self.time];
        used.extend(self.nanoseconds);
        let optional = [&self.qd, &self.qdd].into_iter().flatten();
        let truth = self.truth.iter().flatten();
        used.extend([&self.q, &self.tau].into_iter().chain(optional).chain(truth).flatten());
        used.retain(|column| *column != ABSENT);
        used.sort_unstable();
        used.dedup();
        used
    }

    /// Index of the column of time; [`ABSENT`] where there is none.
    pub(crate) fn time(&self) -> usize {
        self.time
    }

    /// Index of the column of the nanoseconds behind whole seconds.
    pub(crate) fn nanoseconds(&self) -> Option<usize> {
        self.nanoseconds
    }

    /// Seconds per unit of time, where the column's name gives it.
    pub(crate) fn time_factor(&self) -> Option<f64> {
        self.time_factor
    }

    /// Names of the joints.
    pub(crate) fn joints(&self) -> &[String] {
        &self.joints
    }

    /// Index of the column of every joint's position.
    pub(crate) fn positions(&self) -> &[usize] {
        &self.q
    }

    /// Index of the column of every joint's torque; [`ABSENT`] for joints without.
    pub(crate) fn torques(&self) -> &[usize] {
        &self.tau
    }

    /// Takes time from a column that was added, in seconds.
    pub(crate) fn set_time(&mut self, column: usize) {
        (self.time, self.nanoseconds) = (column, None);
    }

    /// Index of the column of every joint's velocity; [`ABSENT`] for joints without.
    pub(crate) fn velocities(&self) -> Option<&[usize]> {
        self.qd.as_deref()
    }

    /// Indices of the columns of velocity and acceleration.
    pub(crate) fn derivatives(&self) -> impl Iterator<Item = usize> + '_ {
        [&self.qd, &self.qdd].into_iter().flatten().flatten().copied().filter(|column| *column != ABSENT)
    }

    /// Units of position, velocity, acceleration and torque of every joint, where the names of the columns give them.
    pub(crate) fn units(&self) -> [Vec<Option<Unit>>; 4] {
        let of = |columns: &[usize]| columns.iter().map(|column| self.units.get(column).copied()).collect();
        let optional = |columns: &Option<Vec<usize>>| columns.as_deref().map_or(Vec::new(), of);
        [of(&self.q), optional(&self.qd), optional(&self.qdd), of(&self.tau)]
    }

    /// The first row with a value that is not finite or a time that does not increase. `columns` is indexed as the
    /// header.
    pub(crate) fn fault(&self, columns: &[Vec<f64>]) -> Option<Fault> {
        let infinite = self.used().into_iter().filter_map(|column| {
            let row = columns[column].iter().position(|value| !value.is_finite())?;
            Some(Fault { row, column, problem: format!("{} is not a finite number", columns[column][row]) })
        });
        let time = &columns[self.time];
        let backward = time.windows(2).position(|pair| pair[1] <= pair[0]).map(|before| Fault {
            row: before + 1,
            column: self.time,
            problem: format!("time must increase, but {:?} s follows {:?} s", time[before + 1], time[before]),
        });
        infinite.chain(backward).min_by_key(|fault| fault.row)
    }

    /// The recording; `columns` is indexed as the header. Robot and provenance stay empty.
    pub(crate) fn recording(self, mut columns: Vec<Vec<f64>>) -> Recording {
        let time = std::mem::take(&mut columns[self.time]);
        let mut take = |indices: &[usize]| {
            let column = |&index: &usize| match index {
                ABSENT => vec![f64::NAN; time.len()],
                _ => std::mem::take(&mut columns[index]),
            };
            let vectors: Vec<_> = indices.iter().map(column).collect();
            Channels::from_vectors(&vectors)
        };
        let q = take(&self.q);
        let qd = self.qd.as_deref().map(&mut take);
        let qdd = self.qdd.as_deref().map(&mut take);
        let tau = take(&self.tau);
        let truth = self.truth.map(|[q, qd, qdd, tau]| {
            Arc::new(Signals { q: take(&q), qd: take(&qd), qdd: take(&qdd), tau: take(&tau) })
        });
        Recording { joints: self.joints, time, q, qd, qdd, tau, truth, ..Default::default() }
    }
}
