//! Columns that are called by their joint alone, `J1`, `A1 [deg]` or any joint of the robot: positions, or what their unit says.

use super::names::{self, Joint, Meaning, POSITION, QUANTITIES, TORQUE, Unit};

/// What controllers call a joint, before its number.
const OF_JOINT: [&str; 9] = ["j", "jt", "a", "joint", "axis", "ax", "axis_a", "motor", "servo"];

/// Letters of a force or torque, directly before the name of a joint.
const OF_FORCE: [char; 4] = ['F', 'T', 'M', 'f'];

/// Positions that a log has besides those of its joints, at most: that of a gripper.
const OTHERS: usize = 1;

/// All ways to understand the names of a header, and a note on columns that are taken for positions without saying so. A joint's
/// name alone counts where the joints have no other positions.
pub(super) fn meanings(header: &[String], known: &[String]) -> (Vec<Vec<Meaning>>, Option<String>) {
    let mut all: Vec<Vec<Meaning>> = header.iter().map(|name| names::meanings(name)).collect();
    let measured = |meaning: &&Meaning| !meaning.truth && !meaning.exact_only && meaning.quantity == POSITION;
    let named = all.iter().filter(|readings| readings.first().as_ref().is_some_and(measured)).count();
    let bare: Vec<(usize, Meaning)> = (0..header.len())
        .filter_map(|column| Some((column, of_known(&header[column], known).or_else(|| bare(&header[column]))?)))
        .collect();
    let positions = bare.iter().filter(|(_, meaning)| meaning.quantity == POSITION).count();
    if named > OTHERS || named >= positions {
        return (all, None);
    }
    let without_unit =
        bare.iter().find(|(_, meaning)| meaning.unit.is_none()).map(|(column, _)| header[*column].clone());
    for (column, meaning) in bare {
        all[column].push(meaning);
    }
    let note = without_unit
        .map(|first| format!("{first} and its like say no quantity: they are taken for the joints' positions"));
    (all, note)
}

/// The meaning of the name of one of the robot's joints alone, with a unit in brackets behind it, or with the letter of a force before it.
fn of_known(column: &str, known: &[String]) -> Option<Meaning> {
    let joint = |name: &str| known.iter().find(|own| *own == name).cloned().map(Joint::Name);
    if let Some(joint) = joint(column) {
        return Some(Meaning::new(POSITION, joint, "bare known".to_owned()));
    }
    if let Some(symbol) = names::unit_of(column)
        && let Some(joint) = joint(names::without_unit_of(column))
    {
        let (quantity, unit) = in_unit(symbol)?;
        let current = unit.is_current();
        return Some(Meaning {
            unit: Some(unit),
            current,
            ..Meaning::new(quantity, joint, format!("bare known {quantity}"))
        });
    }
    let joint = joint(column.strip_prefix(OF_FORCE)?.trim_start_matches('_'))?;
    Some(Meaning::new(TORQUE, joint, "force of known".to_owned()))
}

/// The quantity that is in a unit.
fn in_unit(symbol: &str) -> Option<(usize, Unit)> {
    (0..QUANTITIES.len()).find_map(|quantity| Some((quantity, Unit::of(symbol, quantity)?)))
}

/// The meaning of a joint's name alone, or with a unit behind it.
fn bare(column: &str) -> Option<Meaning> {
    let start = column.find(|letter: char| letter.is_ascii_digit())?;
    let digits = column[start..].bytes().take_while(u8::is_ascii_digit).count();
    let (stem, rest) = (&column[..start], &column[start + digits..]);
    let word = stem.trim_end_matches(['_', ' ', '.', '[']).to_lowercase();
    let unit = rest.trim_matches([' ', '[', ']', '(', ')', '_', '.']);
    // With a unit, the joint may stand behind others' words: `EGM_FB_J1 [deg]`.
    let last = word.rsplit(['_', ' ', '.', '/']).next().unwrap_or_default();
    let is_joint = OF_JOINT.contains(&word.as_str()) || (!unit.is_empty() && OF_JOINT.contains(&last));
    if !is_joint || !names::is_measured_at_joint(stem) {
        return None;
    }
    let (quantity, unit) = match unit {
        "" => (POSITION, None),
        // `rad_s` is `rad/s`.
        text => in_unit(&text.replace('_', "/")).or_else(|| in_unit(text)).map(|(own, unit)| (own, Some(unit)))?,
    };
    // `Axis_A1` is A1 elsewhere.
    let name = &column[..start + digits];
    let last =
        name.rsplit(['_', ' ', '.']).next().filter(|last| last.starts_with(|letter: char| letter.is_alphabetic()));
    let joint = Joint::Name(last.unwrap_or(name).to_owned());
    let current = unit.is_some_and(Unit::is_current);
    Some(Meaning { unit, current, ..Meaning::new(quantity, joint, format!("bare {quantity} {word}")) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(header: &[&str]) -> Vec<Option<(usize, Option<&'static str>)>> {
        let header: Vec<String> = header.iter().map(|name| (*name).to_owned()).collect();
        let first = |readings: &Vec<Meaning>| {
            readings.first().map(|meaning| (meaning.quantity, meaning.unit.map(|unit| unit.symbol)))
        };
        meanings(&header, &[]).0.iter().map(first).collect()
    }

    #[test]
    fn a_joint_alone_is_its_position_where_nothing_else_is() {
        assert_eq!(of(&["t", "J1", "torque_J1"]), [None, Some((0, None)), Some((3, None))]);
        assert_eq!(of(&["JT1 [deg]", "JT1 current [A]"]), [Some((0, Some("deg"))), Some((3, Some("A")))]);
        assert_eq!(of(&["t", "A1 [deg]", "tau1"]), [None, Some((0, Some("deg"))), Some((3, None))]);
        assert_eq!(of(&["t", "J1", "q1", "tau1"])[1], None);
        assert_eq!(of(&["t", "X1", "tau1", "J1 [%]"]), [None, None, Some((3, None)), None]);
    }

    #[test]
    fn a_joint_of_the_robot_with_a_unit_is_what_the_unit_says() {
        let [header, known] = [&["t", "E1 [mm]", "A1 [deg]", "lift (N)", "x [deg]"][..], &["E1", "A1", "lift"]]
            .map(|names| names.iter().map(|name| (*name).to_owned()).collect::<Vec<String>>());
        let (all, _) = meanings(&header, &known);
        let of = |column: usize| {
            let meaning = all[column].first()?;
            Some((meaning.joint.clone(), meaning.quantity, meaning.unit?.symbol))
        };
        let joint = |name: &str| Joint::Name(name.to_owned());
        // A track beside an arm is of the same family, whatever its unit.
        assert_eq!([of(1), of(2)], [Some((joint("E1"), 0, "mm")), Some((joint("A1"), 0, "deg"))]);
        assert_eq!(all[1][0].family, all[2][0].family);
        assert_eq!([of(3), of(4)], [Some((joint("lift"), 3, "N")), None]);
    }

    #[test]
    fn a_unit_says_the_quantity() {
        let of = of(&["J1_rad", "J1_rad_s", "J1_Nm", "j1 [deg/s]"]);
        assert_eq!(of, [(0, "rad"), (1, "rad/s"), (3, "N m"), (1, "deg/s")].map(|(k, unit)| Some((k, Some(unit)))));
        // Then other words may stand before the joint, unless they say that it was not measured.
        let of = self::of(&["EGM_FB_J1 [deg]", "EGM_REF_J1 [deg]", "EGM_FB_J1"]);
        assert_eq!(of, [Some((0, Some("deg"))), None, None]);
    }
}
