//! Events: each kind follows the schemas of results, trials and logs.

use ramp_robot::{Event, MOST_EVENT};
use ramp_testing::data;

/// Events of every kind follow the schema, which is the same in results of episodes and of trials, and in
/// logs.
#[test]
fn every_kind_of_event_follows_the_schemas() {
    let read = |name: &str| -> serde_json::Value {
        let text = std::fs::read_to_string(data().join(format!("schema/{name}.schema.json"))).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let (episode, trial, log) = (read("episode"), read("manipulation"), read("log/event"));
    assert_eq!(episode["$defs"], trial["$defs"]);
    assert_eq!(episode["$defs"]["event"]["oneOf"], log["oneOf"]);
    let validator = jsonschema::validator_for(&log).unwrap();
    let mut kinds = std::collections::BTreeSet::new();
    for fields in EVENTS {
        let text = format!("{{\"t\": 1.5, {fields}}}");
        let event: Event = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{fields}: {error}"));
        let value = serde_json::to_value(&event).unwrap();
        assert!(validator.is_valid(&value), "{value}");
        assert_eq!(value, serde_json::from_str::<serde_json::Value>(&text).unwrap());
        assert_eq!(event.kind.check(MOST_EVENT), Ok(()));
        assert!(!event.kind.to_string().is_empty());
        kinds.insert(format!("{} {}", event.kind.name(), value["fault"]));
    }
    assert_eq!(kinds.len(), log["oneOf"].as_array().unwrap().len());
    assert!(!validator.is_valid(&serde_json::json!({"t": 1.5, "kind": "dance"})));
    assert!(!validator.is_valid(&serde_json::json!({"t": 1.5, "kind": "note", "what": "x"})));
}

/// An event of each kind, without its time.
const EVENTS: [&str; 36] = [
    r#""kind": "action_begun", "action": "pick_up", "item": {"beam": "b4"}, "grasp": {"link": "b4l1"}"#,
    r#""kind": "action_ended", "action": "assemble_cap", "beam": "b4", "joints": ["b4j1", "b4j2"]"#,
    r#""kind": "fault", "fault": "not_held", "part": "b4""#,
    r#""kind": "fault", "fault": "jammed", "part": "b4", "remaining": 0.003, "force": 25.0"#,
    r#""kind": "fault", "fault": "overload", "force": 51.0"#,
    r#""kind": "fault", "fault": "misaligned", "connection": "C1", "offset": 0.002"#,
    r#""kind": "fault", "fault": "off_place", "part": "b4", "offset": 0.004"#,
    r#""kind": "fault", "fault": "hole_not_found", "peg": "p1", "connection": "C1""#,
    r#""kind": "fault", "fault": "not_seated", "peg": "p1", "connection": "C1", "gap": 0.001"#,
    r#""kind": "fault", "fault": "unseen", "part": "b4""#,
    r#""kind": "fault", "fault": "lost", "peg": "p1""#,
    r#""kind": "fault", "fault": "no_skill", "action": "dance""#,
    r#""kind": "fault", "fault": "not_ready", "action": "dance", "need": "an empty hand""#,
    r#""kind": "fault", "fault": "unmet", "action": "dance", "effect": "joy""#,
    r#""kind": "fault", "fault": "skill_gave_up", "skill": "own", "why": "not today""#,
    r#""kind": "fault", "fault": "no_path", "part": "b4""#,
    r#""kind": "fault", "fault": "no_grasp", "part": "b4""#,
    r#""kind": "fault", "fault": "no_motion", "why": "the start is blocked""#,
    r#""kind": "fault", "fault": "robot", "why": "no image""#,
    r#""kind": "fault", "fault": "sight", "why": "a tag of no part""#,
    r#""kind": "fault", "fault": "gave_up", "why": "no plan""#,
    r#""kind": "fault", "fault": "other", "why": "a bad day""#,
    r#""kind": "retry", "step": "insert", "part": "b4", "attempt": 2, "off": 0.001, "because": "it jams""#,
    r#""kind": "search", "method": "push", "part": "b4", "duration": 2.5, "attempts": 3"#,
    r#""kind": "touched", "part": "b4", "surface": "table", "off": [0.0001, -0.0002]"#,
    r#""kind": "seen", "part": "b4", "off": 0.006"#,
    r#""kind": "diagnosis", "cause": "jam", "part": "b4", "evidence": "25 N""#,
    r#""kind": "replan", "coarse": 12"#,
    r#""kind": "motion", "cannot": {"fasten": {"connection": "C1"}}, "past": {"stands": "b3"}, "because": "x""#,
    r#""kind": "unusual_grasp", "beam": "b4", "s": 0.2, "reverse": true, "because": "b3 is near""#,
    r#""kind": "not_rehearsed", "skill": "fasten-by-mine""#,
    r#""kind": "clipped""#,
    r#""kind": "note", "text": "that is all""#,
    r#""kind": "fault_struck", "fault": "jam", "part": "b4""#,
    r#""kind": "recovered", "why": "reflex", "after": 4.2"#,
    r#""kind": "stopped", "why": "reflex""#,
];
