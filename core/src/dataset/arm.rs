//! The arm that logs are of: which joints of a robot's file are under study, and where the others stand.
//!
//! Under study are the joints asked for, else those that every log names, else as many as the logs number. Of these the ones
//! that stand still in all logs are held where they stand, and so are joints of the file that are only in the logs' other
//! columns.

use super::description::Dataset;
use super::order::select;
use super::still;
use super::units::OfJoints;
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::recording::Recording;
use crate::recording::lenient::{self, ColumnMap, JointNames, Sieved};
use crate::robot::description::{self, Description};
use crate::robot::{Choice, InertiaCheck, JointKind, Robot, Unit, shortened};
use nalgebra::Vector3;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Share of the heaviest mass down to which one below zero is rounding of what wrote the file.
const ROUNDING: f64 = 1e-9;

/// What to do about a held joint that logs do not have at one place.
const CURE: &str = "put it under study with --joints, or say where it stands in [hold] of a dataset";

/// Joints not under study with the places where they are held, and notes.
type Elsewhere = (Vec<(String, f64)>, Vec<String>);

/// The joints asked for on the command line.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dataset::arm::{Asked, LoggedArm};
/// use tauscope::identification::effect_model::Trust;
///
/// // Two joints of six are under study; the others are held.
/// let asked = Asked { joints: Some(vec!["joint_2".to_owned(), "joint_3".to_owned()]), ..Asked::default() };
/// let arm = LoggedArm::open("../urdf/irb1600_6_120.urdf".as_ref(), &asked, Trust::Structure, None, &[])?;
/// assert_eq!(arm.robot.joint_names(), ["joint_2", "joint_3"]);
/// assert_eq!(arm.robot.held.len(), 4);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Asked {
    /// Names of the joints under study.
    pub joints: Option<Vec<String>>,
    /// Link at the end of the arm.
    pub tip: Option<String>,
    /// Gravity in the base frame, m/s2.
    pub gravity: Option<Vector3<f64>>,
}

/// An arm with its file, from which it can be made again with more joints held.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dataset::{self, arm::{Asked, LoggedArm}};
/// use tauscope::identification::effect_model::Trust;
///
/// // A joint that stands still in all logs is held where it stands. Here joint j5 does.
/// let file = |name| std::path::PathBuf::from(format!("../tests/reference/payload/{name}"));
/// let (urdf, log) = (file("arm.urdf"), file("before.csv"));
/// let mut arm = LoggedArm::open(&urdf, &Asked::default(), Trust::Structure, None, std::slice::from_ref(&log))?;
/// let mut logs = [dataset::read_all(&[log], &arm.robot)?];
/// logs[0][0].1.recording.q.channel_mut(4).fill(0.25);
/// arm.settle(None, &mut logs)?;
/// assert_eq!((arm.robot.dof(), &arm.robot.held[..]), (4, &[("j5".to_owned(), 0.25)][..]));
/// assert_eq!(logs[0][0].1.recording.joints(), 4);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct LoggedArm {
    /// The arm: mounted, under the gravity asked for.
    pub robot: Robot,
    description: Description,
    choice: Choice,
    trust: Trust,
    asked: Asked,
}

impl LoggedArm {
    /// The arm in `file`, of which `logs` are. Without logs all joints that move are under study.
    ///
    /// # Errors
    /// Those of [`description::read`] and [`Description::robot`]; joints that the file does not have, logs that do not say
    /// which joints they are of; believed inertias of which a mass is below zero, or which there are none of.
    pub fn open(
        file: &Path,
        asked: &Asked,
        trust: Trust,
        dataset: Option<&Dataset>,
        logs: &[PathBuf],
    ) -> Result<LoggedArm> {
        let description = description::read(file)?;
        let named = asked.joints.clone().or_else(|| dataset.and_then(|dataset| dataset.spec.joints.clone()));
        let hold = dataset.map(|dataset| dataset.spec.hold.clone()).unwrap_or_default();
        if let (Some(dataset), Some(unknown)) =
            (dataset, hold.keys().find(|name| !description.joints.iter().any(|joint| joint.name == **name)))
        {
            let problem = format!("{} has no joint `{unknown}`", file.display());
            return Err(dataset.error("hold", problem));
        }
        if let (Some(dataset), Some(names)) = (dataset.filter(|_| asked.joints.is_none()), &named)
            && let Some(unknown) =
                names.iter().find(|name| !description.joints.iter().any(|joint| joint.name == **name))
        {
            let all: Vec<&str> = description.moving().iter().map(|joint| joint.name.as_str()).collect();
            let problem = format!("`{unknown}` is none of the robot's joints {}", all.join(", "));
            return Err(dataset.error("joints", problem));
        }
        let mut choice = Choice { joints: named, tip: asked.tip.clone(), hold };
        let mut columns = Vec::new();
        if choice.joints.is_none() && choice.tip.is_none() && !logs.is_empty() {
            (choice.joints, columns) = studied(&description, dataset, logs)?;
        }
        let mut robot = believed(&description, &choice, trust)?;
        if columns.is_empty() {
            columns = dataset.and_then(|dataset| dataset.spec.joints.clone()).unwrap_or_else(|| robot.joint_names());
        }
        robot.columns = columns;
        let mut arm = LoggedArm { robot, description, choice, trust, asked: asked.clone() };
        arm.mount(dataset)?;
        Ok(arm)
    }

