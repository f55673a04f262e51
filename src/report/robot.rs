//! The result of `tauscope robot`: joints, bodies and notes of a robot's file.

use super::console::{significant, table};
use crate::robot::description::{Description, JointDescription};
use crate::robot::{JointKind, Robot, Unit};
use serde::Serialize;

/// Schema of what `tauscope robot --json` prints.
pub(crate) const SCHEMA: &str = "tauscope.robot/1";

/// The content of the JSON.
#[derive(Debug, Serialize)]
pub(crate) struct RobotResult {
    name: String,
    /// Number of coordinates.
    dof: usize,
    gravity_m_s2: [f64; 3],
    /// All joints that turn or slide, branch by branch.
    joints: Vec<JointResult>,
    notes: Vec<String>,
}

#[derive(Debug, Serialize)]
struct JointResult {
    name: String,
    kind: JointKind,
    /// `coordinate`, `follower` or `held`.
    role: &'static str,
    /// The coordinate that a follower follows, q = multiplier x + offset.
    #[serde(skip_serializing_if = "Option::is_none")]
    follows: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    multiplier: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    offset: Option<f64>,
    /// Where a held joint stands, rad or m.
    #[serde(skip_serializing_if = "Option::is_none")]
    position: Option<f64>,
    /// The joint whose body carries it; null for the base.
    carried_by: Option<String>,
    /// Mass of the body behind it, what is welded to it included, kg.
    #[serde(skip_serializing_if = "Option::is_none")]
    mass_kg: Option<f64>,
}

/// The robot as JSON.
pub(crate) fn result(file: &Description, robot: &Robot) -> RobotResult {
    let joint = |described: &JointDescription| {
        let kind = described.kind()?;
        let name = described.name.clone();
        let Some(body) = (0..robot.bodies()).find(|&body| robot.body(body).name == name) else {
            let position = robot.held.iter().find(|(held, _)| *held == name).map(|(_, position)| *position);
            let [follows, carried_by] = [None, None];
            return Some(JointResult {
                name,
                kind,
                role: "held",
                follows,
                multiplier: None,
                offset: None,
                position,
                carried_by,
                mass_kg: None,
            });
        };
        let coupling = robot.coupling(body);
        let follows = (body >= robot.dof()).then(|| robot.joints[coupling.coordinate].name.clone());
        Some(JointResult {
            kind,
            role: if follows.is_some() { "follower" } else { "coordinate" },
            multiplier: follows.as_ref().map(|_| coupling.multiplier),
            offset: follows.as_ref().map(|_| coupling.offset),
            follows,
            position: None,
            carried_by: robot.parent(body).map(|parent| robot.body(parent).name.clone()),
            mass_kg: Some(robot.body(body).inertia.mass()),
            name,
        })
    };
    RobotResult {
        name: robot.name.clone(),
        dof: robot.dof(),
        gravity_m_s2: robot.gravity.into(),
        joints: file.moving().into_iter().filter_map(joint).collect(),
        notes: robot.notes.clone(),
    }
}

/// The robot as a table.
pub(crate) fn text(file: &Description, robot: &Robot) -> String {
    let rows = result(file, robot).joints.into_iter().map(|joint| {
        let unit = joint.kind.unit(Unit::Position);
        let motion = match (&joint.follows, joint.position) {
            (Some(master), _) => {
                let (multiplier, offset) = (joint.multiplier.unwrap_or(1.0), joint.offset.unwrap_or(0.0));
                format!("{} {master} + {} {unit}", significant(multiplier), significant(offset))
            }
            (None, Some(position)) => format!("held at {} {unit}", significant(position)),
            (None, None) => "under study".to_owned(),
        };
        let kind = if joint.kind == JointKind::Prismatic { "prismatic" } else { "revolute" };
        let carrier =
            joint.carried_by.unwrap_or_else(|| if joint.role == "held" { String::new() } else { "base".into() });
        vec![joint.name, kind.to_owned(), motion, carrier, joint.mass_kg.map_or(String::new(), significant)]
    });
    let header = ["joint", "kind", "motion", "carried by", "mass, kg"];
    let notes: String = robot.notes.iter().map(|note| format!("\nNote: {note}.")).collect();
    format!("{}: {} joints under study\n\n{}{notes}", robot.name, robot.dof(), table(&header, rows.collect()))
}
