//! Results: the same seed gives the same bits, and every file follows the published schema.

use ramp_result::EpisodeResult;
use ramp_result::episode::SCHEMA;
use ramp_robot::Track;
use ramp_testing::{GoalFiles, data};

fn schema() -> serde_json::Value {
    let text = std::fs::read_to_string(data().join("schema/episode.schema.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn the_same_seed_gives_the_same_result_and_it_follows_the_schema() {
    let world = GoalFiles::new("easy-1");
    let (one, two) = (world.run(Track::State, 7), world.run(Track::State, 7));
    assert_eq!(one.without_clock().to_json(), two.without_clock().to_json());
    assert_ne!(one.physics, world.run(Track::State, 8).physics);

    let schema = schema();
    let value: serde_json::Value = serde_json::from_str(&one.to_json()).unwrap();
    let errors: Vec<String> = jsonschema::validator_for(&schema)
        .unwrap()
        .iter_errors(&value)
        .map(|error| error.to_string())
        .collect();
    assert!(errors.is_empty(), "{errors:?}");
    // What is written can be read back.
    let back: EpisodeResult = serde_json::from_str(&one.to_json()).unwrap();
    assert_eq!(back.pegs, one.pegs);
}

#[test]
fn the_schema_names_its_version_and_refuses_other_fields() {
    let schema = schema();
    assert_eq!(schema["properties"]["schema"]["const"], SCHEMA);
    let validator = jsonschema::validator_for(&schema).unwrap();
    assert!(!validator.is_valid(&serde_json::json!({ "schema": SCHEMA })));
}
