//! Units in the names of columns that are not known: the columns are taken as they are, which must be said.

use crate::recording::columns::names::{self, QUANTITIES, TORQUE, Unit};
use std::collections::BTreeMap;

/// One line for each unit of a quantity that is not known; `columns` are those of the quantities in use, and `units` those that are known.
pub(in crate::recording::columns) fn notes(
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
            // That of torques is told with what makes torques of them.
            if quantity == TORQUE && is_percent(unit) {
                continue;
            }
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

/// What makes torques of the columns in percent of a rated torque.
pub(in crate::recording::columns) fn percent(header: &[String], joints: &[String], tau: &[usize]) -> Option<String> {
    let column = |column: &usize| {
        let name = header.get(*column)?;
        names::unknown_unit(name, TORQUE, joints).filter(|unit| is_percent(unit)).map(|_| name)
    };
    let first = tau.iter().find_map(column)?;
    Some(format!(
        "{first} and its like are percent of a rated torque by their names: the numbers are taken as they are; a dataset with [units] torque = \
         \"A\" and [motors] torque_constant_nm_a = one hundredth of the rated torque of every joint, N m, makes torques of them"
    ))
}

fn is_percent(unit: &str) -> bool {
    let unit = unit.to_lowercase();
    ["%", "pct", "percent"].iter().any(|own| unit.starts_with(own))
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
        let told = noted("t [s],q1 [gon],q2 [gon],tau1 [Nm],tau2 [Nm]");
        assert!(told.len() == 1 && told[0].starts_with("gon, in the name of q1 [gon] and 1 others"), "{told:?}");
        for header in ["t,q1 [mdeg],tau1 (Nm)", "t,q1 (measured),tau1 [raw]", "t,q1,tau1"] {
            assert!(noted(header).is_empty(), "{header}: {:?}", noted(header));
        }
    }

    #[test]
    fn percent_of_a_rated_torque_is_told_however_it_is_written() {
        let noted = |torque: &str| {
            let header: Vec<String> = ["t", "q1", torque].map(str::to_owned).to_vec();
            let Layout { notes, understood, .. } = Layout::find(Path::new("log.csv"), Some(1), &header, None).unwrap();
            [notes, understood].concat()
        };
        for torque in ["torque_pct_1", "torque_percent_1", "tau1_pct", "tau1_percent", "tau1 [%]", "tau1 (%)"] {
            let told = noted(torque);
            assert!(told.len() == 1 && told[0].contains("percent of a rated torque"), "{torque}: {told:?}");
        }
        assert!(noted("torque_1").is_empty() && noted("tau1_Nm").is_empty());
    }
}
