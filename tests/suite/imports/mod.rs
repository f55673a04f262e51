//! Imports run one way: rooms in the order in which `lib.rs` declares them, and the files of a room without circles, in both crates.
//! An arrow leads from a file to the file in which a name that it uses is defined, whatever re-exports lie between.
//! So do thresholds: those of gates come from `Criteria`. And files and folders stay short.

mod gates;
mod modules;
mod sizes;
mod tokens;

use modules::{Crate, ModulePath};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Sources of the two crates.
fn roots() -> [PathBuf; 2] {
    ["src", "core/src"].map(|root| Path::new(env!("CARGO_MANIFEST_DIR")).join(root))
}

/// Sets of nodes of which each leads to all others.
fn circles<T: Ord + Clone>(arrows: &BTreeMap<T, BTreeSet<T>>) -> Vec<BTreeSet<T>> {
    let reach = |from: &T| {
        let mut seen = BTreeSet::new();
        let mut open: Vec<&T> = arrows[from].iter().collect();
        while let Some(at) = open.pop() {
            if seen.insert(at.clone()) {
                open.extend(arrows.get(at).into_iter().flatten());
            }
        }
        seen
    };
    let reached: BTreeMap<&T, BTreeSet<T>> = arrows.keys().map(|node| (node, reach(node))).collect();
    let circle = |node: &T| -> BTreeSet<T> {
        let back = |other: &&T| reached.get(other).is_some_and(|far| far.contains(node));
        reached[node].iter().filter(back).cloned().collect()
    };
    let all: BTreeSet<BTreeSet<T>> = arrows.keys().map(circle).filter(|circle| !circle.is_empty()).collect();
    all.into_iter().collect()
}

/// Arrows from one room to another, each with the files that draw it.
fn between_rooms(krate: &Crate, root: &Path) -> BTreeMap<[String; 2], Vec<String>> {
    let mut found: BTreeMap<[String; 2], Vec<String>> = BTreeMap::new();
    for (from, to) in krate.arrows() {
        for to in to {
            // The root of the crate itself is no room.
            if let (Some(room), Some(other)) = (from.first(), to.first())
                && room != other
            {
                let line = format!("{} uses {}", krate.file(&from, root), krate.file(&to, root));
                found.entry([room.clone(), other.clone()]).or_default().push(line);
            }
        }
    }
    found
}

#[test]
fn rooms_use_only_the_rooms_below_them() {
    for root in roots() {
        let krate = Crate::read(&root);
        let order = krate.declared(&[]);
        let level = |room: &String| order.iter().position(|other| other == room).expect("every room is declared");
        let arrows = between_rooms(&krate, &root);
        assert!(arrows.len() > order.len(), "few arrows are seen: {}", arrows.len());
        let wrong: Vec<String> = arrows
            .into_iter()
            .filter(|([room, other], _)| level(room) > level(other))
            .map(|([room, other], files)| {
                format!("`{room}` is below `{other}` in {}/lib.rs:\n    {}", root.display(), files.join("\n    "))
            })
            .collect();
        assert!(wrong.is_empty(), "imports against the order of the rooms:\n{}", wrong.join("\n"));
    }
}

#[test]
fn files_of_a_room_import_each_other_without_circles() {
    for root in roots() {
        let krate = Crate::read(&root);
        let mut arrows = krate.arrows();
        for (from, to) in &mut arrows {
            to.retain(|to| from.first() == to.first());
        }
        let described: Vec<String> = circles(&arrows)
            .iter()
            .map(|circle| {
                let inside = circle.iter().flat_map(|from| arrows[from].intersection(circle).map(move |to| (from, to)));
                let uses =
                    inside.map(|(from, to)| format!("{} uses {}", krate.file(from, &root), krate.file(to, &root)));
                uses.collect::<Vec<_>>().join("\n    ")
            })
            .collect();
        assert!(described.is_empty(), "files import each other in circles:\n    {}", described.join("\n\n    "));
    }
}

