//! Logs as they are read: SI units, at the joints, in the order of the robot's joints.

use super::description::Dataset;
use super::order::select;
use super::spec::Part;
use super::units::TimeUnit;
use crate::error::Result;
use crate::quality;
use crate::recording::lenient::{self, ColumnMap, Sieved};
use crate::robot::Robot;
use std::path::{Path, PathBuf};

impl Dataset {
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
        let units = &self.spec.units;
        columns.time_factor = units.time.map(TimeUnit::factor);
        columns.known_units =
            [units.position.is_some(), units.velocity.is_some(), units.acceleration.is_some(), units.torque.is_some()];
        columns.torque_constants = self.spec.motors.torque_constant_nm_a.is_some();
        columns.motors = motors(robot);
        columns.addresses = robot.addresses.clone();
        let mut sieved = lenient::load_together(files, Some(order), &columns)?;
        if self.spec.motors.gear_ratio.is_none() && self.spec.motors.torque_constant_nm_a.is_none() {
            sieved.corrections.extend(gears(&sieved, robot));
        }
        self.convert(&mut sieved)?;
        select(&mut sieved, order, &robot.joint_names());
        self.exchange(&mut sieved.recording)?;
        quality::settle_named_units(&mut sieved, robot)?;
        Ok(sieved)
    }

    /// Reads all logs, or the parts of them that are wanted, and leaves them as they are otherwise: the training logs,
    /// then the held-out ones, each with its file.
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
}

/// Reads a log without a description: the joints of `robot` in their order.
///
/// # Errors
/// Those of [`lenient::load`].
pub fn read(path: &Path, robot: &Robot) -> Result<Sieved> {
    let map = ColumnMap { motors: motors(robot), addresses: robot.addresses.clone(), ..ColumnMap::default() };
    let mut sieved = lenient::load(path, Some(&robot.columns), &map)?;
    sieved.corrections.extend(gears(&sieved, robot));
    select(&mut sieved, &robot.columns, &robot.joint_names());
    quality::settle_named_units(&mut sieved, robot)?;
    Ok(sieved)
}

/// Names of the motors in the robot's file, each with its joint.
fn motors(robot: &Robot) -> Vec<(String, String)> {
    robot.actuators.iter().map(|motor| (motor.name.clone(), motor.joint.clone())).collect()
}

/// What is said of torques that are called for motors behind which the robot's file has gears. MuJoCo's forces of actuators are those
/// before the gear, those of other recorders may be behind it: the name does not decide it.
fn gears(sieved: &Sieved, robot: &Robot) -> Option<String> {
    let gear =
        |joint: &String| robot.actuators.iter().find(|motor| motor.joint == *joint).map_or(1.0, |motor| motor.gear);
    let gears: Vec<f64> = robot.columns.iter().map(gear).collect();
    let has_gears = sieved.of_motors && gears.iter().any(|gear| *gear != 1.0);
    has_gears.then(|| {
        format!(
            "these motors have gears in the robot's file: forces before them, as MuJoCo's actuator_force, become torques of the joints by \
             [motors] torque_at = \"motor\", gear_ratio = {gears:?} in a dataset"
        )
    })
}

/// Reads logs without a description and leaves them as they are otherwise, each with its file.
///
/// # Errors
/// Those of [`read`].
pub fn read_all(paths: &[PathBuf], robot: &Robot) -> Result<Vec<(PathBuf, Sieved)>> {
    paths.iter().map(|path| Ok((path.clone(), read(path, robot)?))).collect()
}
