//! Default values: classes that inherit from each other, and what an element has in the end.

use super::element::Element;
use crate::error::Result;
use std::collections::HashMap;

/// Name of the class that all others inherit from.
const MAIN: &str = "main";

/// Elements of drives; they share their defaults.
pub(super) const ACTUATORS: [&str; 9] =
    ["general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion"];

/// Attributes by the kind of element they belong to.
type Class = HashMap<String, HashMap<String, String>>;

/// All classes of a model, each with what it inherits.
#[derive(Debug, Clone, Default)]
pub(super) struct Defaults {
    classes: HashMap<String, Class>,
}

impl Defaults {
    /// The classes of a model.
    pub(super) fn of(root: &Element) -> Self {
        let mut defaults = Defaults::default();
        defaults.classes.insert(MAIN.to_owned(), Class::new());
        for top in root.all("default") {
            let mut main = defaults.classes[MAIN].clone();
            overlay(&mut main, top);
            if let Some(name) = top.get("class") {
                defaults.classes.insert(name.to_owned(), main.clone());
            }
            defaults.classes.insert(MAIN.to_owned(), main.clone());
            defaults.nested(top, &main);
        }
        defaults
    }

    fn nested(&mut self, parent: &Element, inherited: &Class) {
        for element in parent.all("default") {
            let mut class = inherited.clone();
            overlay(&mut class, element);
            self.nested(element, &class);
            if let Some(name) = element.get("class") {
                self.classes.insert(name.to_owned(), class);
            }
        }
    }

    /// An element with its defaults; `childclass` is the class of the bodies around it.
    ///
    /// # Errors
    /// If the element's class is not there.
    pub(super) fn apply<'a>(&'a self, element: &'a Element, childclass: Option<&str>) -> Result<Settled<'a>> {
        let class = element.get("class").or(childclass).unwrap_or(MAIN);
        let Some(class) = self.classes.get(class) else {
            return Err(element.error(format!("there is no default class `{class}`")));
        };
        Ok(Settled { element, defaults: class.get(kind(&element.tag)) })
    }
}

fn overlay(class: &mut Class, element: &Element) {
    for child in element.children.iter().filter(|child| child.tag != "default") {
        let attributes = class.entry(kind(&child.tag).to_owned()).or_default();
        attributes.extend(child.attributes().map(|(name, value)| (name.to_owned(), value.to_owned())));
    }
}

fn kind(tag: &str) -> &str {
    if ACTUATORS.contains(&tag) { "general" } else { tag }
}

/// An element with its defaults.
#[derive(Clone, Copy)]
pub(super) struct Settled<'a> {
    /// The element itself.
    pub element: &'a Element,
    defaults: Option<&'a HashMap<String, String>>,
}

impl<'a> Settled<'a> {
    /// An element that has no defaults.
    pub(super) fn plain(element: &'a Element) -> Self {
        Settled { element, defaults: None }
    }

    /// The value of an attribute, its own or by default.
    pub(super) fn get(&self, name: &str) -> Option<&'a str> {
        let default = || self.defaults.and_then(|defaults| defaults.get(name)).map(String::as_str);
        self.element.get(name).or_else(default)
    }

    /// The numbers of an attribute; see [`Element::numbers`].
    pub(super) fn numbers(&self, name: &str, count: [usize; 2]) -> Result<Option<Vec<f64>>> {
        self.get(name).map(|text| self.element.numbers(name, text, count)).transpose()
    }

    /// The first number of an attribute, of up to ten.
    pub(super) fn number(&self, name: &str) -> Result<Option<f64>> {
        Ok(self.numbers(name, [1, 10])?.map(|values| values[0]))
    }

    /// Three numbers.
    pub(super) fn vector(&self, name: &str) -> Result<Option<nalgebra::Vector3<f64>>> {
        Ok(self.numbers(name, [3, 3])?.map(|v| nalgebra::Vector3::new(v[0], v[1], v[2])))
    }
}
