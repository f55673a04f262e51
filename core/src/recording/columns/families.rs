//! Columns that are called alike, and the joints that they name or number.

use super::bare;
use super::names::{self, Joint, Meaning};
use super::prefixes::most_behind_prefix;
use super::spelling;
use std::collections::{BTreeMap, BTreeSet};

/// A column that is the signal of a joint, as one reading of its name has it.
#[derive(Debug)]
pub(super) struct Candidate<'a> {
    /// Index of the column.
    pub column: usize,
    /// The reading.
    pub meaning: &'a Meaning,
    /// Whose signal it is.
    pub joint: Place,
}

/// Where a joint is in the order of joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// As the file numbers it.
    Number(usize),
    /// Counted from 1.
    Index(usize),
}

/// The columns of a quantity whose joint is known, each in the first reading of its name that gives one.
pub(super) fn candidates<'a>(
    meanings: &'a [Vec<Meaning>],
    names: &[String],
    numbers: &BTreeMap<String, usize>,
    truth: bool,
    quantity: usize,
) -> Vec<Candidate<'a>> {
    let place = |meaning: &Meaning| match &meaning.joint {
        Joint::Number(number) => Some(Place::Number(*number)),
        Joint::Name(name) => match numbers.get(name) {
            Some(number) => Some(Place::Index(*number)),
            None => names.iter().position(|own| own == name).map(|index| Place::Index(index + 1)),
        },
    };
    let of = |(column, readings): (usize, &'a Vec<Meaning>)| {
        let (meaning, joint) = readings.iter().find_map(|meaning| Some((meaning, place(meaning)?)))?;
        ((meaning.truth, meaning.quantity) == (truth, quantity)).then_some(Candidate { column, meaning, joint })
    };
    meanings.iter().enumerate().filter_map(of).collect()
}

/// Those columns, of all that could be the same quantity, that are called alike: measured torques before those of a controller, torques
/// before currents, those of more joints, the joint's side of the gear before the motor's, and names that this program writes before others.
pub(super) fn best_family(candidates: Vec<Candidate>) -> Vec<Candidate> {
    let mut families: BTreeMap<&str, Vec<Candidate>> = BTreeMap::new();
    for candidate in candidates {
        families.entry(&candidate.meaning.family).or_default().push(candidate);
    }
    let order = |family: &Vec<Candidate>| -> ((bool, bool), std::cmp::Reverse<usize>, bool, u8) {
        let first = family.first().map(|candidate| candidate.meaning);
        let kind = (first.is_some_and(|m| m.of_controller), first.is_some_and(|m| m.current));
        let of_motor = first.is_some_and(|meaning| !meaning.current && names::is_of_motor(&meaning.family));
        (kind, std::cmp::Reverse(family.len()), of_motor, first.map_or(0, |m| m.rank))
    };
    let Some(best) = families.values().min_by_key(|family| order(family)).and_then(|family| family.first()) else {
        return Vec::new();
    };
    let (name, kind) = (best.meaning.family.clone(), order(&families[best.meaning.family.as_str()]).0);
    let mut taken = families.remove(name.as_str()).unwrap_or_default();
    // A joint that turns has an angle and a torque where one that slides has a position and a force.
    let mut others: Vec<Vec<Candidate>> = families.into_values().filter(|other| order(other).0 == kind).collect();
    others.retain(|other| other.iter().all(|own| are_alike(&own.meaning.family, &name)));
    others.sort_by_key(order);
    for other in others {
        if other.iter().all(|own| taken.iter().all(|before| before.joint != own.joint)) {
            taken.extend(other);
        }
    }
    taken
}

/// Whether names of two families have the joint on the same side of one word.
fn are_alike(one: &str, other: &str) -> bool {
    let is_word = |word: &str| !word.is_empty() && word.chars().all(char::is_alphanumeric);
    let side = |family: &str| match (family.strip_prefix("#_"), family.strip_suffix("_#")) {
        (Some(word), _) if is_word(word) => Some(true),
        (_, Some(word)) if is_word(word) => Some(false),
        _ => None,
    };
    side(one).is_some() && side(one) == side(other)
}

