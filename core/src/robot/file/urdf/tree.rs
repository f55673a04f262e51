//! The tree that the links and joints of a URDF form.

use super::super::xml::{attribute, child, children, line};
use super::elements::joint_type;
use crate::error::{Error, Result};
use roxmltree::Node;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Names of the links that a joint moves; all others are fixed to the base, and nothing depends on their inertia.
pub(super) fn moved<'a>(root: &Node<'a, '_>) -> HashSet<&'a str> {
    let end = |node: &Node<'a, '_>, tag: &str| child(node, tag).and_then(|end| attribute(&end, "link")).unwrap_or("");
    let joints: Vec<_> = children(root, "joint").collect();
    let mut moved = HashSet::new();
    loop {
        let before = moved.len();
        for joint in &joints {
            if joint_type(joint) != "fixed" || moved.contains(end(joint, "parent")) {
                moved.insert(end(joint, "child"));
            }
        }
        if moved.len() == before {
            return moved;
        }
    }
}

/// Links and joints by name.
pub(super) struct Tree<'t, 'a, 'i> {
    pub path: &'t Path,
    pub links: &'t [(&'a str, Node<'a, 'i>)],
    pub joints: &'t [(&'a str, Node<'a, 'i>)],
}

impl<'a> Tree<'_, 'a, '_> {
    /// Indices of the links that belong to the robot, in the order of the file. Links that hang on nothing and carry no
    /// moving joint are left out with a note.
    ///
    /// # Errors
    /// If a name occurs twice, a joint ends at a link that is not there, a link has two parents, the joints form a cycle, or
    /// joints move in more than one tree.
    pub(super) fn main(&self, notes: &mut Vec<String>) -> Result<Vec<usize>> {
        let index = self.unique("link", self.links)?;
        self.unique("joint", self.joints)?;
        let mut parent: Vec<Option<usize>> = vec![None; self.links.len()];
        let mut below: Vec<Vec<usize>> = vec![Vec::new(); self.links.len()];
        for (joint, (name, node)) in self.joints.iter().enumerate() {
            let ends =
                ["parent", "child"].map(|tag| child(node, tag).and_then(|end| attribute(&end, "link")).unwrap_or(""));
            let [above, carried] = ends.map(|end| index.get(end).copied().ok_or(end));
            let missing = |end: &str| self.error("joint", name, node, format!("there is no link `{end}`"));
            let (above, carried) = (above.map_err(missing)?, carried.map_err(missing)?);
            if let Some(other) = parent[carried].replace(joint) {
                let (link, other) = (self.links[carried].0, self.joints[other].0);
                let problem = format!("link `{link}` already hangs on joint `{other}`: a closed loop; cut it open");
                return Err(self.error("joint", name, node, problem));
            }
            below[above].push(joint);
        }
        let roots: Vec<usize> = (0..self.links.len()).filter(|&link| parent[link].is_none()).collect();
        let trees: Vec<(Vec<usize>, bool)> = roots.iter().map(|&root| self.reached(root, &below, &index)).collect();
        let reached: usize = trees.iter().map(|(links, _)| links.len()).sum();
        if roots.is_empty() {
            return Err(self.whole("every link has a parent: the joints form a cycle; cut it open".to_owned()));
        }
        if reached < self.links.len() {
            let from = self.names(&roots);
            let count = self.links.len() - reached;
            return Err(self.whole(format!("{count} links are not reached from `{from}`: their joints form a cycle")));
        }
        let moving: Vec<usize> = (0..roots.len()).filter(|&tree| trees[tree].1).collect();
        let main = match moving[..] {
            [] => (0..roots.len()).max_by_key(|&tree| (trees[tree].0.len(), std::cmp::Reverse(tree))).unwrap_or(0),
            [tree] => tree,
            _ => {
                let names = self.names(&moving.iter().map(|&tree| roots[tree]).collect::<Vec<_>>());
                return Err(self.whole(format!(
                    "{} links have no parent and carry moving joints ({names}); a robot has one base: join them with \
                     fixed joints",
                    moving.len()
                )));
            }
        };
        if roots.len() > 1 {
            let others: Vec<usize> = roots.iter().copied().filter(|&root| root != roots[main]).collect();
            let (others, base) = (self.names(&others), self.links[roots[main]].0);
            notes.push(format!("links that hang on nothing are left out ({others}); the base is `{base}`"));
        }
        let mut links = trees.into_iter().nth(main).map(|(links, _)| links).unwrap_or_default();
        links.sort_unstable();
        Ok(links)
    }

    fn unique(&self, tag: &str, elements: &[(&'a str, Node)]) -> Result<HashMap<&'a str, usize>> {
        let mut index = HashMap::new();
        for (at, (name, node)) in elements.iter().enumerate() {
            if index.insert(*name, at).is_some() {
                return Err(self.error(tag, name, node, format!("two {tag}s have this name; rename one")));
            }
        }
        Ok(index)
    }

    /// The links below a root, itself included, and whether a joint among them moves.
    fn reached(&self, root: usize, below: &[Vec<usize>], index: &HashMap<&str, usize>) -> (Vec<usize>, bool) {
        let (mut links, mut moves, mut next) = (vec![root], false, 0);
        while let Some(&link) = links.get(next) {
            for &joint in &below[link] {
                let node = &self.joints[joint].1;
                moves |= joint_type(node) != "fixed";
                let end = child(node, "child").and_then(|end| attribute(&end, "link"));
                links.extend(end.and_then(|end| index.get(end)));
            }
            next += 1;
        }
        (links, moves)
    }

    fn names(&self, links: &[usize]) -> String {
        links.iter().map(|&link| self.links[link].0).collect::<Vec<_>>().join(", ")
    }

    fn error(&self, tag: &str, name: &str, node: &Node, problem: String) -> Error {
        Error::input(self.path, Some(line(node)), format!("{tag} `{name}`"), problem)
    }

    fn whole(&self, problem: String) -> Error {
        Error::input(self.path, None, "<robot>", problem)
    }
}
