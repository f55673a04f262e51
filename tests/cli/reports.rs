//! `report.html`, the recording for the viewer, and `tauscope view`.

use super::{Case, ROOT, assert_done, assert_refusal, text};

/// Elements of HTML that have no end.
const VOID: [&str; 3] = ["meta", "link", "br"];

/// Checks that every element is closed in order, and that nothing is loaded from elsewhere; returns the page.
fn sound(case: &Case, name: &str) -> String {
    let page = case.read(name);
    let mut open: Vec<&str> = Vec::new();
    for piece in page.split('<').skip(1) {
        let (tag, _) = piece.split_once('>').unwrap_or_else(|| panic!("an open tag: {piece:.60}"));
        let word = tag.split([' ', '\n', '/']).find(|word| !word.is_empty()).unwrap_or_default();
        match tag {
            end if end.starts_with('/') => assert_eq!(open.pop(), Some(word), "{page:.0}</{word}> closes another"),
            other if other.starts_with('!') || other.ends_with('/') || VOID.contains(&word) => {}
            _ => open.push(word),
        }
    }
    assert!(open.is_empty(), "{open:?} stay open");
    for load in ["src=", "url(", "@import", "<script", "href=\"http", "href=\"/"] {
        assert!(!page.contains(load), "{load}");
    }
    let machine = case.folder.path().display().to_string();
    assert!(!page.contains(&machine) && !page.contains(ROOT), "the page tells where it was made");
    page
}

#[test]
fn a_run_writes_a_report_that_can_be_sent() {
    let case = Case::new(&[]);
    let scenario = case.path("s.toml");
    let out = case.path("out");
    assert_done(&case.tauscope(&["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap(), "-q"]));
    let page = sound(&case, "out/report.html");
    assert!(page.len() < 5_000_000, "{}", page.len());
    assert!(page.contains("tauscope run s.toml --out out -q"), "the command");
    assert!(page.contains("Seed 1600"), "the seed");
    // Over time, torque, velocity, position, spectrum: each of six joints.
    assert_eq!(page.matches("class=\"ts-figure chart\"").count(), 5 * 6);
    for joint in 1..=6 {
        assert!(page.matches(&format!(">joint_{joint}, N m<")).count() >= 4, "joint {joint}");
    }
    assert!(page.find("<h1").unwrap() < page.find("<table").unwrap(), "the verdict comes first");
    assert_eq!(case.path("out/recording.rrd").is_file(), cfg!(feature = "viewer"));
}

#[test]
fn a_diagnosis_writes_a_report_that_can_be_sent() {
    let case = Case::new(&[]);
    let scenario = format!("{ROOT}/scenarios/effects/stribeck_friction.toml");
    assert_done(&case.tauscope(&["simulate", &scenario, "--out", "logs", "-q"]));
    let logs = ["--train", "logs/recording.csv", "--test", "logs/held_out.csv", "--candidates", "stribeck_friction"];
    let arguments = [&["diagnose", "--robot", "arm.urdf", "--out", "out", "-q"], &logs[..]].concat();
    assert_done(&case.tauscope(&arguments));
    let page = sound(&case, "out/report.html");
    assert!(page.contains("The model misses stribeck friction on joint_2."), "the verdict");
    for part in ["Findings", "95 % from", "Candidates, ranked", "Minimum detectable sizes", "Next: ", "Data quality"] {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(page.matches("class=\"ts-figure chart\"").count(), 5 * 6);
    assert_eq!(case.path("out/recording.rrd").is_file(), cfg!(feature = "viewer"));
}

#[test]
fn a_report_does_not_colour_a_pipe() {
    let case = Case::new(&[]);
    let output = case.tauscope(&["run", "s.toml", "--out", "out"]);
    assert_done(&output);
    assert!(!text(&output.stdout).contains('\u{1b}') && !text(&output.stderr).contains('\u{1b}'));
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
}

#[test]
fn view_says_what_is_missing() {
    let case = Case::new(&[]);
    assert_refusal(&case.tauscope(&["view", "nowhere"]), &["nowhere", "is not there"]);
    case.write("recording.rrd", "");
    let output = case.bash("PATH=/nowhere \"$TAUSCOPE\" view .");
    assert_refusal(&output, &["not on the PATH", "pip install rerun-sdk==0.36.3"]);
}

#[cfg(unix)]
#[test]
fn view_opens_the_recording_with_the_viewer() {
    let case = Case::new(&[]);
    case.write("recording.rrd", "");
    let script = "mkdir bin; printf '#!/bin/sh\\necho \"$@\" > opened' > bin/rerun; chmod +x bin/rerun; \
                  PATH=$PWD/bin:$PATH \"$TAUSCOPE\" view .";
    assert_done(&case.bash(script));
    assert_eq!(case.read("opened").trim(), "./recording.rrd");
}