/// Whether the joints of a quantity are counted from 0 or from 1; None where none is numbered. A quantity without number
/// 0 is counted as positions are, unless it has as many joints from 1 on. Of a robot with so many `joints`, if that is known, as many numbers
/// beyond these are counted from the lowest: motors on a bus, or a second arm.
pub(super) fn base(
    family: &[Candidate],
    of_positions: Option<usize>,
    positions: usize,
    joints: Option<usize>,
) -> Option<usize> {
    let numbers = family.iter().filter_map(|candidate| match candidate.joint {
        Place::Number(number) => Some(number),
        Place::Index(_) => None,
    });
    let (lowest, highest) = (numbers.clone().min()?, numbers.max()?);
    if from_another(family, joints) == Some(lowest) {
        return Some(lowest);
    }
    Some(if lowest == 0 || (of_positions == Some(0) && highest < positions) { 0 } else { 1 })
}

/// The lowest number, where the numbers of a family are as many as the robot has joints, without a hole, and none of them can be that of a joint.
pub(super) fn from_another(family: &[Candidate], joints: Option<usize>) -> Option<usize> {
    let number = |candidate: &Candidate| match candidate.joint {
        Place::Number(number) => Some(number),
        Place::Index(_) => None,
    };
    let numbers: BTreeSet<usize> = family.iter().map(number).collect::<Option<_>>()?;
    let (&lowest, &highest) = (numbers.first()?, numbers.last()?);
    let count = joints?;
    (lowest > count && numbers.len() == count && highest - lowest + 1 == count).then_some(lowest)
}

/// Whether any joint has a position.
pub(super) fn any_position(meanings: &[Vec<Meaning>], names: &[String]) -> bool {
    !candidates(meanings, names, &BTreeMap::new(), false, names::POSITION).is_empty()
}

/// The numbers of joints that the file calls by other names than the robot does, as `joint1` to `joint6`: name -> number
/// counted from 1. Empty unless there are `count` of them without a hole; a gripper beside them has no number.
pub(super) fn numbers_in_names(names: &[String], count: usize) -> BTreeMap<String, usize> {
    if names.len() > count {
        let arm: Vec<String> = without_others(names, count);
        return if arm.len() == count { numbers_in_names(&arm, count) } else { BTreeMap::new() };
    }
    if names.len() != count || names.is_empty() {
        return BTreeMap::new();
    }
    // `rob1_3` has two numbers, of which one is the joint's.
    let places = names.iter().map(|name| numbers_of(name).len()).min().unwrap_or(0);
    let counted = |place: usize| {
        let parts: Vec<(String, usize)> = names.iter().map(|name| numbers_of(name).swap_remove(place)).collect();
        let mut sorted: Vec<usize> = parts.iter().map(|(_, number)| *number).collect();
        sorted.sort_unstable();
        let lowest = sorted[0];
        let alike = parts.iter().all(|(pattern, _)| *pattern == parts[0].0);
        let whole = alike && lowest <= 1 && sorted.into_iter().eq(lowest..lowest + count);
        whole.then(|| names.iter().cloned().zip(parts.into_iter().map(|(_, number)| number + 1 - lowest)).collect())
    };
    (0..places).find_map(counted).or_else(|| in_convention(names)).unwrap_or_default()
}

/// Words of the names of grippers, which logs of numbered joints hold too: `gripper_position` beside `actuators_0_position`.
const OF_GRIPPERS: [&str; 8] = ["gripper", "grippers", "hand", "finger", "fingers", "jaw", "claw", "tool"];

/// The names that are none of a gripper.
fn without_grippers(names: &[String]) -> Vec<String> {
    let is_of_gripper = |name: &&String| {
        let mut words = name.split(|letter: char| !letter.is_alphabetic()).map(str::to_lowercase);
        words.any(|word| OF_GRIPPERS.contains(&word.as_str()))
    };
    names.iter().filter(|name| !is_of_gripper(name)).cloned().collect()
}

