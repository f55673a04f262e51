//! Names whose words stand in no known order: one quantity somewhere, and the joint around it, as in `joint1_position_actual`,
//! `position/robot0/left_arm/joint_1`, `servo_angle_1`.

use super::meaning::{Joint, Meaning, of_present};
use super::quantity::{POSITION, TORQUE};
use super::unit::Unit;
use super::vocabulary;
use super::words::without_unit;

/// Rank of names in no known order: all others are likelier.
const RANK: u8 = 4;

/// Words that mean a quantity only where no other word of the name does.
const WEAK: [&str; 7] = ["state", "load", "current", "moment", "i", "u", "par"];

/// Sensors of position, which stand for it where no other word of the name is a quantity.
const SENSORS: [&str; 3] = ["enc", "encoder", "encoders"];

/// Words of things that have positions, speeds or forces and are no joints.
const OF_OTHER_THINGS: [&str; 22] = [
    "eef", "ee", "base", "object", "camera", "imu", "wrench", "ft", "external", "contact", "limit", "limits", "max",
    "min", "quat", "pose", "friction", "gravity", "bias", "coriolis", "inertia", "mass",
];

/// Words beside a quantity that mean whose it is and name no joint.
const OF_DRIVES: [&str; 8] = ["servo", "motor", "drive", "axis", "actuator", "joint", "joints", "dof"];

/// A word of a name and where it stands.
struct Piece {
    start: usize,
    end: usize,
    word: String,
}

/// The meaning of a name that holds one quantity among other words, if that was measured at a joint.
pub(crate) fn scattered(column: &str) -> Option<Meaning> {
    let translated = super::translated::translated(column);
    let (name, unit) = without_unit(translated.as_deref().unwrap_or(column));
    let pieces = pieces(name);
    let words: Vec<String> = pieces.iter().map(|piece| piece.word.clone()).collect();
    if words.iter().any(|word| !vocabulary::is_of_joint(word) || OF_OTHER_THINGS.contains(&word.as_str())) {
        return None;
    }
    let (mut from, mut to, (quantity, current)) = span(&words)?;
    // Words beside the quantity that say the same of every joint.
    let says_nothing = |word: &String| {
        vocabulary::is_measured(word) || [&OF_DRIVES[..], &SENSORS].iter().any(|own| own.contains(&word.as_str()))
    };
    // Before a number alone they are the joint, `servo_1_position`.
    while to < words.len() && says_nothing(&words[to]) && !words.get(to + 1).is_some_and(|word| is_number(word)) {
        to += 1;
    }
    while from > 0 && says_nothing(&words[from - 1]) {
        from -= 1;
    }
    let separators = |letter: char| !letter.is_alphanumeric();
    let before = pieces[..from].last().map_or("", |piece| &name[..piece.end]).trim_matches(separators);
    let behind = pieces.get(to).map_or("", |piece| &name[piece.start..]).trim_matches(separators);
    let quantity = of_present(quantity, current, unit);
    let current = current && quantity == TORQUE;
    let unit = unit.and_then(|unit| Unit::of(unit, quantity));
    let current = current || unit.is_some_and(Unit::is_current);
    let quantity_words = words[from..to].join("_");
    let joint = match (before, behind) {
        ("", "") => return None,
        ("", number) | (number, "") if is_number(number) => Joint::Number(number.parse().ok()?),
        ("", joint) | (joint, "") => Joint::Name(joint.to_owned()),
        (before, behind) => Joint::Name(format!("{before}/{behind}")),
    };
    let family = format!("{quantity_words} scattered, {}", if before.is_empty() { "before" } else { "behind" });
    Some(Meaning { rank: RANK, unit, current, ..Meaning::new(quantity, joint, family) })
}

fn is_number(word: &str) -> bool {
    !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_digit())
}

/// Where the one quantity of a name stands among its words: the first, and behind the last.
fn span(words: &[String]) -> Option<(usize, usize, (usize, bool))> {
    let mut found: Vec<(usize, usize, (usize, bool))> = Vec::new();
    let mut from = 0;
    while from < words.len() {
        let of_sensor = |joined: &str| SENSORS.contains(&joined).then_some((POSITION, false));
        let of = |to: usize| {
            let joined = words[from..to].join("_");
            Some((from, to, vocabulary::lookup(&joined).or_else(|| of_sensor(&joined))?))
        };
        let longest = (from + 1..=words.len()).rev().find_map(of);
        from = longest.map_or(from + 1, |(_, to, _)| to);
        found.extend(longest);
    }
    let is_weak = |word: &str| WEAK.contains(&word) || SENSORS.contains(&word);
    let is_strong = |own: &&(usize, usize, (usize, bool))| !is_weak(&words[own.0..own.1].join("_"));
    let strong: Vec<_> = found.iter().filter(is_strong).copied().collect();
    let likely = if strong.is_empty() { found } else { strong };
    // Of a name with two quantities it is not known which is meant.
    match likely[..] {
        [one] => Some(one),
        _ => None,
    }
}

