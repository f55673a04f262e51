//! Arrays whose entries have no names, as the observations of a simulator: how a dataset splits them.

use super::names;

/// Words of arrays that hold the state of an arm; the entries of others are taken where there is none.
const OF_STATES: [&str; 7] = ["obs", "observation", "observations", "state", "states", "proprio", "agent"];

/// Words of arrays that may hold torques.
const OF_TORQUES: [&str; 6] = ["action", "actions", "ctrl", "control", "controls", "act"];

/// An array: the names of its entries.
struct Array<'a> {
    stem: &'a str,
    entries: Vec<&'a str>,
}

/// What splits the arrays of a header for so many joints: an array that holds the column `of`, or one of a state that is long enough.
pub(super) fn cure(header: &[String], dof: usize, of: Option<&str>) -> Option<String> {
    let arrays = arrays(header);
    let long = |array: &&Array| array.entries.len() >= dof.max(1);
    let has = |array: &&Array, words: &[&str]| {
        array
            .stem
            .split(|letter: char| !letter.is_alphanumeric())
            .any(|word| words.contains(&word.to_lowercase().as_str()))
    };
    let state = match of {
        Some(column) => arrays.iter().find(|array| array.entries.contains(&column)),
        None => arrays.iter().filter(long).find(|array| has(array, &OF_STATES)),
    }
    .filter(long)?;
    let part = |array: &Array, place: usize| {
        let own = array.entries.get(place * dof..(place + 1) * dof)?;
        Some(format!("[{}]", own.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")))
    };
    let mut fields = vec![format!("q = {}", part(state, 0)?)];
    let velocities = part(state, 1);
    let behind = if velocities.is_some() { ", then velocities" } else { "" };
    fields.extend(velocities.map(|own| format!("qd = {own}")));
    let is_torque =
        |name: &String| names::meanings(name).iter().any(|own| own.quantity == names::TORQUE && !own.exact_only);
    let mut torques = String::new();
    if !header.iter().any(is_torque) {
        let others = arrays.iter().filter(long).find(|array| has(array, &OF_TORQUES));
        let (text, own) = match (part(state, 2), others) {
            (Some(own), _) => (", then torques".to_owned(), own),
            (None, Some(other)) => (format!(", and {} torques", other.stem), part(other, 0)?),
            (None, None) => return None,
        };
        torques = text;
        fields.push(format!("tau = {own}"));
    }
    let (first, last) = (state.entries.first()?, state.entries.last()?);
    Some(format!(
        "{first} to {last} are an array without names: say in a dataset which entry is what. If it holds positions{behind}{torques}, that is the \
         line: columns = {{ {} }}",
        fields.join(", ")
    ))
}

/// The arrays of a header: names that differ in the number at their end, which goes up by one.
fn arrays(header: &[String]) -> Vec<Array<'_>> {
    let mut out: Vec<(Array, usize)> = Vec::new();
    for name in header {
        let bare = name.strip_suffix(']').unwrap_or(name);
        let stem = bare.trim_end_matches(|letter: char| letter.is_ascii_digit());
        let Ok(number) = bare[stem.len()..].parse::<usize>() else { continue };
        let stem = stem.trim_end_matches(['[', '_', '.']);
        match out.iter_mut().find(|(array, next)| array.stem == stem && *next == number) {
            Some((array, next)) => {
                array.entries.push(name);
                *next += 1;
            }
            None if number <= 1 => out.push((Array { stem, entries: vec![name] }, number + 1)),
            None => {}
        }
    }
    out.into_iter().map(|(array, _)| array).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(arrays: &[(&str, usize)]) -> Vec<String> {
        arrays.iter().flat_map(|(name, count)| (0..*count).map(move |k| name.replace('#', &k.to_string()))).collect()
    }

    #[test]
    fn the_entries_of_an_array_are_split_by_the_number_of_joints() {
        let said = cure(&header(&[("obs[#]", 4), ("actions[#]", 2), ("t", 1)]), 2, None).unwrap();
        let line = "columns = { q = [\"obs[0]\", \"obs[1]\"], qd = [\"obs[2]\", \"obs[3]\"], tau = [\"actions[0]\", \"actions[1]\"] }";
        assert!(said.ends_with(line) && said.contains("positions, then velocities, and actions torques"), "{said}");
        // Torques behind velocities; torques by their names; too few entries, and no torque at all.
        let all = cure(&header(&[("obs_#", 6)]), 2, None).unwrap();
        assert!(all.ends_with("tau = [\"obs_4\", \"obs_5\"] }"), "{all}");
        let known = cure(&header(&[("observation.state[#]", 5), ("effort[#]", 2)]), 2, Some("observation.state[2]"));
        assert!(known.unwrap().ends_with("\"observation.state[3]\"] }"));
        assert!(cure(&header(&[("obs_#", 1)]), 2, None).is_none() && cure(&header(&[("obs_#", 4)]), 2, None).is_none());
        assert!(cure(&header(&[("temp_#", 6)]), 2, None).is_none());
    }
}
