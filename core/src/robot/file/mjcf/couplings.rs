//! Equality constraints of a MuJoCo model: joints that follow others, and loops that a tree does not have.

use super::bodies::Bodies;
use super::compiler::turn;
use super::defaults::Settled;
use super::element::Element;
use crate::error::Result;
use crate::robot::description::{JointDescription, Mimic, Motion};
use crate::robot::model::Pose;
use nalgebra::Unit;

/// Couples the joints that an equality couples.
///
/// # Errors
/// If a number is malformed.
pub(super) fn couple(root: &Element, bodies: &mut Bodies) -> Result<()> {
    let mut loops = Vec::new();
    for element in root.all("equality").flat_map(|section| &section.children) {
        if element.get("active") == Some("false") {
            continue;
        }
        match element.tag.as_str() {
            "joint" => joint(element, bodies)?,
            "connect" | "weld" => {
                let ends = ["body1", "body2", "site1", "site2"].iter().filter_map(|end| element.get(end));
                loops.push(ends.collect::<Vec<_>>().join(" to "));
            }
            tag => {
                let line = element.line;
                bodies
                    .notes
                    .push(format!("the equality of {tag}s in line {line} is not read: the joints move by themselves"));
            }
        }
    }
    if !loops.is_empty() {
        let (count, which) = (loops.len(), loops.join(", "));
        bodies
            .notes
            .push(format!("{count} loop(s) are cut open ({which}): the robot is read as the tree of its bodies"));
    }
    Ok(())
}

fn joint(element: &Element, bodies: &mut Bodies) -> Result<()> {
    let line = element.line;
    let polynomial = Settled::plain(element).numbers("polycoef", [1, 5])?.unwrap_or_else(|| vec![0.0, 1.0]);
    let coefficient = |power: usize| polynomial.get(power).copied().unwrap_or(0.0);
    let index = |name: Option<&str>| bodies.joints.iter().position(|joint| Some(joint.name.as_str()) == name);
    let Some(follower) = index(element.get("joint1")) else { return Ok(()) };
    let name = bodies.joints[follower].name.clone();
    let moves = |at: usize| matches!(bodies.joints[at].motion, Motion::Revolute | Motion::Prismatic);
    let mut refuse = |why: &str| {
        bodies
            .notes
            .push(format!("the coupling of joint `{name}` in line {line} is not read ({why}): it moves by itself"));
        Ok(())
    };
    let master = element.get("joint2");
    let leader = index(master);
    if !moves(follower) || leader.is_some_and(|leader| !moves(leader)) {
        return refuse("one of the joints is held");
    }
    if master.is_some() && leader.is_none() {
        return refuse("the other joint is not there");
    }
    if (2..5).any(|power| coefficient(power) != 0.0) {
        return refuse("it is not linear");
    }
    if bodies.joints[follower].mimic.is_some() {
        return refuse("it already follows a joint");
    }
    // Both are counted from where they are drawn.
    let rest = bodies.drawn[follower] + coefficient(0);
    let Some(leader) = leader else {
        hold(&mut bodies.joints[follower], rest);
        bodies.notes.push(format!("joint `{name}` is held at {rest} by the equality in line {line}"));
        return Ok(());
    };
    let multiplier = coefficient(1);
    let offset = rest - multiplier * bodies.drawn[leader];
    bodies.joints[follower].mimic = Some(Mimic { master: bodies.joints[leader].name.clone(), multiplier, offset });
    Ok(())
}

/// Makes a joint stand at a position.
fn hold(joint: &mut JointDescription, position: f64) {
    let moved = match joint.motion {
        Motion::Revolute => Pose { rotation: turn(&Unit::new_unchecked(joint.axis), position), ..Pose::identity() },
        _ => Pose { translation: position * joint.axis, ..Pose::identity() },
    };
    joint.origin = joint.origin.then(&moved);
    joint.motion = Motion::Fixed;
}
