//! The easy class, from goal file to result, in the real physics. The result follows the published schema,
//! and the same seed gives the same bits.
//!
//! `RAMP_SEEDS="1 2 3"` chooses other seeds than those that every test run takes. Seed 1 of easy-3 is among
//! the recorded states, where it has to be built as well.

use ramp_result::EpisodeResult;
use ramp_result::episode::SCHEMA;
use ramp_robot::{EventKind, Track};
use ramp_testing::{GoalFiles, data};

/// Builds the goal from each seed.
fn builds(goal: &str, seeds: &str) -> Vec<EpisodeResult> {
    let world = GoalFiles::new(goal);
    let seeds = std::env::var("RAMP_SEEDS").unwrap_or_else(|_| seeds.to_string());
    let built = |seed: u64| {
        let result = world.run(Track::State, seed);
        let faults: Vec<_> =
            result.events.iter().filter(|event| matches!(event.kind, EventKind::Fault(_))).collect();
        assert_eq!(result.ended.reason, "done", "{goal}, seed {seed}: {faults:?}");
        assert!((result.completion - 1.0).abs() < 1e-12, "{goal}, seed {seed}: {faults:?}");
        assert!(result.physics.as_ref().unwrap().deepest_penetration < 0.3e-3, "{goal}, seed {seed}");
        assert!(result.time.robot < 300.0);
        // Every peg's time lies within the episode, and thinking only adds to it.
        for peg in result.pegs.iter().flatten() {
            assert!(peg.t_robot > 0.0 && peg.t_robot <= result.time.robot && peg.t_total >= peg.t_robot);
        }
        result
    };
    seeds.split_whitespace().map(|word| built(word.parse().unwrap())).collect()
}

fn schema() -> serde_json::Value {
    let text = std::fs::read_to_string(data().join("schema/episode.schema.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn easy_1_is_built_and_the_same_seed_gives_the_same_result() {
    let results = builds("easy-1", "1 101");
    let again = GoalFiles::new("easy-1").run(Track::State, results[0].seed);
    assert_eq!(results[0].without_clock().to_json(), again.without_clock().to_json());
    for other in &results[1..] {
        assert_ne!(results[0].physics, other.physics, "seed {}", other.seed);
    }
    // The written result follows the schema and can be read back.
    let text = again.to_json();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let validator = jsonschema::validator_for(&schema()).unwrap();
    let errors: Vec<String> = validator.iter_errors(&value).map(|error| error.to_string()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    let back: EpisodeResult = serde_json::from_str(&text).unwrap();
    assert_eq!(back.pegs, again.pegs);
}

#[test]
fn easy_2_is_built() {
    builds("easy-2", "1 101");
}

#[test]
fn easy_3_is_built() {
    builds("easy-3", "101");
}

#[test]
fn the_schema_names_its_version_and_refuses_other_fields() {
    let schema = schema();
    assert_eq!(schema["properties"]["schema"]["const"], SCHEMA);
    let validator = jsonschema::validator_for(&schema).unwrap();
    assert!(!validator.is_valid(&serde_json::json!({ "schema": SCHEMA })));
}
