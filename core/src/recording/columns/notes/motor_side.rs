//! Columns of the motor side beside those of the joints: arms with two encoders, or with springs between motors and links.

use crate::recording::columns::names::{self, POSITION, VELOCITY};
use std::collections::BTreeSet;

/// What is said where positions or velocities of the motors are not used; `position` is the first column of position in use.
pub(in crate::recording::columns) fn note(
    header: &[String],
    used: &BTreeSet<usize>,
    position: Option<usize>,
) -> Option<String> {
    let position = header.get(position?).filter(|name| !names::is_of_motor(name))?;
    let of_motion = |name: &String| {
        let readings = names::meanings(name).into_iter().chain(names::scattered(name));
        names::is_measured_at_joint(name)
            && readings.into_iter().any(|meaning| [POSITION, VELOCITY].contains(&meaning.quantity))
    };
    let motors = header.iter().enumerate().filter(|(column, _)| !used.contains(column)).map(|(_, name)| name);
    let first = motors.into_iter().find(|name| names::is_of_motor(name) && of_motion(name))?;
    Some(format!(
        "{position} and its like are taken for the joints' side, and {first} and its like, by their names those of the motors, are not used: to \
         take these, name them in a dataset ([columns] q = [..], and [motors] gear_ratio, position_at = \"motor\")"
    ))
}

#[cfg(test)]
mod tests {
    use crate::recording::columns::layout::Layout;
    use crate::recording::columns::search::Demand;
    use std::path::Path;

    /// The columns of position and velocity in use, and whether the motors' are named.
    fn read(names: &[&str]) -> (Vec<String>, bool) {
        let each = (1..=2).flat_map(|joint| names.iter().map(move |name| name.replace('#', &joint.to_string())));
        let header: Vec<String> = std::iter::once("t".to_owned()).chain(each).collect();
        let joints = ["elbow", "wrist"].map(str::to_owned);
        let demand = Demand { lenient: true, ..Demand::default() };
        let layout = Layout::search(Path::new("log.csv"), Some(1), &header, Some(&joints), demand).unwrap();
        let columns = layout.positions().iter().chain(layout.velocities().unwrap_or_default());
        let used = columns.map(|&column| header[column].clone()).collect();
        (used, layout.understood.iter().any(|note| note.contains("those of the motors, are not used")))
    }

    #[test]
    fn the_side_of_the_joint_is_taken_whatever_the_order() {
        for names in [
            ["motor_position_#", "link_position_#", "motor_velocity_#", "link_velocity_#", "link_torque_#"],
            ["link_position_#", "motor_position_#", "link_velocity_#", "motor_velocity_#", "motor_torque_#"],
            ["position_motor_#", "position_link_#", "velocity_motor_#", "velocity_link_#", "torque_#"],
            ["q_motor_#", "q_link_#", "dq_motor_#", "dq_link_#", "tau_#"],
            ["motor_position_#", "joint_position_#", "motor_velocity_#", "joint_velocity_#", "joint_torque_#"],
            ["motor_position_#", "load_position_#", "motor_velocity_#", "load_velocity_#", "torque_#"],
        ] {
            let (used, is_noted) = read(&names);
            assert!(used.len() == 4 && is_noted, "{names:?}: {used:?}");
            assert!(used.iter().all(|name| !name.contains("motor")), "{used:?}");
        }
        // Motors alone are what there is.
        let (used, is_noted) = read(&["motor_position_#", "motor_velocity_#", "motor_torque_#"]);
        assert!(used.len() == 4 && !is_noted, "{used:?}");
    }
}
