//! What a recording shows: motions, lines and markers on one timeline.

use crate::channels::Channels;
use crate::robot::Robot;

/// Time between two logs on the timeline, s.
pub const PAUSE_S: f64 = 1.0;

/// Everything that a recording shows.
///
/// ```
/// use tauscope::channels::Channels;
/// use tauscope::report::viewer::{Film, Look, Quantity, Track};
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
///
/// // A pendulum that swings for 2 s, with a line of its position.
/// let (time, q) = (vec![0.0, 1.0, 2.0], vec![0.0, 0.5, 0.0]);
/// let track = Track { name: "measured", ghost: false, time: time.clone(), q: Channels::from_vectors(&[q.clone()]) };
/// let (title, text) = ("A swing".to_owned(), String::new());
/// let mut film = Film { title, robot: &robot, text, tracks: vec![track], signals: Vec::new(), markers: Vec::new() };
/// film.add(Quantity::Position, "measured", Look::Measured, |_| (time.clone(), q.clone()));
///
/// assert_eq!((film.span(), film.signals.len()), ([0.0, 2.0], 1));
/// assert!(film.path(&film.signals[0]).contains("pivot"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Film<'a> {
    /// Heading.
    pub title: String,
    /// The arm that moves.
    pub robot: &'a Robot,
    /// The verdict, in Markdown.
    pub text: String,
    /// Motions of the arm.
    pub tracks: Vec<Track>,
    /// Lines of the plots.
    pub signals: Vec<Signal>,
    /// What happens when.
    pub markers: Vec<Marker>,
}

/// A motion of the arm.
///
/// ```
/// use tauscope::channels::Channels;
/// use tauscope::report::viewer::Track;
///
/// // The simulated arm is shown in outline where it follows the measured one.
/// let q = Channels::from_vectors(&[vec![0.0, 0.5, 0.0]]);
/// let simulated = Track { name: "simulated", ghost: true, time: vec![0.0, 1.0, 2.0], q };
/// assert_eq!(simulated.time.len(), simulated.q.samples());
/// ```
#[derive(Debug, Clone)]
pub struct Track {
    /// Whose motion: "measured", "simulated".
    pub name: &'static str,
    /// Shown in outline rather than solid.
    pub ghost: bool,
    /// Time of every sample, s.
    pub time: Vec<f64>,
    /// Joint positions, rad.
    pub q: Channels,
}

/// What a plot shows.
///
/// ```
/// use tauscope::report::viewer::Quantity;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
///
/// assert_eq!(Quantity::Torque.unit(&robot, 0), "N m");
/// assert_eq!(Quantity::ALL[0], Quantity::Residual);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Torques, N m.
    Torque,
    /// Measured torque less a model's, N m.
    Residual,
    /// Joint positions, rad.
    Position,
    /// Joint velocities, rad/s.
    Velocity,
}

impl Quantity {
    /// All, in the order of the tabs.
    pub const ALL: [Quantity; 4] = [Quantity::Residual, Quantity::Torque, Quantity::Position, Quantity::Velocity];

    /// Name in entity paths.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Torque => "torque",
            Quantity::Residual => "residual",
            Quantity::Position => "position",
            Quantity::Velocity => "velocity",
        }
    }

    /// Heading of the tab.
    pub fn title(self) -> &'static str {
        match self {
            Quantity::Torque => "Torque",
            Quantity::Residual => "Residual",
            Quantity::Position => "Position",
            Quantity::Velocity => "Velocity",
        }
    }

    /// Unit on a joint.
    pub fn unit(self, robot: &Robot, joint: usize) -> String {
        let joint = &robot.joints[joint];
        match self {
            Quantity::Torque | Quantity::Residual => joint.effort_unit().to_owned(),
            Quantity::Position => joint.position_unit().to_owned(),
            Quantity::Velocity => format!("{}/s", joint.position_unit()),
        }
    }
}

/// How a line looks: one look for one meaning, in all plots.
///
/// ```
/// use tauscope::report::viewer::{Look, Quantity, Signal};
///
/// // Measured and predicted torque of a joint differ in their look in all plots.
/// let (time, values) = (vec![0.0, 1.0], vec![3.0, 4.0]);
/// let (quantity, look) = (Quantity::Torque, Look::Measured);
/// let measured = Signal { quantity, joint: 0, name: "measured", look, time, values };
/// let predicted = Signal { name: "with the findings", look: Look::Extended, ..measured.clone() };
/// assert_ne!(measured.look, predicted.look);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// Sensor signals.
    Measured,
    /// Prediction of a model without the findings, or of the simulation.
    Simulated,
    /// Prediction of the model with the findings, or of the identified model.
    Extended,
    /// What was asked for.
    Reference,
    /// The noise floor.
    Noise,
}

