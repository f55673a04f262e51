//! Folders of results in all weathers.

use super::*;
use std::collections::BTreeMap;

/// Everything below a folder, hidden or not, with its content.
fn tree(folder: &Path) -> BTreeMap<String, String> {
    let mut files = BTreeSet::new();
    collect(folder, "", &mut files).unwrap();
    files.into_iter().map(|name| (name.clone(), std::fs::read_to_string(folder.join(name)).unwrap())).collect()
}

fn names(folder: &Path) -> Vec<String> {
    tree(folder).into_keys().collect()
}

fn write(target: &Path, files: &[(&str, &str)]) {
    let folder = ResultFolder::create(target).unwrap();
    for (name, text) in files {
        folder.write_text(name, text).unwrap();
    }
    folder.finish().unwrap();
}

#[test]
fn a_new_folder_with_its_parents() {
    let base = tempfile::tempdir().unwrap();
    let target = base.path().join("a/b/out");
    let folder = ResultFolder::create(&target).unwrap();
    folder.write_text("plots/one/x.svg", "picture").unwrap();
    std::fs::write(folder.file("log.csv").unwrap(), "t\n").unwrap();
    assert!(!target.exists());
    assert_eq!(folder.finish().unwrap(), target);
    assert_eq!(names(base.path()), ["a/b/out/log.csv", "a/b/out/manifest.json", "a/b/out/plots/one/x.svg"]);
    let manifest = "{\n  \"schema\": \"tauscope.manifest/1\",\n  \"files\": [\n    \"log.csv\",\n    \
                    \"plots/one/x.svg\"\n  ]\n}\n";
    assert_eq!(tree(&target)["manifest.json"], manifest);
}

#[test]
fn a_drop_in_the_middle_leaves_nothing() {
    let base = tempfile::tempdir().unwrap();
    let target = base.path().join("a/out");
    let folder = ResultFolder::create(&target).unwrap();
    folder.write_text("x.txt", "x").unwrap();
    drop(folder);
    assert_eq!(std::fs::read_dir(base.path()).unwrap().count(), 0);

    write(&target, &[("x.txt", "old")]);
    let before = tree(base.path());
    let folder = ResultFolder::create(&target).unwrap();
    folder.write_text("x.txt", "new").unwrap();
    assert_eq!(tree(&target).len(), 2);
    drop(folder);
    assert_eq!(tree(base.path()), before);
}

#[test]
fn nothing_is_made_before_the_first_file() {
    let base = tempfile::tempdir().unwrap();
    let folder = ResultFolder::create(base.path().join("out")).unwrap();
    assert_eq!(std::fs::read_dir(base.path()).unwrap().count(), 0);
    drop(folder);
}

#[test]
fn a_second_run_replaces_its_own_files_only() {
    let base = tempfile::tempdir().unwrap();
    let target = base.path().join("out");
    write(&target, &[("x.txt", "old"), ("plots/gone.svg", "old"), ("more/gone.svg", "old"), ("gone.txt", "old")]);
    std::fs::write(target.join("foreign.txt"), "mine").unwrap();
    std::fs::write(target.join("plots/foreign.svg"), "mine").unwrap();
    write(&target, &[("x.txt", "new"), ("y/z.txt", "new")]);
    assert_eq!(
        names(base.path()),
        ["out/foreign.txt", "out/manifest.json", "out/plots/foreign.svg", "out/x.txt", "out/y/z.txt"]
    );
    assert_eq!(tree(&target)["x.txt"], "new");
    assert!(!target.join("more").exists(), "an emptied folder goes with its files");
}

#[test]
fn a_manifest_cannot_reach_out_of_its_folder() {
    let base = tempfile::tempdir().unwrap();
    let target = base.path().join("out");
    write(&target, &[("x.txt", "old")]);
    let outside = base.path().join("outside.txt");
    std::fs::write(&outside, "mine").unwrap();
    let files = ["../outside.txt", outside.to_str().unwrap(), "never_written.txt", "x.txt"];
    let manifest = serde_json::json!({ "schema": MANIFEST_SCHEMA, "files": files });
    std::fs::write(target.join(MANIFEST), manifest.to_string()).unwrap();
    write(&target, &[("y.txt", "new")]);
    assert_eq!(names(base.path()), ["out/manifest.json", "out/y.txt", "outside.txt"]);
}

