//! The thresholds in the schema: each with its reason, in the words of the source.

use super::schema;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use tauscope::diagnosis::Criteria;

/// Fields of the structs of thresholds with their documentation, `group/field`, as the source has them.
fn documented() -> BTreeMap<String, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("core/src/diagnosis/criteria");
    let mut found = BTreeMap::new();
    for group in ["", "levels", "estimate", "search", "comparison", "structure", "verdict"] {
        let file = if group.is_empty() { "thresholds" } else { group };
        let text = std::fs::read_to_string(folder.join(file).with_extension("rs")).unwrap();
        let mut sentences: Vec<&str> = Vec::new();
        for line in text.lines().map(str::trim) {
            let field =
                line.strip_prefix("pub ").filter(|rest| rest.ends_with(',')).and_then(|rest| rest.split_once(':'));
            match (line.strip_prefix("/// "), field) {
                (Some(sentence), _) => sentences.push(sentence),
                (None, Some((name, _))) => drop(found.insert(format!("{group}/{name}"), sentences.join(" "))),
                (None, None) => sentences.clear(),
            }
            if field.is_some() {
                sentences.clear();
            }
        }
    }
    found
}

/// Every number of the thresholds, `group/field`.
fn numbers(criteria: &Value) -> Vec<String> {
    let of_group = |(group, value): (&String, &Value)| match value {
        Value::Object(fields) => fields.keys().map(|name| format!("{group}/{name}")).collect(),
        _ => vec![format!("/{group}")],
    };
    criteria.as_object().unwrap().iter().flat_map(of_group).collect()
}

#[test]
fn thresholds_are_described_as_in_the_source() {
    let (documented, schema) = (documented(), schema());
    let criteria = &schema["properties"]["criteria"]["properties"];
    let own = numbers(&json!(Criteria::default()));
    assert!(own.len() > 30, "{own:?}");
    for place in &own {
        let (group, name) = place.split_once('/').unwrap();
        let fields = if group.is_empty() { criteria } else { &criteria[group]["properties"] };
        let source = documented.get(place).unwrap_or_else(|| panic!("{place} has no documentation"));
        assert_eq!(fields[name]["description"], **source, "{place}");
    }
}

/// What stands under the name of a question refers to the threshold that it shares.
#[test]
fn what_is_shared_refers_to_its_threshold() {
    let (own, schema) = (numbers(&json!(Criteria::default())), schema());
    let is_own = |path: &str| own.contains(&path.replace('.', "/"));
    let groups = schema["properties"]["criteria"]["properties"].as_object().unwrap();
    let mut shared = 0;
    for (group, value) in groups {
        let single = serde_json::Map::from_iter([(group.clone(), value.clone())]);
        let (group, fields) = match value["properties"].as_object() {
            Some(fields) => (group.as_str(), fields),
            None => ("", &single),
        };
        for (name, field) in fields.iter().filter(|(name, _)| !own.contains(&format!("{group}/{name}"))) {
            let description = field["description"].as_str().unwrap();
            let refers = description.split('`').skip(1).step_by(2).any(is_own);
            assert!(refers, "{group}/{name} does not say from which threshold it comes: {description}");
            shared += 1;
        }
    }
    assert!(shared > 30, "{shared}");
}
