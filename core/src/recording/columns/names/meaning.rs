//! Which quantity of which joint a column holds, from its name.

use super::quantity::{QUANTITIES, Quantity, TORQUE, TRUE};
use super::translated::translated;
use super::unit::{Unit, bare, is_unit};
use super::vocabulary::{
    MEASURED, OF_CONTROLLER, OF_GROUPS, OF_JOINT, OF_OTHERS, OF_PRESENT, PERCENT, PRESENT, UNIT_WORDS, WANTED,
    WANTED_NUMBERED, lookup,
};
use super::words::{SEPARATORS, without_tuple, without_unit, words};

/// Whose signal a column holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Joint {
    /// The joint's number as it stands in the name.
    Number(usize),
    /// The joint's name.
    Name(String),
}

/// One way to understand a column's name.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Meaning {
    /// Whether it belongs to the truth behind a simulated log.
    pub truth: bool,
    /// Index of the quantity.
    pub quantity: usize,
    /// The joint.
    pub joint: Joint,
    /// Columns of one family are called alike but for the joint.
    pub family: String,
    /// 0 for the names that this program writes, more for others.
    pub rank: u8,
    /// A motor current in place of a torque.
    pub current: bool,
    /// A torque that a controller wanted or computed, in the place of a measured one.
    pub of_controller: bool,
    /// The unit that the name gives.
    pub unit: Option<Unit>,
    /// Counts only for a joint of exactly this name: else it would be a value that was wanted, or none of a joint.
    pub exact_only: bool,
}

impl Meaning {
    /// A measured quantity of a joint, in a unit that is not known.
    pub(in crate::recording::columns) fn new(quantity: usize, joint: Joint, family: String) -> Meaning {
        Meaning {
            truth: false,
            quantity,
            joint,
            family,
            rank: 0,
            current: false,
            of_controller: false,
            unit: None,
            exact_only: false,
        }
    }
}

/// All ways to understand a column's name, the most likely first.
pub(crate) fn meanings(column: &str) -> Vec<Meaning> {
    let mut out = as_written(column);
    // A joint may be called in that language: its own words come first.
    out.extend(translated(column).into_iter().flat_map(|english| as_written(&english)));
    out
}

/// The same without other languages.
fn as_written(column: &str) -> Vec<Meaning> {
    let column = &without_tuple(column);
    let (column, unit) = without_unit(column);
    let mut out = Vec::new();
    // The unit may stand before the number of the joint.
    if let Some((stem, number)) = index(column)
        && let Some((stem, unit)) = without_unit_word(stem)
    {
        out = in_unit(readings(&format!("{stem}_{number}")), Some(unit));
        out.retain(|meaning| matches!(meaning.joint, Joint::Number(_)));
    }
    out.extend(in_unit(readings(column), unit));
    // A joint may be called like a unit: that comes first.
    if let Some((stem, unit)) = without_unit_word(column) {
        out.extend(in_unit(readings(stem), Some(unit)));
    } else if let Some((stem, letter)) = column.rsplit_once(['_', ' ']).filter(|(_, unit)| unit.len() == 1) {
        // A letter is a unit where it is one of the quantity before it, `current_A`.
        let mut of_letter = in_unit(readings(stem), Some(letter));
        of_letter.retain(|meaning| meaning.unit.is_some_and(|unit| unit.symbol == letter));
        out.extend(of_letter);
    }
    out
}

/// A column that is called for a quantity alone, as `position [deg]`, with the joint that it is of.
pub(crate) fn with_joint(column: &str, joint: &str) -> Option<String> {
    let (stem, unit) = match without_unit(column) {
        (stem, Some(unit)) => (stem, Some(unit)),
        (stem, None) => without_unit_word(stem).map_or((stem, None), |(stem, unit)| (stem, Some(unit))),
    };
    let name = format!("{}_{joint}", prefix_of(stem)?);
    Some(unit.map_or(name.clone(), |unit| format!("{name} [{unit}]")))
}

/// The prefix of columns of the quantity that a name means by itself, as that of a file: `tau` for `joint_torques`.
pub(crate) fn prefix_of(name: &str) -> Option<&'static str> {
    let (quantity, current) = quantity(&words(name))?;
    Some(if current { "current" } else { QUANTITIES[quantity].prefixes[0] })
}

