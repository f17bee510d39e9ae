//! Events of an episode, as data: the same in agents, their protocol, logs and results.

use std::fmt;

use ramp_source::{MAX_SENTENCE, is_name, is_text, plain, shorten};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::action::{Action, Argument};
use crate::cause::Cause;
use crate::fault::Fault;

/// The most events of an episode or a trial.
pub const MOST_EVENTS: usize = 10_000;
/// The most characters of the JSON of an event that an agent reports, without its time.
pub const MOST_EVENT: usize = 250;
/// The deepest nesting of lists and objects in an event.
const DEEPEST: usize = 4;

/// One thing that happened. Its JSON has the time `t`, the field `kind`, and the fields of that kind.
///
/// ```
/// use ramp_robot::{Cause, Event, EventKind};
/// let kind = EventKind::Diagnosis { cause: Cause::Jam, part: Some("b4".into()), evidence: "25 N".into() };
/// let event = Event::new(1.5, kind);
/// let json = r#"{"t":1.5,"kind":"diagnosis","cause":"jam","part":"b4","evidence":"25 N"}"#;
/// assert_eq!(serde_json::to_string(&event)?, json);
/// assert_eq!(serde_json::from_str::<Event>(json)?, event);
/// assert_eq!(event.kind.to_string(), "jam: 25 N");
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Robot time, s.
    #[serde(rename = "t")]
    pub time: f64,
    /// Its kind and the fields of that kind.
    #[serde(flatten)]
    pub kind: EventKind,
}

impl Event {
    /// At a robot time, s.
    pub fn new(time: f64, kind: EventKind) -> Event {
        Event { time, kind }
    }
}

/// A kind of event with its fields. `Display` gives the text for a person, without the kind's name.
///
/// Lengths are in m, forces in N, durations in s.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum EventKind {
    /// An action begins.
    ActionBegun(Action),
    /// The action has ended as it should.
    ActionEnded(Action),
    /// Something went wrong.
    Fault(Fault),
    /// A step is tried again.
    Retry(Retry),
    /// A search ended.
    Search(Search),
    /// A part was put down on a surface to measure its height.
    Touched {
        /// The part.
        part: String,
        /// The surface.
        surface: Surface,
        /// Height of each touching end over where it was believed, m.
        off: Vec<f64>,
    },
    /// A part was found at another place than expected.
    Seen {
        /// The part.
        part: String,
        /// Distance between the two places, m.
        off: f64,
    },
    /// The agent names the cause of a disturbance.
    Diagnosis {
        /// The cause.
        cause: Cause,
        /// The part that is affected.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        part: Option<String>,
        /// The evidence, for a person.
        evidence: String,
    },
    /// A new plan was made.
    Replan {
        /// Number of its coarse actions.
        coarse: usize,
    },
    /// A motion that the arm cannot make. Plans do without it. The form is that of `motion` in a state of the
    /// planner.
    Motion {
        /// The motion.
        cannot: Argument,
        /// The beam that is in the way.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        past: Option<Argument>,
        /// The reason, for a person.
        because: String,
    },
    /// The usual grasp of a beam cannot be used, and another one is.
    UnusualGrasp {
        /// The beam.
        beam: String,
        /// Distance of the grasp from the beam's j1 hole, m.
        s: f64,
        /// The hand is turned by half a turn.
        reverse: bool,
        /// Why the usual grasp cannot be used, for a person.
        because: String,
    },
    /// A skill cannot rehearse its motions. Its actions count as possible when a plan is checked.
    NotRehearsed {
        /// The skill.
        skill: String,
    },
    /// A command was clipped to the limits of the arm. Only the first one is reported.
    Clipped {},
    /// Anything else, for a person.
    Note {
        /// The text.
        text: String,
    },
    /// An injected fault struck. The episode reports it, no agent does.
    FaultStruck {
        /// The kind of the fault.
        fault: String,
        /// The part that it struck.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        part: Option<String>,
    },
    /// The arm stopped, for example by a reflex, and was ready again. The episode reports it, no agent does.
    Recovered {
        /// The robot's reason.
        why: String,
        /// Robot time for which the arm stood, s.
        after: f64,
    },
    /// The robot stopped for good, for example at a limit of a joint. The episode reports it, no agent does.
    Stopped {
        /// The robot's reason.
        why: String,
    },
}

/// A step that is tried again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Retry {
    /// The step, such as `insert`.
    pub step: String,
    /// The part or connection that it works on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// The number of the try that begins, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attempt: Option<usize>,
    /// Distance to the place after the last try, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub off: Option<f64>,
    /// The reason, for a person.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub because: Option<String>,
}

impl Retry {
    /// Of a step that works on a part or a connection.
    pub fn new(step: &str, part: &str) -> Retry {
        Retry { step: step.to_string(), part: Some(part.to_string()), ..Retry::default() }
    }

