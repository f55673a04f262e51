//! A description of logs, corrected where it was found wrong.

use super::description::Dataset;
use super::spec::SCHEMA;
use super::units::UnitOf;
use crate::error::{Error, Result};
use crate::quality::descriptions::{Change, Description};
use crate::quality::{OtherRate, UnitChanges};
use crate::recording::memory;
use crate::robot::{JointKind, Robot};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Factors to N m that mean mN m, between bodies that are described twice too light and too heavy.
const MILLINEWTON: [f64; 2] = [5e-4, 2e-3];

/// Factors to N m of a unit that was given and is none, likewise.
const UNDONE: [f64; 2] = [0.5, 2.0];

impl Dataset {
    /// Whether the motors are coupled: a change of one joint is then none of one motor, and [`corrected`] refuses it.
    pub fn is_coupled(&self) -> bool {
        self.spec.motors.coupling.is_some()
    }
}

/// Files of a description that is not written yet.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dataset::{self, Named};
/// use tauscope::quality::UnitChanges;
/// use tauscope::quality::descriptions::{Change, Description};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // The description of a log whose torque has the wrong sign.
/// let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let named = Named { train: vec!["/logs/monday.csv".into()], ..Named::default() };
/// let reversed = Description::as_given(1, robot.gravity).with(Change::TorqueSign(0));
/// let text = dataset::corrected(None, &named, &robot, &reversed, UnitChanges::default())?;
/// assert!(text.contains("/logs/monday.csv") && text.contains("torque_sign = [-1"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Named {
    /// The file of the arm.
    pub robot: Option<PathBuf>,
    /// Training logs.
    pub train: Vec<PathBuf>,
    /// Held-out logs.
    pub test: Vec<PathBuf>,
}