/// Arrows between the rooms and files right inside each room, drawn by all files within them.
fn inside_rooms(krate: &Crate) -> BTreeMap<ModulePath, BTreeMap<String, BTreeSet<String>>> {
    let mut found: BTreeMap<ModulePath, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for (from, to) in krate.arrows() {
        for to in to {
            let shared = from.iter().zip(&to).take_while(|(own, other)| own == other).count();
            if let (Some(own), Some(other)) = (from.get(shared), to.get(shared)) {
                let arrows = found.entry(from[..shared].to_vec()).or_default();
                arrows.entry(other.clone()).or_default();
                arrows.entry(own.clone()).or_default().insert(other.clone());
            }
        }
    }
    found
}

/// The table of the diagnosis lists its rooms from the last to the first.
#[test]
fn rooms_of_the_diagnosis_use_only_the_rooms_below_them() {
    let root = &roots()[1];
    let text = std::fs::read_to_string(root.join("diagnosis/mod.rs")).expect("the diagnosis has a room");
    let order: Vec<&str> =
        text.lines().filter_map(|line| line.strip_prefix("//! | `")?.split_once('`')).map(|(room, _)| room).collect();
    let mut rooms: Vec<String> = std::fs::read_dir(root.join("diagnosis"))
        .expect("the diagnosis has rooms")
        .filter_map(|entry| entry.ok().filter(|entry| entry.path().is_dir()))
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    rooms.sort();
    let mut listed: Vec<&str> = order.clone();
    listed.sort_unstable();
    assert_eq!(rooms, listed, "the table lists every room");
    assert!(rooms.len() <= 12, "{rooms:?}");
    let level = |room: &String| order.iter().position(|other| other == room);
    let found = inside_rooms(&Crate::read(root));
    let wrong: Vec<String> = found[&vec!["diagnosis".to_owned()]]
        .iter()
        .flat_map(|(room, others)| others.iter().map(move |other| (room, other)))
        .filter(|(room, other)| matches!((level(room), level(other)), (Some(own), Some(used)) if own > used))
        .map(|(room, other)| format!("`{room}` is below `{other}`"))
        .collect();
    assert!(wrong.is_empty(), "imports against the order of the table: {wrong:?}");
}

#[test]
fn rooms_inside_a_room_import_each_other_without_circles() {
    for root in roots() {
        let found = inside_rooms(&Crate::read(&root));
        assert!(found.len() > 5, "{:?}", found.keys());
        let wrong: Vec<String> = found
            .iter()
            .filter(|(room, _)| !room.is_empty())
            .flat_map(|(room, arrows)| {
                circles(arrows).into_iter().map(move |circle| format!("{}: {circle:?}", room.join("::")))
            })
            .collect();
        assert!(wrong.is_empty(), "rooms import each other in circles:\n    {}", wrong.join("\n    "));
    }
}

#[test]
fn circles_are_found_and_chains_are_none() {
    let graph = |arrows: &[(u8, u8)]| {
        let mut graph: BTreeMap<u8, BTreeSet<u8>> = (0..5).map(|node| (node, BTreeSet::new())).collect();
        for &(from, to) in arrows {
            graph.entry(from).or_default().insert(to);
        }
        graph
    };
    assert!(circles(&graph(&[(0, 1), (1, 2), (0, 2), (3, 2)])).is_empty());
    assert_eq!(circles(&graph(&[(0, 1), (1, 2), (2, 1), (3, 4), (4, 3)])), [[1, 2].into(), [3, 4].into()]);
}

#[test]
fn names_lead_to_the_file_that_defines_them() {
    let folder = tempfile::tempdir().unwrap();
    for (file, text) in [
        ("lib.rs", "pub mod low; pub mod high;"),
        ("low/mod.rs", "mod law; pub use law::{Law, old as new}; #[cfg(test)] mod tests { use crate::high::Top; }"),
        ("low/law.rs", "use std::fmt; pub struct Law; pub fn old() { fmt::x() }"),
        ("high.rs", "use crate::low::{self, new}; pub struct Top(low::Law); fn f() { new() }"),
    ] {
        let path = folder.path().join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let krate = Crate::read(folder.path());
    let path = |names: &[&str]| -> ModulePath { names.iter().map(|name| (*name).to_owned()).collect() };
    let arrows = krate.arrows();
    assert_eq!(arrows[&path(&["high"])], [path(&["low", "law"])].into());
    assert!(arrows[&path(&["low"])].is_empty() && arrows[&path(&["low", "law"])].is_empty());
    assert_eq!(krate.declared(&[]), ["low", "high"]);
}
