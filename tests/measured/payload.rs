//! The load between logs of real arms, where a folder has them. Run with `--ignored`.

use super::{folder, printed};
use serde_json::Value;
use std::process::Command;
use tempfile::TempDir;

/// `payload.json` of two logs; the tests that call it are ignored, so that the folder must be there.
fn payload(urdf: &str, logs: [&str; 2], more: &[&str]) -> Value {
    let folder = folder();
    let work = TempDir::new().unwrap();
    let path = |name: &str| std::path::absolute(folder.join(name)).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_tauscope"));
    command
        .arg("payload")
        .args([path(logs[0]), path(logs[1])])
        .arg("--robot")
        .arg(path(urdf))
        .args(["--out", "out", "--json"])
        .args(more)
        .current_dir(work.path());
    printed(&mut command)
}

/// A number with its standard error.
fn number(quantity: &Value) -> [f64; 2] {
    ["value", "standard_error"].map(|key| quantity[key].as_f64().unwrap())
}

#[test]
#[ignore = "needs the folder of measured logs"]
fn the_airbots_load_is_one_answer() {
    let logs = ["airbot/airbot_chirp.csv", "airbot/airbot_chirp_load0.48kg.csv"];
    let found = payload("airbot/airbot.urdf", logs, &[]);
    assert_eq!((&found["verdict"], &found["estimator"]), (&"load".into(), &"difference".into()));
    // 0.48 kg is mounted; with the drives' unknown gains hand analysis has 0.30 +- 0.01, joint by joint 0.34 to 0.47 kg.
    let [mass, error] = number(&found["mass_kg"]);
    assert!((mass - 0.30).abs() < 2.0 * error && error < 0.06, "{mass} +- {error}");
    assert!(found["mass_with_free_offsets_kg"].is_null(), "free offsets leave the mass open");
    let notes = found["notes"].to_string();
    assert!(notes.contains("would not determine the mass") && notes.contains("joints disagree"), "{notes}");
}

#[test]
#[ignore = "needs the folder of measured logs"]
fn loads_on_the_psms_pitch_link_have_a_first_moment() {
    // Published masses 0.105 and 0.205 kg; hand analysis 0.0498 and 0.0225 kg m. The link turns about one point: no mass.
    for (log, moment) in [("psm/ins105.csv", 0.0498), ("psm/par205.csv", 0.0225)] {
        let found = payload("psm/psm.urdf", ["psm/none.csv", log], &["--at", "pitch"]);
        assert_eq!(found["verdict"], "mass_not_determined", "{log}");
        let [value, error] = number(&found["first_moment_kg_m"][1]);
        assert!((value - moment).abs() < 0.007 && error < 0.003, "{log}: {value} +- {error}");
    }
}

#[test]
#[ignore = "needs the folder of measured logs"]
fn nothing_on_the_psm_has_no_number() {
    for (log, verdict) in [("psm/one.csv", "load_or_offsets"), ("psm/two.csv", "no_body")] {
        let found = payload("psm/psm.urdf", ["psm/none.csv", log], &["--at", "pitch"]);
        assert_eq!(found["verdict"], verdict, "{log}");
        assert!(
            found["mass_kg"].is_null() && found["first_moment_kg_m"].as_array().unwrap().iter().all(Value::is_null)
        );
    }
}