/// What stands in brackets behind a name and is no unit of the quantity that is known, or a word for percent; `joints` may stand there too.
pub(crate) fn unknown_unit<'a>(column: &'a str, quantity: usize, joints: &[String]) -> Option<&'a str> {
    let unit = without_unit(column).1.or_else(|| percent(column));
    let is_word = |word: &String| MEASURED.contains(&word.as_str()) || OF_CONTROLLER.contains(&word.as_str());
    unit.filter(|unit| {
        let is_joint = joints.iter().any(|joint| joint == unit);
        !is_joint && Unit::of(unit, quantity).is_none() && !words(unit).iter().all(is_word)
    })
}

/// Whether a word behind a name is a unit. Joints are called by one or two letters, too.
fn is_unit_word(word: &str) -> bool {
    let long = bare(word).chars().count() > 2 && is_unit(word);
    UNIT_WORDS.contains(&bare(word).as_str()) || (word.contains('/') && is_unit(word)) || long
}

/// A name without the unit behind it, of which a point may be a part, and the unit.
fn without_unit_word(name: &str) -> Option<(&str, &str)> {
    let is_cut = |(stem, unit): &(&str, &str)| !stem.is_empty() && is_unit_word(unit);
    let cut = |at: &[char]| name.rsplit_once(at).filter(is_cut);
    // `N_m` is one unit.
    let of_two = || {
        let (place, _) = name.rmatch_indices(['_', ' ']).nth(1)?;
        Some((&name[..place], &name[place + 1..])).filter(is_cut)
    };
    of_two().or_else(|| cut(&['_', ' ', '.'])).or_else(|| cut(&['_', ' ']))
}

/// The word in a name that means percent.
fn percent(name: &str) -> Option<&str> {
    name.split(SEPARATORS).find(|part| PERCENT.contains(&part.to_lowercase().as_str()))
}

/// Readings of a name with the unit that stands behind it.
fn in_unit(mut readings: Vec<Meaning>, unit: Option<&str>) -> Vec<Meaning> {
    for meaning in &mut readings {
        meaning.quantity = of_present(meaning.quantity, meaning.current, unit);
        meaning.current &= meaning.quantity == TORQUE;
        meaning.unit = unit.and_then(|unit| Unit::of(unit, meaning.quantity)).or(meaning.unit);
        meaning.current |= meaning.unit.is_some_and(Unit::is_current);
    }
    readings
}

/// The quantity of a name with a unit. `cur` and `current` mean the present value where the unit is that of another quantity, `CurJ1[deg]`.
pub(super) fn of_present(quantity: usize, current: bool, unit: Option<&str>) -> usize {
    unit.filter(|_| current).and_then(Unit::quantity).unwrap_or(quantity)
}

/// The ways to understand a name without a unit.
fn readings(column: &str) -> Vec<Meaning> {
    let (truth, name) = column.strip_suffix(TRUE).map_or((false, column), |name| (true, name));
    let own = words(name);
    let is_wanted = |word: &str| OF_CONTROLLER.contains(&word) || OF_OTHERS.contains(&word);
    let wanted = own.iter().any(|word| is_wanted(word))
        || (index(name).is_some() && own.iter().any(|word| WANTED_NUMBERED.contains(&word.as_str())));
    let mut out = Vec::new();
    if !wanted {
        out.extend(numbered(name).or_else(|| of_device(name)));
    }
    out.extend(
        plain(name)
            .map(|(quantity, joint, family)| Meaning { exact_only: wanted, ..Meaning::new(quantity, joint, family) }),
    );
    if wanted {
        out.extend(of_controller(name));
    } else {
        out.extend(named(name));
        out.extend(around_quantity(name));
    }
    out.iter_mut().for_each(|meaning| meaning.truth = truth);
    out
}

/// `actuator_force_elbow`, `X_force`: several words of a quantity, or one that means others too, around a name. It counts where that is a
/// joint's.
fn around_quantity(name: &str) -> Vec<Meaning> {
    let force = |words: &[String]| match words {
        [force] if force == "force" || force == "forces" => Some((TORQUE, false)),
        _ => None,
    };
    let of = |around: &str| {
        let words = words(around);
        quantity(&words).or_else(|| force(&words))
    };
    let reading = |found: Option<(usize, bool)>, joint: &str, family: String| {
        let (quantity, current) = found.filter(|_| !joint.is_empty())?;
        let joint = Joint::Name(joint.to_owned());
        Some(Meaning { rank: 3, current, exact_only: true, ..Meaning::new(quantity, joint, family) })
    };
    let cuts = name.char_indices().filter(|(_, letter)| ['_', ' '].contains(letter)).map(|(place, _)| place);
    let both = cuts.flat_map(|place| {
        let (before, behind) = (&name[..place], &name[place + 1..]);
        [reading(of(before), behind, format!("{before}_#")), reading(of(behind), before, format!("#_{behind}"))]
    });
    both.flatten().collect()
}

