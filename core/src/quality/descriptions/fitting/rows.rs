//! The rows on which descriptions of the logs are compared: few, band-limited, and cut into blocks of time.

use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::linear::root_mean_square;
use crate::quality::channels;
use crate::quality::view::{self, View};
use crate::robot::{JointKind, Limits, Robot};
use std::ops::Range;

/// Spacing of the rows, s. Gravity, inertia and friction of an arm act below 10 Hz; more rows would only repeat them.
const SPACING_S: f64 = 0.05;

/// Most rows of all logs together: a search over a hundred descriptions then takes seconds.
const MOST_ROWS: usize = 1500;

/// Blocks of time that are aimed at. Each is held out in turn, and each counts as one observation in the paired comparison,
/// since residuals within it are dependent.
const BLOCKS: f64 = 20.0;

/// Shortest block, s: noise and what friction does after a reversal are dependent for less.
const SHORTEST_BLOCK_S: f64 = 0.5;

/// Samples at either end of a log whose derivatives are one-sided, s.
const EDGE_S: f64 = 0.08;

/// Share of the samples of a torque from which it is left out where they are no measurements: without those rows too little of the others
/// would be left.
const MOSTLY: f64 = 0.2;

/// A joint slower than this share of its own root mean square speed may stick: its direction is not certain.
const STICKS: f64 = 0.1;

/// No joint is faster, rad/s or m/s: such a velocity comes from a jump of the position.
const FASTEST: f64 = 50.0;

/// Rows of all logs, one after the other.
#[derive(Clone)]
pub(crate) struct Rows {
    /// Smoothed motion as logged, `[channel][row]`.
    pub motion: Motion,
    /// Smoothed torque as logged, `[channel][row]`.
    pub tau: Channels,
    /// Block of every row.
    pub block: Vec<usize>,
    /// Log of every block.
    pub log: Vec<usize>,
    /// Whether a position channel surely moves, `[channel][row]`.
    pub moves: Vec<Vec<bool>>,
    /// Whether a joint turns, and does not slide.
    pub turns: Vec<bool>,
    /// Limits of every joint, where they are known.
    pub limits: Vec<Option<Limits>>,
    /// Whether a torque channel holds measurements that change.
    pub measured: Vec<bool>,
    /// Root mean square of every torque channel.
    pub size: Vec<f64>,
    /// Whether the bodies are taken at rest at every position, so that gravity alone is their torque.
    pub at_rest: bool,
}

impl Rows {
    /// The rows of some logs of one arm.
    pub(crate) fn new(views: &[&View], robot: Option<&Robot>) -> Option<Rows> {
        let first = views.first()?;
        let dof = first.dof();
        let seconds: f64 = views.iter().map(|view| view.log.duration()).sum();
        let spacing = SPACING_S.max(seconds / MOST_ROWS as f64);
        let length = (seconds / BLOCKS).max(SHORTEST_BLOCK_S);
        let mut picked: Vec<(usize, usize)> = Vec::new();
        let mut spoilt = vec![false; dof];
        let (mut block, mut log) = (Vec::new(), Vec::new());
        for (place, view) in views.iter().enumerate() {
            let samples = view.log.samples();
            let edge = ((EDGE_S / view.period).round() as usize).max(view.late.unsigned_abs()).min(samples / 4);
            let step = ((spacing / view.period).round() as usize).max(1);
            let usable = usable(view, &mut spoilt);
            let own: Vec<usize> = (edge..samples - edge).step_by(step).filter(|&sample| usable[sample]).collect();
            let blocks = ((view.log.duration() / length).round() as usize).max(1);
            block.extend((0..own.len()).map(|row| log.len() + row * blocks / own.len()));
            log.extend(std::iter::repeat_n(place, blocks));
            picked.extend(own.into_iter().map(|sample| (place, sample)));
        }
        let pick = |picked: &[(usize, usize)], of: for<'v> fn(&'v View) -> &'v Channels| -> Channels {
            let at = |joint: usize, (place, row): (usize, usize)| of(views[place]).channel(joint)[row];
            let channel = |joint: usize| picked.iter().map(|&own| at(joint, own)).collect();
            Channels::from_vectors(&(0..dof).map(channel).collect::<Vec<Vec<f64>>>())
        };
        let motion = Motion {
            q: pick(&picked, |view| &view.q),
            qd: pick(&picked, |view| &view.qd),
            qdd: pick(&picked, |view| &view.qdd),
        };
        for (place, row) in &mut picked {
            *row = row.saturating_add_signed(views[*place].late).min(views[*place].log.samples() - 1);
        }
        let tau = pick(&picked, |view| &view.tau);
        let kind = |joint: usize| robot.map(|robot| robot.joints[joint].kind);
        let moves = (0..dof).map(|joint| moves(motion.q.channel(joint), motion.qd.channel(joint), kind(joint)));
        let measured = |tau: &[f64]| tau.iter().all(|v| v.is_finite()) && tau.iter().any(|v| *v != tau[0]);
        Some(Rows {
            moves: moves.collect(),
            turns: (0..dof).map(|joint| kind(joint) != Some(JointKind::Prismatic)).collect(),
            limits: (0..dof).map(|joint| robot.map(|robot| robot.joints[joint].limits)).collect(),
            measured: tau.iter().zip(spoilt).map(|(tau, spoilt)| !spoilt && measured(tau)).collect(),
            size: tau.iter().map(root_mean_square).collect(),
            at_rest: false,
            motion,
            tau,
            block,
            log,
        })
    }
}

