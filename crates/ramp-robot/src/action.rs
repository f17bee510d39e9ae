//! An action of a plan as an event reports it: a kind and its arguments, in the form of the plan's JSON.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

/// An action. Its JSON is that of a fine action in a plan: `{"action": "push", "beam": "b4", "link":
/// "b4l2"}`.
///
/// ```
/// use ramp_robot::Action;
/// let action: Action = serde_json::from_str(
///     r#"{"action": "pick_up", "item": {"beam": "b4"}, "grasp": {"link": "b4l1"}}"#,
/// )?;
/// assert_eq!(action.to_string(), "pick up b4 by b4l1");
/// let own: Action = serde_json::from_str(r#"{"action": "wipe_table", "with": "a cloth"}"#)?;
/// assert_eq!(own.to_string(), "wipe table with a cloth");
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Action {
    /// Its kind, such as `pick_up`.
    #[serde(rename = "action")]
    pub kind: String,
    /// Its arguments by name.
    #[serde(flatten)]
    pub arguments: BTreeMap<String, Argument>,
}

/// An argument of an action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Argument {
    /// A name or a word.
    Text(String),
    /// A number in SI units.
    Number(f64),
    /// Several arguments.
    List(Vec<Argument>),
    /// Arguments by name, such as `{"beam": "b4"}`.
    Named(BTreeMap<String, Argument>),
}

/// How an action reads: its kind, and a phrase in which `{name}` stands for an argument. An action that is
/// not listed here reads as its kind followed by its arguments.
const PHRASES: [(&str, &str); 16] = [
    ("move", "move to {to}"),
    ("pick_up", "pick up {item} by {grasp}"),
    ("put_down", "put down {item}"),
    ("assemble_angled", "insert {beam} at an angle by {joint}"),
    ("assemble_deep", "insert {beam} too deep by {joint}"),
    ("assemble_square", "insert {beam} by {joint}"),
    ("assemble_through", "slide {beam} in by {joint} until {through} is in its sleeve"),
    ("assemble_cap", "cap with {beam} at {joints}"),
    ("lay_down", "lay down {beam} at its place"),
    ("slide", "slide {beam} forward by {link}"),
    ("regrasp", "regrasp {beam} by {link}"),
    ("fasten", "fasten {connection} ({male}-{female}) with {peg}"),
    ("push", "push {beam} by {link}"),
    ("take_out", "draw {beam} out by {link}"),
    ("pull_out", "pull {peg} out of {connection}"),
    ("slide_back", "slide {beam} back by {link}"),
];

impl Action {
    /// Without arguments.
    pub fn new(kind: &str) -> Action {
        Action { kind: kind.to_string(), arguments: BTreeMap::new() }
    }

    /// From an action of a plan, or anything else whose JSON is an object with the field `action`; an action
    /// without a kind from other values.
    pub fn of(action: &impl Serialize) -> Action {
        let value = serde_json::to_value(action).unwrap_or_default();
        serde_json::from_value(value).unwrap_or_default()
    }

    /// The same with one more argument.
    #[must_use]
    pub fn with(mut self, name: &str, value: &str) -> Action {
        self.arguments.insert(name.to_string(), Argument::Text(value.to_string()));
        self
    }

    /// The action that reads like this, if there is a phrase for it.
    pub(crate) fn from_words(words: &str) -> Option<Action> {
        PHRASES.iter().find_map(|(kind, phrase)| {
            let arguments = matched(phrase, words)?;
            Some(Action { kind: (*kind).to_string(), arguments })
        })
    }
}

/// The arguments with which a phrase gives these words.
fn matched(phrase: &str, words: &str) -> Option<BTreeMap<String, Argument>> {
    let mut pieces = phrase.split('{');
    let mut rest = words.strip_prefix(pieces.next()?)?;
    let mut arguments = BTreeMap::new();
    for piece in pieces {
        let (name, literal) = piece.split_once('}')?;
        let end = if literal.is_empty() { rest.len() } else { rest.find(literal)? };
        arguments.insert(name.to_string(), Argument::Text(rest[..end].to_string()));
        rest = &rest[end + literal.len()..];
    }
    rest.is_empty().then_some(arguments)
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let phrase = PHRASES.iter().find(|(kind, _)| *kind == self.kind).and_then(|(_, it)| self.fill(it));
        if let Some(text) = phrase {
            return f.write_str(&text);
        }
        f.write_str(&self.kind.replace('_', " "))?;
        for (name, value) in &self.arguments {
            write!(f, " {} {value}", name.replace('_', " "))?;
        }
        Ok(())
    }
}

impl Action {
    /// A phrase with the arguments in their places; `None` when it needs others than there are.
    fn fill(&self, phrase: &str) -> Option<String> {
        if phrase.matches('{').count() != self.arguments.len() {
            return None;
        }
        let mut pieces = phrase.split('{');
        let mut text = pieces.next()?.to_string();
        for piece in pieces {
            let (name, literal) = piece.split_once('}')?;
            text.push_str(&self.arguments.get(name)?.to_string());
            text.push_str(literal);
        }
        Some(text)
    }
}

impl fmt::Display for Argument {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Argument::Text(text) if text == "head" => f.write_str("its head"),
            Argument::Text(text) => f.write_str(text),
            Argument::Number(number) => write!(f, "{number}"),
            Argument::List(list) => {
                for (index, argument) in list.iter().enumerate() {
                    write!(f, "{}{argument}", if index == 0 { "" } else { ", " })?;
                }
                Ok(())
            }
            Argument::Named(named) => {
                for (index, (name, argument)) in named.iter().enumerate() {
                    f.write_str(if index == 0 { "" } else { ", " })?;
                    match (name.as_str(), argument) {
                        ("beam" | "peg" | "connection" | "link", it) => write!(f, "{it}")?,
                        ("input", it) => write!(f, "the start of {it}")?,
                        ("approach", it) => write!(f, "the approach of {it}")?,
                        ("target", it) => write!(f, "the place of {it}")?,
                        ("above", Argument::Text(area)) => match area.as_str() {
                            "input" => f.write_str("above the sheet")?,
                            "intermediate" => f.write_str("above the intermediate area")?,
                            "assembly" => f.write_str("above the assembly")?,
                            other => write!(f, "above {other}")?,
                        },
                        (name, it) => write!(f, "{} {it}", name.replace('_', " "))?,
                    }
                }
                Ok(())
            }
        }
    }
}
