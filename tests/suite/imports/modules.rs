//! The modules of the crate and the names that each of them sees.

use super::tokens::{tokens, without_tests};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Path of a module from the root of the crate, `["simulation", "plant"]`.
pub(super) type ModulePath = Vec<String>;

/// Re-exports of re-exports are followed this deep; more is a circle of names.
const DEEPEST_REEXPORT: usize = 20;

/// One file of the crate.
#[derive(Default)]
struct Module {
    file: PathBuf,
    /// Modules declared in it, in that order.
    children: Vec<String>,
    /// Names brought in by `use`, with the paths they stand for as written.
    names: BTreeMap<String, Vec<String>>,
    /// Those of them that are re-exports.
    exported: BTreeSet<String>,
    /// Paths of `use m::*`, as written.
    globs: Vec<Vec<String>>,
    /// Paths that the code needs, as written: private imports, qualified names, and re-exports that it uses itself.
    needed: Vec<Vec<String>>,
}

/// All files of the crate, test code left out.
pub(super) struct Crate {
    modules: BTreeMap<ModulePath, Module>,
}

impl Crate {
    /// Reads the crate whose root module is `root/lib.rs`.
    pub(super) fn read(root: &Path) -> Self {
        let mut modules = BTreeMap::new();
        let mut open = vec![(Vec::new(), root.join("lib.rs"))];
        while let Some((path, file)) = open.pop() {
            let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
            let module = Module::parse(file, &without_tests(&tokens(&text)));
            for child in &module.children {
                let path: ModulePath = path.iter().chain([child]).cloned().collect();
                let flat = root.join(path.join("/")).with_extension("rs");
                let file = if flat.exists() { flat } else { root.join(path.join("/")).join("mod.rs") };
                open.push((path, file));
            }
            modules.insert(path, module);
        }
        Crate { modules }
    }

    /// Modules that a module declares, in their order.
    pub(super) fn declared(&self, module: &[String]) -> &[String] {
        &self.modules[module].children
    }

    /// File of a module, relative to `root`.
    pub(super) fn file(&self, module: &ModulePath, root: &Path) -> String {
        let file = &self.modules[module].file;
        file.strip_prefix(root).unwrap_or(file).display().to_string()
    }

    /// The modules from which each module takes something: those in which the names are defined, whatever re-exports lie
    /// between.
    pub(super) fn arrows(&self) -> BTreeMap<ModulePath, BTreeSet<ModulePath>> {
        let to = |from: &ModulePath, module: &Module| -> BTreeSet<ModulePath> {
            let defined = module.needed.iter().filter_map(|path| self.resolve(from, path, 0));
            defined.filter(|to| to != from).collect()
        };
        self.modules.iter().map(|(path, module)| (path.clone(), to(path, module))).collect()
    }

    /// The module in which the item is defined that `path` stands for in `module`. None for what is not of the crate, and
    /// for paths that name a module only.
    fn resolve(&self, module: &ModulePath, path: &[String], depth: usize) -> Option<ModulePath> {
        assert!(depth < DEEPEST_REEXPORT, "`{}` in {module:?} leads in a circle", path.join("::"));
        let mut at = match path.first()?.as_str() {
            "crate" => (Vec::new(), 1),
            "self" => (module.clone(), 1),
            "super" => {
                let up = path.iter().take_while(|part| *part == "super").count();
                (module[..module.len().checked_sub(up)?].to_vec(), up)
            }
            _ => {
                self.modules[module].sees(&path[0])?;
                (module.clone(), 0)
            }
        };
        while let Some(part) = path.get(at.1) {
            let here = &self.modules[&at.0];
            if here.children.contains(part) {
                at.0.push(part.clone());
                at.1 += 1;
            } else if let Some(target) = here.names.get(part) {
                let onward: Vec<String> = target.iter().chain(&path[at.1 + 1..]).cloned().collect();
                return if target.first() == Some(part) && !here.children.contains(part) {
                    None // `use rand::Rng`: the name of another crate.
                } else {
                    self.resolve(&at.0, &onward, depth + 1)
                };
            } else {
                let exported = here.globs.iter().find_map(|glob| {
                    let onward: Vec<String> = glob.iter().chain(&path[at.1..]).cloned().collect();
                    self.resolve(&at.0, &onward, depth + 1)
                });
                return Some(exported.unwrap_or(at.0));
            }
        }
        None
    }
}