/// The names that are none of a gripper and, where that leaves more than `count`, none of the motors beside the joints.
fn without_others(names: &[String], count: usize) -> Vec<String> {
    let mut own = without_grippers(names);
    if own.len() > count {
        own.retain(|name| !names::is_of_motor(name));
    }
    own
}

/// What controllers call the joints that they do not number, in their order: those of Yaskawa with six and seven axes, and of Universal Robots.
const CONVENTIONS: [&[&str]; 3] = [
    &["s", "l", "u", "r", "b", "t"],
    &["s", "l", "e", "u", "r", "b", "t"],
    &["base", "shoulder", "elbow", "wrist1", "wrist2", "wrist3"],
];

/// The numbers of joints that have all names of a convention, counted from 1. Words for a joint may stand around, `S-axis`.
fn in_convention(names: &[String]) -> Option<BTreeMap<String, usize>> {
    let bare = |name: &String| -> String {
        let words = name.split(|letter: char| !letter.is_alphanumeric()).map(str::to_lowercase);
        words.filter(|word| !["axis", "joint"].contains(&word.as_str())).collect()
    };
    let own: Vec<String> = names.iter().map(bare).collect();
    CONVENTIONS.into_iter().filter(|convention| convention.len() == names.len()).find_map(|convention| {
        let number = |word: &str| convention.iter().position(|name| *name == word).map(|place| place + 1);
        let numbers: BTreeMap<String, usize> =
            names.iter().zip(&own).map(|(name, word)| Some((name.clone(), number(word)?))).collect::<Option<_>>()?;
        let all = (1..=names.len()).all(|number| numbers.values().any(|own| *own == number));
        all.then_some(numbers)
    })
}

/// The numbers in a name, each with the name around it.
fn numbers_of(name: &str) -> Vec<(String, usize)> {
    let mut out = Vec::new();
    let mut end = 0;
    while let Some(start) = name[end..].find(|letter: char| letter.is_ascii_digit()).map(|start| end + start) {
        end = start + name[start..].bytes().take_while(u8::is_ascii_digit).count();
        out.extend(
            name[start..end].parse().ok().map(|number| (format!("{}#{}", &name[..start], &name[end..]), number)),
        );
    }
    out
}

/// The readings of a quantity in the family that most columns share, torques before currents.
fn most_named(meanings: &[Vec<Meaning>], quantity: usize) -> Vec<&Meaning> {
    let mut families: BTreeMap<&str, Vec<&Meaning>> = BTreeMap::new();
    for meaning in meanings.iter().filter_map(|readings| readings.iter().find(|meaning| !meaning.exact_only)) {
        if !meaning.truth && !meaning.of_controller && meaning.quantity == quantity {
            families.entry(&meaning.family).or_default().push(meaning);
        }
    }
    let order = |family: &Vec<&Meaning>| {
        let first = family.first();
        (
            first.is_some_and(|meaning| meaning.current),
            std::cmp::Reverse(family.len()),
            first.map(|meaning| meaning.rank),
        )
    };
    families.into_values().min_by_key(order).unwrap_or_default()
}

/// The joints of which a log holds positions.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::recording::lenient::{self, ColumnMap};
///
/// // Which joints a log has, from its header alone.
/// let names = lenient::joint_names("../tests/reference/payload/before.csv", &[], &ColumnMap::default())?;
/// assert_eq!(names.names, ["j1", "j2", "j3", "j4", "j5"]);
///
/// // These names are numbers: the columns can be the first five joints of any robot.
/// assert_eq!(names.numbered, 5);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct JointNames {
    /// Names in the order of the file; empty where the joints are numbered alone.
    pub names: Vec<String>,
    /// Number of joints where they are numbered, be it in their names; 0 where they are named.
    pub numbered: usize,
}