/// The words of a name with their places; a number ends a word, as in `joint1pos`.
fn pieces(name: &str) -> Vec<Piece> {
    let mut out: Vec<Piece> = Vec::new();
    let mut before = None;
    for (place, letter) in name.char_indices() {
        let is_word = letter.is_alphanumeric();
        let begins = match before {
            Some(before) if is_word => starts_word(before, letter),
            _ => true,
        };
        if is_word {
            if begins {
                out.push(Piece { start: place, end: place, word: String::new() });
            }
            if let Some(piece) = out.last_mut() {
                piece.word.extend(letter.to_lowercase());
                piece.end = place + letter.len_utf8();
            }
        }
        before = is_word.then_some(letter);
    }
    out
}

/// Whether a letter begins a word behind another: `jointPosition`, `J1Position`, `joint1pos`.
fn starts_word(before: char, letter: char) -> bool {
    (before.is_lowercase() && letter.is_uppercase()) || (before.is_ascii_digit() && letter.is_alphabetic())
}

#[cfg(test)]
mod tests {
    use super::super::quantity::VELOCITY;
    use super::*;

    #[test]
    fn one_quantity_somewhere_in_the_name() {
        for (column, quantity, joint) in [
            ("position/robot0/left_arm/joint_1", POSITION, "robot0/left_arm/joint_1"),
            ("effort_robot0/left_arm/joint_1", TORQUE, "robot0/left_arm/joint_1"),
            ("joint1_position_actual", POSITION, "joint1"),
            ("J1ActualVelocity", VELOCITY, "J1"),
            ("joint1pos", POSITION, "joint1"),
            ("left_position_joint_1", POSITION, "left/joint_1"),
            ("par_motor_eje_1", TORQUE, "eje_1"),
            ("関節1トルク", TORQUE, "joint_1"),
            ("motor_1_torque", TORQUE, "motor_1"),
        ] {
            let meaning = scattered(column).unwrap_or_else(|| panic!("{column}"));
            assert_eq!((meaning.quantity, meaning.joint), (quantity, Joint::Name(joint.to_owned())), "{column}");
        }
        for (column, quantity, number) in [
            ("servo_angle_1", POSITION, 1),
            ("motor_pos_2", POSITION, 2),
            ("enc_3", POSITION, 3),
            ("encoder_speed_3", VELOCITY, 3),
        ] {
            let meaning = scattered(column).unwrap_or_else(|| panic!("{column}"));
            assert_eq!((meaning.quantity, meaning.joint), (quantity, Joint::Number(number)), "{column}");
        }
        // Of Denso: the present position, and no current.
        for (column, unit, quantity) in [("CurJ1[deg]", "deg", POSITION), ("CurJ1[deg/s]", "deg/s", VELOCITY)] {
            let present = scattered(column).unwrap();
            assert_eq!((present.quantity, present.unit.unwrap().symbol, present.current), (quantity, unit, false));
        }
        assert!(scattered("CurJ1[A]").unwrap().current && scattered("CmdJ1[deg]").is_none());
        let in_degrees = scattered("关节1角度(度)").unwrap();
        assert_eq!((in_degrees.quantity, in_degrees.unit.unwrap().symbol), (POSITION, "deg"));
        assert!(scattered("servo_current_3").unwrap().current && !scattered("present_load_3").unwrap().current);
    }

    #[test]
    fn what_is_not_measured_at_a_joint_has_no_meaning() {
        for column in [
            "joint1_position_target",
            "joint1_torque_limit",
            "robot0_eef_pos_1",
            "tcp_speed_1",
            "joint1_position_error",
            "tau_ext_hat_filtered_1",
            "object_pose_2",
            "position_torque_1",
            "position",
            "status_1",
            "qfrc_bias_1",
        ] {
            assert_eq!(scattered(column), None, "{column}");
        }
    }
}
