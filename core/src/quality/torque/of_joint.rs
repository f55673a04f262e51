//! What the torque of one joint shows by itself: the residual of its own model, a constant, and lags behind the motion.

use super::dead_time::{Lag, Search};
use super::joint_fit::JointFit;
use super::since_reversal::SinceReversal;
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::quality::channels::spoilt;
use crate::quality::motion::Constant;
use crate::quality::view::View;
use std::ops::Range;

/// The torque of a joint against its own model.
pub(super) struct OfJoint {
    /// Share of the torque that the model does not explain.
    pub unexplained: f64,
    /// The constant that explains most of that; None where the model has one.
    pub constant: Option<Constant>,
    /// Its lags; None where they are not asked for, or the torque is no measurement in parts, which lags nothing.
    pub lags: Option<LagsOfJoint>,
}

/// Lags of a torque behind the motion, by all samples and by those away from reversals.
pub(super) struct LagsOfJoint {
    pub near: Option<Lag>,
    pub far: Option<Lag>,
    pub near_away: Option<Lag>,
    pub far_away: Option<Lag>,
}

/// The model of a joint along the rows of a log.
pub(super) struct Rows<'a> {
    pub view: &'a View<'a>,
    pub rows: &'a [usize],
    /// The smoothed motion at the rows.
    pub motion: &'a Motion,
    /// Samples to either side that lags are looked for at once.
    pub reach: usize,
    /// Whether the arm is known, so that lags can be told from the pull of other joints.
    pub asks_lags: bool,
}

impl OfJoint {
    /// Of a joint, by the `columns` of its model; None where its torque is silent or no row is left.
    pub(super) fn new(along: &Rows, joint: usize, columns: &Channels) -> Option<OfJoint> {
        let view = along.view;
        let tau = view.tau.channel(joint);
        if tau.iter().all(|v| *v == tau[0] || v.is_nan()) {
            return None;
        }
        let fit = |columns: &Channels, wanted: &dyn Fn(usize) -> bool| {
            JointFit::new(columns, along.rows, along.motion.qd.channel(joint), view.band[joint], wanted)
        };
        // Smoothing carries what is no measurement to its neighbours.
        let around = |part: Range<usize>| part.start.saturating_sub(along.reach)..part.end + along.reach;
        let spoilt: Vec<Range<usize>> = spoilt(view, joint).into_iter().map(around).collect();
        let is_measured = |row: usize| spoilt.iter().all(|part| !part.contains(&row));
        let own = fit(columns, &is_measured).or_else(|| fit(columns, &|_| true))?;
        let (unexplained, constant) = (own.unexplained(tau, 0), own.constant(tau));
        if !along.asks_lags || !spoilt.is_empty() {
            return Some(OfJoint { unexplained, constant, lags: None });
        }
        let since = SinceReversal::of(view, joint);
        let with_reversals = columns.iter().map(<[f64]>::to_vec).chain(since.decaying(along.rows));
        let with_reversals = Channels::from_vectors(&with_reversals.collect::<Vec<_>>());
        let (near, far) = (Search::Near(along.reach), Search::far(view));
        let is_away = |search: Search, row: usize| search.is_within(row, tau.len()) && since.is_built_up(row);
        let lag = |search: Search, fit: Option<JointFit>| fit.and_then(|fit| search.lag(&fit, tau));
        let lags = LagsOfJoint {
            near: lag(near, fit(&with_reversals, &|_| true)),
            far: lag(far, fit(&with_reversals, &|row| far.is_within(row, tau.len()))),
            near_away: lag(near, fit(columns, &|row| is_away(near, row))),
            far_away: lag(far, fit(columns, &|row| is_away(far, row))),
        };
        Some(OfJoint { unexplained, constant, lags: Some(lags) })
    }
}