    /// Holds the joints that stand still at one place in all logs, and places the joints not under study where the logs say that
    /// they stand. Joints asked for by name stay under study. The logs keep the joints that are left. What one model cannot
    /// say of all logs is noted.
    ///
    /// # Errors
    /// Those of [`LoggedArm::open`].
    pub fn settle(&mut self, dataset: Option<&Dataset>, logs: &mut [Vec<(PathBuf, Sieved)>]) -> Result<()> {
        let mut logs: Vec<&mut (PathBuf, Sieved)> = logs.iter_mut().flatten().collect();
        let paths: Vec<&Path> = logs.iter().map(|log| log.0.as_path()).collect();
        let (mut hold, mut notes) = self.elsewhere(dataset, &paths)?;
        let asked = self.asked.joints.is_some() || self.asked.tip.is_some();
        let names = self.robot.joint_names();
        let mut moving = names.clone();
        let (mut standing, mut places_apart) = (Vec::new(), Vec::new());
        for (joint, name) in names.iter().enumerate().filter(|_| !asked) {
            let kind = self.robot.joints[joint].kind;
            let tolerance = still::range(&self.robot, kind);
            let recordings = logs.iter().map(|log| &log.1.recording);
            let Some(places) = still::places(recordings, joint, tolerance) else { continue };
            let Some([low, high]) = still::ends(&places) else { continue };
            if high.1 - low.1 <= tolerance {
                hold.push((name.clone(), 0.5 * (low.1 + high.1)));
                moving.retain(|other| other != name);
            } else {
                // Its own coordinate has it right in every log; one position would be wrong in some.
                places_apart.push((name.clone(), apart(&paths, [low, high], kind)));
                standing.push((joint, places));
            }
        }
        notes.extend(still::keep_coordinates(&places_apart));
        // Noise of its encoder would determine what it carries, and badly.
        for (joint, places) in standing {
            for (log, place) in logs.iter_mut().zip(places) {
                stand(&mut log.1.recording, joint, place);
            }
        }
        // Where nothing moves the checks of the logs say so.
        if !moving.is_empty() && self.hold(dataset, hold, moving.clone())? {
            for log in &mut logs {
                select(&mut log.1, &names, &moving);
            }
        }
        self.robot.notes.extend(notes);
        Ok(())
    }

    /// Makes the arm again with joints held, the joints `moving` under study; false where there are none to hold.
    fn hold(&mut self, dataset: Option<&Dataset>, hold: Vec<(String, f64)>, moving: Vec<String>) -> Result<bool> {
        if hold.is_empty() {
            return Ok(false);
        }
        self.choice.hold.extend(hold);
        self.choice.joints = Some(moving);
        let columns = std::mem::take(&mut self.robot.columns);
        self.robot = Robot { columns, ..believed(&self.description, &self.choice, self.trust)? };
        self.mount(dataset)?;
        Ok(true)
    }

