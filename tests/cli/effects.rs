//! Effects named in scenarios and on the command line.

use super::{Case, ROOT};
use serde_json::Value;

fn with_effect(table: &str) -> Case {
    let case = Case::new(&[]);
    let text = case.read("s.toml") + "\n[[effect]]\n" + table;
    case.write("s.toml", &text);
    case
}

fn refusal(case: &Case, arguments: &[&str]) -> String {
    let output = case.tauscope(arguments);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn a_bad_effect_in_a_scenario_is_named_with_what_would_be_right() {
    for (table, words) in [
        (
            "name = \"stribek_friction\"\njoint = \"joint_2\"\n",
            vec!["stribek_friction", "did you mean `stribeck_friction`"],
        ),
        ("name = \"stribeck_friction\"\njoint = \"joint_9\"\n", vec!["joint_9", "joint_1, joint_2"]),
        ("name = \"stribeck_friction\"\n", vec!["acts on a joint", "joint_1"]),
        ("name = \"payload\"\njoint = \"joint_6\"\n", vec!["acts on the arm as a whole"]),
        ("name = \"joint_coupling\"\njoint = \"joint_6\"\n", vec!["the one after it"]),
        (
            "name = \"stribeck_friction\"\njoint = \"joint_2\"\nparameters = { rize = 3.0 }\n",
            vec!["rize", "did you mean `rise`"],
        ),
        (
            "name = \"stribeck_friction\"\njoint = \"joint_2\"\nparameters = { velocity = -1.0 }\n",
            vec!["velocity", "outside"],
        ),
        (
            "name = \"joint_elasticity\"\njoint = \"joint_2\"\nparameters = { compliance = nan }\n",
            vec!["compliance", "outside"],
        ),
    ] {
        let said = refusal(&with_effect(table), &["run", "s.toml"]);
        for word in words.into_iter().chain(["s.toml:"]) {
            assert!(said.contains(word), "`{word}` is not in: {said}");
        }
    }
}

#[test]
fn named_effects_are_fitted_on_demand_with_standard_deviations() {
    let scenario = format!("{ROOT}/scenarios/effects/stribeck_friction.toml");
    let case = Case::new(&[]);
    let effects = ["--effect", "stribeck_friction:joint_2", "--effect", "load_dependent_friction"];
    let arguments = [&["identify", "--scenario", &scenario, "--out", "fit", "--quiet"], &effects[..]].concat();
    let output = case.tauscope(&arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let result: Value = serde_json::from_str(&case.read("fit/identification.json")).unwrap();
    assert_eq!(result["schema"], "tauscope.identify/1");
    let found = result["with_effects"]["effects"].as_array().unwrap();
    assert_eq!(found.len(), 7, "one Stribeck effect and load-dependent friction on every joint");
    let stribeck = &found[0];
    assert_eq!((&stribeck["effect"], &stribeck["joints"][0]), (&"stribeck_friction".into(), &"joint_2".into()));
    let rise = &stribeck["parameters"][0];
    let (value, std) = (rise["value"].as_f64().unwrap(), rise["std"].as_f64().unwrap());
    assert!((value - 25.0).abs() < 4.0 * std && std < 2.0, "{value} +- {std}");
    for friction in &found[1..] {
        // The last joint carries next to nothing: any coefficient fits there, also one at its bound, which is said.
        if friction["joints"][0] == "joint_6" && friction["parameters"][0]["at_bound"] == true {
            continue;
        }
        // None was simulated, so none may be found; one that would be negative is zero, and certain.
        let (value, std) =
            (friction["parameters"][0]["value"].as_f64().unwrap(), friction["parameters"][0]["std"].as_f64().unwrap());
        assert!(value.abs() <= 4.5 * std, "{friction}");
    }
    let residual = |side: &str| result[side]["test_rms_nm"][1].as_f64().unwrap();
    assert!(residual("with_effects") < 0.5 * residual("without_effects"));
}

#[test]
fn bad_requests_to_identify_are_refused() {
    let case = Case::new(&[]);
    for (arguments, word) in [
        (vec!["identify"], "--robot"),
        (vec!["identify", "--robot", "arm.urdf"], "--train"),
        (vec!["identify", "--robot", "arm.urdf", "--train", "none.csv"], "none.csv"),
        (vec!["identify", "--scenario", "s.toml", "--effect", "backlsh:joint_1"], "did you mean `backlash`"),
        (vec!["identify", "--scenario", "s.toml", "--effect", "backlash:joint_7"], "joint_7"),
        (vec!["identify", "--scenario", "s.toml", "--effect", "payload:joint_1"], "the arm as a whole"),
        (vec!["identify", "--scenario", "s.toml", "--gravity", "0,0"], "gravity"),
    ] {
        let said = refusal(&case, &arguments);
        assert!(said.contains(word), "`{word}` is not in: {said}");
    }
    assert!(!case.path("results").exists());
}
