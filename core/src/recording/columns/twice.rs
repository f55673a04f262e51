//! Columns that are called alike, of which the first is used.

use super::layout::{ABSENT, Layout};

impl Layout {
    /// Columns in use, each with another of the same name.
    pub(crate) fn twice(&self) -> &[[usize; 2]] {
        &self.twice
    }

    /// How a dataset takes the second of two columns in the place of the first, by the numbers of the columns.
    pub(crate) fn other_choice(&self, [first, second]: [usize; 2]) -> Option<String> {
        let tables =
            [("q", Some(&self.q)), ("qd", self.qd.as_ref()), ("qdd", self.qdd.as_ref()), ("tau", Some(&self.tau))];
        let of = |(name, columns): (&str, Option<&Vec<usize>>)| {
            let columns = columns.filter(|columns| columns.contains(&first) && !columns.contains(&ABSENT))?;
            let number = |column: &usize| (1 + if *column == first { second } else { *column }).to_string();
            Some(format!("[columns] {name} = [{}]", columns.iter().map(number).collect::<Vec<_>>().join(", ")))
        };
        tables.into_iter().find_map(of)
    }
}
