//! The published schema agrees with the parser: whatever shape the one refuses, the other does.

use std::cell::Cell;

use jsonschema::Validator;
use proptest::{prelude::*, sample::Index, test_runner::TestRunner};
use recto::manifest::{check_shape, schema};
use serde_json::{Value, json};

use super::{
    broken::written_cases,
    sound::{FULL, SMALL},
};

fn validator() -> Validator {
    jsonschema::draft7::new(&schema()).unwrap()
}

/// The data of a manifest as JSON. Dates and numbers that JSON lacks become what no schema
/// accepts in their place.
fn to_json(value: &toml::Value) -> Value {
    match value {
        toml::Value::String(text) => json!(text),
        toml::Value::Integer(integer) => json!(integer),
        toml::Value::Float(float) if float.is_finite() => json!(float),
        toml::Value::Float(_) | toml::Value::Datetime(_) => Value::Null,
        toml::Value::Boolean(boolean) => json!(boolean),
        toml::Value::Array(array) => array.iter().map(to_json).collect(),
        toml::Value::Table(table) => Value::Object(
            table
                .iter()
                .map(|(key, value)| (key.clone(), to_json(value)))
                .collect(),
        ),
    }
}

fn parse(text: &str) -> Option<Value> {
    Some(to_json(&toml::Value::Table(toml::from_str(text).ok()?)))
}

/// Whether both accept it; fails where only one does.
fn verdict(validator: &Validator, json: &Value, text: &str) -> Result<bool, TestCaseError> {
    let parser = check_shape(text);
    let schema = validator.is_valid(json);
    prop_assert_eq!(
        parser.is_ok(),
        schema,
        "\n{}\nparser: {:?}\nschema: {:?}",
        text,
        parser.map_err(|faults| faults.to_string()),
        validator
            .iter_errors(json)
            .map(|error| error.to_string())
            .collect::<Vec<_>>()
    );
    Ok(schema)
}

/// As [`verdict`], of data that is written as TOML first.
fn judge(validator: &Validator, json: &Value) -> Result<bool, TestCaseError> {
    verdict(validator, json, &toml::to_string(json).unwrap())
}

#[test]
fn the_schema_is_a_schema_and_describes_every_key() {
    let schema = schema();
    assert!(jsonschema::meta::is_valid(&schema));
    let mut undescribed = Vec::new();
    fn walk(value: &Value, path: &str, undescribed: &mut Vec<String>) {
        if let Some(properties) = value.get("properties").and_then(Value::as_object) {
            for (key, property) in properties {
                if property["description"].as_str().is_none_or(str::is_empty) {
                    undescribed.push(format!("{path}.{key}"));
                }
            }
        }
        match value {
            Value::Object(object) => {
                object
                    .iter()
                    .for_each(|(k, v)| walk(v, &format!("{path}/{k}"), undescribed));
            }
            Value::Array(array) => array.iter().for_each(|v| walk(v, path, undescribed)),
            _ => {}
        }
    }
    walk(&schema, "", &mut undescribed);
    assert_eq!(undescribed, Vec::<String>::new());
}

#[test]
fn both_accept_sound_manifests() {
    let validator = validator();
    let samples = [
        include_str!("../../exhibits/landscape/exhibit.toml"),
        include_str!("../../exhibits/media-chart/exhibit.toml"),
        include_str!("../../exhibits/one-picture/exhibit.toml"),
    ];
    for text in [SMALL, FULL].into_iter().chain(samples) {
        assert!(verdict(&validator, &parse(text).unwrap(), text).unwrap());
    }
}

#[test]
fn both_refuse_the_same_broken_manifests() {
    let validator = validator();
    let (mut accepted, mut refused) = (0, 0);
    for (name, text, _) in written_cases() {
        // What is no TOML has no data to hold against the schema.
        let Some(json) = parse(text) else { continue };
        match verdict(&validator, &json, text) {
            Ok(true) => accepted += 1,
            Ok(false) => refused += 1,
            Err(error) => panic!("{name}: {error}"),
        }
    }
    assert!(
        refused > 40 && accepted > 40,
        "{refused} refused, {accepted} accepted"
    );
}

/// One change somewhere in a manifest.
#[derive(Clone, Debug)]
enum Mutation {
    Remove,
    Rename(String),
    Replace(Value),
    /// Adds a key to the table there, or a value to the array.
    Add(String, Value),
}

