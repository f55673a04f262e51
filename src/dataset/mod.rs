//! `dataset.toml`: what a log's file cannot say of itself. Columns, units, motors and gears, mounting and payload, and
//! which logs train and which are held out.
//!
//! ```toml
//! schema = "tauscope.dataset/1"
//! robot = "arm.urdf"            # beside this file
//! joints = ["j1", "j2"]         # joints under study, in the order of columns and lists below; without, those that the logs name
//!
//! [[train]]
//! file = "a.csv"
//! [[test]]
//! file = "b.csv"                # from_s and to_s, on the log's clock, take a part of a file
//! # files = ["q.csv", "tau.csv"]  # in the place of `file`: columns in several files, rows matched one by one where there
//!                                 # are as many in each, else by time
//! # rate_hz = 100                 # rows per second of files without a column of time; also in [columns]
//!
//! [columns]                     # one per joint; usual names are found without
//! time = "stamp"
//! # rate_hz = 100               # in the place of `time`
//! q = ["enc1", "enc2"]
//! tau = ["i1", "i2"]
//! topic = "/joint_states"       # of a log of ROS 2 with several that tell of the joints
//!
//! [units]
//! time = "ms"                   # s, ms, us, ns; recognised from its name and numbers where it is not given
//! position = "deg"              # rad, deg, mrad, rev, m, mm
//! velocity = "rpm"              # rad/s, deg/s, mrad/s, rpm, m/s, mm/s
//! acceleration = "deg/s2"       # rad/s2, deg/s2, m/s2
//! torque = "A"                  # Nm, mNm, kNm, A, mA, N
//! time_factor = 1.6             # of a clock that runs wrong: true seconds per second of the log
//!
//! [motors]                      # a number for all or one per joint
//! gear_ratio = [100.0, 80.0]    # turns of the motor per turn of the joint
//! torque_constant_nm_a = 0.12
//! sign = [1, -1]                # of position, velocity and torque
//! torque_sign = -1              # of torque alone
//! torque_offset = 0.4           # N m (N) at the joint that the torque shows too much
//! position_at = "motor"         # or "joint"
//! torque_at = "motor"           # or "joint"; currents are at the motor
//! coupling = [[1.0, 0.0], [0.5, 1.0]]   # joints = coupling x motors, behind their gears
//! torques_exchanged = [["j1", "j2"]]    # pairs of joints in each other's columns of torque
//! positions_exchanged = [["j1", "j2"]]  # the same of position, velocity and acceleration
//!
//! [hold]                        # joints not under study that the logs do not have, or not at one place, rad or m
//! finger_joint = 0.02
//!
//! [payload]                     # at the flange, known
//! mass_kg = 5.0
//! center_m = [0.0, 0.0, 0.1]
//! inertia_kg_m2 = [0.1, 0.0, 0.1, 0.0, 0.0, 0.1]   # about its centre: xx, xy, yy, xz, yz, zz
//!
//! [mounting]
//! gravity_m_s2 = [0.0, 0.0, 9.81]   # in the base frame: an arm that hangs
//! ```

pub mod arm;
mod convert;
mod corrected;
mod still;
mod units;

pub use corrected::{Named, corrected};
pub use units::{PositionUnit, TimeUnit, TorqueUnit, VelocityUnit};

use crate::error::{Error, Result};
use crate::quality;
use crate::quality::descriptions::Description;
use crate::recording::lenient::{self, ColumnMap, Sieved};
use crate::recording::{Recording, resample};
use crate::robot::{Inertia, Robot};
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use units::AccelerationUnit;

/// Schema of the file.
pub const SCHEMA: &str = "tauscope.dataset/1";

/// No arm is mounted where gravity is larger, m/s2.
const LARGEST_GRAVITY: f64 = 1e3;

