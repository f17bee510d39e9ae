//! Things that the hand can hold, how it holds them, and the places that it moves to.

use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};

/// Coarse places: three areas in a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Area {
    /// Over the sheet.
    #[default]
    Input,
    /// Between the sheet and the assembly.
    Intermediate,
    /// Over the assembly.
    Assembly,
}

/// A thing the hand can hold.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Item {
    /// A beam, by name.
    Beam(String),
    /// A peg, by name.
    Peg(String),
}

impl Item {
    /// Its name in the kit.
    pub fn name(&self) -> &str {
        match self {
            Item::Beam(name) | Item::Peg(name) => name,
        }
    }
}

/// How the hand holds a thing.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Grasp {
    /// A beam, by one of its links.
    Link(String),
    /// A peg, by its head.
    Head,
}

/// Fine places of the hand.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// Over an area, clear of everything.
    Above(Area),
    /// Over the start place of an item.
    Input(Item),
    /// The start of a beam's insertion path, or over the hole of a connection.
    Approach(Target),
    /// The place itself.
    Target(Target),
}

impl Place {
    /// The part that the place belongs to, by name; `None` over an area or a connection.
    pub fn part(&self) -> Option<&str> {
        match self {
            Place::Input(item) => Some(item.name()),
            Place::Approach(Target::Beam(beam)) | Place::Target(Target::Beam(beam)) => Some(beam),
            Place::Above(_) | Place::Approach(_) | Place::Target(_) => None,
        }
    }
}

/// The owner of a fine place.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// A beam's place in the assembly.
    Beam(String),
    /// A connection's hole.
    Connection(String),
}

// In words, for people and for the golden files of the tests.

impl Display for Area {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Area::Input => "the sheet",
            Area::Intermediate => "the intermediate area",
            Area::Assembly => "the assembly",
        })
    }
}

impl Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Display for Grasp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Grasp::Link(link) => f.write_str(link),
            Grasp::Head => f.write_str("its head"),
        }
    }
}

impl Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Above(area) => write!(f, "above {area}"),
            Place::Input(item) => write!(f, "the start of {item}"),
            Place::Approach(target) => write!(f, "the approach of {target}"),
            Place::Target(target) => write!(f, "the place of {target}"),
        }
    }
}

impl Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Target::Beam(name) | Target::Connection(name) => f.write_str(name),
        }
    }
}