fn mutation() -> impl Strategy<Value = Mutation> {
    let value = prop_oneof![
        Just(json!(0)),
        Just(json!(-1)),
        Just(json!(1e12)),
        Just(json!(0.5)),
        Just(json!(45)),
        Just(json!(true)),
        Just(json!("")),
        Just(json!("recto")),
        Just(json!("wash")),
        Just(json!("#abcdef")),
        Just(json!("state:x")),
        Just(json!([])),
        Just(json!([1, 2])),
        Just(json!([1, 2, 3])),
        Just(json!({})),
        Just(json!({ "file": "recto.png" })),
        Just(json!({ "en": "x" })),
        Just(json!({ "id": "x" })),
    ];
    let key = prop_oneof![
        Just("id".to_owned()),
        Just("file".to_owned()),
        Just("kind".to_owned()),
        Just("source".to_owned()),
        Just("register".to_owned()),
        Just("gloss".to_owned()),
        Just("roughness".to_owned()),
        Just("lumen".to_owned()),
        Just("candela".to_owned()),
        Just("position_mm".to_owned()),
        Just("azimuth_deg".to_owned()),
        Just("distance_mm".to_owned()),
        Just("legend".to_owned()),
        Just("weights".to_owned()),
        Just("gltf".to_owned()),
        "[a-z_]{1,8}",
    ];
    prop_oneof![
        Just(Mutation::Remove),
        key.clone().prop_map(Mutation::Rename),
        value.clone().prop_map(Mutation::Replace),
        (key, value).prop_map(|(key, value)| Mutation::Add(key, value)),
    ]
}

/// JSON pointers of all values.
fn pointers(value: &Value, path: &str, found: &mut Vec<String>) {
    let children: Vec<(String, &Value)> = match value {
        Value::Object(object) => object.iter().map(|(k, v)| (k.clone(), v)).collect(),
        Value::Array(array) => array
            .iter()
            .enumerate()
            .map(|(i, v)| (i.to_string(), v))
            .collect(),
        _ => return,
    };
    for (key, child) in children {
        let path = format!("{path}/{}", key.replace('~', "~0").replace('/', "~1"));
        pointers(child, &path, found);
        found.push(path);
    }
}

fn apply(root: &mut Value, at: Index, mutation: Mutation) {
    let mut places = Vec::new();
    pointers(root, "", &mut places);
    let place = at.get(&places);
    let (parent, last) = place.rsplit_once('/').unwrap();
    match mutation {
        Mutation::Replace(value) => *root.pointer_mut(place).unwrap() = value,
        Mutation::Add(key, value) => match root.pointer_mut(place).unwrap() {
            Value::Object(object) => {
                object.insert(key, value);
            }
            Value::Array(array) => array.push(value),
            _ => {}
        },
        Mutation::Remove => match root.pointer_mut(parent).unwrap() {
            Value::Object(object) => {
                object.remove(last);
            }
            Value::Array(array) => {
                array.remove(last.parse().unwrap());
            }
            _ => {}
        },
        Mutation::Rename(key) => {
            if let Value::Object(object) = root.pointer_mut(parent).unwrap()
                && let Some(value) = object.remove(last)
            {
                object.insert(key, value);
            }
        }
    }
}

#[test]
fn both_judge_changed_manifests_alike() {
    let validator = validator();
    let full = parse(FULL).unwrap();
    let config = ProptestConfig {
        cases: 1500,
        failure_persistence: None,
        ..Default::default()
    };
    let changes = prop::collection::vec((any::<Index>(), mutation()), 1..3);
    let (accepted, refused) = (Cell::new(0), Cell::new(0));
    TestRunner::new(config)
        .run(&changes, |changes| {
            let mut json = full.clone();
            for (at, mutation) in changes {
                apply(&mut json, at, mutation);
            }
            let count = if judge(&validator, &json)? {
                &accepted
            } else {
                &refused
            };
            count.set(count.get() + 1);
            Ok(())
        })
        .unwrap();
    let (accepted, refused) = (accepted.get(), refused.get());
    assert!(
        accepted > 50 && refused > 500,
        "{accepted} accepted, {refused} refused"
    );
}

#[test]
fn a_schema_that_differs_is_found_out() {
    let mut lax = schema();
    lax["definitions"]["Drawing"]
        .as_object_mut()
        .unwrap()
        .remove("required");
    let lax = jsonschema::draft7::new(&lax).unwrap();
    let mut json = parse(FULL).unwrap();
    json["drawing"][0]
        .as_object_mut()
        .unwrap()
        .remove("size_mm");
    assert!(judge(&lax, &json).is_err());
    assert!(!judge(&validator(), &json).unwrap());
}