    /// The number of the try that begins, from 1.
    #[must_use]
    pub fn attempt(self, attempt: usize) -> Retry {
        Retry { attempt: Some(attempt), ..self }
    }

    /// The distance to the place after the last try, m.
    #[must_use]
    pub fn off(self, off: f64) -> Retry {
        Retry { off: Some(off), ..self }
    }

    /// The reason, for a person.
    #[must_use]
    pub fn because(self, because: impl fmt::Display) -> Retry {
        Retry { because: Some(because.to_string()), ..self }
    }
}

impl From<Retry> for EventKind {
    fn from(retry: Retry) -> EventKind {
        EventKind::Retry(retry)
    }
}

/// A search for the place of a part by contact.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Search {
    /// The method, such as `spiral`.
    pub method: String,
    /// The part or connection that was searched for.
    pub part: String,
    /// Its duration, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration: Option<f64>,
    /// Number of tries.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attempts: Option<usize>,
}

impl From<Search> for EventKind {
    fn from(search: Search) -> EventKind {
        EventKind::Search(search)
    }
}

impl From<Fault> for EventKind {
    fn from(fault: Fault) -> EventKind {
        EventKind::Fault(fault)
    }
}

/// A surface that a part is put down on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Surface {
    /// The table.
    Table,
    /// The floor of a sleeve.
    Floor,
}

impl EventKind {
    /// A motion that the arm cannot make, from a fact of the planner: `cannot`, `past` and `because`.
    pub fn motion(fact: &impl Serialize) -> EventKind {
        let mut value = serde_json::to_value(fact).unwrap_or_default();
        if let Some(fields) = value.as_object_mut() {
            fields.insert("kind".to_string(), "motion".into());
        }
        serde_json::from_value(value.clone()).unwrap_or_else(|_| EventKind::Note { text: value.to_string() })
    }

    /// Its name in JSON.
    pub fn name(&self) -> &'static str {
        match self {
            EventKind::ActionBegun(_) => "action_begun",
            EventKind::ActionEnded(_) => "action_ended",
            EventKind::Fault(_) => "fault",
            EventKind::Retry(_) => "retry",
            EventKind::Search(_) => "search",
            EventKind::Touched { .. } => "touched",
            EventKind::Seen { .. } => "seen",
            EventKind::Diagnosis { .. } => "diagnosis",
            EventKind::Replan { .. } => "replan",
            EventKind::Motion { .. } => "motion",
            EventKind::UnusualGrasp { .. } => "unusual_grasp",
            EventKind::NotRehearsed { .. } => "not_rehearsed",
            EventKind::Clipped {} => "clipped",
            EventKind::Note { .. } => "note",
            EventKind::FaultStruck { .. } => "fault_struck",
            EventKind::Recovered { .. } => "recovered",
            EventKind::Stopped { .. } => "stopped",
        }
    }

    /// Whether the episode reports it, and no agent does.
    pub fn is_of_episode(&self) -> bool {
        matches!(
            self,
            EventKind::FaultStruck { .. } | EventKind::Recovered { .. } | EventKind::Stopped { .. }
        )
    }

    /// The same with every text such as a result may hold: no control characters, and not too long. An event
    /// with a number that is not finite, which JSON cannot hold, becomes a note.
    #[must_use]
    pub fn plain(self) -> EventKind {
        let note = || EventKind::Note { text: plain(&self.to_string(), MAX_SENTENCE - 1) };
        let Ok(mut value) = serde_json::to_value(&self) else { return note() };
        make_plain(&mut value);
        serde_json::from_value(value).unwrap_or_else(|_| note())
    }

    /// Checks an event that somebody else made. `most` is the largest number of characters of its JSON.
    ///
    /// # Errors
    /// The first thing that is wrong with it, as the end of a sentence that begins with the event.
    pub fn check(&self, most: usize) -> Result<(), String> {
        let value = serde_json::to_value(self).map_err(|error| error.to_string())?;
        let length = value.to_string().chars().count();
        if length > most {
            return Err(format!("has {length} characters, and {most} is the most"));
        }
        check_value(&value, most, DEEPEST)?;
        if let EventKind::ActionBegun(action) | EventKind::ActionEnded(action) = self {
            let reserved = action.arguments.keys().find(|name| ["t", "kind"].contains(&name.as_str()));
            if let Some(name) = reserved {
                return Err(format!(
                    "has an action with an argument `{name}`, which is a field of the event"
                ));
            }
        }
        Ok(())
    }
}

fn make_plain(value: &mut Value) {
    match value {
        Value::String(text) if !is_text(text, MAX_SENTENCE) => *text = plain(text, MAX_SENTENCE - 1),
        Value::Array(list) => list.iter_mut().for_each(make_plain),
        Value::Object(fields) => fields.values_mut().for_each(make_plain),
        _ => {}
    }
}