impl Rows {
    /// All rows with one block per log: for fits of all rows, which ask for no blocks.
    pub(crate) fn whole(&self) -> Rows {
        self.thinned(self.block.len())
    }

    /// About so many of the rows, evenly spaced, with one block per log: for a scan over many motions.
    pub(crate) fn thinned(&self, count: usize) -> Rows {
        let step = (self.block.len() / count.max(1)).max(1);
        let pick = |table: &Channels| table.map(|_, channel| channel.iter().copied().step_by(step).collect());
        Rows {
            motion: Motion { q: pick(&self.motion.q), qd: pick(&self.motion.qd), qdd: pick(&self.motion.qdd) },
            tau: pick(&self.tau),
            block: self.block.iter().step_by(step).map(|&block| self.log[block]).collect(),
            log: (0..self.logs()).collect(),
            moves: self.moves.iter().map(|moves| moves.iter().copied().step_by(step).collect()).collect(),
            turns: self.turns.clone(),
            limits: self.limits.clone(),
            measured: self.measured.clone(),
            size: self.size.clone(),
            at_rest: self.at_rest,
        }
    }

    /// By how much the positions of a joint leave its limits, rad (m); zero or less where they do not.
    pub(crate) fn beyond_limits(&self, joint: usize, positions: &[f64]) -> f64 {
        self.limits[joint].map_or(f64::NEG_INFINITY, |limits| limits.left_by(positions))
    }

    /// Number of logs.
    pub(crate) fn logs(&self) -> usize {
        self.log.last().map_or(0, |last| last + 1)
    }
}

/// Samples at which the motion is known and all torques are measurements. A joint of which too many are none is left out instead: it is
/// `spoilt`.
fn usable(view: &View, spoilt: &mut [bool]) -> Vec<bool> {
    let samples = view.log.samples();
    let margin = (EDGE_S / view.period).round() as usize;
    let mut usable = vec![true; samples];
    let mut leave_out = |part: Range<usize>| {
        usable[part.start.saturating_sub(margin)..(part.end + margin).min(samples)].fill(false);
    };
    let frozen = channels::frozen_rows(view);
    (0..samples).filter(|&sample| frozen[sample]).for_each(|sample| leave_out(sample..sample + 1));
    for (joint, spoilt) in spoilt.iter_mut().enumerate() {
        let parts = channels::spoilt_torques(view, joint);
        if parts.iter().map(Range::len).sum::<usize>() as f64 > MOSTLY * samples as f64 {
            *spoilt = true;
            continue;
        }
        parts.into_iter().for_each(&mut leave_out);
    }
    usable
}

/// Where a position surely changes; nowhere for one that stands still throughout.
fn moves(q: &[f64], qd: &[f64], kind: Option<JointKind>) -> Vec<bool> {
    let enough = view::moves(q, qd, kind);
    let sticks = STICKS * root_mean_square(qd);
    qd.iter().map(|v| enough && v.abs() > sticks && v.abs() < FASTEST).collect()
}
