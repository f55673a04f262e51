//! Joints that the file calls by the robot's names behind a prefix, or the robot by the file's: `left_arm/elbow` for `elbow`. Or each calls them
//! behind one of its own: `robot0/elbow` for `left_elbow`. What separates words does not matter.

use super::names::{Joint, Meaning, QUANTITIES};
use std::collections::{BTreeMap, BTreeSet};

/// What stands between a prefix and the joint behind it.
const SEPARATORS: [char; 6] = ['/', '_', '.', '-', ':', ' '];

/// The numbers of joints by their names in the file, counted from 1, and the prefix.
type Fit = (BTreeMap<String, usize>, String);

/// The numbers of joints that the file calls by the robot's names behind a prefix that all share, as `left_arm/elbow`, or the robot
/// by the file's behind one, in columns of a quantity: name -> number counted from 1, and the prefix. None where two prefixes fit, as of
/// two arms.
pub(super) fn behind_prefix(meanings: &[Vec<Meaning>], names: &[String], quantity: usize) -> Option<Fit> {
    let mut fits = fits(meanings, names, quantity);
    if fits.len() == 1 { fits.pop() } else { None }
}

/// Why the columns of a quantity are not found, and what to do, where the names fit behind several prefixes.
pub(super) fn several(meanings: &[Vec<Meaning>], names: &[String], quantity: usize) -> Option<String> {
    let name = QUANTITIES[quantity].name;
    let of_file: Vec<String> = fits(meanings, names, quantity).into_iter().map(|(_, prefix)| prefix).collect();
    if of_file.len() > 1 {
        return Some(format!(
            "the columns of {name} fit the robot's joints behind {} alike; name those that are meant in a dataset, in the order \
             of the joints: [columns] q = [..], qd = [..], tau = [..]",
            of_file.join(" and ")
        ));
    }
    let own = named(meanings, quantity);
    let of_robot = most_shared(&own, names);
    if of_robot.len() < 2 || of_robot.iter().any(|(_, in_file, _)| *in_file) {
        return None;
    }
    let prefixes: Vec<&str> = of_robot.iter().map(|(prefix, ..)| *prefix).collect();
    let first: Vec<&str> = of_robot[0].2.iter().map(|joint| joint.as_str()).collect();
    Some(format!(
        "the joints of the file fit the robot's behind {} alike; choose with --tip LINK, the last link of the arm that is meant, or \
         with --joints {}",
        prefixes.join(" and "),
        first.join(",")
    ))
}

/// What stands before a short name in a long one, up to a separator; words may be separated otherwise.
fn before<'a>(long: &'a str, short: &str) -> Option<&'a str> {
    let (prefix, own) = long.split_at_checked(long.len().checked_sub(short.len())?)?;
    (prefix.ends_with(SEPARATORS) && is_alike(own, short)).then_some(prefix)
}

/// Whether two names differ at most in what separates their words.
fn is_alike(a: &str, b: &str) -> bool {
    let plain = |letter: char| if SEPARATORS.contains(&letter) { SEPARATORS[0] } else { letter };
    a.chars().map(plain).eq(b.chars().map(plain))
}

/// What all names share up to a separator; nothing of a single one.
fn shared(names: &[String]) -> &str {
    let Some((first, others)) = names.split_first().filter(|(_, others)| !others.is_empty()) else { return "" };
    let ends = first.match_indices(SEPARATORS).map(|(place, separator)| place + separator.len());
    let mut prefixes = ends.map(|end| &first[..end]);
    prefixes.rfind(|prefix| others.iter().all(|other| other.starts_with(prefix))).unwrap_or("")
}

/// The names of joints in columns of a quantity, each once.
fn named(meanings: &[Vec<Meaning>], quantity: usize) -> Vec<String> {
    let readings = meanings.iter().flatten().filter(|m| !m.truth && !m.exact_only && m.quantity == quantity);
    let mut out: Vec<String> = Vec::new();
    for meaning in readings {
        if let Joint::Name(name) = &meaning.joint
            && !out.contains(name)
        {
            out.push(name.clone());
        }
    }
    out
}

/// Every prefix behind which all joints are, with their numbers.
fn fits(meanings: &[Vec<Meaning>], names: &[String], quantity: usize) -> Vec<Fit> {
    let own = named(meanings, quantity);
    let Some(first) = names.first() else { return Vec::new() };
    let of_file = own.iter().filter_map(|name| before(name, first)).map(|prefix| (prefix, Side::File));
    let of_robot = own.iter().filter_map(|name| before(first, name)).map(|prefix| (prefix, Side::Robot));
    let ahead = shared(names);
    let fit = |(prefix, side): (&str, Side)| -> Option<Fit> {
        let is_called = |name: &String, joint: &String| match side {
            Side::File => before(name, joint) == Some(prefix),
            Side::Robot => before(joint, name) == Some(prefix),
            Side::Both => before(name, &joint[ahead.len()..]) == Some(prefix),
        };
        let of_joint = |joint: &String| own.iter().find(|name| is_called(name, joint)).cloned();
        let all: Vec<String> = names.iter().map(of_joint).collect::<Option<_>>()?;
        Some((all.into_iter().zip(1..).collect(), prefix.to_owned()))
    };
    let mut fits: Vec<Fit> = of_file.chain(of_robot).filter_map(fit).collect();
    // Each has a prefix of its own where none of them is behind one of the other's names.
    if fits.is_empty() && !ahead.is_empty() {
        let of_both = own.iter().filter_map(|name| before(name, &first[ahead.len()..]));
        fits.extend(of_both.filter_map(|prefix| fit((prefix, Side::Both))));
    }
    let mut seen = BTreeSet::new();
    fits.retain(|(_, prefix)| seen.insert(prefix.clone()));
    fits
}

