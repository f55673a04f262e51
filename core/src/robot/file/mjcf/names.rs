//! Names of bodies and joints: those of the file are kept, those it leaves out are made up.

use super::element::Element;
use crate::error::Result;
use std::collections::HashSet;

/// The names of one kind of element.
pub(super) struct Names {
    given: HashSet<String>,
    used: HashSet<String>,
}

impl Names {
    /// The names that elements of a kind have anywhere in a model.
    pub(super) fn of(root: &Element, tag: &str) -> Self {
        let mut given = HashSet::new();
        let mut open = vec![root];
        while let Some(element) = open.pop() {
            open.extend(&element.children);
            let own = element.tag == tag || tag == "joint" && element.tag == "freejoint";
            given.extend(element.get("name").filter(|_| own).map(str::to_owned));
        }
        Names { given, used: HashSet::new() }
    }

    /// The name of an element; where it has none, one that starts with `wanted`.
    ///
    /// # Errors
    /// If another element has the same name.
    pub(super) fn name(&mut self, element: &Element, wanted: &str) -> Result<String> {
        match element.get("name") {
            Some(name) if self.used.insert(name.to_owned()) => Ok(name.to_owned()),
            Some(_) => Err(element.error("another element of this kind has the same name; rename one")),
            None => Ok(self.unique(wanted.to_owned())),
        }
    }

    /// A name that nothing else has: the wanted one, with a number if need be.
    pub(super) fn unique(&mut self, wanted: String) -> String {
        let (mut name, mut number) = (wanted.clone(), 1);
        while self.given.contains(&name) || !self.used.insert(name.clone()) {
            number += 1;
            name = format!("{wanted}_{number}");
        }
        name
    }
}
