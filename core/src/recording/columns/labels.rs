//! Names of joints that stand in the rows of a log and not in its header.

use super::names::QUANTITIES;

/// The header of a message of sensor_msgs/JointState as `ros2 topic echo --csv` writes it, from its first line: seconds,
/// nanoseconds, frame, the names of the joints, positions, velocities and efforts, of which an empty list is an empty cell.
/// None of another line.
pub(crate) fn of_joint_state_message(cells: &[String]) -> Option<Vec<String>> {
    let number = |cell: &String| cell.parse::<f64>().is_ok();
    let whole = |cell: Option<&String>| cell?.parse::<u64>().ok();
    let (_, nanoseconds) = (whole(cells.first())?, whole(cells.get(1))?);
    if nanoseconds >= 1_000_000_000 || cells.get(2).is_none_or(number) {
        return None;
    }
    let count = cells[3..].iter().take_while(|cell| !cell.is_empty() && !number(cell)).count();
    let names = &cells[3..3 + count];
    let mut header: Vec<String> = ["header.stamp.sec", "header.stamp.nanosec", "frame_id"].map(str::to_owned).to_vec();
    header.extend((0..count).map(|joint| format!("name[{joint}]")));
    let mut place = 3 + count;
    for quantity in [0, 1, 3] {
        let suffix = QUANTITIES[quantity].suffixes[0];
        match cells.get(place) {
            None => break,
            Some(cell) if cell.is_empty() => {
                header.push(format!("(no{suffix})"));
                place += 1;
            }
            Some(_) => {
                header.extend(names.iter().map(|name| format!("{name}{suffix}")));
                place += count;
            }
        }
    }
    (count > 0 && place == cells.len()).then_some(header)
}

/// The header of messages of control_msgs/DynamicJointState, whose first row names the joints and their interfaces: columns
/// `joint_names[0]`, `interface_values[0].interface_names[1]` and `interface_values[0].values[1]`.
fn of_dynamic_joint_states(header: Vec<String>, first: &[String]) -> Vec<String> {
    let numbers = |column: &str, word: &str| -> Option<Vec<usize>> {
        let (before, behind) = column.split_once(word)?;
        let of = |text: &str| text.split(|letter: char| !letter.is_ascii_digit()).find_map(|part| part.parse().ok());
        let joint = before.split_once("interface_values").map(|(_, joint)| of(joint));
        joint.into_iter().chain([of(behind)]).collect()
    };
    let cell = |word: &str, wanted: &[usize]| {
        let place = header.iter().position(|column| numbers(column, word).is_some_and(|own| own == wanted))?;
        first.get(place).filter(|cell| !cell.is_empty() && cell.parse::<f64>().is_err())
    };
    let rename = |column: &String| {
        let place = numbers(column, ".values").or_else(|| numbers(column, "/values"))?;
        let [joint, _] = place[..] else { return None };
        Some(format!("{}/{}", cell("joint_names", &[joint])?, cell("interface_names", &place)?))
    };
    header.iter().map(|column| rename(column).unwrap_or_else(|| column.clone())).collect()
}

/// The header with the names of joints that the first row holds: of columns `name0` or `name[0]` next to `position0` or
/// `position[0]`.
pub(crate) fn named(header: Vec<String>, first: &[String]) -> Vec<String> {
    let header = of_dynamic_joint_states(header, first);
    let split = |column: &str| -> Option<(String, String, usize)> {
        let bare = column.strip_suffix(']').unwrap_or(column);
        let stem = bare.trim_end_matches(|letter: char| letter.is_ascii_digit());
        let number = bare[stem.len()..].parse().ok()?;
        let stem = stem.trim_end_matches(['[', '_', '.']);
        let (group, word) = stem.rsplit_once(['.', '/']).unwrap_or(("", stem));
        Some((group.to_owned(), word.to_owned(), number))
    };
    let parts: Vec<_> = header.iter().map(|column| split(column)).collect();
    let label = |group: &str, number: usize| {
        let place = parts.iter().position(|part| {
            part.as_ref().is_some_and(|(own, word, count)| {
                own == group && *count == number && matches!(word.as_str(), "name" | "names" | "joint_names")
            })
        })?;
        first.get(place).filter(|cell| !cell.is_empty() && cell.parse::<f64>().is_err())
    };
    let rename = |part: &Option<(String, String, usize)>| {
        let suffix = |word: &str| match word {
            "position" | "positions" => Some(QUANTITIES[0].suffixes[0]),
            "velocity" | "velocities" => Some(QUANTITIES[1].suffixes[0]),
            "effort" | "efforts" | "torque" | "torques" => Some(QUANTITIES[3].suffixes[0]),
            _ => None,
        };
        let (group, word, number) = part.as_ref()?;
        let (suffix, label) = (suffix(word)?, label(group, *number)?);
        Some(format!("{label}{suffix}"))
    };
    header.iter().zip(&parts).map(|(column, part)| rename(part).unwrap_or_else(|| column.clone())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(line: &str) -> Vec<String> {
        line.split(',').map(str::to_owned).collect()
    }

    #[test]
    fn messages_without_a_header() {
        let header = of_joint_state_message(&cells("17,5000,base,a,b,1,2,,3,4")).unwrap();
        assert_eq!(
            header[3..],
            ["name[0]", "name[1]", "a_position", "b_position", "(no_velocity)", "a_effort", "b_effort"]
        );
        let full = of_joint_state_message(&cells("17,5000,,a,1,2,3")).unwrap();
        assert_eq!(full[4..], ["a_position", "a_velocity", "a_effort"]);
        for other in ["t,q1,tau1", "0,1,2", "17,5000,,a,1,2,3,4", "17,5e9,,a,1,2,3"] {
            assert_eq!(of_joint_state_message(&cells(other)), None, "{other}");
        }
    }

    #[test]
    fn interfaces_in_the_first_row() {
        let header = cells(
            "t,joint_names[0],interface_values[0].interface_names[0],interface_values[0].interface_names[1],interface_values[0].values[0],\
             interface_values[0].values[1],interface_values[1].values[0]",
        );
        let named = named(header, &cells("0,elbow,velocity,position,0.1,0.2,0.3"));
        assert_eq!(named[4..], ["elbow/velocity", "elbow/position", "interface_values[1].values[0]"]);
    }

    #[test]
    fn names_in_the_first_row() {
        let header = cells("%time,field.name0,field.name1,field.position0,field.position1,field.effort1");
        let named = named(header, &cells("5,a,b,1,2,3"));
        assert_eq!(named[3..], ["a_position", "b_position", "b_effort"]);
        let header = cells("t,name[0],position[0],q[0]");
        assert_eq!(super::named(header.clone(), &cells("0,7,1,1")), header);
    }
}