#[test]
fn a_failure_while_moving_leaves_the_folder_as_it_was() {
    let base = tempfile::tempdir().unwrap();
    let target = base.path().join("out");
    write(&target, &[("a.txt", "old"), ("gone.txt", "old")]);
    std::fs::create_dir_all(target.join("z.txt/folder")).unwrap();
    std::fs::write(target.join("z.txt/folder/mine"), "mine").unwrap();
    std::fs::write(target.join("foreign.txt"), "mine").unwrap();
    let before = tree(base.path());
    for (name, expected) in [("z.txt", "out/z.txt: "), ("foreign.txt/x", "out/foreign.txt/x: ")] {
        let folder = ResultFolder::create(&target).unwrap();
        folder.write_text("aa/new.txt", "new").unwrap();
        folder.write_text(name, "new").unwrap();
        let error = folder.finish().unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
        assert_eq!(tree(base.path()), before);
        assert!(!target.join("aa").exists());
    }
}

#[test]
fn places_that_cannot_be_written_are_refused_at_once() {
    let base = tempfile::tempdir().unwrap();
    let file = base.path().join("file.txt");
    std::fs::write(&file, "mine").unwrap();
    for target in [file.clone(), file.join("out"), file.join("a/b")] {
        let error = ResultFolder::create(&target).unwrap_err();
        assert!(matches!(error, Error::Io { .. }), "{error:?}");
        assert!(error.to_string().starts_with(target.to_str().unwrap()), "{error}");
    }
    assert_eq!(names(base.path()), ["file.txt"]);
}

#[test]
fn a_manifest_of_another_program_is_kept() {
    for text in ["{}", "not json", r#"{ "schema": "other", "files": [] }"#] {
        let base = tempfile::tempdir().unwrap();
        std::fs::write(base.path().join(MANIFEST), text).unwrap();
        let error = ResultFolder::create(base.path()).unwrap_err().to_string();
        assert!(error.contains("manifest.json") && error.contains("another folder"), "{error}");
        assert_eq!(tree(base.path())[MANIFEST], text);
    }
}

#[test]
fn names_that_leave_the_folder_are_refused() {
    let base = tempfile::tempdir().unwrap();
    let folder = ResultFolder::create(base.path().join("out")).unwrap();
    for name in ["", "/etc/x", "../x", "a/../../x", "a//b", "a/", ".", "a\\b", "c:x", "manifest.json"] {
        let error = folder.file(name).unwrap_err();
        let Error::Io { path, source, .. } = error else { panic!("{error}") };
        assert_eq!((path, source.kind()), (base.path().join("out").join(name), ErrorKind::InvalidInput));
    }
    assert!(folder.file("a/manifest.json").is_ok());
}

#[derive(Serialize)]
struct Report {
    zeta: f64,
    alpha: Option<Vec<f64>>,
}

#[test]
fn json_starts_with_its_schema_and_keeps_the_order() {
    let base = tempfile::tempdir().unwrap();
    let folder = ResultFolder::create(base.path().join("out")).unwrap();
    folder.write_json("r.json", "tauscope.report/1", &Report { zeta: 0.1, alpha: Some(vec![1e-300]) }).unwrap();
    let target = folder.finish().unwrap();
    let expected = "{\n  \"schema\": \"tauscope.report/1\",\n  \"zeta\": 0.1,\n  \"alpha\": [\n    1e-300\n  ]\n}\n";
    assert_eq!(tree(&target)["r.json"], expected);
}

#[test]
fn json_must_be_an_object_without_a_schema() {
    let base = tempfile::tempdir().unwrap();
    let folder = ResultFolder::create(base.path().join("out")).unwrap();
    let own = BTreeMap::from([("schema", 1)]);
    for error in [
        folder.write_json("r.json", "s/1", &[1, 2]).unwrap_err(),
        folder.write_json("r.json", "s/1", &()).unwrap_err(),
        folder.write_json("r.json", "s/1", &"text").unwrap_err(),
        folder.write_json("r.json", "s/1", &own).unwrap_err(),
    ] {
        assert!(error.to_string().contains("out/r.json"), "{error}");
    }
}

#[cfg(unix)]
#[test]
fn a_full_disk_names_the_file() {
    if !Path::new("/dev/full").exists() {
        return;
    }
    let base = tempfile::tempdir().unwrap();
    let folder = ResultFolder::create(base.path().join("out")).unwrap();
    std::os::unix::fs::symlink("/dev/full", folder.file("r.json").unwrap()).unwrap();
    let value = Report { zeta: 1.0, alpha: None };
    for error in
        [folder.write_json("r.json", "s/1", &value).unwrap_err(), folder.write_text("r.json", "text").unwrap_err()]
    {
        let Error::Io { path, source, .. } = error else { panic!("{error}") };
        assert_eq!((path, source.kind()), (base.path().join("out/r.json"), ErrorKind::StorageFull));
    }
    drop(folder);
    assert_eq!(std::fs::read_dir(base.path()).unwrap().count(), 0);
}
