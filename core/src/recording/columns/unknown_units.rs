//! Units in the names of columns that are not known: the columns are taken as they are, which must be said.

use super::names::{self, QUANTITIES, Unit};
use std::collections::BTreeMap;

/// One line for each unit of a quantity that is not known; `columns` are those of the quantities in use, and `units` those that are known.
pub(super) fn notes(
    header: &[String],
    joints: &[String],
    columns: [Option<&Vec<usize>>; 4],
    units: &BTreeMap<usize, Unit>,
) -> Vec<String> {
    let mut out = Vec::new();
    for (quantity, columns) in columns.into_iter().enumerate() {
        let unknown = |column: &usize| {
            let name = header.get(*column).filter(|_| !units.contains_key(column))?;
            Some((names::unknown_unit(name, quantity, joints)?, name.as_str()))
        };
        let mut found: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (unit, name) in columns.into_iter().flatten().filter_map(unknown) {
            found.entry(unit).or_default().push(name);
        }
        for (unit, of) in found {
            let and_others = if of.len() > 1 { format!(" and {} others", of.len() - 1) } else { String::new() };
            let quantity_name = QUANTITIES[quantity].name;
            out.push(format!(
                "{unit}, in the name of {}{and_others}, is no known unit: the numbers are taken as they are; write them in one of {}, or set \
                 [units] {quantity_name} in a dataset",
                of[0],
                Unit::symbols(quantity)
            ));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use crate::recording::columns::Layout;
    use std::path::Path;

    #[test]
    fn a_unit_that_is_not_known_is_told_once() {
        let noted = |header: &str| {
            let header: Vec<String> = header.split(',').map(str::to_owned).collect();
            Layout::find(Path::new("log.csv"), Some(1), &header, None).unwrap().notes
        };
        let told = noted("t [s],q1 [grad],q2 [grad],tau1 [Nm],tau2 [Nm]");
        assert!(told.len() == 1 && told[0].starts_with("grad, in the name of q1 [grad] and 1 others"), "{told:?}");
        for header in ["t,q1 [mdeg],tau1 (Nm)", "t,q1 (measured),tau1 [raw]", "t,q1,tau1"] {
            assert!(noted(header).is_empty(), "{header}: {:?}", noted(header));
        }
    }
}