/// `target_moment_0`, `tau_J_d_0`, `elbow_effort_cmd`: torques that a controller wanted or computed.
fn of_controller(name: &str) -> Vec<Meaning> {
    let parts = || name.split(['_', ' ']);
    let of_joint = |word: &&str| {
        let word = word.to_lowercase();
        word != WANTED && !OF_CONTROLLER.contains(&word.as_str())
    };
    let measured: Vec<&str> = parts().filter(of_joint).collect();
    if measured.len() == parts().count() {
        return Vec::new();
    }
    let mut readings = readings(&measured.join("_"));
    readings.retain(|meaning| meaning.quantity == TORQUE && !meaning.exact_only);
    for meaning in &mut readings {
        meaning.of_controller = true;
        meaning.family = format!("{} of the controller", meaning.family);
    }
    readings
}

/// The names that this program writes and documents, each with its family.
fn plain(name: &str) -> Option<(usize, Joint, String)> {
    (0..QUANTITIES.len()).find_map(|quantity| {
        let Quantity { prefixes, suffixes, .. } = QUANTITIES[quantity];
        let behind = prefixes.iter().find_map(|prefix| {
            // Exports like to shout: Q1, TAU1.
            let rest = name
                .get(..prefix.len())
                .filter(|own| own.eq_ignore_ascii_case(prefix))
                .map(|_| &name[prefix.len()..])?;
            let bare = rest.strip_prefix('_').unwrap_or(rest);
            if !bare.is_empty() && bare.bytes().all(|byte| byte.is_ascii_digit()) {
                return bare.parse().ok().map(Joint::Number);
            }
            (bare.len() < rest.len() && !bare.is_empty()).then(|| Joint::Name(bare.to_owned()))
        });
        let before = suffixes.iter().find_map(|suffix| Some((name.strip_suffix(suffix)?, suffix)));
        let before = before.filter(|(joint, _)| !joint.is_empty());
        let before = before.map(|(joint, suffix)| (quantity, Joint::Name(joint.to_owned()), format!("#{suffix}")));
        behind.map(|joint| (quantity, joint, String::new())).or(before)
    })
}

/// `actual_q_0`, `state.q[0]`, `position[0]`, `/left/joint_states/position/0`: a quantity and behind it a number.
fn numbered(name: &str) -> Option<Meaning> {
    let (stem, number) = index(name)?;
    let segments: Vec<&str> = segments(stem);
    let (last, groups) = segments.split_last()?;
    // What stands before the field of a message is its topic, in whatever namespace.
    if !name.starts_with('/') && !groups.iter().all(|group| is_group(group)) {
        return None;
    }
    let (quantity, current) = quantity(&words(last))?;
    let written = groups.is_empty() && QUANTITIES[quantity].prefixes.iter().any(|p| last.eq_ignore_ascii_case(p));
    // The names written have one family, in which velocity may be `qd` or `dq`.
    let family = if written { String::new() } else { stem.to_owned() };
    let rank = if written { 0 } else { 1 };
    Some(Meaning { rank, current, ..Meaning::new(quantity, Joint::Number(number), family) })
}

/// `axisTauMsr_LBR_iiwa_7_R800_1[0]`: a quantity of several words in one, and the name of the device before the number in brackets.
fn of_device(name: &str) -> Option<Meaning> {
    let (stem, number) = index(name).filter(|_| name.ends_with(']'))?;
    let (first, _) = stem.split_once('_')?;
    let words = words(first);
    let (quantity, current) = quantity(&words).filter(|_| words.len() > 1)?;
    Some(Meaning { rank: 3, current, ..Meaning::new(quantity, Joint::Number(number), stem.to_owned()) })
}

