//! Results of the two versions before: they name neither arm nor start, and the events of the older one are a
//! kind and a text.

use ramp_kit::source::without_mark;
use ramp_robot::{Event, EventKind};
use ramp_world::Start;
use serde::de::{DeserializeOwned, Error};
use serde_json::Value;

use crate::start::StartInfo;

/// The begin of the names of episodes' schemas. Trials name no arm.
const EPISODE: &str = "ramp-episode-";
/// The arm of episodes in these versions.
const ARM: &str = "panda";

/// Reads a result. One of the two older schemas becomes one of the newest. Their parts lay on the sheet.
///
/// # Errors
/// When it is not JSON, or not a result.
pub(crate) fn read<T: DeserializeOwned>(
    bytes: &[u8],
    [oldest, older]: [&str; 2],
    newest: &str,
) -> Result<T, serde_json::Error> {
    let bytes = without_mark(bytes);
    // From the bytes, so that a message has its line and column.
    let Ok(mut value) = serde_json::from_slice::<Value>(bytes) else { return serde_json::from_slice(bytes) };
    if value["schema"] != oldest && value["schema"] != older {
        return serde_json::from_slice(bytes);
    }
    if value["schema"] == oldest {
        for event in value["events"].as_array_mut().into_iter().flatten() {
            *event = converted(event)?;
        }
    }
    // In a trial, `start` was the draw.
    if let Some(drawn) = value.get("start").cloned() {
        value["drawn"] = drawn;
        if let Some(drawn) = value["drawn"].as_object_mut() {
            let draws = drawn.remove("drawn").unwrap_or_default();
            drawn.insert("draws".to_string(), draws);
        }
    }
    if value["world"].is_object() {
        value["start"] = serde_json::to_value(StartInfo::of(Start::sheet()))?;
        if newest.starts_with(EPISODE) {
            value["arm"] = ARM.into();
        }
    }
    value["schema"] = newest.into();
    serde_json::from_value(value)
}

/// An older event in the form of today.
fn converted(event: &Value) -> Result<Value, serde_json::Error> {
    let wrong = |field: &str| serde_json::Error::custom(format!("an event has no `{field}`"));
    let time = event["t"].as_f64().ok_or_else(|| wrong("t"))?;
    let kind = event["kind"].as_str().ok_or_else(|| wrong("kind"))?;
    let text = event["what"].as_str().ok_or_else(|| wrong("what"))?;
    serde_json::to_value(Event::new(time, EventKind::of_words(kind, text)))
}

#[cfg(test)]
mod tests {
    use ramp_robot::{Action, Cause};

    use super::*;
    use crate::activity;
    use crate::episode::{EpisodeResult, SCHEMA};
    use crate::manipulation;

    /// A result of `ramp run easy-1 --fault jam@1` as the version before wrote it.
    const OLDER: &str = include_str!("older/episode-3.json");

    fn episode() -> EpisodeResult {
        EpisodeResult::from_json(OLDER.as_bytes()).unwrap()
    }

    #[test]
    fn a_result_of_the_schema_before_is_read_with_its_actions_and_diagnoses() {
        let result = episode();
        assert_eq!((result.schema.as_str(), result.events.len()), (SCHEMA, 123));
        assert_eq!(result.arm.as_deref(), Some("panda"));
        let EventKind::ActionBegun(action) = &result.events[2].kind else { panic!() };
        assert_eq!(*action, Action::new("pick_up").with("item", "b4").with("grasp", "b4l2"));
        let jams = |event: &Event| matches!(event.kind, EventKind::Diagnosis { cause: Cause::Jam, .. });
        assert_eq!(result.events.iter().filter(|event| jams(event)).count(), 1);
        // Written again, it is of the schema of today.
        assert_eq!(EpisodeResult::from_json(result.to_json().as_bytes()).unwrap(), result);
    }

    /// The parts of older results lay on the sheet.
    #[test]
    fn a_result_without_a_start_is_of_the_sheet() {
        let mut value: Value = serde_json::from_slice(episode().to_json().as_bytes()).unwrap();
        value["schema"] = "ramp-episode-4".into();
        value.as_object_mut().unwrap().remove("start");
        let read = EpisodeResult::from_json(value.to_string().as_bytes()).unwrap();
        assert_eq!(read, episode());
        assert_eq!(read.start.map(|start| start.name), Some("sheet".to_string()));
    }

    #[test]
    fn an_older_event_reads_as_it_did() {
        let older: Value = serde_json::from_str(OLDER).unwrap();
        for (event, older) in episode().events.iter().zip(older["events"].as_array().unwrap()) {
            assert_eq!(event.kind.to_string(), older["what"].as_str().unwrap());
        }
    }

    #[test]
    fn the_robot_time_of_an_older_result_is_that_of_its_words() {
        let found = activity::times(&episode()).map(|time| (time * 1e3).round() / 1e3);
        assert_eq!(found, [18.544, 6.815, 20.982, 6.308, 0.0, 0.042]);
    }

    #[test]
    fn an_older_event_without_a_text_is_refused() {
        let wrong = OLDER.replacen("\"what\"", "\"why\"", 1);
        let error = EpisodeResult::from_json(wrong.as_bytes()).unwrap_err().to_string();
        assert!(error.contains("an event has no `what`"), "{error}");
    }

    #[test]
    fn older_schemas_are_not_read() {
        assert!(EpisodeResult::reads("ramp-episode-3") && EpisodeResult::reads("ramp-episode-4"));
        assert!(!EpisodeResult::reads("ramp-episode-2"));
        assert!(manipulation::Trial::reads("ramp-manipulation-2"));
        assert!(!manipulation::Trial::reads("ramp-manipulation-1"));
    }
}