    /// Positions of joints that are not under study, where all logs have them standing still, with notes of those that do not
    /// stand at one place.
    fn elsewhere(&self, dataset: Option<&Dataset>, paths: &[&Path]) -> Result<Elsewhere> {
        let mut map = columns_of(&self.description, dataset);
        let others: Vec<(String, JointKind)> = self
            .description
            .masters()
            .into_iter()
            .filter_map(|joint| Some((joint.name.clone(), joint.kind()?)))
            .filter(|(name, _)| self.robot.held.iter().any(|(held, _)| held == name))
            .collect();
        let (mut found, mut notes, mut moving, mut between) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        if others.is_empty() {
            return Ok((found, notes));
        }
        let mut paths = paths.to_vec();
        paths.dedup();
        let known: Vec<String> = self.description.moving().into_iter().map(|joint| joint.name.clone()).collect();
        let names = |path: &&Path| Ok(lenient::joint_names(path, &known, &map)?.names);
        let named = paths.iter().map(names).collect::<Result<Vec<_>>>()?;
        let in_all = |(name, _): &(String, JointKind)| named.iter().all(|names| names.contains(name));
        let others: Vec<(String, JointKind)> = others.into_iter().filter(in_all).collect();
        // Lists of units are of the joints under study.
        let factor = dataset.and_then(|dataset| match dataset.spec.units.position {
            Some(OfJoints::All(unit)) => Some(unit.factor()),
            Some(OfJoints::Each(_)) | None => None,
        });
        map.known_units[0] = factor.is_some();
        let factor = factor.unwrap_or(1.0);
        let read = |joints: &[String]| -> Option<Vec<Recording>> {
            let of = |path: &&Path| {
                let Sieved { mut recording, rejected, .. } = lenient::positions(path, joints, &map).ok()?;
                recording.q.as_mut_slice().iter_mut().for_each(|q| *q *= factor);
                // Rows that only some of the joints have must not hide the others.
                (joints.len() == 1 || rejected.is_empty()).then_some(recording)
            };
            paths.iter().map(of).collect()
        };
        let joints: Vec<String> = others.iter().map(|(name, _)| name.clone()).collect();
        let together = if joints.is_empty() { None } else { read(&joints) };
        for (place, (name, kind)) in others.into_iter().enumerate() {
            let alone = if together.is_none() { read(&joints[place..=place]) } else { None };
            let (Some(recordings), joint) =
                (together.as_ref().or(alone.as_ref()), if alone.is_some() { 0 } else { place })
            else {
                continue;
            };
            let tolerance = still::range(&self.robot, kind);
            let places = still::places(recordings.iter(), joint, tolerance);
            let given = self.choice.hold.contains_key(&name);
            match places.as_deref().and_then(still::ends) {
                Some([low, high]) if high.1 - low.1 <= tolerance => found.push((name, 0.5 * (low.1 + high.1))),
                // Where the dataset says where it stands, that is decided; on another branch it does not matter.
                _ if given || !self.matters(&name) => {}
                Some([low, high]) => {
                    found.push((name.clone(), 0.5 * (low.1 + high.1)));
                    between.push((name, apart(&paths, [low, high], kind)));
                }
                None => moving.push(name),
            }
        }
        notes.extend(still::held_between(&between, CURE));
        if !moving.is_empty() {
            notes.push(format!(
                "joints not under study move in the logs, but are held in the middle of their range ({}); {CURE}",
                shortened(&moving)
            ));
        }
        Ok((found, notes))
    }

    /// Whether the torques depend on where a held joint stands: it carries a joint that moves, or one that moves carries it.
    fn matters(&self, held: &str) -> bool {
        let path = |joint: &str| -> Vec<&str> {
            let link = self.description.joints.iter().find(|own| own.name == joint).map_or(0, |own| own.child);
            let joints = self.description.path_to(&self.description.links[link].name).unwrap_or_default();
            joints.into_iter().map(|joint| joint.name.as_str()).collect()
        };
        let behind = path(held);
        let moving = (0..self.robot.bodies()).map(|body| self.robot.body(body).name.as_str());
        moving.into_iter().any(|joint| behind.contains(&joint) || path(joint).contains(&held))
    }

    fn mount(&mut self, dataset: Option<&Dataset>) -> Result<()> {
        if let Some(dataset) = dataset {
            dataset.mount(&mut self.robot)?;
        }
        self.robot.gravity = self.asked.gravity.unwrap_or(self.robot.gravity);
        Ok(())
    }
}