/// `/joint_states/position/elbow`, `position_elbow`, `elbow.pos`, `/joint_states/elbow/position`, `elbow current`.
fn named(name: &str) -> Option<Meaning> {
    let meaning = |(quantity, current): (usize, bool), joint: &str, family: String, rank| {
        let joint = joint.trim_matches(SEPARATORS);
        (!joint.is_empty()).then(|| Meaning {
            rank,
            current,
            ..Meaning::new(quantity, Joint::Name(joint.to_owned()), family)
        })
    };
    // A quantity between groups and joint, or behind the joint, as a part of a path of its own.
    let all = segments(name);
    let first = all.iter().position(|part| !is_group(part)).unwrap_or(all.len());
    let parts = &all[first..];
    if parts.len() == 2 {
        if let Some(found) = quantity(&words(parts[0])) {
            return meaning(found, parts[1], format!("{}/#", parts[0]), 1);
        }
        if let Some(found) = quantity(&words(parts[1])) {
            return meaning(found, parts[0], format!("#/{}", parts[1]), 1);
        }
    }
    let is_measured = |part: &str| words(part).iter().all(|word| MEASURED.contains(&word.as_str()));
    // The arm or the namespace of a joint stands before it, and behind it may stand that it was measured.
    if let [joint @ .., last] = parts
        && joint.len() > 1
        && let Some(found) = quantity(&words(last))
    {
        let behind = joint[1..].iter().rev().take_while(|part| is_measured(part)).count();
        let (joint, others) = parts.split_at(joint.len() - behind);
        return meaning(found, &joint.join("/"), format!("#/{}", others.join("/")), 1);
    }
    // A topic of whatever name stands before the quantity as the arm does before the joint.
    if let [topic @ .., field, joint] = parts
        && !topic.is_empty()
        && !is_measured(joint)
        && !is_group(joint)
        && let Some(found) = quantity(&words(field))
    {
        let topic = topic.join("/");
        return meaning(found, &format!("{topic}/{joint}"), format!("{topic}/{field}/#"), 2);
    }
    let [part] = parts else { return None };
    // Several words before a joint of a letter and a number: `TORQUE_AXIS_ACT_A1`.
    if let Some((before, joint)) = part.rsplit_once(['_', ' ']).filter(|(_, joint)| is_numbered(joint))
        && let Some(found) = quantity(&words(before))
    {
        return meaning(found, joint, format!("{before}_#"), 1);
    }
    // One word before or behind the joint's name.
    let (before, behind) = part.split_once(['_', ' '])?;
    if let Some(found) = quantity(&words(before)).filter(|_| before.len() > 1) {
        return meaning(found, behind, format!("{before}_#"), 1);
    }
    let (before, behind) = part.rsplit_once(['_', ' '])?;
    let found = quantity(&words(behind))?;
    let is_present = |word: &str| PRESENT.iter().any(|own| word.eq_ignore_ascii_case(own));
    let joint = before.rsplit_once(['_', ' ']).filter(|(joint, word)| !joint.is_empty() && is_present(word));
    let joint = joint.filter(|_| !found.1).map_or(before, |(joint, _)| joint);
    meaning(found, joint, format!("#_{behind}"), 2)
}

/// Whether a word is a letter and a number, as controllers call axes.
fn is_numbered(word: &str) -> bool {
    let number = word.trim_start_matches(|letter: char| letter.is_ascii_alphabetic());
    number.len() + 1 == word.len() && !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())
}

/// Parts of a path.
fn segments(name: &str) -> Vec<&str> {
    name.split(['/', '.']).map(str::trim).filter(|part| !part.is_empty()).collect()
}

fn is_group(part: &str) -> bool {
    words(part).iter().all(|word| OF_GROUPS.contains(&word.as_str()))
}

/// The quantity that words stand for, and whether it is a current; words that mean only that it was measured may stand around.
fn quantity(words: &[String]) -> Option<(usize, bool)> {
    let of_value = |word: &&String| MEASURED.contains(&word.as_str());
    let before = |word: &&String| of_value(word) || OF_JOINT.contains(&word.as_str());
    // Behind the quantity, `joint` begins the name of one: `effort_joint_1`.
    let front = words.iter().take_while(before).count();
    let back = words.iter().rev().take_while(of_value).count();
    // The most words that have a meaning together: `axis_act` is one, and `meas` of `axis_act_meas` is none of it.
    let parts = (0..=front).flat_map(|from| (0..=back).map(move |behind| (from, behind)));
    let mut parts: Vec<(usize, usize)> = parts.filter(|(from, behind)| from + behind < words.len()).collect();
    parts.sort_by_key(|(from, behind)| from + behind);
    // `current_torque` is the present one.
    if let [current, word] = words
        && current == "current"
        && OF_PRESENT.contains(&word.as_str())
    {
        return lookup(word);
    }
    parts.into_iter().find_map(|(from, behind)| lookup(&words[from..words.len() - behind].join("_")))
}

/// The number at the end of a name, as in `q0`, `q_0`, `q[0]`, `q.0`, with what stands before it.
fn index(name: &str) -> Option<(&str, usize)> {
    let bare = name.strip_suffix([']', ')']).unwrap_or(name);
    let stem = bare.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let number = bare[stem.len()..].parse().ok()?;
    let stem = stem.trim_end_matches(['[', '(', '_', '.', '/', ' ', '-']);
    (!stem.is_empty()).then_some((stem, number))
}