/// Where a prefix stands.
#[derive(Clone, Copy)]
enum Side {
    File,
    Robot,
    Both,
}

/// Those of `known` that more than half of the names of a file are behind one prefix, or that are so behind one of the robot's. None where
/// two prefixes fit as many.
pub(super) fn most_behind_prefix(names: &[String], known: &[String]) -> Option<Vec<String>> {
    let mut best = most_shared(names, known);
    let (.., joints) = best.pop().filter(|_| best.is_empty())?;
    Some(joints.into_iter().cloned().collect())
}

/// The prefixes that most names of a file share with joints of `known`, if more than half do: each with whether it stands in the file, else
/// in the robot, and the joints.
fn most_shared<'a>(names: &'a [String], known: &'a [String]) -> Vec<(&'a str, bool, Vec<&'a String>)> {
    let mut found: BTreeMap<(&str, bool), Vec<&String>> = BTreeMap::new();
    for (name, joint) in names.iter().flat_map(|name| known.iter().map(move |joint| (name, joint))) {
        let pairs = [(name, joint, true), (joint, name, false)];
        for (long, short, in_file) in pairs {
            if let Some(prefix) = before(long, short) {
                found.entry((prefix, in_file)).or_default().push(joint);
            }
        }
    }
    let most = found.values().map(Vec::len).max().filter(|most| 2 * most > names.len());
    let best = found.into_iter().filter(|(_, joints)| Some(joints.len()) == most);
    best.map(|((prefix, in_file), joints)| (prefix, in_file, joints)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::columns::bare;
    use crate::recording::columns::names::{POSITION, TORQUE};

    fn list(names: &str) -> Vec<String> {
        names.split(',').map(str::to_owned).collect()
    }

    fn of_columns(columns: &str, joints: &str, quantity: usize) -> Option<String> {
        let (meanings, _) = bare::meanings(&list(columns), &[]);
        several(&meanings, &list(joints), quantity)
    }

    fn is_found(columns: &str, joints: &str) -> bool {
        let (meanings, _) = bare::meanings(&list(columns), &[]);
        let found = behind_prefix(&meanings, &list(joints), POSITION);
        found.is_some_and(|(numbers, _)| numbers.values().eq([1, 2].iter()) || numbers.values().eq([2, 1].iter()))
    }

    #[test]
    fn prefixes_may_be_on_both_sides_and_words_be_separated_otherwise() {
        let robot = "left_arm_shoulder,left_arm_elbow";
        for columns in ["robot0/left_arm/shoulder", "left_arm/shoulder", "robot0/shoulder", "robot0.left-arm.shoulder"]
        {
            let columns = ["shoulder", "elbow"].map(|joint| format!("{}/position", columns.replace("shoulder", joint)));
            assert!(is_found(&columns.join(","), robot), "{columns:?}");
        }
        assert!(!is_found("robot0/knee/position,robot0/elbow/position", robot));
        // Two arms of the file.
        let two = "robot0/shoulder/position,robot0/elbow/position,robot1/shoulder/position,robot1/elbow/position";
        assert!(
            !is_found(two, robot) && of_columns(two, robot, POSITION).unwrap().contains("robot0/ and robot1/ alike")
        );
        assert!(!is_found("robot0/shoulder/position,robot1/elbow/position", robot));
    }

    #[test]
    fn two_arms_of_the_robot_are_chosen_between() {
        let two = "left_shoulder,left_elbow,right_shoulder,right_elbow";
        let said = of_columns("shoulder_position,elbow_position,gripper_position", two, POSITION).unwrap();
        for part in ["behind left_ and right_ alike", "--tip LINK", "--joints left_shoulder,left_elbow"] {
            assert!(said.contains(part), "{said}");
        }
        assert_eq!(of_columns("left_shoulder_position,left_elbow_position", two, POSITION), None);
        assert_eq!(of_columns("x_position,y_position", two, POSITION), None);
    }

    #[test]
    fn two_topics_of_the_file_are_chosen_between() {
        let columns = |topic: &str| format!("/{topic}/effort/shoulder,/{topic}/effort/elbow");
        let said = of_columns(&format!("{},{}", columns("a"), columns("b")), "shoulder,elbow", TORQUE).unwrap();
        assert!(said.contains("behind a/ and b/ alike") && said.contains("[columns] q = [..]"), "{said}");
        assert_eq!(of_columns(&columns("a"), "shoulder,elbow", TORQUE), None);
    }
}