/// The text of a dataset that describes the logs as `description` says: `dataset` with the changes, or a new one of the
/// files `named`; `units` are changed too. Files are named from the root, so that the text may be kept anywhere.
///
/// # Errors
/// If a path has no absolute form, or the motors are coupled: a change of one joint is then none of one motor.
pub fn corrected(
    dataset: Option<&Dataset>,
    named: &Named,
    robot: &Robot,
    description: &Description,
    units: UnitChanges,
) -> Result<String> {
    let mut table = match dataset {
        Some(dataset) => {
            dataset.text.parse::<Table>().map_err(|error| Error::toml(&dataset.path, &dataset.text, &error))?
        }
        None => Table::from_iter([("schema".to_owned(), Value::from(SCHEMA))]),
    };
    if dataset.is_some_and(Dataset::is_coupled) {
        let problem = "the motors are coupled: apply the change to the columns by hand";
        return Err(Error::request("motors.coupling", problem));
    }
    files(&mut table, dataset, named)?;
    // Lists of the motors are in the order of the file's columns.
    let order = dataset.and_then(|dataset| dataset.spec.joints.clone()).unwrap_or(robot.columns.clone());
    let joints = &robot.joint_names()[..];
    let joint_of = |of: &[usize], name: &String| {
        let channel = joints.iter().position(|joint| joint == name)?;
        of.iter().position(|&own| own == channel)
    };
    // A joint that is held keeps its signs.
    let sign = |signs: &[f64], of: &[usize], name: &String| joint_of(of, name).map_or(1.0, |joint| signs[joint]);
    let position = |name: &String| sign(&description.position_sign, &description.position_of, name);
    let torque = |name: &String| sign(&description.torque_sign, &description.torque_of, name);
    let motors = section(&mut table, "motors");
    // `sign` is of position and torque alike, and `torque_sign` comes on top of it.
    signs(motors, "sign", order.iter().map(position).collect());
    signs(motors, "torque_sign", order.iter().map(|name| position(name) * torque(name)).collect());
    let offset =
        |name: &String| joint_of(&description.position_of, name).map_or(0.0, |j| description.position_offset[j]);
    // What was added before a sign was changed has the other sign after it.
    let zeros: Vec<[f64; 2]> = order.iter().map(|name| [position(name), offset(name)]).collect();
    if description.position_offset.iter().any(|offset| *offset != 0.0) || motors.contains_key("position_offset") {
        let new = each_of(motors.get("position_offset"), 0.0, &zeros, |old, [sign, offset]| sign * old + offset);
        motors.insert("position_offset".into(), new);
    }
    exchanges(motors, "torques_exchanged", joints, &description.torque_of);
    exchanges(motors, "positions_exchanged", joints, &description.position_of);
    let scale = |name: &String| sign(&description.torque_scale, &description.torque_of, name);
    let found: Vec<f64> = order.iter().map(scale).collect();
    if found.iter().any(|scale| *scale != 1.0) {
        let given = dataset.and_then(|dataset| dataset.spec.units.torque);
        let currents = given.is_some_and(UnitOf::is_current);
        // The factors are those of torques in the unit that was given.
        let unit = given.filter(|_| !currents).map_or(1.0, UnitOf::factor);
        let scales: Vec<f64> = found.iter().map(|scale| scale * unit).collect();
        let shared = scales.first().copied().filter(|first| scales.iter().all(|scale| scale == first));
        if shared.is_some_and(|scale| unit != 1.0 && (UNDONE[0]..UNDONE[1]).contains(&scale)) {
            section(&mut table, "units").remove("torque");
        } else if !currents && shared.is_some_and(|scale| (MILLINEWTON[0]..MILLINEWTON[1]).contains(&scale)) {
            section(&mut table, "units").insert("torque".into(), Value::from("mNm"));
        } else {
            // A torque is a current under a constant in N m per ampere, whatever its unit is.
            let old = motors.get("torque_constant_nm_a").cloned();
            let new = match shared {
                Some(scale) => scaled(old, scale),
                None => each_of(old.as_ref(), 1.0, &scales, |old, scale| old * scale),
            };
            motors.insert("torque_constant_nm_a".into(), new);
            if !currents {
                section(&mut table, "units").insert("torque".into(), Value::from("A"));
            }
        }
    }
    if description.changes.iter().any(|change| matches!(change, Change::Gravity(_) | Change::WithoutGravity)) {
        let gravity: Vec<Value> = description.gravity.iter().map(|&value| Value::from(value)).collect();
        section(&mut table, "mounting").insert("gravity_m_s2".into(), Value::Array(gravity));
    }
    let written = section(&mut table, "units");
    if let Some(factor) = units.time_factor {
        let old = written.get("time_factor").cloned();
        written.insert("time_factor".into(), scaled(old, factor));
    }
    let of_positions = |joint: usize| units.position(joint).map(|unit| unit.symbol().to_owned());
    if let Some(unit) = units_of(&order, robot, &of_positions, ["rad", "m"]) {
        written.insert("position".into(), unit);
    }
    let of_velocities = |joint: usize| units.velocity(joint).map(OtherRate::symbol);
    if let Some(unit) = units_of(&order, robot, &of_velocities, ["rad/s", "m/s"]) {
        written.insert("velocity".into(), unit);
    }
    table.retain(|_, value| value.as_table().is_none_or(|section| !section.is_empty()));
    Ok(table.to_string())
}

/// The unit of a quantity: one where all joints share it, else one for each of the file's joints; none where `of` no joint there is
/// another than that of SI, of joints that turn and slide. A joint that is held has that of those that turn, where they share one.
fn units_of(
    order: &[String],
    robot: &Robot,
    of: &dyn Fn(usize) -> Option<String>,
    [turning, sliding]: [&str; 2],
) -> Option<Value> {
    let unit = |joint: usize| {
        let slides = robot.joints[joint].kind == JointKind::Prismatic;
        of(joint).unwrap_or_else(|| if slides { sliding } else { turning }.to_owned())
    };
    (0..robot.dof()).find_map(of)?;
    let turn: Vec<String> =
        (0..robot.dof()).filter(|&joint| robot.joints[joint].kind == JointKind::Revolute).map(unit).collect();
    let held = turn.first().filter(|first| turn.iter().all(|unit| unit == *first));
    let of_name = |name: &String| match robot.joints.iter().position(|joint| joint.name == *name) {
        Some(joint) => unit(joint),
        None => held.cloned().unwrap_or_else(|| turning.to_owned()),
    };
    let each: Vec<String> = order.iter().map(of_name).collect();
    let first = each.first()?.clone();
    Some(if each.iter().all(|unit| *unit == first) { Value::from(first) } else { Value::from(each) })
}

