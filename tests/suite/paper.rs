//! `tauscope paper` from end to end on a short scenario, with the built command.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;
use tempfile::TempDir;

const FIGURES: [&str; 4] =
    ["figure_4_position.svg", "figure_5_velocity.svg", "figure_6_acceleration.svg", "figure_7_torque.svg"];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn paper(scenario: &Path, folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .arg("paper")
        .arg(scenario)
        .arg("--out")
        .arg(folder)
        .output()
        .expect("the command starts")
}

/// The results of the short scenario, made once for all tests, and what was printed.
static CASE: LazyLock<(TempDir, String, Value)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let output = paper(&root().join("tests/scenarios/short.toml"), folder.path());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(folder.path().join("paper.json")).unwrap();
    (folder, String::from_utf8(output.stdout).unwrap(), serde_json::from_str(&text).unwrap())
});

fn read(name: &str) -> String {
    std::fs::read_to_string(CASE.0.path().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|v| v.as_f64().expect("a number")).collect()
}

/// The entry of a list whose `key` is `name`.
fn entry<'a>(list: &'a Value, key: &str, name: &str) -> &'a Value {
    list.as_array().unwrap().iter().find(|item| item[key] == name).unwrap_or_else(|| panic!("no {key} {name}"))
}

#[test]
fn the_folder_holds_tables_figures_and_numbers() {
    let manifest: Value = serde_json::from_str(&read("manifest.json")).unwrap();
    let files: Vec<&str> = manifest["files"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    for name in ["paper.json", "tables.md", "recording.csv", "held_out.csv", "scenario.toml"].into_iter().chain(FIGURES)
    {
        assert!(files.contains(&name), "{name} is not in {files:?}");
        assert!(!read(name).is_empty(), "{name}");
    }
    assert_eq!(CASE.2["schema"], "tauscope.paper/1");
    let tables = read("tables.md");
    for heading in ["Table 1.", "Table 2.", "Table 3.", "Figure 3.", "Departures from print"] {
        assert!(tables.contains(&format!("## {heading}")), "{heading}");
    }
    assert!(!tables.contains("NaN") && !tables.contains("inf "), "{tables}");
}

#[test]
fn the_figures_are_well_formed_and_small() {
    for name in FIGURES {
        let text = read(name);
        assert!(text.len() < 300_000, "{name}: {} bytes", text.len());
        let document = roxmltree::Document::parse(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        let rect = ("http://www.w3.org/2000/svg", "rect");
        let frames = document
            .descendants()
            .filter(|node| node.has_tag_name(rect) && node.attribute("class") == Some("frame"))
            .count();
        assert_eq!(frames, 6, "{name}: one panel per joint");
        let lines = document
            .descendants()
            .filter(|node| node.attribute("class").is_some_and(|class| class.starts_with("line ")))
            .count();
        assert_eq!(lines, 6 * 3 + 3, "{name}: three lines in every panel, and the legend");
        let words: Vec<&str> = document.descendants().filter_map(|node| node.text()).collect();
        for word in ["reference", "disturbed", "smoothed", "time (s)"] {
            assert!(words.contains(&word), "{name}: {word}");
        }
        assert!(!text.contains("NaN"));
    }
}

#[test]
fn ranks_and_sums_of_the_78_parameters() {
    for (variant, rank) in [("as_printed", 48), ("consistent", 44), ("euler_lagrange", 44)] {
        let model = entry(&CASE.2["model_78"], "variant", variant);
        assert_eq!(
            (&model["parameters"], &model["rank"], &model["rank_on_motion"]),
            (&78.into(), &rank.into(), &rank.into())
        );
        assert_eq!(model["null_dimension"], 78 - rank);
        assert_eq!(model["sums"][0], serde_json::json!([1, 2, 3, 4, 5, 6]));
        for fit in model["fits"].as_array().unwrap() {
            assert_eq!(numbers(&fit["x"]).len(), 78);
            assert!(fit["unseen_share"].as_f64().unwrap() < 1e-9, "from zero the fit is the shortest X: {fit}");
            // What stands in one sum gets equal shares of it.
            let x = numbers(&fit["x"]);
            for k in 1..6 {
                assert!((x[k] - x[0]).abs() < 1e-9 * x[0].abs(), "{variant}: {:?}", &x[..6]);
            }
        }
    }
}

#[test]
fn other_starts_predict_the_same_torque_with_other_parameters() {
    let starts = CASE.2["other_starts"].as_array().unwrap();
    assert!(starts.len() >= 4);
    for start in starts {
        assert!(start["largest_torque_change_nm"].as_f64().unwrap() < 1e-6, "{start}");
        let moved = start["largest_x_change"].as_f64().unwrap();
        if start["start"] == "zero" {
            assert!(moved < 1e-6, "{start}");
        } else {
            assert!(moved > 1.0, "{start}");
        }
    }
}

#[test]
fn smoothing_lowers_the_torque_standard_deviation_on_every_joint() {
    let rows = CASE.2["table_3"].as_array().unwrap();
    assert_eq!(rows.len(), 6);
    for row in rows {
        for model in ["model_78", "spatial", "printed"] {
            let pair = numbers(&row[model]);
            assert!(pair[1] < pair[0], "{model}: {row}");
            let ratio = row[format!("{model}_ratio")].as_f64().unwrap();
            assert!((ratio - pair[1] / pair[0]).abs() < 1e-12);
        }
    }
}

#[test]
fn the_planar_model_leaves_what_the_spatial_one_explains() {
    let planar = entry(&entry(&CASE.2["model_78"], "variant", "consistent")["fits"], "signals", "savitzky_golay");
    let spatial = entry(&CASE.2["spatial"], "signals", "savitzky_golay");
    for motion in ["training", "held_out"] {
        let percent = |fit: &Value| numbers(&fit["quality"][motion]["residual_percent"]);
        let (planar, spatial) = (percent(planar), percent(spatial));
        for joint in 0..3 {
            assert!(planar[joint] > 5.0 * spatial[joint], "{motion}, joint {}: {planar:?} {spatial:?}", joint + 1);
            assert!(spatial[joint] < 3.0, "{motion}, joint {}: {spatial:?}", joint + 1);
        }
    }
}

#[test]
fn levenberg_marquardt_is_weighted_least_squares_on_the_spatial_model() {
    for fit in CASE.2["spatial"].as_array().unwrap() {
        assert!(fit["solver_difference"].as_f64().unwrap() < 1e-9, "{}", fit["solver_difference"]);
        assert_eq!(fit["base_parameters"].as_array().unwrap().len(), 52);
    }
}

#[test]
fn one_move_shows_51_of_52_base_parameters_and_the_sequence_all() {
    assert_eq!((&CASE.2["single_move"]["rank"], &CASE.2["single_move"]["of"]), (&51.into(), &52.into()));
    assert_eq!((&CASE.2["sequence"]["rank"], &CASE.2["sequence"]["of"]), (&52.into(), &52.into()));
}

#[test]
fn table_2_has_ours_beside_the_printed_values() {
    let rows = CASE.2["table_2"].as_array().unwrap();
    assert_eq!(rows.len(), 78);
    assert_eq!((&rows[0]["symbol"], &rows[0]["printed"]), (&"X1".into(), &10.9.into()));
    assert!(rows[28]["printed"].is_null(), "the values of X29 to X42 are lost");
    // The friction of joint 6 is alone on its joint, so even this model finds the plant's.
    let urdf = std::fs::read_to_string(root().join("urdf/irb1600_6_120.urdf")).unwrap();
    let document = roxmltree::Document::parse(&urdf).unwrap();
    let joint = document
        .descendants()
        .find(|node| node.has_tag_name("joint") && node.attribute("name") == Some("joint_6"))
        .and_then(|joint| joint.children().find(|node| node.has_tag_name("dynamics")))
        .unwrap();
    let coulomb: f64 = joint.attribute("friction").unwrap().parse().unwrap();
    let found = rows[76]["consistent"].as_f64().unwrap();
    assert!((found / coulomb - 1.0).abs() < 0.05, "X77 {found} against {coulomb}");
}

#[test]
fn every_stage_that_ran_has_a_time() {
    let stages = CASE.2["procedure"].as_array().unwrap();
    let names: Vec<&str> = stages.iter().map(|stage| stage["stage"].as_str().unwrap()).collect();
    let expected =
        ["model", "excitation", "simulation", "measurement", "smoothing", "regression", "levenberg_marquardt"];
    assert_eq!(names[..7], expected);
    for stage in stages {
        assert!(stage["seconds"].as_f64().unwrap() > 0.0, "{stage}");
    }
}

#[test]
fn the_console_gives_a_verdict() {
    let printed = CASE.1.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in ["The paper is right:", "The paper is wrong:", "planar chain", "51 of the 52", "not identifiable"] {
        assert!(printed.contains(words), "{words} is not in\n{}", CASE.1);
    }
    let verdict = &CASE.2["verdict"];
    assert_eq!(verdict["right"].as_array().unwrap().len(), 3);
    assert!(verdict["wrong"].as_array().unwrap().len() >= 5);
}

#[test]
fn an_arm_without_six_joints_is_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = root().join("tests/reference/fixed_links.urdf");
    let text = std::fs::read_to_string(&urdf).unwrap();
    let name = roxmltree::Document::parse(&text).unwrap().root_element().attribute("name").unwrap().to_owned();
    let scenario = std::fs::read_to_string(root().join("tests/scenarios/short.toml"))
        .unwrap()
        .replace("../../urdf/irb1600_6_120.urdf", urdf.to_str().unwrap())
        .replace("irb1600_6_120", &name)
        .replace("[10.0, 10.0, 12.0, 35.0, 40.0, 50.0]", "10.0")
        .replace("[3.0, 4.0, 2.0, 0.45, 0.35, 0.18]", "1.0");
    let path = folder.path().join("scenario.toml");
    std::fs::write(&path, scenario).unwrap();
    let output = paper(&path, &folder.path().join("out"));
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("6 joints"), "{message}");
    assert!(!folder.path().join("out").exists());
}