/// The robot, as far as its inertias are believed. Believed inertias that no body has are reported and taken as they are: their
/// torque is well defined.
fn believed(description: &Description, choice: &Choice, trust: Trust) -> Result<Robot> {
    if trust == Trust::Structure {
        let mut robot = description.robot(choice, InertiaCheck::Ignored)?;
        let note = |known: String| format!("{known}: `identify` and `diagnose` estimate them (--trust structure)");
        robot.notes.extend(robot.placeholders().map(note));
        return Ok(robot);
    }
    let mut robot = match description.robot(choice, InertiaCheck::Required) {
        Ok(robot) => robot,
        Err(problem) => {
            let mut robot = description.robot(choice, InertiaCheck::Ignored)?;
            let masses = || (0..robot.bodies()).map(|body| robot.body(body).inertia.mass());
            let heaviest = masses().fold(0.0, f64::max);
            if masses().any(|mass| mass < -ROUNDING * heaviest) {
                return Err(problem);
            }
            robot.notes.push(format!("{problem}; they are taken as they are"));
            robot
        }
    };
    if (0..robot.bodies()).all(|body| robot.body(body).inertia.mass() == 0.0) {
        let problem = "no link that moves has a mass to trust; describe the inertias, or use --trust structure";
        return Err(Error::input(&description.source, None, "inertial", problem));
    }
    let note = |known: String| format!("{known}: use --trust structure, which estimates them");
    robot.notes.extend(robot.placeholders().map(note));
    Ok(robot)
}

/// The columns that a dataset names, in logs of a robot's file.
fn columns_of(file: &Description, dataset: Option<&Dataset>) -> ColumnMap {
    let given = dataset.map(|dataset| dataset.spec.columns.clone()).unwrap_or_default();
    ColumnMap { addresses: file.addresses.clone(), ..given }
}

/// The joints of the file that logs are of, and what numbered columns stand for; neither where that is all of them.
fn studied(
    file: &Description,
    dataset: Option<&Dataset>,
    logs: &[PathBuf],
) -> Result<(Option<Vec<String>>, Vec<String>)> {
    let map = columns_of(file, dataset);
    let moving: Vec<String> = file.moving().iter().map(|joint| joint.name.clone()).collect();
    let names = |log| lenient::joint_names(log, &moving, &map);
    let found = logs.iter().map(names).collect::<Result<Vec<JointNames>>>()?;
    let masters: Vec<String> = file.masters().iter().map(|joint| joint.name.clone()).collect();
    let in_all = |name: &&String| found.iter().all(|one| one.names.contains(name));
    let named: Vec<String> = moving.iter().filter(in_all).cloned().collect();
    if !named.is_empty() {
        return Ok((Some(file.leading(&named)), Vec::new()));
    }
    let numbered = found.iter().map(|one| one.numbered).max().unwrap_or(0);
    if numbered == 0 || numbered == masters.len() || found.iter().any(|one| one.numbered != numbered) {
        return Ok((None, Vec::new()));
    }
    if numbered == moving.len() {
        return Ok((None, moving));
    }
    let chains: BTreeSet<Vec<String>> = file.chains_of(numbered).into_iter().collect();
    match chains.len() {
        1 => Ok((chains.into_iter().next(), Vec::new())),
        // The log does not say; a plain arm has another number of joints, and reading the log says so.
        0 => Ok((None, Vec::new())),
        _ => {
            let lists: Vec<String> = chains.iter().map(|chain| chain.join(",")).collect();
            let problem = format!(
                "{numbered} joints are numbered, but {} has {} that move; name those of the log: --joints {}",
                file.source.display(),
                moving.len(),
                lists.join(", or --joints ")
            );
            Err(Error::input(&logs[0], None, "columns", problem))
        }
    }
}

/// Has a joint stand at a place, rad or m.
fn stand(recording: &mut Recording, joint: usize, place: f64) {
    recording.q.channel_mut(joint).fill(place);
    for rates in [&mut recording.qd, &mut recording.qdd].into_iter().flatten() {
        // One that is not a number was not measured.
        rates.channel_mut(joint).iter_mut().filter(|rate| rate.is_finite()).for_each(|rate| *rate = 0.0);
    }
}

/// Where a joint stands in the logs at either end, in words.
fn apart(paths: &[&Path], ends: [(usize, f64); 2], kind: JointKind) -> String {
    let unit = kind.unit(Unit::Position);
    let [low, high] = ends.map(|(log, place)| format!("at {place:.4} {unit} in {}", paths[log].display()));
    format!("{low} and {high}")
}