/// Names all files from the root.
fn files(table: &mut Table, dataset: Option<&Dataset>, named: &Named) -> Result<()> {
    let absolute = |path: &Path| {
        if memory::is_held(path) {
            return Ok(Value::from(path.display().to_string()));
        }
        let path = std::path::absolute(path).map_err(|source| Error::io(path, "find this file", source))?;
        Ok::<Value, Error>(Value::from(path.display().to_string()))
    };
    if let Some(robot) = named.robot.clone().or_else(|| dataset.and_then(Dataset::robot)) {
        table.insert("robot".into(), absolute(&robot)?);
    }
    for (key, paths) in [("train", &named.train), ("test", &named.test)] {
        match (dataset, table.get_mut(key).and_then(Value::as_array_mut)) {
            (Some(dataset), Some(parts)) => {
                for part in parts.iter_mut().filter_map(Value::as_table_mut) {
                    if let Some(file) = part.get("file").and_then(Value::as_str) {
                        let file = absolute(&dataset.beside(Path::new(file)))?;
                        part.insert("file".into(), file);
                    }
                }
            }
            _ if !paths.is_empty() => {
                let part = |path: &PathBuf| Ok(Value::from(Table::from_iter([("file".to_owned(), absolute(path)?)])));
                table.insert(key.into(), Value::Array(paths.iter().map(part).collect::<Result<_>>()?));
            }
            _ => {}
        }
    }
    Ok(())
}

fn section<'a>(table: &'a mut Table, name: &str) -> &'a mut Table {
    let entry = table.entry(name).or_insert_with(|| Value::from(Table::new()));
    if !entry.is_table() {
        *entry = Value::from(Table::new());
    }
    entry.as_table_mut().expect("it was made a table")
}

/// A number or a list of numbers times another.
fn scaled(value: Option<Value>, factor: f64) -> Value {
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|v| v as f64)).unwrap_or(1.0);
    match value {
        Some(Value::Array(each)) => Value::Array(each.iter().map(|v| Value::from(number(v) * factor)).collect()),
        Some(one) => Value::from(number(&one) * factor),
        None => Value::from(factor),
    }
}

/// The number of one joint, where a value is one for all or one for each, and `usual` where it is none.
fn number_of(value: Option<&Value>, place: usize, usual: f64) -> f64 {
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|v| v as f64)).unwrap_or(usual);
    match value {
        Some(Value::Array(each)) => each.get(place).map_or(usual, number),
        Some(one) => number(one),
        None => usual,
    }
}

/// A number for all or one for each, `usual` where there is none, changed by what each joint has of its own.
fn each_of<T>(value: Option<&Value>, usual: f64, changes: &[T], new: impl Fn(f64, &T) -> f64) -> Value {
    let of = |(place, change): (usize, &T)| Value::from(new(number_of(value, place, usual), change));
    Value::Array(changes.iter().enumerate().map(of).collect())
}

/// Multiplies the signs of a key, unless all stay as they are.
fn signs(motors: &mut Table, key: &str, change: Vec<f64>) {
    if change.iter().all(|sign| *sign == 1.0) {
        return;
    }
    let old = motors.get(key);
    let of = |(place, sign): (usize, &f64)| Value::from((number_of(old, place, 1.0) * sign) as i64);
    let new = change.iter().enumerate().map(of).collect();
    motors.insert(key.into(), Value::Array(new));
}

/// Adds the exchanges that put channels in the order `of`.
fn exchanges(motors: &mut Table, key: &str, joints: &[String], of: &[usize]) {
    let mut now: Vec<usize> = (0..of.len()).collect();
    let mut pairs = Vec::new();
    for place in 0..of.len() {
        if let Some(other) = (place + 1..of.len()).find(|&other| now[place] != of[place] && now[other] == of[place]) {
            now.swap(place, other);
            pairs.push(Value::from(vec![joints[place].clone(), joints[other].clone()]));
        }
    }
    if !pairs.is_empty() {
        let list = motors.entry(key).or_insert_with(|| Value::Array(Vec::new()));
        if let Some(list) = list.as_array_mut() {
            list.extend(pairs);
        }
    }
}
