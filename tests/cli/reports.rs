//! `report.html`, the recording for the viewer, and `tauscope view`.

use super::{Case, ROOT, assert_done, assert_refusal, assert_stopped, text};

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
fn a_run_on_measured_logs_writes_a_report_that_can_be_sent() {
    let case = Case::new(&[]);
    assert_done(&case.tauscope(&["simulate", "s.toml", "--out", "logs", "-q"]));
    let dataset = "schema = \"tauscope.dataset/1\"\nrobot = \"arm.urdf\"\n[[train]]\nfile = \"logs/recording.csv\"\n";
    case.write("d.toml", &format!("{dataset}[[test]]\nfile = \"logs/held_out.csv\"\n"));
    case.write("alone.toml", dataset);
    assert_done(&case.tauscope(&["run", "--dataset", "d.toml", "--out", "out", "-q"]));
    let page = sound(&case, "out/report.html");
    for part in
        ["from measured logs", "tauscope run --dataset d.toml", "noise floor", "95 % from", "Data quality", "Next: "]
    {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(page.matches("class=\"ts-figure chart\"").count(), 5 * 6);
    assert!(!page.contains("NaN"));
    assert_eq!(case.path("out/recording.rrd").is_file(), cfg!(feature = "viewer"));

    // A list that is too short, and a joint without a torque, are refused by name.
    let columns = "[columns]\nq = [\"q1\", \"q2\", \"q3\", \"q4\", \"q5\", \"q6\"]\ntau = [\"tau1\"]\n";
    let names = |quantity: &str| (1..=6).map(|joint| format!("\"{quantity}{joint}\"")).collect::<Vec<_>>().join(", ");
    let columns = columns.replace("\"q1\", \"q2\", \"q3\", \"q4\", \"q5\", \"q6\"", &names("q"));
    case.write("short.toml", &format!("{dataset}{columns}"));
    let refused = |name: &str| {
        let output = case.tauscope(&["run", "--dataset", name, "--out", "refused", "-q"]);
        assert_eq!(output.status.code(), Some(2));
        text(&output.stderr)
    };
    let said = refused("short.toml");
    assert!(said.contains("columns.tau: a list of 1, and q is one of 6"), "{said}");
    let log = case.read("logs/recording.csv");
    let mut lines = log.lines().skip_while(|line| line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let last = header.iter().position(|name| ["tau6", "tau_joint_6", "joint_6_effort"].contains(name));
    let last = last.unwrap_or_else(|| panic!("{header:?}"));
    let without = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        [&cells[..last], &cells[last + 1..]].concat().join(",") + "\n"
    };
    case.write("lacks.csv", &std::iter::once(header.join(",").as_str()).chain(lines).map(without).collect::<String>());
    case.write("lacks.toml", &dataset.replace("logs/recording.csv", "lacks.csv"));
    let said = refused("lacks.toml");
    assert!(said.contains("joint_6: no torque of it is in the training logs"), "{said}");

    // Where nothing is held out there is nothing to plot, and the page says so.
    assert_done(&case.tauscope(&["run", "--dataset", "alone.toml", "--out", "alone", "-q"]));
    let page = sound(&case, "alone/report.html");
    assert!(page.contains("nothing was held out") && page.contains("hold a log of another motion out"), "{page}");
    assert_eq!(page.matches("class=\"ts-figure chart\"").count(), 0);
}

#[test]
fn a_diagnosis_that_faults_stop_writes_a_report_too() {
    let case = Case::new(&[]);
    let scenario = format!("{ROOT}/scenarios/effects/stribeck_friction.toml");
    assert_done(&case.tauscope(&["simulate", &scenario, "--out", "logs", "-q"]));
    // Torque of the second joint with its sign turned.
    let log = case.read("logs/recording.csv");
    let mut lines = log.lines().filter(|line| !line.starts_with('#'));
    let header = lines.next().unwrap();
    let column = header.split(',').position(|name| name == "tau2").unwrap();
    let turned = lines.map(|line| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        cells[column] = (-cells[column].parse::<f64>().unwrap()).to_string();
        cells.join(",") + "\n"
    });
    case.write("turned.csv", &format!("{header}\n{}", turned.collect::<String>()));
    assert_stopped(&case.tauscope(&["diagnose", "--robot", "arm.urdf", "--train", "turned.csv", "--out", "out", "-q"]));
    let page = sound(&case, "out/report.html");
    for part in ["The logs cannot be diagnosed", "stops the diagnosis", "Next: ", "turned.csv", "Data quality"] {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(page.matches("class=\"ts-figure chart\"").count(), 2 * 6);
}

#[test]
fn a_study_writes_a_report_that_can_be_sent() {
    let case = Case::new(&[]);
    let study = ["montecarlo", "s.toml", "--trials", "3", "--estimators", "ols,wls", "--sg-windows", "0,31"];
    let levels = ["--noise-levels", "1e-5,1e-4", "--out", "out", "-q"];
    assert_done(&case.tauscope(&[&study[..], &levels[..]].concat()));
    let page = sound(&case, "out/report.html");
    assert!(page.contains("Closest to the true parameters") && page.contains("--estimators ols,wls"), "the verdict");
    for part in ["Comparison", "Smoothing", "As the noise grows", "Parameters", "Every trial gave an estimate", "Seed "]
    {
        assert!(page.contains(part), "{part}");
    }
    // Windows at two levels, two quantities over the noise at two windows, parameters at two levels.
    assert_eq!(page.matches("class=\"ts-figure chart\"").count(), 2 + 2 * 2 + 2);
    assert!(!page.contains("NaN"));
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
