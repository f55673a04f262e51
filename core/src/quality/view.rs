//! A log at even steps with its smoothed signals, as all checks see it.

use crate::channels::Channels;
use crate::error::Result;
use crate::recording::Recording;
use crate::robot::{JointKind, Robot};
use crate::signal::{Edge, NoiseGains, SavitzkyGolay, Slow, moves_enough, size_quantile};

/// Time over which positions are smoothed for the checks, s.
const SMOOTHING_S: f64 = 0.08;

/// A log at even steps with what all checks need of it.
pub(super) struct View<'a> {
    /// The log.
    pub log: &'a Recording,
    /// Time between two samples, s.
    pub period: f64,
    /// Positions, by Savitzky-Golay.
    pub q: Channels,
    /// Their velocities.
    pub qd: Channels,
    /// Their accelerations.
    pub qdd: Channels,
    /// Torques, by Savitzky-Golay.
    pub tau: Channels,
    /// Samples by which the torques come behind the motion, as far as that is known: descriptions are judged without that time.
    pub late: isize,
    /// Whether the torques are motor currents, or percent of rated torques, by their names.
    pub is_current: bool,
    /// Speed above which each joint surely moves, rad/s or m/s; none reaches it where the joint hardly moves at all.
    pub band: Vec<f64>,
    /// Samples at which each joint surely moves by its own speed and noise, also where it hardly moves at all.
    pub moving: Vec<usize>,
}

impl<'a> View<'a> {
    /// Smooths a log; `robot` determines which joints slide.
    ///
    /// # Errors
    /// Those of the filters: the log is too short.
    pub(super) fn new(log: &'a Recording, robot: Option<&Robot>) -> Result<Self> {
        let period = 1.0 / log.rate_hz();
        let window = ((SMOOTHING_S / period).round() as usize | 1).clamp(7, 101).min((log.samples() - 1) | 1);
        let smooth = |signals: &Channels, degree| -> Result<Channels> {
            let smoother = SavitzkyGolay::new(window, 4, degree, period, Edge::Polynomial)?;
            let mut out = Channels::zeros(signals.channels(), signals.samples());
            for joint in 0..signals.channels() {
                smoother.apply(signals.channel(joint), out.channel_mut(joint))?;
            }
            Ok(out)
        };
        let (q, qd) = (smooth(&log.q, 0)?, smooth(&log.q, 1)?);
        let gains = NoiseGains::new(log.samples(), |impulse| {
            let impulse = Channels::from_vectors(&[impulse.to_vec()]);
            Ok([smooth(&impulse, 0)?, smooth(&impulse, 1)?].map(|passed| passed.channel(0).to_vec()))
        })?;
        let each = (0..log.joints()).map(|joint| {
            let (own, velocity) = (log.q.channel(joint), qd.channel(joint));
            let sure = Slow::new(velocity, gains.velocity_noise(own, q.channel(joint))).sure;
            let moves = moves(own, velocity, robot.map(|robot| robot.joints[joint].kind));
            let moving = velocity.iter().filter(|velocity| velocity.abs() > sure).count();
            (if moves { sure } else { f64::INFINITY }, moving)
        });
        let (band, moving) = each.unzip();
        let [qdd, tau] = [smooth(&log.q, 2)?, smooth(&log.tau, 0)?];
        Ok(View { log, period, late: 0, is_current: false, band, moving, q, qd, qdd, tau })
    }

    /// Number of joints.
    pub(super) fn dof(&self) -> usize {
        self.log.joints()
    }

    /// A column as the file may call it, with the joint.
    pub(super) fn place(&self, quantity: &str, joint: usize) -> String {
        format!("{quantity}{} ({})", joint + 1, self.log.joints[joint])
    }
}

/// Whether a joint moves enough, from its positions and velocities.
pub(super) fn moves(q: &[f64], qd: &[f64], kind: Option<JointKind>) -> bool {
    let (low, high) = q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    moves_enough(high - low, size_quantile(qd.iter().copied(), 1.0), kind == Some(JointKind::Prismatic))
}