fn check_value(value: &Value, most: usize, depth: usize) -> Result<(), String> {
    match value {
        Value::String(text) if is_text(text, most) => Ok(()),
        Value::String(text) => Err(format!("holds a control character: `{}`", shorten(text))),
        // JSON has no number for what is not finite.
        Value::Null => Err("holds a number that is not finite".to_string()),
        Value::Array(_) | Value::Object(_) if depth == 0 => Err("is nested too deep".to_string()),
        Value::Array(list) => list.iter().try_for_each(|it| check_value(it, most, depth - 1)),
        Value::Object(fields) => fields.iter().try_for_each(|(name, it)| {
            if !is_name(name) {
                return Err(format!("has a field `{}`, which is not a name", shorten(name)));
            }
            check_value(it, most, depth - 1)
        }),
        Value::Bool(_) | Value::Number(_) => Ok(()),
    }
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            EventKind::ActionBegun(action) | EventKind::ActionEnded(action) => write!(f, "{action}"),
            EventKind::Fault(fault) => write!(f, "{fault}"),
            EventKind::Retry(retry) => write!(f, "{retry}"),
            EventKind::Search(search) => write!(f, "{search}"),
            EventKind::Touched { part, surface, off } => {
                let surface = match surface {
                    Surface::Table => "table",
                    Surface::Floor => "floor of its sleeve",
                };
                let off: Vec<String> = off.iter().map(|off| format!("{:.2}", off * 1e3)).collect();
                write!(f, "{part} touched the {surface} {} mm off", off.join(" and "))
            }
            EventKind::Seen { part, off } => {
                write!(f, "{part} is {:.1} mm from where it was believed", off * 1e3)
            }
            EventKind::Diagnosis { cause, evidence, .. } => write!(f, "{cause}: {evidence}"),
            EventKind::Replan { coarse } => write!(f, "{coarse} coarse actions"),
            EventKind::Motion { cannot, past, because } => {
                cannot_in_words(cannot, f)?;
                match past {
                    Some(Argument::Named(past)) => {
                        for (where_, beam) in past {
                            match where_.as_str() {
                                "stands" => write!(f, " once {beam} is placed")?,
                                _ => write!(f, " while {beam} is at its start pose")?,
                            }
                        }
                    }
                    Some(past) => write!(f, " while {past} is in the way")?,
                    None => {}
                }
                write!(f, ": {because}")
            }
            EventKind::UnusualGrasp { beam, s, reverse, because } => {
                let turned = if *reverse { ", with the hand turned by 180°" } else { "" };
                let s = s * 1e3;
                write!(
                    f,
                    "{beam} is gripped {s:.0} mm from its j1 hole{turned}; by the usual grasp {because}"
                )
            }
            EventKind::NotRehearsed { skill } => {
                write!(f, "not rehearsed: {skill}; its actions count as possible")
            }
            EventKind::Clipped {} => {
                f.write_str("a command was clipped to the limits of the arm; more may follow")
            }
            EventKind::Note { text } => f.write_str(text),
            EventKind::FaultStruck { fault, part: Some(part) } => write!(f, "{fault} strikes {part}"),
            EventKind::FaultStruck { fault, part: None } => write!(f, "{fault} strikes"),
            EventKind::Recovered { why, after } => {
                write!(f, "{why}; the arm is ready again after {after:.1} s")
            }
            EventKind::Stopped { why } => f.write_str(why),
        }
    }
}

/// A motion that cannot be made, in words.
fn cannot_in_words(cannot: &Argument, f: &mut fmt::Formatter) -> fmt::Result {
    let Argument::Named(named) = cannot else { return write!(f, "{cannot} is impossible") };
    for (what, fields) in named {
        let field = |name: &str| match fields {
            Argument::Named(fields) => fields.get(name).map(ToString::to_string).unwrap_or_default(),
            other => other.to_string(),
        };
        match what.as_str() {
            "grasp" => {
                let place = if field("at") == "start" { "in its start pose" } else { "in its goal pose" };
                write!(f, "{} cannot be grasped at {} {place}", field("beam"), field("link"))?;
            }
            "insert" => {
                write!(f, "{} cannot be inserted along the path {}", field("beam"), field("path"))?;
            }
            "fasten" => write!(f, "{} cannot be fastened", field("connection"))?,
            other => write!(f, "{} {fields} is impossible", other.replace('_', " "))?,
        }
    }
    Ok(())
}

impl fmt::Display for Retry {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.step.replace('_', " "))?;
        if let Some(part) = &self.part {
            write!(f, " {part}")?;
        }
        if let Some(attempt) = self.attempt {
            write!(f, ", try {attempt}")?;
        }
        if let Some(off) = self.off {
            write!(f, ", {:.2} mm off", off * 1e3)?;
        }
        match &self.because {
            Some(because) => write!(f, ": {because}"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Search {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.part, self.method.replace('_', " "))?;
        if let Some(attempts) = self.attempts {
            write!(f, ", {attempts} tries")?;
        }
        match self.duration {
            Some(duration) => write!(f, ", {duration:.1} s"),
            None => Ok(()),
        }
    }
}
