//! Poses that cameras saw of a real robot: the first line is the message on `/run`, each further one is on
//! `/parts`.
#![no_main]

use std::path::Path;

use ramp_fuzz::{GOALS, KIT, mcap_file, shows, software, target};
use ramp_real_run::poses::{QuaternionOrder, Reader};
use ramp_result::collection::parse;
use serde_json::{Value, json};

/// The clock's reading when the goal is handed over, s.
const BEGIN: u64 = 1_700_000_000;

fn check(bytes: &[u8]) {
    let topics = std::iter::once("/run").chain(std::iter::repeat("/parts"));
    let messages: Vec<(&str, &[u8])> = topics.zip(bytes.split(|byte| *byte == b'\n')).collect();
    let file = mcap_file(&messages, None);
    match (Reader { kit: &KIT, goals: &GOALS, software: &software(), order: QuaternionOrder::default() }).from_bytes(Path::new("x.mcap"), &file)
    {
        // A report accepts every value from a log.
        Ok(result) => {
            let parsed = parse("it", result.to_json().as_bytes());
            assert!(matches!(parsed, Ok(Some(_))), "{parsed:?}");
        }
        Err(error) => shows(error),
    }
}

/// A run in which every beam is seen at its place, twice.
fn seed() -> Vec<u8> {
    let run = json!({
        "schema": "ramp-poses-1", "rules": "ramp-rules-2", "goal": "easy-1", "repeat": 2, "track": "tags",
        "agent": "our-system", "version": "2.1", "robot": "arm", "computer": "a laptop", "cores": 8,
        "scorer": "A. Person", "source": "bench 2",
        "begin": {"sec": BEGIN, "nsec": 0}, "planning": 3.5, "end": {"sec": BEGIN + 200, "nsec": 0}, "ended": "done",
    });
    let x_wa = KIT.x_wa();
    let sight = |time: u64| -> Value {
        let transforms = GOALS[0].beams.iter().map(|placed| {
            let x_wb = x_wa * placed.x_ab;
            let (p, q) = (x_wb.translation.vector, x_wb.rotation.quaternion());
            json!({
                "timestamp": {"sec": BEGIN + time, "nsec": 0},
                "parent_frame_id": "world", "child_frame_id": placed.beam.name,
                "translation": {"x": p.x, "y": p.y, "z": p.z}, "rotation": {"x": q.i, "y": q.j, "z": q.k, "w": q.w},
            })
        });
        json!({"transforms": transforms.collect::<Vec<_>>()})
    };
    format!("{run}\n{}\n{}", sight(10), sight(199)).into_bytes()
}

target!([seed()], check);