impl Module {
    fn parse(file: PathBuf, tokens: &[String]) -> Self {
        let mut module = Module { file, ..Module::default() };
        let (mut used, mut at) = (BTreeSet::new(), 0);
        while at < tokens.len() {
            let before = at.checked_sub(1).map(|i| tokens[i].as_str());
            let public = matches!(before, Some("pub" | ")"));
            match (tokens[at].as_str(), tokens.get(at + 1).map(String::as_str)) {
                ("mod", Some(name)) if tokens.get(at + 2).map(String::as_str) == Some(";") => {
                    module.children.push(name.to_owned());
                    at += 3;
                }
                ("use", Some(next)) if next != "<" => {
                    let end = (at..tokens.len()).find(|&i| tokens[i] == ";").unwrap_or(tokens.len());
                    module.import(&tokens[at + 1..end], &mut 0, &[], public);
                    at = end + 1;
                }
                (first, Some("::")) if is_name(first) && !matches!(before, Some("::" | ".")) => {
                    let mut path = vec![first.to_owned()];
                    at += 1;
                    while tokens.get(at).is_some_and(|t| t == "::") && tokens.get(at + 1).is_some_and(|t| is_name(t)) {
                        path.push(tokens[at + 1].clone());
                        at += 2;
                    }
                    module.needed.push(path);
                }
                (name, next) => {
                    // A name before a colon is a field's or a parameter's own.
                    if is_name(name) && !matches!(before, Some("::" | ".")) && next != Some(":") {
                        used.insert(name.to_owned());
                    }
                    at += 1;
                }
            }
        }
        let own = module.exported.iter().filter(|name| used.contains(*name)).map(|name| module.names[name].clone());
        module.needed.extend(own.collect::<Vec<_>>());
        module
    }

    /// Reads one branch of a use tree, from `at` to behind its comma or to the brace that ends the branches.
    fn import(&mut self, tree: &[String], at: &mut usize, prefix: &[String], public: bool) {
        let mut path = prefix.to_vec();
        let mut name = None;
        while let Some(token) = tree.get(*at).map(String::as_str).filter(|&token| token != "}") {
            *at += 1;
            match token {
                "::" => {}
                "," => break,
                "{" => {
                    while tree.get(*at).is_some_and(|token| token != "}") {
                        self.import(tree, at, &path, public);
                    }
                    *at += 1;
                    name = None;
                }
                "*" => {
                    self.globs.push(path.clone());
                    // What a glob brings in is not seen by name: the module itself counts as needed.
                    if !public {
                        self.needed.push(path.iter().cloned().chain(["*".to_owned()]).collect());
                    }
                    name = None;
                }
                "self" if path.len() > prefix.len() || prefix.is_empty() => path.push(token.to_owned()),
                "self" => name = path.last().cloned(),
                "as" => {
                    name = tree.get(*at).cloned();
                    *at += 1;
                }
                part => {
                    path.push(part.to_owned());
                    name = Some(part.to_owned());
                }
            }
        }
        if let Some(name) = name {
            self.bring(name, &path, public);
        }
    }

    fn bring(&mut self, name: String, path: &[String], public: bool) {
        if public {
            self.exported.insert(name.clone());
        } else {
            self.needed.push(path.to_vec());
        }
        self.names.insert(name, path.to_vec());
    }

    /// Whether a name at the start of a path is one of the crate's.
    fn sees(&self, name: &str) -> Option<()> {
        (self.children.iter().any(|child| child == name) || self.names.contains_key(name)).then_some(())
    }
}

fn is_name(token: &str) -> bool {
    token.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_')
}