/// A line of a plot.
///
/// ```
/// use tauscope::report::viewer::{Film, Look, Quantity, Signal};
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
///
/// // NaN breaks a line, here between two logs.
/// let (time, values) = (vec![0.0, 1.0, 1.5, 2.0], vec![0.1, 0.2, f64::NAN, 0.3]);
/// let name = "without the findings";
/// let signal = Signal { quantity: Quantity::Residual, joint: 0, name, look: Look::Simulated, time, values };
/// # let (title, text, tracks, markers) = (String::new(), String::new(), Vec::new(), Vec::new());
/// # let film = Film { title, robot: &robot, text, tracks, signals: Vec::new(), markers };
/// assert!(film.path(&signal).ends_with("without_the_findings"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Signal {
    /// What it is.
    pub quantity: Quantity,
    /// The joint.
    pub joint: usize,
    /// Name in the legend and, with `_` for spaces, in the entity path.
    pub name: &'static str,
    /// How it looks.
    pub look: Look,
    /// Time of every sample, s.
    pub time: Vec<f64>,
    /// Values; NaN breaks the line.
    pub values: Vec<f64>,
}

/// Something that happens at a time.
///
/// ```
/// use tauscope::report::viewer::Marker;
///
/// let marker = Marker { time: 12.5, text: "external_contact begins".to_owned(), finding: true };
/// assert!(marker.finding);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Marker {
    /// When, s.
    pub time: f64,
    /// What.
    pub text: String,
    /// Whether it is a finding rather than an event of the log.
    pub finding: bool,
}

impl Film<'_> {
    /// Entity path of a signal.
    pub fn path(&self, signal: &Signal) -> String {
        let joint = part(&self.robot.joints[signal.joint].name);
        format!("{}/{joint}/{}", signal.quantity.name(), part(signal.name))
    }

    /// First and last time of anything, s.
    pub fn span(&self) -> [f64; 2] {
        let times = self.tracks.iter().map(|track| &track.time).chain(self.signals.iter().map(|signal| &signal.time));
        let ends = times.filter_map(|time| Some((*time.first()?, *time.last()?)));
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (a, b)| (l.min(a), h.max(b)));
        if low <= high { [low, high] } else { [0.0, 1.0] }
    }

    /// Adds a line for every joint: `of` gives time and values of a joint.
    pub fn add(
        &mut self,
        quantity: Quantity,
        name: &'static str,
        look: Look,
        of: impl Fn(usize) -> (Vec<f64>, Vec<f64>),
    ) {
        for joint in 0..self.robot.dof() {
            let (time, values) = of(joint);
            self.signals.push(Signal { quantity, joint, name, look, time, values });
        }
    }

    /// Adds the band of plus and minus the noise of every joint over the whole span to the residuals.
    pub fn add_noise(&mut self, noise: &[f64]) {
        let span = self.span().to_vec();
        for (name, sign) in [("noise floor", 1.0), ("minus noise floor", -1.0)] {
            self.add(Quantity::Residual, name, Look::Noise, |joint| (span.clone(), vec![sign * noise[joint]; 2]));
        }
    }
}

/// A name as a part of an entity path, in which few characters need no escape.
pub fn part(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

/// Where each of several logs starts on the timeline, as what is added to its own times. Each log's first and last time
/// are given.
pub fn offsets(logs: impl IntoIterator<Item = [f64; 2]>) -> Vec<f64> {
    let mut end = None;
    logs.into_iter()
        .map(|[first, last]| {
            let offset = end.map_or(0.0, |end: f64| end + PAUSE_S - first);
            end = Some(last + offset);
            offset
        })
        .collect()
}

/// Several logs' times one after the other, with a sample between two logs at which lines break.
pub fn joined_time(logs: &[(f64, &[f64])]) -> Vec<f64> {
    let mut all = Vec::new();
    for (offset, time) in logs {
        if let Some(&last) = all.last() {
            all.push(last + 0.5 * PAUSE_S);
        }
        all.extend(time.iter().map(|t| t + offset));
    }
    all
}

/// The values that go with [`joined_time`].
pub fn joined(logs: &[&[f64]]) -> Vec<f64> {
    logs.join(&[f64::NAN][..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parts_of_paths() {
        assert_eq!(part("joint a/1.2"), "joint_a_1_2");
    }

    #[test]
    fn logs_follow_each_other() {
        assert_eq!(offsets([[0.0, 10.0], [0.0, 4.0], [2.0, 3.0]]), [0.0, 11.0, 14.0]);
        assert_eq!(offsets([[5.0, 10.0], [5.0, 6.0]]), [0.0, 6.0]);
        let time = joined_time(&[(0.0, &[0.0, 1.0]), (2.0, &[0.0, 1.0])]);
        let values = joined(&[&[7.0, 8.0], &[9.0, 10.0]]);
        assert_eq!(time, [0.0, 1.0, 1.5, 2.0, 3.0]);
        assert_eq!(values.iter().map(|v| v.is_nan()).collect::<Vec<_>>(), [false, false, true, false, false]);
    }
}
