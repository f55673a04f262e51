//! The keys of `dataset.toml`.

use super::units::{OfJoints, TimeUnit, UnitOf};
use crate::recording::lenient::{ColumnMap, Sieved};
use crate::recording::{ACCELERATION, POSITION, TORQUE, VELOCITY};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Schema of the file.
pub const SCHEMA: &str = "tauscope.dataset/1";

/// The content of the file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Spec {
    /// Empty where it is missing.
    #[serde(default)]
    pub schema: String,
    pub robot: Option<PathBuf>,
    pub joints: Option<Vec<String>>,
    /// Where joints stand that are not under study, rad or m.
    #[serde(default)]
    pub hold: BTreeMap<String, f64>,
    #[serde(default)]
    pub train: Vec<Part>,
    #[serde(default)]
    pub test: Vec<Part>,
    #[serde(default)]
    pub columns: ColumnMap,
    #[serde(default)]
    pub units: Units,
    #[serde(default)]
    pub motors: Motors,
    pub payload: Option<Payload>,
    #[serde(default)]
    pub mounting: Mounting,
}

/// A log, or a part of one.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Part {
    pub file: Option<PathBuf>,
    /// Files whose columns belong together, in the place of `file`.
    pub files: Option<Vec<PathBuf>>,
    /// Rows per second, Hz, of files without a column of time.
    pub rate_hz: Option<f64>,
    pub from_s: Option<f64>,
    pub to_s: Option<f64>,
}

/// Units of the columns.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Units {
    pub time: Option<TimeUnit>,
    pub position: Option<OfJoints<UnitOf<POSITION>>>,
    pub velocity: Option<OfJoints<UnitOf<VELOCITY>>>,
    pub acceleration: Option<OfJoints<UnitOf<ACCELERATION>>>,
    pub torque: Option<UnitOf<TORQUE>>,
    pub time_factor: Option<f64>,
}

/// Motors and gears.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Motors {
    pub gear_ratio: Option<PerJoint>,
    pub torque_constant_nm_a: Option<PerJoint>,
    pub sign: Option<PerJoint>,
    pub torque_sign: Option<PerJoint>,
    pub position_at: Option<Side>,
    pub torque_at: Option<Side>,
    pub coupling: Option<Vec<Vec<f64>>>,
    pub position_offset: Option<PerJoint>,
    pub torque_offset: Option<PerJoint>,
    pub torques_exchanged: Option<Vec<[String; 2]>>,
    pub positions_exchanged: Option<Vec<[String; 2]>>,
}

/// A number for all joints, or one each.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a number, or a list of one number per joint")]
pub(super) enum PerJoint {
    All(f64),
    Each(Vec<f64>),
}

/// Side of the gear.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Side {
    Joint,
    Motor,
}

/// A known body at the flange, in its frame.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Payload {
    pub mass_kg: f64,
    #[serde(default)]
    pub center_m: [f64; 3],
    #[serde(default)]
    pub inertia_kg_m2: [f64; 6],
}

/// How the arm is mounted.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Mounting {
    pub gravity_m_s2: Option<[f64; 3]>,
}

impl Part {
    /// The files of the log.
    pub(super) fn paths(&self) -> Vec<&PathBuf> {
        self.file.iter().chain(self.files.iter().flatten()).collect()
    }

    /// The files in messages.
    pub(super) fn name(&self) -> String {
        self.paths().iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(" and ")
    }

    /// From when to when, on the log's clock.
    pub(super) fn seconds(&self) -> [f64; 2] {
        [self.from_s.unwrap_or(f64::NEG_INFINITY), self.to_s.unwrap_or(f64::INFINITY)]
    }

    /// The part of a log that is wanted.
    pub(super) fn of(&self, sieved: Sieved) -> Sieved {
        if self.from_s.is_none() && self.to_s.is_none() {
            return sieved;
        }
        let [from, to] = self.seconds();
        let start = sieved.recording.time.partition_point(|&t| t < from);
        let end = sieved.recording.time.partition_point(|&t| t < to).max(start);
        Sieved { recording: sieved.recording.slice(start..end), lines: sieved.lines[start..end].to_vec(), ..sieved }
    }
}
