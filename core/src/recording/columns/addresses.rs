//! Numbered columns of a simulator's whole vectors, `qpos_7`, `qvel_6`, `qfrc_actuator_6`, under the names of their joints.
//!
//! A vector holds free bodies, ball joints and grippers beside the arm: its numbers are those of its places and not of the arm's joints.
//! They are taken as places where there are as many columns as the vector has.

use super::names::{self, ACCELERATION, Joint, POSITION, QUANTITIES, TORQUE, VELOCITY};
use crate::robot::Addresses;
use std::collections::BTreeMap;

/// Parts of names of vectors that only a simulator has.
const OF_SIMULATOR: [&str; 4] = ["qvel", "qacc", "qfrc", "actuator_force"];

/// A header whose numbers are replaced by joints.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Placed {
    /// The header; columns that are of no joint that turns or slides have a name that is none of a joint.
    pub header: Vec<String>,
    /// Columns of other bodies than those of joints that turn or slide.
    pub others: Vec<usize>,
    /// Torques are numbered as the motors.
    pub of_motors: bool,
    /// How the numbers were understood.
    pub note: Option<String>,
}

/// The header with joints in the place of numbers; as it is where the model's vectors are no longer than its joints.
pub(crate) fn placed(header: &[String], addresses: &Addresses) -> Placed {
    let mut out = Placed { header: header.to_vec(), ..Placed::default() };
    if addresses.are_plain() {
        return out;
    }
    let mut vectors: BTreeMap<(usize, String), Vec<(usize, usize)>> = BTreeMap::new();
    for (column, name) in header.iter().enumerate() {
        let readings = names::meanings(name);
        let Some(meaning) = readings.first().filter(|meaning| !meaning.truth && !meaning.current) else { continue };
        if let Joint::Number(number) = meaning.joint {
            vectors.entry((meaning.quantity, meaning.family.clone())).or_default().push((number, column));
        }
    }
    for ((quantity, family), mut columns) in vectors {
        columns.sort_unstable();
        let numbers = columns.iter().map(|(number, _)| *number);
        let first = columns[0].0;
        // Without positions of the whole vector, others may be those of the arm's joints, unless only a simulator calls them so.
        let is_vector =
            quantity == POSITION || out.note.is_some() || OF_SIMULATOR.iter().any(|own| family.contains(own));
        let whole = is_vector && first <= 1 && numbers.eq(first..first + columns.len());
        let Some((joints, of_motors)) = vector(addresses, quantity, &family, columns.len()).filter(|_| whole) else {
            continue;
        };
        let single = |joint: &&String| addresses.single.contains(joint);
        let is_called = columns.iter().zip(&joints).find_map(|((_, column), joint)| {
            let joint = joint.as_ref().filter(single)?;
            Some(format!("{} is that of {joint}", header[*column]))
        });
        if quantity == POSITION {
            out.note = is_called.map(|called| {
                format!(
                    "numbers of columns are places in the vectors of the simulator by the robot's file, which have other bodies too: {called} \
                     and so on"
                )
            });
        }
        out.of_motors |= of_motors;
        for ((_, column), joint) in columns.iter().zip(joints) {
            let joint = joint.as_ref().filter(single);
            out.others.extend(joint.is_none().then_some(*column));
            out.header[*column] = match joint {
                Some(joint) => format!("{}_{joint}", QUANTITIES[quantity].prefixes[0]),
                None => format!("({} of another object)", header[*column]),
            };
        }
    }
    out
}

/// The joint of each place of the vector of a quantity with so many places, and whether they are those of motors.
fn vector(addresses: &Addresses, quantity: usize, family: &str, places: usize) -> Option<(Vec<Option<String>>, bool)> {
    let of = |own: &[String]| (own.len() == places).then(|| own.iter().cloned().map(Some).collect());
    let by_velocities = || Some((of(&addresses.velocities)?, false));
    match quantity {
        POSITION => Some((of(&addresses.positions)?, false)),
        VELOCITY | ACCELERATION => by_velocities(),
        TORQUE => {
            let by_motors = || (addresses.motors.len() == places).then(|| (addresses.motors.clone(), true));
            // Generalised forces, `qfrc_actuator`, have the places of velocities.
            if family.contains("qfrc") { by_velocities() } else { by_motors().or_else(by_velocities) }
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    fn placed(columns: &[(&str, usize)]) -> Placed {
        let text = "<mujoco><worldbody><body><freejoint name='box'/><geom size='.1'/></body>\
                    <body><joint name='lift' type='slide'/><geom size='.1'/><body><joint name='bend'/><geom size='.1'/></body></body>\
                    <body><joint name='lamp' type='ball'/><geom size='.1'/></body></worldbody>\
                    <actuator><motor joint='bend'/><motor joint='lift'/></actuator></mujoco>";
        let robot = Robot::from_urdf_str(text).unwrap();
        let names = columns.iter().flat_map(|(name, count)| (0..*count).map(move |k| format!("{name}{k}")));
        super::placed(&names.collect::<Vec<_>>(), &robot.addresses)
    }

    fn joints(placed: &Placed) -> Vec<(usize, &str)> {
        let all = placed.header.iter().enumerate().filter(|(_, name)| !name.starts_with('('));
        all.map(|(column, name)| (column, name.as_str())).collect()
    }

    #[test]
    fn free_bodies_and_ball_joints_take_places_of_their_own() {
        let read = placed(&[("qpos_", 13), ("qvel_", 11), ("qfrc_actuator_", 11)]);
        let at = |first: usize, name: &'static str| [(first, name)];
        let expected = [at(7, "q_lift"), at(8, "q_bend"), at(19, "qd_lift"), at(20, "qd_bend"), at(30, "tau_lift")];
        assert_eq!(joints(&read)[..5], expected.concat());
        assert!(!read.of_motors && read.note.unwrap().contains("qpos_7 is that of lift"));
    }

    #[test]
    fn forces_of_motors_are_in_the_order_of_the_motors() {
        let read = placed(&[("qpos[", 13), ("actuator_force_", 2)]);
        assert_eq!(joints(&read)[2..], [(13, "tau_bend"), (14, "tau_lift")]);
        assert!(read.of_motors);
    }

    #[test]
    fn other_numbers_are_those_of_joints() {
        let read = placed(&[("q", 2), ("tau", 2)]);
        assert_eq!(joints(&read)[..2], [(0, "q0"), (1, "q1")]);
        assert_eq!(read.note, None);
    }
}