/// All ways to understand the names of a header, in which `known` joints are spelled as the robot spells them, and a note on columns that are
/// taken for positions without saying so. Names that number the joints stay: they are taken by their numbers.
pub(super) fn meanings(header: &[String], known: &[String]) -> (Vec<Vec<Meaning>>, Option<String>) {
    let (mut meanings, note) = bare::meanings(header, known);
    add_scattered(&mut meanings, header);
    let own = own_names(&meanings);
    if numbers_in_names(&own, own.len()).is_empty() {
        spelling::correct(&mut meanings, known);
    }
    (meanings, note)
}

/// Adds readings of names whose words stand in no known order, of quantities that more of these name than all others.
fn add_scattered(meanings: &mut [Vec<Meaning>], header: &[String]) {
    let is_sure = |meaning: &&Meaning| !meaning.exact_only && !meaning.of_controller;
    let sure: Vec<Option<usize>> =
        meanings.iter().map(|readings| readings.iter().find(is_sure).map(|meaning| meaning.quantity)).collect();
    let mut families: BTreeMap<(usize, String), Vec<(usize, Meaning)>> = BTreeMap::new();
    let open = (0..header.len()).filter(|column| sure[*column].is_none());
    for (column, meaning) in open.filter_map(|column| Some((column, names::scattered(&header[column])?))) {
        families.entry((meaning.quantity, meaning.family.clone())).or_default().push((column, meaning));
    }
    for ((quantity, _), family) in families {
        if family.len() > sure.iter().filter(|known| **known == Some(quantity)).count() {
            family.into_iter().for_each(|(column, meaning)| meanings[column].push(meaning));
        }
    }
}

/// The joints whose positions a header names or numbers. Those of `known` that it names are found under every name that a reader who
/// wants them understands.
pub(crate) fn joint_names(header: &[String], known: &[String]) -> JointNames {
    let (meanings, _) = meanings(header, known);
    let is_numbered = |meaning: &&&Meaning| matches!(meaning.joint, Joint::Number(_));
    let numbered = most_named(&meanings, names::POSITION).iter().filter(is_numbered).count();
    let names = own_names(&meanings);
    // `joint1_pos` numbers a joint of a robot that calls it otherwise.
    let of_robot = names.iter().filter(|name| known.contains(name)).count();
    let own = if of_robot == 0 { without_others(&names, known.len()) } else { names.clone() };
    let in_names = numbers_in_names(&own, own.len()).len();
    let around = around_names(&meanings, known);
    let names = match around.len() > of_robot.max(numbered) {
        true => around,
        false if of_robot == 0 => most_behind_prefix(&names, known).unwrap_or(names),
        false => names,
    };
    JointNames { names, numbered: numbered.max(in_names) }
}

/// Those of `known` that stand in the names of positions among words that count only around a joint, as in `msr_pos_elbow`.
fn around_names(meanings: &[Vec<Meaning>], known: &[String]) -> Vec<String> {
    let mut named = candidates(meanings, known, &BTreeMap::new(), false, names::POSITION);
    named.retain(|candidate| matches!(candidate.joint, Place::Index(_)));
    let of = |candidate: Candidate| match candidate.joint {
        Place::Index(index) => known.get(index - 1).cloned(),
        Place::Number(_) => None,
    };
    best_family(named).into_iter().filter_map(of).collect()
}

/// Joint names in the order of their positions; none where the positions are numbered.
pub(super) fn own_names(meanings: &[Vec<Meaning>]) -> Vec<String> {
    names_of(meanings, names::POSITION)
}