/// A description of logs.
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    path: PathBuf,
    text: String,
    spec: Spec,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Spec {
    schema: String,
    robot: Option<PathBuf>,
    joints: Option<Vec<String>>,
    /// Where joints stand that are not under study, rad or m.
    #[serde(default)]
    hold: BTreeMap<String, f64>,
    #[serde(default)]
    train: Vec<Part>,
    #[serde(default)]
    test: Vec<Part>,
    #[serde(default)]
    columns: ColumnMap,
    #[serde(default)]
    units: Units,
    #[serde(default)]
    motors: Motors,
    payload: Option<Payload>,
    #[serde(default)]
    mounting: Mounting,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Part {
    file: Option<PathBuf>,
    /// Files whose columns belong together, in the place of `file`.
    files: Option<Vec<PathBuf>>,
    /// Rows per second, Hz, of files without a column of time.
    rate_hz: Option<f64>,
    from_s: Option<f64>,
    to_s: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Units {
    time: Option<TimeUnit>,
    position: PositionUnit,
    velocity: VelocityUnit,
    acceleration: AccelerationUnit,
    torque: TorqueUnit,
    time_factor: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Motors {
    gear_ratio: Option<PerJoint>,
    torque_constant_nm_a: Option<PerJoint>,
    sign: Option<PerJoint>,
    torque_sign: Option<PerJoint>,
    position_at: Option<Side>,
    torque_at: Option<Side>,
    coupling: Option<Vec<Vec<f64>>>,
    torque_offset: Option<PerJoint>,
    torques_exchanged: Option<Vec<[String; 2]>>,
    positions_exchanged: Option<Vec<[String; 2]>>,
}

/// A number for all joints, or one each.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a number, or a list of one number per joint")]
enum PerJoint {
    All(f64),
    Each(Vec<f64>),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Side {
    Joint,
    Motor,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Payload {
    mass_kg: f64,
    #[serde(default)]
    center_m: [f64; 3],
    #[serde(default)]
    inertia_kg_m2: [f64; 6],
}

#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Mounting {
    gravity_m_s2: Option<[f64; 3]>,
}

/// Logs made ready, in SI units at the joints and at even steps, with what had to be done to them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Logs {
    /// Logs to identify from.
    pub train: Vec<Recording>,
    /// Logs to judge by.
    pub test: Vec<Recording>,
    /// Rows left out, clocks made even, and warnings of [`quality::examine`]; each begins with the file.
    pub notes: Vec<String>,
    /// The description that the logs were taken by, where the given one is wrong beyond doubt; the arm's gravity is then the
    /// one in it.
    pub correction: Option<Description>,
}

impl Dataset {
    /// Reads a description. Files named in it are beside it.
    ///
    /// # Errors
    /// An unreadable file, an unknown key or unit, another schema, no log to train from.
    pub fn load(path: impl AsRef<Path>) -> Result<Dataset> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|source| Error::io(path, "read the dataset", source))?;
        let spec: Spec = toml::from_str(&text).map_err(|error| Error::toml(path, &text, &error))?;
        let dataset = Dataset { path: path.to_owned(), text, spec };
        if dataset.spec.schema != SCHEMA {
            return Err(dataset.error("schema", format!("`{}` is not known; this is {SCHEMA}", dataset.spec.schema)));
        }
        if dataset.spec.train.is_empty() {
            return Err(dataset.error("train", "name at least one log: [[train]] with file = \"...\""));
        }
        dataset.check_parts()?;
        Ok(dataset)
    }

    /// Parts end after they begin, and what judges is not what was trained from.
    fn check_parts(&self) -> Result<()> {
        for (key, part) in self.parts() {
            if part.file.is_some() == part.files.is_some() || part.paths().is_empty() {
                let problem =
                    "name the log by file = \"...\", or by files = [\"...\", \"...\"] where its columns are in several";
                return Err(self.error(key, problem));
            }
            let [from, to] = part.seconds();
            // Not a number compares to nothing.
            if from.partial_cmp(&to) != Some(std::cmp::Ordering::Less) {
                let problem = format!("{}: from {from} s to {to} s is no part of a log", part.name());
                return Err(self.error(key, problem));
            }
        }
        for test in &self.spec.test {
            let [from, to] = test.seconds();
            let shares = |train: &&Part| {
                let [begin, end] = train.seconds();
                train.paths().iter().any(|path| test.paths().contains(path)) && begin < to && from < end
            };
            if let Some(train) = self.spec.train.iter().find(shares) {
                let problem = format!(
                    "{} is trained from in part or as a whole; judge by what the fit did not see, with to_s in [[train]] and \
                     from_s in [[test]] or with another log",
                    train.name()
                );
                return Err(self.error("test", problem));
            }
        }
        Ok(())
    }

    fn parts(&self) -> impl Iterator<Item = (&'static str, &Part)> {
        let of = |key| move |part| (key, part);
        self.spec.train.iter().map(of("train")).chain(self.spec.test.iter().map(of("test")))
    }

    /// The URDF that the dataset names.
    pub fn robot(&self) -> Option<PathBuf> {
        self.spec.robot.as_ref().map(|robot| self.beside(robot))
    }

    /// All logs it names, those to train from first; of a log in several files the first of them.
    pub fn files(&self) -> Vec<PathBuf> {
        self.parts().filter_map(|(_, part)| Some(self.beside(part.paths().first()?))).collect()
    }

    /// Puts the mounting and the known payload on an arm.
    ///
    /// # Errors
    /// Numbers that are not finite, a payload that no body can have.
    pub fn mount(&self, robot: &mut Robot) -> Result<()> {
        if let Some(gravity) = self.spec.mounting.gravity_m_s2 {
            let gravity = Vector3::from(gravity);
            if !gravity.norm().is_finite() || gravity.norm() > LARGEST_GRAVITY {
                let problem = format!("{:?} is no gravity in m/s2", gravity.as_slice());
                return Err(self.error("mounting.gravity_m_s2", problem));
            }
            robot.gravity = gravity;
        }
        let Some(payload) = &self.spec.payload else { return Ok(()) };
        let (tip, flange) = (robot.tip(), robot.flange);
        let last = robot.body_mut(tip);
        let [xx, xy, yy, xz, yz, zz] = payload.inertia_kg_m2;
        let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let body = Inertia::from_center_of_mass(payload.mass_kg, Vector3::from(payload.center_m), tensor);
        if let Some(problem) = body.physical_fault(1e-3) {
            return Err(self.error("payload", problem));
        }
        last.inertia = last.inertia.welded_to(&body.seen_from_parent(&flange.rotation, &flange.translation));
        Ok(())
    }

    /// Reads one log as the dataset says: SI units, at the joints, in the order of `robot`'s joints.
    ///
    /// # Errors
    /// Those of [`lenient::load`]; lists that do not fit the joints, units that need what is not given.
    pub fn read(&self, file: &Path, robot: &Robot) -> Result<Sieved> {
        let is_file = |own: &PathBuf| match (own.canonicalize(), file.canonicalize()) {
            (Ok(own), Ok(file)) => own == file,
            _ => false,
        };
        // A file that is a part of a log is read together with the others.
        let whole = self.parts().find_map(|(_, part)| {
            let files = self.beside_all(part);
            files.iter().any(is_file).then_some((files, part.rate_hz))
        });
        let (files, rate_hz) = whole.unwrap_or_else(|| (vec![file.to_owned()], None));
        self.read_together(&files, rate_hz, robot)
    }

    /// The same of a log whose columns are in several files; `rate_hz` where it is known and they have no time.
    fn read_together(&self, files: &[PathBuf], rate_hz: Option<f64>, robot: &Robot) -> Result<Sieved> {
        let order = self.spec.joints.as_ref().unwrap_or(&robot.columns);
        if let Some(missing) = robot.joint_names().into_iter().find(|name| !order.contains(name)) {
            let names = robot.joint_names().join(", ");
            let problem = format!("{} are not the robot's joints {names}: `{missing}` is missing", order.join(", "));
            return Err(self.error("joints", problem));
        }
        let mut columns = self.spec.columns.clone();
        columns.rate_hz = rate_hz.or(columns.rate_hz);
        columns.time_factor = self.spec.units.time.map(TimeUnit::factor);
        let mut sieved = lenient::load_together(files, Some(order), &columns)?;
        self.convert(&mut sieved)?;
        arm::select(&mut sieved, order, &robot.joint_names());
        self.exchange(&mut sieved.recording)?;
        Ok(sieved)
    }

    /// Reads all logs, or the parts of them that are wanted, and leaves them as they are otherwise: those to train from,
    /// then those to judge by, each with its file.
    ///
    /// # Errors
    /// Those of [`Dataset::read`].
    pub fn sieved(&self, robot: &Robot) -> Result<[Vec<(PathBuf, Sieved)>; 2]> {
        let read = |key: &str, parts: &[Part]| -> Result<Vec<(PathBuf, Sieved)>> {
            let one = |part: &Part| {
                let files = self.beside_all(part);
                let path = files[0].clone();
                let sieved = self.read_together(&files, part.rate_hz, robot)?;
                let ends = [sieved.recording.time.first(), sieved.recording.time.last()]
                    .map(|t| (t.copied().unwrap_or(0.0) * 1e6).round() / 1e6);
                let sieved = part.of(sieved);
                if sieved.recording.time.is_empty() {
                    let ([from, to], [first, last]) = (part.seconds(), ends);
                    let problem = format!(
                        "{}: no row is from {from} s to {to} s; the log's clock goes from {first} s to {last} s",
                        part.name()
                    );
                    return Err(self.error(key, problem));
                }
                Ok((path, sieved))
            };
            parts.iter().map(one).collect()
        };
        Ok([read("train", &self.spec.train)?, read("test", &self.spec.test)?])
    }

    fn beside_all(&self, part: &Part) -> Vec<PathBuf> {
        part.paths().into_iter().map(|path| self.beside(path)).collect()
    }

    fn beside(&self, file: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(file)
    }

    /// An error about a key, at its line.
    fn error(&self, key: &str, problem: impl Into<String>) -> Error {
        let last = key.rsplit('.').next().unwrap_or(key);
        let line = self.text.lines().position(|line| {
            let line = line.trim_start().trim_start_matches('[');
            line.strip_prefix(last).is_some_and(|rest| rest.trim_start().starts_with(['=', ']']))
        });
        Error::input(&self.path, line.map(|line| line + 1), key, problem)
    }
}

impl Part {
    /// The files of the log.
    fn paths(&self) -> Vec<&PathBuf> {
        self.file.iter().chain(self.files.iter().flatten()).collect()
    }

    /// The files in messages.
    fn name(&self) -> String {
        self.paths().iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(" and ")
    }

    /// From when to when, on the log's clock.
    fn seconds(&self) -> [f64; 2] {
        [self.from_s.unwrap_or(f64::NEG_INFINITY), self.to_s.unwrap_or(f64::INFINITY)]
    }

    /// The part of a log that is wanted.
    fn of(&self, sieved: Sieved) -> Sieved {
        if self.from_s.is_none() && self.to_s.is_none() {
            return sieved;
        }
        let [from, to] = self.seconds();
        let start = sieved.recording.time.partition_point(|&t| t < from);
        let end = sieved.recording.time.partition_point(|&t| t < to).max(start);
        Sieved { recording: sieved.recording.slice(start..end), lines: sieved.lines[start..end].to_vec(), ..sieved }
    }
}

/// Reads a log without a description: the joints of `robot` in their order.
///
/// # Errors
/// Those of [`lenient::load`].
pub fn read(path: &Path, robot: &Robot) -> Result<Sieved> {
    let mut sieved = lenient::load(path, Some(&robot.columns), &ColumnMap::default())?;
    arm::select(&mut sieved, &robot.columns, &robot.joint_names());
    Ok(sieved)
}

/// A log without a description made ready: rows that cannot be used left out, clock made even, faults noted.
///
/// # Errors
/// Those of [`lenient::load`], and a log that cannot be used, with the reason.
pub fn plain(path: &Path, robot: &Robot, notes: &mut Vec<String>) -> Result<Vec<Recording>> {
    let logs = ready([read_all(&[path.to_owned()], robot)?, Vec::new()], robot)?;
    notes.extend(logs.notes);
    Ok(logs.train)
}

/// Reads logs without a description and leaves them as they are otherwise, each with its file.
///
/// # Errors
/// Those of [`read`].
pub fn read_all(paths: &[PathBuf], robot: &Robot) -> Result<Vec<(PathBuf, Sieved)>> {
    paths.iter().map(|path| Ok((path.clone(), read(path, robot)?))).collect()
}

/// Examines logs, those to train from and those to judge by, refuses those that cannot be used, corrects what is wrong with
/// their description beyond doubt, and cuts them into pieces at even steps.
///
/// # Errors
/// A log that cannot be used, with the reason.
pub fn ready([train, test]: [Vec<(PathBuf, Sieved)>; 2], robot: &Robot) -> Result<Logs> {
    let mut logs = Logs::default();
    let trained = train.len();
    let all: Vec<(PathBuf, Sieved)> = train.into_iter().chain(test).collect();
    let sieved: Vec<&Sieved> = all.iter().map(|(_, sieved)| sieved).collect();
    let quality::Together { reports, verdict } = quality::examine_together(&sieved, Some(robot))?;
    logs.correction = verdict.filter(|verdict| verdict.beyond_doubt).map(|verdict| verdict.description);
    for (place, ((path, sieved), report)) in all.into_iter().zip(reports).enumerate() {
        if let Some(finding) = report.fatal() {
            let problem = format!("the log cannot be used: {}", finding.text);
            return Err(Error::input(path, None, finding.place.as_str(), problem));
        }
        let rows = sieved.rejected.iter().take(1).map(|row| {
            let all = sieved.rejected.len();
            format!("{}:{}: {}: {} ({all} rows left out)", path.display(), row.line, row.column, row.problem)
        });
        logs.notes.extend(rows);
        logs.notes.extend(sieved.mended.iter().map(|note| format!("{}: {note}", path.display())));
        let told = report.findings.iter().filter(|finding| {
            finding.severity == quality::Severity::Warning || finding.kind == quality::Kind::ModelTorque
        });
        logs.notes.extend(told.map(|finding| format!("{}: {}: {}", path.display(), finding.place, finding.text)));
        let mut pieces = resample::pieces(sieved.recording);
        if pieces.is_empty() {
            return Err(Error::input(path, None, "t", "the clock is so full of gaps that no piece of the log is left"));
        }
        if let Some(description) = &logs.correction {
            pieces.iter_mut().for_each(|piece| description.apply(piece));
        }
        if place < trained { &mut logs.train } else { &mut logs.test }.extend(pieces);
    }
    if logs.correction.is_some() {
        logs.notes.push(
            "the logs are taken as corrected.toml describes them; the arm's gravity is the one given there".into(),
        );
    }
    Ok(logs)
}

#[cfg(test)]
mod tests;
