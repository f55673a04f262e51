//! The JSON schema of `diagnosis.json`: what the runs of the tests write is valid, and every field is described.

mod criteria;

use boon::{Compiler, SchemaIndex, Schemas};
use serde_json::Value;

const SCHEMA: &str = include_str!("../../docs/schema/diagnosis.schema.json");

fn schema() -> Value {
    serde_json::from_str(SCHEMA).unwrap()
}

/// The schema, itself checked against that of draft 2020-12, which it names.
fn compiled() -> (Schemas, SchemaIndex) {
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource("diagnosis.schema.json", schema()).unwrap();
    let index = compiler.compile("diagnosis.schema.json", &mut schemas).unwrap_or_else(|error| panic!("{error:#}"));
    (schemas, index)
}

/// Fails with the place and the reason if the schema does not allow a `diagnosis.json`.
#[track_caller]
pub(crate) fn assert_valid(document: &Value) {
    let (schemas, index) = compiled();
    if let Err(error) = schemas.validate(document, index) {
        panic!("diagnosis.json does not follow its schema: {error:#}\n{document}");
    }
}

/// Every schema of an object, with its place.
fn objects<'a>(value: &'a Value, place: &str, found: &mut Vec<(String, &'a Value)>) {
    match value {
        Value::Object(map) => {
            if map.get("type") == Some(&"object".into()) {
                found.push((place.to_owned(), value));
            }
            map.iter().for_each(|(key, value)| objects(value, &format!("{place}/{key}"), found));
        }
        Value::Array(values) => values.iter().for_each(|value| objects(value, place, found)),
        _ => {}
    }
}

#[test]
fn every_field_is_described_and_no_other_is_allowed() {
    let schema = schema();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    let mut all = Vec::new();
    objects(&schema, "#", &mut all);
    assert!(all.len() > 10, "{}", all.len());
    for (place, object) in all {
        assert_eq!(object["additionalProperties"], false, "{place}");
        for (name, property) in object["properties"].as_object().unwrap() {
            let referred = property["$ref"].as_str().and_then(|path| schema.pointer(path.trim_start_matches('#')));
            let described = [Some(property), referred].into_iter().flatten().any(|one| one["description"].is_string());
            assert!(described, "{place}: {name} has no description");
        }
    }
}

#[test]
fn what_is_missing_or_unknown_is_refused() {
    let (schemas, index) = compiled();
    let stopped = serde_json::json!({
        "schema": "tauscope.diagnosis/1", "verdict": "not_testable", "robot": "arm", "joints": [], "effort_units": [],
        "alpha": 0.05, "noise_floor_nm": [], "test_torque_rms_nm": [], "simulation": {"test_rms_nm": [], "structure": []},
        "baseline": {"train_rms_nm": [], "test_rms_nm": []}, "findings": [], "not_found": [], "unexplained": [],
        "next_experiment": "", "data_quality": [],
    });
    assert!(schemas.validate(&stopped, index).is_ok());
    for (key, value) in [("alpha", "0.05".into()), ("verdict", "unknown".into()), ("more", Value::Null)] {
        let mut wrong = stopped.clone();
        wrong[key] = value;
        assert!(schemas.validate(&wrong, index).is_err(), "{key}");
    }
    let mut less = stopped.clone();
    less.as_object_mut().unwrap().remove("findings");
    assert!(schemas.validate(&less, index).is_err());
}