/// The same of any quantity.
pub(super) fn names_of(meanings: &[Vec<Meaning>], quantity: usize) -> Vec<String> {
    let name = |meaning: &&Meaning| match &meaning.joint {
        Joint::Name(name) => Some(name.clone()),
        Joint::Number(_) => None,
    };
    let names: Option<Vec<String>> = most_named(meanings, quantity).iter().map(name).collect();
    let mut unique: Vec<String> = Vec::new();
    for name in names.unwrap_or_default() {
        if !unique.contains(&name) {
            unique.push(name);
        }
    }
    unique
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(names: &str) -> Vec<String> {
        names.split(',').map(str::to_owned).collect()
    }

    /// The joints that a header of positions names, of a tree with two arms.
    fn named(positions: &str) -> Vec<String> {
        let known = list("head,l_shoulder,l_elbow,l_wrist_1,r_shoulder,r_elbow,r_wrist_1");
        joint_names(&list(&format!("t,{positions}")), &known).names
    }

    #[test]
    fn joints_of_a_tree_are_named_with_every_word_around_them() {
        for pattern in [
            "q_#",
            "#_position",
            "msr_pos_#",
            "meas_position_#",
            "#_pos_actual",
            "/joint_states/#/position",
            "#/actual/pos",
        ] {
            let header = ["r_shoulder", "r_elbow", "r_wrist_1"].map(|joint| pattern.replace('#', joint)).join(",");
            assert_eq!(named(&header), ["r_shoulder", "r_elbow", "r_wrist_1"], "{header}");
        }
        // More joints under one kind of name than under another.
        assert_eq!(named("q_head,msr_pos_r_shoulder,msr_pos_r_elbow"), ["r_shoulder", "r_elbow"]);
        // Numbers stay numbers, and others stay others.
        assert_eq!(named("q1,q2,q3,msr_pos_head"), Vec::<String>::new());
        assert_eq!(named("q_x,q_y"), ["x", "y"]);
        assert_eq!(named("target_position_r_elbow,q_x,q_y"), ["x", "y"]);
    }

    #[test]
    fn a_gripper_beside_numbered_joints_has_no_number() {
        let names = list("actuators_0,actuators_1,gripper");
        let numbers = numbers_in_names(&names, 2);
        assert_eq!(numbers.into_values().collect::<Vec<_>>(), [1, 2]);
        assert!(numbers_in_names(&names, 3).is_empty() && numbers_in_names(&names, 1).is_empty());
        // Other joints without numbers may be of the arm.
        assert!(numbers_in_names(&list("elbow,wrist_1,wrist_2"), 2).is_empty());
        let header = list("t,actuators_0_position,actuators_1_position,gripper_position");
        assert_eq!(joint_names(&header, &list("base,arm,finger")).numbered, 2);
    }

    #[test]
    fn names_of_a_convention_are_numbers() {
        let of =
            |names: &str| numbers_in_names(&list(names), names.split(',').count()).into_values().collect::<Vec<_>>();
        // By name: B, L, R, S, T, U.
        assert_eq!(of("S,L,U,R,B,T"), [5, 2, 4, 1, 6, 3]);
        assert_eq!(of("B-axis,L-axis,R-axis,S-axis,T-axis,U-axis"), [5, 2, 4, 1, 6, 3]);
        assert_eq!(of("S,L,E,U,R,B,T").len(), 7);
        assert_eq!(of("Base,Shoulder,Elbow,Wrist 1,Wrist 2,Wrist 3"), [1, 3, 2, 4, 5, 6]);
        assert!(of("S,L,U,R,B,X").is_empty() && of("S,L,U,R,B,S").is_empty() && of("S,L").is_empty());
    }

    #[test]
    fn joints_of_a_tree_are_named_behind_a_prefix() {
        assert_eq!(named("robot/r_shoulder_position,robot/r_elbow_position"), ["r_shoulder", "r_elbow"]);
        assert_eq!(named("q_my_l_elbow,q_my_l_wrist_1"), ["l_elbow", "l_wrist_1"]);
        // Of either arm, or hardly any of them.
        assert_eq!(named("q_shoulder,q_elbow"), ["shoulder", "elbow"]);
        assert_eq!(named("q_a_head,q_b,q_c"), ["a_head", "b", "c"]);
        let one_arm = joint_names(&list("t,q_elbow,q_wrist"), &list("ur_lift,ur_elbow,ur_wrist"));
        assert_eq!(one_arm.names, ["ur_elbow", "ur_wrist"]);
    }
}
