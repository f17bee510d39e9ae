//! Checks of the texts and lists of a result file: names, text for a person, hashes, and how many of
//! each. Whoever shows a result, or calls a file after something in it, relies on this.

use ramp_kit::source::{A_NAME, MAX_SENTENCE, MAX_TITLE, is_name, is_text, shorten};
use ramp_robot::{Event, MOST_EVENTS};

use crate::episode::{AgentInfo, Host, Software, StartInfo, StateInfo, WorldInfo};

/// Largest number of pegs of a goal.
pub const MOST_PEGS: usize = 1000;
/// Largest number of parts of a frame.
pub const MOST_PARTS: usize = 2 * MOST_PEGS;
/// The longest JSON of an event, characters.
const LONGEST_EVENT: usize = 4 * MAX_SENTENCE;
/// The most quantities that a world draws, and the longest list of numbers of one.
const MOST_NUMBERS: usize = 200;

/// Checks a name.
pub(crate) fn name(what: &str, text: &str) -> Result<(), String> {
    match is_name(text) {
        true => Ok(()),
        false => Err(format!("{what} is `{}`, expected {A_NAME}", shorten(text))),
    }
}

/// Checks a text for a person, no longer than a title.
pub(crate) fn title(what: &str, text: &str) -> Result<(), String> {
    words(what, text, MAX_TITLE)
}

/// Checks a text for a person, no longer than a sentence or two.
pub(crate) fn sentence(what: &str, text: &str) -> Result<(), String> {
    words(what, text, MAX_SENTENCE)
}

fn words(what: &str, text: &str, most: usize) -> Result<(), String> {
    match is_text(text, most) {
        true => Ok(()),
        false => Err(format!(
            "{what} is `{}`, expected at most {most} characters and no control character",
            shorten(text)
        )),
    }
}

/// Checks a hash of `digits` hexadecimal digits.
pub(crate) fn hash(what: &str, text: &str, digits: usize) -> Result<(), String> {
    match text.len() == digits && text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        true => Ok(()),
        false => Err(format!("{what} is `{}`, expected {digits} hexadecimal digits", shorten(text))),
    }
}

/// Checks that a list has at most `most` elements.
pub(crate) fn few<T>(what: &str, list: &[T], most: usize) -> Result<(), String> {
    match list.len() <= most {
        true => Ok(()),
        false => Err(format!("it has {} {what}, expected at most {most}", list.len())),
    }
}

/// The start's name and hash.
pub(crate) fn start(start: &StartInfo) -> Result<(), String> {
    name("the start", &start.name)?;
    hash("the hash of the start", &start.sha256, 64)
}

/// The hash of a state, which must be that of its text.
pub(crate) fn state(state: &StateInfo) -> Result<(), String> {
    hash("the hash of the state", &state.sha256, 64)?;
    match *state == StateInfo::of(&state.json) {
        true => Ok(()),
        false => Err("the state does not match its hash".to_string()),
    }
}

/// The world's name, hash and draw.
pub(crate) fn world(world: &WorldInfo) -> Result<(), String> {
    name("the world", &world.name)?;
    hash("the hash of the world", &world.sha256, 64)?;
    few("numbers of the world", &Vec::from_iter(&world.draw), MOST_NUMBERS)?;
    for (quantity, numbers) in &world.draw {
        name("a number of the world", quantity)?;
        few("numbers of the world", numbers, MOST_NUMBERS)?;
    }
    Ok(())
}

/// The agent's name, version and hash.
pub(crate) fn agent(agent: &AgentInfo) -> Result<(), String> {
    name("the agent's name", &agent.name)?;
    name("the agent's version", &agent.version)?;
    agent.sha256.as_ref().map_or(Ok(()), |text| hash("the agent's hash", text, 64))
}

/// The version and the commit of the software.
pub(crate) fn software(software: &Software) -> Result<(), String> {
    name("the version of the software", &software.version)?;
    name("the commit of the software", &software.commit)
}

/// The machine.
pub(crate) fn host(host: &Host) -> Result<(), String> {
    title("the processor", &host.cpu)
}

/// Class, where there is one, and track.
pub(crate) fn class_and_track(class: Option<&str>, track: &str) -> Result<(), String> {
    class.map_or(Ok(()), known_class)?;
    match ramp_robot::Track::ALL.iter().any(|known| known.name() == track) {
        true => Ok(()),
        false => Err(format!("there is no track `{}`", shorten(track))),
    }
}

/// Checks that the class exists.
pub(crate) fn known_class(class: &str) -> Result<(), String> {
    match ramp_assembly::Class::of_name(class) {
        Some(_) => Ok(()),
        None => Err(format!("there is no class `{}`", shorten(class))),
    }
}

/// Events up to the latest time, s.
pub(crate) fn events(events: &[Event], latest: f64) -> Result<(), String> {
    few("events", events, MOST_EVENTS)?;
    for event in events {
        if !(0.0..=latest).contains(&event.time) {
            return Err(format!("an event is at {} s", event.time));
        }
        event.kind.check(LONGEST_EVENT).map_err(|why| format!("an event {why}"))?;
    }
    Ok(())
}
